// Runs as the command makes them: what they are asked for, the folder that they fill, runs that are interrupted or
// killed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "command_probe.h"

namespace ferrers::command_testing {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

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
    become_command(arguments);
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

TEST_F(CommandTest, ARunReplacesNothingInAFolderThatIsNoRun) {
  fs::create_directories(folder_ / "mine");
  write("mine/model.yaml", "my own\n");
  const Result refused = run({"simulate", bricard(), "--end", "0.1", "-o", "mine"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.errors, HasSubstr("'mine'"));
  EXPECT_EQ(read_text(folder_ / "mine/model.yaml"), "my own\n");
  // A run's own folder is used again.
  ASSERT_EQ(run({"simulate", bricard(), "--end", "0.1", "-o", "run"}).exit_code, 0);
  EXPECT_EQ(run({"simulate", bricard(), "--end", "0.1", "-o", "run"}).exit_code, 0);
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

}  // namespace
}  // namespace ferrers::command_testing
