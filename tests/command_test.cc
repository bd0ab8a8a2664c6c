// The command as its users and their scripts meet it: exit codes, what goes to which stream, JSON when things go wrong,
// hints.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "command_probe.h"

namespace ferrers::command_testing {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

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

// ---------------------------------------------------------------------------------------------------------------------
// The command line

TEST_F(CommandTest, HelpAndVersionAreResultsAndNotErrors) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"--help"},
                                                    {"--version"},
                                                    {"analyze", "--help"},
                                                    {"simulate", "-h"},
                                                    {"sweep", "--help"},
                                                    {"inverse", "--help"},
                                                    {"kinematics", "--help"},
                                                    {"equilibrium", "--help"},
                                                    {"linearize", "--help"},
                                                    {"equations", "--help"},
                                                    {"convert", "--help"},
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
  for (const char* verb : {"analyze", "inverse", "simulate", "sweep", "kinematics", "equilibrium", "linearize",
                           "equations", "convert", "schema", "new", "doctor"}) {
    EXPECT_THAT(help, HasSubstr("\n  " + std::string(verb) + " "));
  }
  for (const char* verb : {"view", "report", "optimize", "plot"}) {
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
  for (const std::string verb : {"analyze", "inverse", "simulate", "sweep", "kinematics", "equilibrium", "linearize",
                                 "equations", "schema", "new", "doctor"}) {
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
// Models with errors, and mechanisms that do not close

TEST_F(CommandTest, AllErrorsOfAModelAreOnStderrWithTheirLines) {
  const std::string model = write("wrong.yaml", kWrongModel).string();
  for (const char* verb : {"analyze", "simulate", "inverse", "kinematics", "equilibrium", "linearize", "equations"}) {
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
  for (const char* verb : {"simulate", "inverse", "equilibrium", "linearize", "equations"}) {
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
}  // namespace ferrers::command_testing
