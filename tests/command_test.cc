// The command as its users and their scripts meet it: exit codes, what goes to which stream, JSON when things go wrong,
// hints, runs that are interrupted or killed.

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

const fs::path kExamples = fs::path(FERRERS_SOURCE_DIR) / "examples";

// A triangle whose third joint lies out of reach.
constexpr const char* kOpenModel = R"(ferrers: 1
name: triangle
bodies:
  a: {mass: 1, com: [0.5, 0, 0], pose: {position: [0, 0, 0]}}
  b: {mass: 1, com: [0.5, 0, 0], pose: {position: [1, 0, 0]}}
joints:
  O: {type: revolute, bodies: [ground, a], at: {ground: [0, 0, 0], a: [0, 0, 0]}, axis: z}
  A: {type: revolute, bodies: [a, b], at: {a: [1, 0, 0], b: [0, 0, 0]}, axis: z}
  B: {type: revolute, bodies: [b, ground], at: {b: [1, 0, 0], ground: [5, 0, 0]}, axis: z}
)";

// Two mistakes.
constexpr const char* kWrongModel = R"(ferrers: 1
name: wrong
bodies:
  a: {mass: 1 m, com: [0, 0, 0]}
joints:
  j: {type: revolut, bodies: [ground, a], at: [0, 0, 0], axis: z}
)";

// A pendulum without a mass, and with a drive.
constexpr const char* kMasslessModel = R"(ferrers: 1
name: massless
bodies:
  a: {}
joints:
  j: {type: revolute, bodies: [ground, a], at: [0, 0, 0], axis: z}
drives:
  motor: {joint: j, motion: = 2*t}
)";

std::string read_text(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::vector<std::string> lines_of(const fs::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

struct Result {
  int exit_code = -1;  ///< -1 when a signal ended it.
  int signal = 0;
  std::string output, errors;
  ordered_json json() const { return ordered_json::parse(output, nullptr, /*allow_exceptions=*/false); }
};

/// A scratch folder, in which the command runs.
class CommandTest : public testing::Test {
 protected:
  CommandTest()
      : folder_(fs::temp_directory_path() / ("ferrers-command-" + std::to_string(getpid())) /
                testing::UnitTest::GetInstance()->current_test_info()->name()) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~CommandTest() override {
    std::error_code ignored;
    if (!HasFailure()) fs::remove_all(folder_, ignored);
    fs::remove(folder_.parent_path(), ignored);
  }

  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }

  pid_t start(const std::vector<std::string>& arguments) const {
    const pid_t child = fork();
    if (child != 0) return child;
    const auto redirect = [&](const char* name, int descriptor) {
      const int file = open((folder_ / name).c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600);
      dup2(file, descriptor);
    };
    redirect("stdout", STDOUT_FILENO);
    redirect("stderr", STDERR_FILENO);
    if (chdir(folder_.c_str()) != 0) _exit(126);
    std::vector<std::string> words = {FERRERS_COMMAND};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    execv(pointers[0], pointers.data());
    _exit(127);
  }

  Result wait_for(pid_t child) const {
    int status = 0;
    waitpid(child, &status, 0);
    Result result;
    if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
    if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
    result.output = read_text(folder_ / "stdout");
    result.errors = read_text(folder_ / "stderr");
    return result;
  }

  Result run(const std::vector<std::string>& arguments) const { return wait_for(start(arguments)); }

  /// Starts a run of many hours and waits until some of its rows are in the file.
  pid_t start_long_run() const {
    const pid_t child =
        start({"simulate", (kExamples / "pendulum-a01/model.yaml").string(), "--end", "50000", "-o", "run"});
    for (int i = 0; i < 600 && lines_of(folder_ / "run/result.csv").size() < 20; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return child;
  }

  fs::path folder_;
};

std::string bricard() { return (kExamples / "bricard-a04/model.yaml").string(); }

// ---------------------------------------------------------------------------------------------------------------------
// The command line

TEST_F(CommandTest, HelpAndVersionAreResultsAndNotErrors) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"--help"},
                                                    {"--version"},
                                                    {"analyze", "--help"},
                                                    {"simulate", "-h"},
                                                    {"inverse", "--help"},
                                                    {"kinematics", "--help"},
                                                    {"equilibrium", "--help"},
                                                    {"linearize", "--help"},
                                                    {"schema", "--help"},
                                                    {"new", "--help"},
                                                    {"doctor", "--help"}}) {
    const Result result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << arguments.front();
    EXPECT_THAT(result.output, Not(IsEmpty()));
    EXPECT_THAT(result.errors, IsEmpty());
  }
}

TEST_F(CommandTest, HelpListsWhatThereIsAndNothingElse) {
  const std::string help = run({"--help"}).output;
  for (const char* verb :
       {"analyze", "inverse", "simulate", "kinematics", "equilibrium", "linearize", "schema", "new", "doctor"}) {
    EXPECT_THAT(help, HasSubstr("\n  " + std::string(verb) + " "));
  }
  for (const char* verb : {"view", "report", "sweep", "optimize", "plot", "convert"}) {
    EXPECT_THAT(help, Not(HasSubstr("\n  " + std::string(verb) + " ")));
  }
  EXPECT_THAT(run({"simulate", "--help"}).output, HasSubstr("Examples:"));
}

TEST_F(CommandTest, HelpNamesTheFormulationThatIsTaken) {
  const std::string help = run({"simulate", "--help"}).output;
  const Result taken = run({"simulate", bricard(), "--end", "0.01", "-o", (folder_ / "taken").string(), "--json"});
  const std::string method = taken.json().at("method");
  EXPECT_THAT(help, HasSubstr("[" + method.substr(method.rfind(' ') + 1) + "]"));
}

TEST_F(CommandTest, AVerbThatIsMistypedIsNamedWithTheOneMeant) {
  const Result result = run({"analize", bricard()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, IsEmpty());
  EXPECT_THAT(result.errors, HasSubstr("unknown verb 'analize'; did you mean 'analyze'?"));
}

TEST_F(CommandTest, AVerbLikeNoOtherIsToldTheVerbsThatThereAre) {
  const Result result = run({"chek", bricard()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, IsEmpty());
  EXPECT_THAT(result.errors, HasSubstr("unknown verb 'chek'; the verbs are analyze, inverse, simulate, "));
}

TEST_F(CommandTest, HelpIsAlsoAWordAndTellsTheSame) {
  const std::string general = run({"--help"}).output;
  EXPECT_THAT(general, HasSubstr("ferrers help VERB"));
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"help"}, {"help", "--help"}, {"help", "help"}}) {
    const Result result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << testing::PrintToString(arguments);
    EXPECT_EQ(result.output, general) << testing::PrintToString(arguments);
    EXPECT_THAT(result.errors, IsEmpty());
  }
  for (const std::string verb :
       {"analyze", "inverse", "simulate", "kinematics", "equilibrium", "linearize", "schema", "new", "doctor"}) {
    const Result result = run({"help", verb});
    EXPECT_EQ(result.exit_code, 0) << verb;
    EXPECT_EQ(result.output, run({verb, "--help"}).output) << verb;
    EXPECT_THAT(result.output, Not(general));
  }
}

TEST_F(CommandTest, HelpOnAVerbThatIsNoneIsAnError) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"analize", "--help"}, {"--help", "analize"}, {"help", "analize"}}) {
    const Result result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << testing::PrintToString(arguments);
    EXPECT_THAT(result.output, IsEmpty()) << testing::PrintToString(arguments);
    EXPECT_THAT(result.errors, HasSubstr("unknown verb 'analize'; did you mean 'analyze'?"));
  }
}

TEST_F(CommandTest, AnOptionThatIsMistypedIsNamedWithTheOneMeant) {
  const Result result = run({"simulate", bricard(), "--tolerence", "1e-9"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, IsEmpty());
  EXPECT_THAT(result.errors, HasSubstr("unknown option '--tolerence'; did you mean '--tolerance'?"));
}

TEST_F(CommandTest, AChoiceThatIsMistypedIsNamedWithTheOneMeant) {
  const Result result = run({"simulate", bricard(), "--integrator", "runge-kuta-4"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.errors, HasSubstr("did you mean 'runge-kutta-4'?"));
}

TEST_F(CommandTest, ABadCommandLineIsExitTwo) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{},
                                                    {"analyze"},
                                                    {"simulate", bricard(), "--step", "0"},
                                                    {"simulate", bricard(), "--step", "nan"},
                                                    {"simulate", bricard(), "--end", "-1"},
                                                    {"simulate", bricard(), "--end", "ten"},
                                                    {"simulate", bricard(), "--step", "0.1", "--tolerance", "1e-9"},
                                                    {"simulate", bricard(), "--every", "1e-12"},
                                                    {"analyze", bricard(), "another.yaml"},
                                                    {"analyze", bricard(), "-p"},
                                                    {"new", "no-such-example"}}) {
    const Result result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << testing::PrintToString(arguments);
    EXPECT_THAT(result.output, IsEmpty()) << testing::PrintToString(arguments);
    EXPECT_THAT(result.errors, Not(IsEmpty())) << testing::PrintToString(arguments);
  }
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(CommandTest, OneParameterOptionTakesOneParameter) {
  EXPECT_EQ(run({"analyze", "-p", "a=500 mm", bricard()}).exit_code, 0);
  EXPECT_EQ(run({"analyze", "-p", "a=500 mm", "-p", "c=50 mm", bricard()}).exit_code, 0);
}

// ---------------------------------------------------------------------------------------------------------------------
// What simulate can be asked for

std::vector<std::string> last_row(const fs::path& folder) {
  const std::vector<std::string> lines = lines_of(folder / "result.csv");
  return {lines.front(), lines.back()};
}

TEST_F(CommandTest, ARunThatGoesOnEndsWhereTheWholeRunEnds) {
  ASSERT_EQ(run({"simulate", bricard(), "--end", "1", "-o", "whole"}).exit_code, 0);
  ASSERT_EQ(run({"simulate", bricard(), "--end", "0.5", "-o", "half"}).exit_code, 0);
  ASSERT_EQ(run({"simulate", bricard(), "--end", "1", "--restart", "half", "-o", "rest"}).exit_code, 0);
  const std::vector<std::string> whole = last_row(folder_ / "whole"), rest = last_row(folder_ / "rest");
  EXPECT_EQ(whole[0], rest[0]);
  EXPECT_EQ(lines_of(folder_ / "rest/result.csv").size(), 1u + 51u);
  std::istringstream a(whole[1]), b(rest[1]);
  std::string x, y;
  while (std::getline(a, x, ',') && std::getline(b, y, ',')) EXPECT_NEAR(std::stod(x), std::stod(y), 1e-9);
}

TEST_F(CommandTest, ARunGoesOnWithoutTheDriveThatWasSwitchedOff) {
  const std::string model = write("slide.yaml", R"(ferrers: 1
gravity: [0, 0, 0]
bodies: {m: {mass: 2, com: [0, 0, 0]}}
joints: {g: {type: prismatic, bodies: [ground, m], at: [0, 0, 0], axis: x}}
drives: {push: {joint: g, effort: "= 4"}}
events: {off: {when: "= t - 0.5", do: switch, drive: push}}
)")
                                .string();
  ASSERT_EQ(run({"simulate", model, "--end", "1", "-o", "half"}).exit_code, 0);
  const Result rest = run({"simulate", model, "--end", "2", "--restart", "half", "-o", "rest", "--json"});
  ASSERT_EQ(rest.exit_code, 0) << rest.errors;
  EXPECT_EQ(rest.json().at("drives_off"), ordered_json::array({"push"}));
  EXPECT_NEAR(rest.json().at("energy").at("end").get<double>(), 1, 1e-12);  // 2 kg at 1 m/s
  fs::remove(folder_ / "half/summary.json");
  const Result killed = run({"simulate", model, "--end", "2", "--restart", "half", "-o", "rest"});
  EXPECT_EQ(killed.exit_code, 3);
  EXPECT_THAT(killed.errors, HasSubstr("from the start"));
}

TEST_F(CommandTest, AFolderThatIsNoRunOfTheModelIsRefusedWithTheReason) {
  const Result missing = run({"simulate", bricard(), "--restart", "nowhere", "-o", "out"});
  EXPECT_EQ(missing.exit_code, 3);
  EXPECT_THAT(missing.errors, HasSubstr("nowhere"));
  ASSERT_EQ(
      run({"simulate", (kExamples / "pendulum-a01/model.yaml").string(), "--end", "0.1", "-o", "other"}).exit_code, 0);
  const Result other = run({"simulate", bricard(), "--restart", "other", "-o", "out"});
  EXPECT_EQ(other.exit_code, 3);
  EXPECT_THAT(other.errors, HasSubstr("J1.angle"));
}

TEST_F(CommandTest, DrivenDrivesFollowTheirLawsInASimulation) {
  const std::string model = (kExamples / "four-bar-driven/model.yaml").string();
  ASSERT_EQ(run({"simulate", model, "--driven", "--end", "0.5", "-o", "driven"}).exit_code, 0);
  ASSERT_EQ(run({"inverse", model, "--end", "0.5", "-o", "inverse"}).exit_code, 0);
  const std::vector<std::string> a = last_row(folder_ / "driven"), b = last_row(folder_ / "inverse");
  EXPECT_EQ(a[0], b[0]);
  std::istringstream x(a[1]), y(b[1]);
  std::string left, right;
  while (std::getline(x, left, ',') && std::getline(y, right, ',')) {
    EXPECT_NEAR(std::stod(left), std::stod(right), 1e-7 * std::max(1.0, std::abs(std::stod(right))));
  }
}

// One of the balls closes the loop, so that its rates are no coordinates of the engine.
TEST_F(CommandTest, LawsReadTheRatesOfABallThatClosesALoop) {
  const fs::path model = write("closed.yaml", R"(ferrers: 1
name: closed
gravity: [0, -9.81, 0]
bodies:
  a: {mass: 1, com: [1, 0, 0], inertia: {moments: [1, 1, 1]}}
  b: {mass: 1, com: [1, 1, 0.5], inertia: {moments: [1, 2, 3]}}
  c: {mass: 1, com: [2, 2, 1], inertia: {moments: [1, 1, 1]}}
joints:
  A: {type: revolute, bodies: [ground, a], at: [0, 0, 0], axis: z}
  S: {type: spherical, bodies: [a, b], at: [1, 0, 0]}
  T: {type: spherical, bodies: [b, c], at: [1, 2, 1]}
  C: {type: revolute, bodies: [ground, c], at: [3, 2, 1], axis: [0, 0.3, 1]}
drives:
  one: {joint: A, effort: "= S.omega_x + 2*S.omega_y + 3*S.omega_z"}
  two: {joint: A, effort: "= T.omega_x + 2*T.omega_y + 3*T.omega_z"}
)");
  ASSERT_EQ(run({"simulate", model.string(), "--end", "0.5", "-o", "run"}).exit_code, 0);
  const std::vector<std::string> lines = last_row(folder_ / "run");
  std::map<std::string, double> values;
  std::istringstream names(lines[0]), cells(lines[1]);
  std::string name, cell;
  while (std::getline(names, name, ',') && std::getline(cells, cell, ',')) values[name] = std::stod(cell);
  for (const auto& [drive, ball] : {std::pair<std::string, std::string>{"one", "S"}, {"two", "T"}}) {
    const double wanted = values.at(ball + ".omega_x.velocity") + 2 * values.at(ball + ".omega_y.velocity") +
                          3 * values.at(ball + ".omega_z.velocity");
    EXPECT_GT(std::abs(wanted), 0.1);
    EXPECT_NEAR(values.at(drive + ".effort"), wanted, 1e-12 * std::abs(wanted)) << ball;
  }
}

TEST_F(CommandTest, TheSummaryOfASimulationHasItsBalancesAndItsErrorEstimate) {
  const Result result = run({"simulate", bricard(), "--end", "1", "--json"});
  ASSERT_EQ(result.exit_code, 0);
  const ordered_json json = result.json();
  EXPECT_LT(std::abs(json.at("balance").at("error_J").get<double>()), 1e-10);
  EXPECT_LT(json.at("error_estimate").get<double>(), 1e-8);
  EXPECT_EQ(json.at("momentum").at("linear_kgmps").at("start").size(), 3u);
  EXPECT_TRUE(json.at("events").is_array());
  EXPECT_THAT(json.at("method").get<std::string>(), HasSubstr("dormand-prince-8"));
  const ordered_json quick = run({"simulate", bricard(), "--end", "1", "--quick", "--json"}).json();
  EXPECT_TRUE(quick.at("error_estimate").is_null());
}

// ---------------------------------------------------------------------------------------------------------------------
// Models with errors, and mechanisms that do not close

TEST_F(CommandTest, AllErrorsOfAModelAreOnStderrWithTheirLines) {
  const std::string model = write("wrong.yaml", kWrongModel).string();
  for (const char* verb : {"analyze", "simulate", "inverse", "kinematics", "equilibrium", "linearize"}) {
    const Result result = run({verb, model});
    EXPECT_EQ(result.exit_code, 3) << verb;
    EXPECT_THAT(result.output, IsEmpty());
    EXPECT_THAT(result.errors, HasSubstr(":4:13: error[F204]"));
    EXPECT_THAT(result.errors, HasSubstr("    4 |   a: {mass: 1 m, com: [0, 0, 0]}"));
    EXPECT_THAT(result.errors, HasSubstr(":6:13: error[F209]"));
    EXPECT_THAT(result.errors, HasSubstr("did you mean 'revolute'?"));
  }
}

TEST_F(CommandTest, AModelWithErrorsIsOneJsonObjectToo) {
  const std::string model = write("wrong.yaml", kWrongModel).string();
  const Result analysis = run({"analyze", model, "--json"});
  EXPECT_EQ(analysis.exit_code, 3);
  const ordered_json json = analysis.json();
  ASSERT_TRUE(json.is_object()) << analysis.output;
  EXPECT_EQ(json.at("schema"), "ferrers.analyze/1");
  EXPECT_EQ(json.at("ok"), false);
  EXPECT_TRUE(json.at("rank").is_null());
  EXPECT_TRUE(json.at("reactions").is_null());
  ASSERT_EQ(json.at("diagnostics").size(), 2u);
  EXPECT_EQ(json.at("diagnostics").at(0).at("code"), "F204");
  EXPECT_EQ(json.at("diagnostics").at(0).at("line"), 4);
  EXPECT_EQ(json.at("diagnostics").at(1).at("hint"), "did you mean 'revolute'?");

  const Result simulation = run({"simulate", model, "--json"});
  EXPECT_EQ(simulation.exit_code, 3);
  EXPECT_EQ(simulation.json().at("schema"), "ferrers.run/1");
  EXPECT_EQ(simulation.json().at("ok"), false);
  EXPECT_EQ(simulation.json().at("diagnostics").size(), 2u);
}

TEST_F(CommandTest, AFileThatIsNotThereIsAModelError) {
  const Result result = run({"analyze", "none.yaml", "--json"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_EQ(result.json().at("diagnostics").at(0).at("code"), "F101");
}

TEST_F(CommandTest, ALoopThatCannotCloseIsExitFourWithItsGap) {
  const std::string model = write("open.yaml", kOpenModel).string();
  const Result analysis = run({"analyze", model, "--json"});
  EXPECT_EQ(analysis.exit_code, 4);
  const ordered_json json = analysis.json();
  EXPECT_EQ(json.at("ok"), false);
  EXPECT_EQ(json.at("model"), "triangle");
  EXPECT_TRUE(json.at("mobility").is_null());
  EXPECT_THAT(json.at("diagnostics").dump(), HasSubstr("stays open by"));
  EXPECT_THAT(analysis.errors, HasSubstr(" mm and "));

  const Result simulation = run({"simulate", model, "--json"});
  EXPECT_EQ(simulation.exit_code, 4);
  EXPECT_EQ(simulation.json().at("status"), "not_assembled");
  EXPECT_EQ(simulation.json().at("ok"), false);
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(CommandTest, DynamicsWantsMassesAndNamesTheBodies) {
  const std::string model = write("massless.yaml", kMasslessModel).string();
  EXPECT_EQ(run({"analyze", model}).exit_code, 0);
  for (const char* verb : {"simulate", "inverse", "equilibrium", "linearize"}) {
    const Result result = run({verb, model, "--json"});
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_THAT(result.errors, HasSubstr(":4:3: error[F504]: body 'a' has no mass"));
    EXPECT_EQ(result.json().at("diagnostics").at(0).at("code"), "F504");
  }
  const Result motion = run({"kinematics", model, "--end", "1", "-o", "run"});
  EXPECT_EQ(motion.exit_code, 0) << motion.errors;
  EXPECT_EQ(lines_of(folder_ / "run/result.csv").size(), 102u);
}

TEST_F(CommandTest, MotionThatIsNotPrescribedIsAModelError) {
  const Result result = run({"inverse", (kExamples / "pendulum-a01/model.yaml").string(), "--json"});
  EXPECT_EQ(result.exit_code, 3) << result.errors;
  EXPECT_EQ(result.json().at("status"), "bad_motion");
  EXPECT_EQ(result.json().at("ok"), false);
}

// ---------------------------------------------------------------------------------------------------------------------
// Rest and linear systems

std::string pendulum() { return (kExamples / "pendulum-a01/model.yaml").string(); }

TEST_F(CommandTest, APendulumFallsToItsEquilibriumWhichTheWrittenModelStartsFrom) {
  const Result found = run({"equilibrium", pendulum(), "--json", "--write-model", "rest.yaml"});
  ASSERT_EQ(found.exit_code, 0) << found.errors;
  const ordered_json json = found.json();
  EXPECT_EQ(json.at("schema"), "ferrers.equilibrium/1");
  EXPECT_EQ(json.at("stability").at("verdict"), "stable");
  EXPECT_NEAR(json.at("positions").at(0).at("value").get<double>(), -1.5707963267948966, 1e-12);
  EXPECT_NEAR(json.at("reactions").at(0).at("components").at("force_y").at("value").get<double>(), 9.81, 1e-12);
  const Result linear = run({"linearize", "rest.yaml", "--json"});
  ASSERT_EQ(linear.exit_code, 0) << linear.errors;
  EXPECT_EQ(linear.json().at("in_equilibrium"), true);
  EXPECT_NEAR(linear.json().at("modes").at(0).at("frequency_rad_s").get<double>(), 3.1320919526731652, 1e-11);
  EXPECT_THAT(run({"linearize", pendulum(), "--at-equilibrium"}).output, HasSubstr("0.498488 Hz"));
}

TEST_F(CommandTest, WithoutAnEquilibriumOrSomeoneToHoldItIsExitFive) {
  const std::vector<std::string> falling = {pendulum(), "--set", "joints.pivot.type=prismatic", "--set",
                                            "joints.pivot.axis=y"};
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"equilibrium"}, {"linearize", "--at-equilibrium"}}) {
    std::vector<std::string> words = {arguments[0]};
    words.insert(words.end(), falling.begin(), falling.end());
    words.insert(words.end(), arguments.begin() + 1, arguments.end());
    words.emplace_back("--json");
    const Result result = run(words);
    EXPECT_EQ(result.exit_code, 5) << result.errors;
    EXPECT_THAT(result.errors, HasSubstr("error[F512]: no equilibrium was found"));
    EXPECT_THAT(result.errors, HasSubstr("pivot.displacement (-9.81 m/s²)"));
    EXPECT_EQ(result.json().at("ok"), false);
  }
  const Result hold = run({"equilibrium", pendulum(), "--hold", "--json"});
  EXPECT_EQ(hold.exit_code, 5);
  EXPECT_EQ(hold.json().at("status"), "not_held");
  EXPECT_TRUE(hold.json().at("reactions").is_null());
  EXPECT_THAT(hold.errors, HasSubstr("error[F513]"));
}

// ---------------------------------------------------------------------------------------------------------------------
// Results

TEST_F(CommandTest, WithJsonStdoutIsOneObject) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"analyze", bricard(), "--json"},
                                                    {"simulate", bricard(), "--end", "0.1", "--json"},
                                                    {"equilibrium", bricard(), "--json"},
                                                    {"linearize", bricard(), "--json"},
                                                    {"doctor", "--json"},
                                                    {"new", "--json"},
                                                    {"schema"}}) {
    const Result result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_TRUE(result.json().is_object()) << arguments.front() << ": " << result.output;
    EXPECT_THAT(result.errors, IsEmpty());
  }
}

TEST_F(CommandTest, WithoutATerminalThereIsNoColourAndNoBar) {
  const Result good = run({"analyze", bricard()});
  const Result bad = run({"analyze", write("wrong.yaml", kWrongModel).string()});
  for (const std::string& text : {good.output, good.errors, bad.output, bad.errors})
    EXPECT_THAT(text, Not(HasSubstr("\033")));
  const pid_t child = start_long_run();
  std::this_thread::sleep_for(std::chrono::milliseconds(900));
  kill(child, SIGINT);
  EXPECT_THAT(wait_for(child).errors, Not(HasSubstr("\r")));
}

/// What the command shows on a terminal, with NO_COLOR set to `no_color` (null: not set).
std::string shown_on_terminal(const std::vector<std::string>& arguments, const char* no_color) {
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
  if (child == 0) {
    setenv("TERM", "xterm", 1);
    unsetenv("NO_COLOR");
    if (no_color != nullptr) setenv("NO_COLOR", no_color, 1);
    std::vector<std::string> words = {FERRERS_COMMAND};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    execv(pointers[0], pointers.data());
    _exit(127);
  }
  std::string text;
  char buffer[4096];
  for (ssize_t got = 0; (got = read(terminal, buffer, sizeof buffer)) > 0;)
    text.append(buffer, static_cast<std::size_t>(got));
  close(terminal);
  waitpid(child, nullptr, 0);
  return text;
}

TEST_F(CommandTest, ATerminalHasColoursUnlessNoColorIsSet) {
  const std::string wrong = write("wrong.yaml", kWrongModel).string();
  for (const std::string& model : {bricard(), wrong}) {
    EXPECT_THAT(shown_on_terminal({"analyze", model}, nullptr), HasSubstr("\033["));
    EXPECT_THAT(shown_on_terminal({"analyze", model}, ""), HasSubstr("\033["));  // empty counts as not set
    const std::string plain = shown_on_terminal({"analyze", model}, "1");
    EXPECT_THAT(plain, Not(HasSubstr("\033")));
    EXPECT_THAT(plain, Not(IsEmpty()));
  }
}

TEST_F(CommandTest, ARunTellsItsFolderAndFillsIt) {
  const Result result = run({"simulate", bricard(), "--end", "0.5"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("out/bricard-a04-simulate"));
  const fs::path out = folder_ / "out/bricard-a04-simulate";
  EXPECT_EQ(lines_of(out / "result.csv").size(), 52u);
  EXPECT_EQ(lines_of(out / "reactions.csv").size(), 1u + 51 * 6 * 6);
  EXPECT_EQ(read_text(out / "model.yaml"), read_text(bricard()));
  const ordered_json summary = ordered_json::parse(read_text(out / "summary.json"));
  EXPECT_EQ(summary.at("status"), "finished");
  EXPECT_EQ(summary.at("ok"), true);
  EXPECT_EQ(summary.at("t_reached"), 0.5);
  EXPECT_LT(summary.at("max_constraint_residual_m"), 1e-9);
}

/// Every reaction of the Bricard linkage has a part that rigid bodies do not determine: no row may show a figure for
/// it.
TEST_F(CommandTest, UndeterminedValuesAreNeverPrinted) {
  const Result result = run({"simulate", bricard(), "--end", "0.1", "-o", "run"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("undetermined"));
  int undetermined = 0;
  for (const std::string& line : lines_of(folder_ / "run/reactions.csv")) {
    if (line.find("undetermined") == std::string::npos) continue;
    ++undetermined;
    EXPECT_THAT(line, HasSubstr(",,undetermined"));
  }
  EXPECT_GT(undetermined, 11 * 6 * 3);
  for (const auto& joint : ordered_json::parse(read_text(folder_ / "run/summary.json")).at("joints")) {
    EXPECT_TRUE(joint.at("max_force_N").is_null());
    EXPECT_EQ(joint.at("status"), "undetermined");
  }
}

TEST_F(CommandTest, TheModelInTheFolderGivesTheSameRunAgain) {
  ASSERT_EQ(run({"simulate", bricard(), "--end", "0.2", "-p", "a=0.7 m", "--set", "bodies.rod1.mass=2.5", "-o", "first",
                 "--write-model", "changed.yaml"})
                .exit_code,
            0);
  ASSERT_EQ(run({"simulate", "first/model.yaml", "--end", "0.2", "-o", "second"}).exit_code, 0);
  ASSERT_EQ(run({"simulate", bricard(), "--end", "0.2", "-o", "unchanged"}).exit_code, 0);
  EXPECT_EQ(read_text(folder_ / "first/result.csv"), read_text(folder_ / "second/result.csv"));
  EXPECT_NE(read_text(folder_ / "first/result.csv"), read_text(folder_ / "unchanged/result.csv"));
  EXPECT_EQ(read_text(folder_ / "changed.yaml"), read_text(folder_ / "first/model.yaml"));
}

TEST_F(CommandTest, LawFilesOfForcesGoAlongWithTheModel) {
  write("table.csv", "t,torque\n0,0\n1,2\n");
  const fs::path model = write("turned.yaml", R"(ferrers: 1
name: turned
bodies: {a: {mass: 1, com: [1, 0, 0]}}
joints: {j: {type: revolute, bodies: [ground, a], at: [0, 0, 0], axis: z}}
forces: {load: {type: torque, body: a, torque: [0, 0, {file: table.csv}]}}
)");
  ASSERT_EQ(run({"simulate", model.string(), "--end", "0.1", "-o", "first"}).exit_code, 0);
  ASSERT_EQ(run({"simulate", "first/model.yaml", "--end", "0.1", "-o", "second"}).exit_code, 0);
  EXPECT_EQ(read_text(folder_ / "first/result.csv"), read_text(folder_ / "second/result.csv"));
}

TEST_F(CommandTest, ARunNeverOverwritesTheModelThatItReads) {
  fs::create_directories(folder_ / "mine");
  const std::string text = read_text(bricard());
  write("mine/model.yaml", text);
  const Result refused = run({"simulate", "mine/model.yaml", "-p", "a=0.7 m", "--end", "0.1", "-o", "mine"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_EQ(read_text(folder_ / "mine/model.yaml"), text);
  EXPECT_EQ(run({"simulate", "mine/model.yaml", "--end", "0.1", "-o", "mine"}).exit_code, 0);
  EXPECT_EQ(read_text(folder_ / "mine/model.yaml"), text);
}

/// Cell of a row of CSV.
std::string cell(const std::string& line, long column) {
  std::istringstream in(line);
  std::string text;
  for (long i = 0; i <= column; ++i) std::getline(in, text, ',');
  return text;
}

TEST_F(CommandTest, KinematicsPrintsNoForces) {
  const Result result =
      run({"kinematics", (kExamples / "four-bar-driven/model.yaml").string(), "--end", "0.1", "-o", "run"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_FALSE(fs::exists(folder_ / "run/reactions.csv"));
  const std::vector<std::string> lines = lines_of(folder_ / "run/result.csv");
  ASSERT_EQ(lines.size(), 12u);
  const std::string head = lines[0];
  const long effort = std::count(head.begin(), head.begin() + static_cast<long>(head.find("motor.effort")), ',');
  EXPECT_EQ(cell(head, effort), "motor.effort");
  EXPECT_EQ(cell(lines[1], effort), "");
  EXPECT_NE(cell(lines[1], effort - 1), "");
  EXPECT_TRUE(ordered_json::parse(read_text(folder_ / "run/summary.json")).at("joints").is_null());
}

TEST_F(CommandTest, ReactionsComeInTheAxesThatAreAskedFor) {
  const std::string model = (kExamples / "four-bar-driven/model.yaml").string();
  ASSERT_EQ(run({"inverse", model, "--end", "1", "-o", "world"}).exit_code, 0);
  ASSERT_EQ(run({"inverse", model, "--end", "1", "--reactions", "joint", "-o", "joint"}).exit_code, 0);
  EXPECT_NE(read_text(folder_ / "world/reactions.csv"), read_text(folder_ / "joint/reactions.csv"));
  EXPECT_EQ(read_text(folder_ / "world/result.csv"), read_text(folder_ / "joint/result.csv"));
}

TEST_F(CommandTest, EqualStiffnessIsNamedWhereverItsReactionsStand) {
  const Result result = run({"simulate", bricard(), "--end", "0.1", "--distribute", "equal", "-o", "run"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("equal stiffness"));
  EXPECT_THAT(result.output, Not(HasSubstr("undetermined")));
  const std::string reactions = read_text(folder_ / "run/reactions.csv");
  EXPECT_THAT(reactions, HasSubstr(",distributed"));
  EXPECT_THAT(reactions, Not(HasSubstr("undetermined")));
  const ordered_json summary = ordered_json::parse(read_text(folder_ / "run/summary.json"));
  EXPECT_EQ(summary.at("distribution").at("by"), "equal stiffness");
  EXPECT_GT(summary.at("distribution").at("length_m"), 0.0);
}

TEST_F(CommandTest, RangesOfReactionsAreColumnsOfTheirOwn) {
  const std::string model = (kExamples / "door/model-compliant-hinges.yaml").string();
  const Result result =
      run({"inverse", model, "--end", "0.1", "--every", "0.1", "--stiffness-range", "0.5:2", "-o", "run"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const std::vector<std::string> lines = lines_of(folder_ / "run/reactions.csv");
  EXPECT_EQ(lines[0], "t,joint,component,value,status,low,high");
  int seen = 0;
  for (const std::string& line : lines) {
    if (line.find("0,lower,force_z,") != 0) continue;
    ++seen;  // half the weight; between a fifth and four fifths of it
    EXPECT_NEAR(std::stod(cell(line, 3)), 98.1, 1e-9);
    EXPECT_NEAR(std::stod(cell(line, 5)), 196.2 / 5, 1e-9);
    EXPECT_NEAR(std::stod(cell(line, 6)), 196.2 * 4 / 5, 1e-9);
  }
  EXPECT_EQ(seen, 1);
  EXPECT_EQ(ordered_json::parse(read_text(folder_ / "run/summary.json")).at("distribution").at("bounds"), "exact");
  for (const char* range : {"2:0.5", "0:1", "1", "a:b", "1:2:3", "1:inf"}) {
    EXPECT_EQ(run({"inverse", model, "--stiffness-range", range}).exit_code, 2) << range;
  }
}

// ---------------------------------------------------------------------------------------------------------------------
// Interruption

TEST_F(CommandTest, AnInterruptedRunKeepsItsRowsAndSaysSo) {
  const pid_t child = start_long_run();
  kill(child, SIGINT);
  const Result result = wait_for(child);
  EXPECT_EQ(result.exit_code, 130) << result.errors;
  const std::vector<std::string> lines = lines_of(folder_ / "run/result.csv");
  EXPECT_GE(lines.size(), 20u);
  const auto cells = std::count(lines[0].begin(), lines[0].end(), ',');
  for (const std::string& line : lines) EXPECT_EQ(std::count(line.begin(), line.end(), ','), cells);
  const ordered_json summary = ordered_json::parse(read_text(folder_ / "run/summary.json"));
  EXPECT_EQ(summary.at("status"), "interrupted");
  EXPECT_EQ(summary.at("ok"), false);
  EXPECT_LT(summary.at("t_reached"), 50000.0);
  EXPECT_THAT(result.output, HasSubstr("interrupted"));
}

TEST_F(CommandTest, AKilledRunKeepsItsRowsAndHasNoSummary) {
  const pid_t child = start_long_run();
  kill(child, SIGKILL);
  EXPECT_EQ(wait_for(child).signal, SIGKILL);
  EXPECT_GE(lines_of(folder_ / "run/result.csv").size(), 20u);
  EXPECT_GE(lines_of(folder_ / "run/reactions.csv").size(), 20u);
  EXPECT_FALSE(fs::exists(folder_ / "run/summary.json"));
}

// ---------------------------------------------------------------------------------------------------------------------
// schema, new, doctor

TEST_F(CommandTest, TheSchemaIsASchemaOfModelFiles) {
  const ordered_json schema = run({"schema"}).json();
  EXPECT_TRUE(schema.contains("$schema"));
  EXPECT_TRUE(schema.at("properties").contains("joints"));
}

TEST_F(CommandTest, EveryExampleCanBeStartedFrom) {
  const ordered_json list = run({"new", "--json"}).json();
  ASSERT_GE(list.at("examples").size(), 10u);
  for (const auto& one : list.at("examples")) {
    const std::string name = one.at("name");
    EXPECT_THAT(one.at("title").get<std::string>(), Not(IsEmpty()));
    const Result result = run({"new", name});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.output, read_text(kExamples / name / "model.yaml"));
  }
}

TEST_F(CommandTest, NewDoesNotReplaceAFileUnlessItIsTold) {
  EXPECT_EQ(run({"new", "door", "-o", "door.yaml"}).exit_code, 0);
  EXPECT_EQ(run({"analyze", "door.yaml"}).exit_code, 0);
  write("door.yaml", "mine");
  EXPECT_EQ(run({"new", "door", "-o", "door.yaml"}).exit_code, 2);
  EXPECT_EQ(read_text(folder_ / "door.yaml"), "mine");
  EXPECT_EQ(run({"new", "door", "-o", "door.yaml", "--force"}).exit_code, 0);
  EXPECT_THAT(read_text(folder_ / "door.yaml"), StartsWith("ferrers: 1"));
}

TEST_F(CommandTest, AReleaseIsAppliedAndTheChangedModelHasNothingRedundant) {
  const std::string model = (kExamples / "four-bar" / "model.yaml").string();
  EXPECT_EQ(run({"analyze", model, "--apply-release", "1"}).exit_code, 2);
  EXPECT_EQ(run({"analyze", model, "--apply-release", "99", "--write-model", "none.yaml"}).exit_code, 2);
  EXPECT_FALSE(fs::exists(folder_ / "none.yaml"));
  const ordered_json before = run({"analyze", model, "--json"}).json();
  EXPECT_EQ(before.at("redundant"), 3);
  for (const char* number : {"1", "2"}) {
    const Result result = run({"analyze", model, "--apply-release", number, "--write-model", "released.yaml"});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_THAT(result.errors, HasSubstr("becomes"));
    const ordered_json after = run({"analyze", "released.yaml", "--json"}).json();
    EXPECT_EQ(after.at("redundant"), 0);
    EXPECT_EQ(after.at("mobility"), before.at("mobility"));
  }
}

TEST_F(CommandTest, DoctorIsWell) {
  const ordered_json json = run({"doctor", "--json"}).json();
  EXPECT_EQ(json.at("ok"), true) << json;
  EXPECT_GT(json.at("diagnostic_codes"), 50);
  EXPECT_TRUE(json.at("dependencies").contains("eigen"));
}

}  // namespace
