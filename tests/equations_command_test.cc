// The verb `equations` as its users meet it.

#include <gmock/gmock.h>

#include <cmath>
#include <regex>

#include "command_probe.h"
#include "ferrers/testing/json_schema.h"

namespace ferrers {
namespace {

using namespace command_testing;  // NOLINT(google-build-using-namespace)
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class EquationsCommandTest : public CommandTest {
 protected:
  static std::string example(const std::string& name) { return (kExamples / name / "model.yaml").string(); }

  /// The object of a call with `--json`, checked against the schema.
  ordered_json object_of(std::vector<std::string> arguments, int exit_code = 0) const {
    static const witness::JsonSchema schema(
        nlohmann::json::parse(read_text(fs::path(FERRERS_SOURCE_DIR) / "schemas/equations.schema.json")));
    arguments.insert(arguments.begin(), "equations");
    arguments.emplace_back("--json");
    const Result result = run(arguments);
    EXPECT_EQ(result.exit_code, exit_code) << result.errors;
    EXPECT_THAT(schema.faults(nlohmann::json::parse(result.output, nullptr, false)), IsEmpty());
    return result.json();
  }
};

// A point of 1 kg on a massless link of 1 m, from the horizontal.
TEST_F(EquationsCommandTest, APendulumIsItsClosedForm) {
  const ordered_json json = object_of({example("pendulum-a01")});
  EXPECT_EQ(json.at("n"), 1);
  EXPECT_EQ(json.at("m"), 0);
  EXPECT_EQ(json.at("equations"), 1);
  EXPECT_NEAR(json.at("M").at(0).at(0).get<double>(), 1, 1e-15);
  EXPECT_NEAR(json.at("h").at(0).get<double>(), 9.81, 1e-14);
  EXPECT_NEAR(json.at("vdot").at(0).get<double>(), -9.81, 1e-14);
  EXPECT_THAT(run({"equations", example("pendulum-a01")}).output, HasSubstr("None: no loop is closed."));
}

// θ'' = −(G/I) cos θ with I = 8 kg·m², G = 9 kg · 9.81 m/s² · 1 m (examples/three-cranks).
TEST_F(EquationsCommandTest, ThreeCranksMoveByOneEquationAndTellNoMultiplier) {
  const ordered_json json = object_of({example("three-cranks")});
  EXPECT_EQ(json.at("r"), 3);
  EXPECT_EQ(json.at("w"), 1);
  EXPECT_EQ(json.at("excluded_rows").size(), 7u);
  EXPECT_NEAR(json.at("vdot").at(0).get<double>(), -9 * 9.81 / 8 * std::cos(0.7), 1e-12);
  for (const ordered_json& one : json.at("lambda")) EXPECT_TRUE(one.at("value").is_null()) << one;
  for (const ordered_json& one : json.at("residuals")) {
    EXPECT_LE(one.at("largest").get<double>(), 1e-13 * (1 + one.at("size").get<double>())) << one;
  }
  const std::string text = run({"equations", example("three-cranks")}).output;
  EXPECT_THAT(text, HasSubstr("3r + n = 13 equations"));
  EXPECT_THAT(text, HasSubstr("lambda of the kept rows, the excluded ones zero"));
  static const std::regex row("\n  high\\d/\\w+ +\\? +undetermined ");
  EXPECT_EQ(std::distance(std::sregex_iterator(text.begin(), text.end(), row), std::sregex_iterator()), 10);
}

TEST_F(EquationsCommandTest, EveryBlockStandsUnderItsNumber) {
  const std::string text = run({"equations", example("four-bar-driven"), "--inverse"}).output;
  for (const char* heading :
       {"(6) phi(q) = 0, (7) G v = nu, (8) G vdot = gamma", "(9) M vdot + h = tau + B u + G^T lambda",
        "Solution of (8) and (9)", "inverse (the paper's direct)"}) {
    EXPECT_THAT(text, HasSubstr(heading));
  }
  EXPECT_THAT(text, HasSubstr("found: the motion needs it"));
}

// The crank's law is 1.2 (1 − cos 2t); torque at the start by hand in ferrers/dynamics/equations_report_test.cc, for
// rods without thickness.
TEST_F(EquationsCommandTest, TheInverseProblemFollowsTheLawsAtTheTimeAskedFor) {
  const ordered_json json = object_of({example("four-bar-driven"), "--inverse", "--at", "0.5"});
  EXPECT_EQ(json.at("t"), 0.5);
  EXPECT_NEAR(json.at("q").at(0).get<double>(), 1.2 * (1 - std::cos(1.0)), 1e-13);
  EXPECT_NEAR(json.at("v").at(0).get<double>(), 2.4 * std::sin(1.0), 1e-13);
  EXPECT_NEAR(json.at("vdot").at(0).get<double>(), 4.8 * std::cos(1.0), 1e-12);
  const ordered_json start = object_of({example("four-bar-driven"), "--inverse"});
  EXPECT_NEAR(start.at("u").at(0).get<double>(), 41.0 / 9 * 4.8 + 4.5 * 9.81, 1e-11);
}

TEST_F(EquationsCommandTest, AStoredStateIsTakenFromARunsFolder) {
  ASSERT_EQ(run({"simulate", example("three-cranks"), "--end", "0.3", "-o", "run"}).exit_code, 0);
  const ordered_json json = object_of({example("three-cranks"), "--state", "run", "--at", "0.1"});
  EXPECT_EQ(json.at("t"), 0.1);
  EXPECT_NEAR(json.at("q").at(0).get<double>(), -0.04245305578924163, 1e-9);  // examples/three-cranks/expected.json
  EXPECT_EQ(object_of({example("three-cranks"), "--state", "run"}).at("t"), 0.3);
  const Result missing = run({"equations", example("three-cranks"), "--state", "nowhere"});
  EXPECT_EQ(missing.exit_code, 3);
  EXPECT_THAT(missing.errors, HasSubstr("cannot be read"));
  EXPECT_THAT(missing.output, IsEmpty());
}

TEST_F(EquationsCommandTest, ParametersChangeTheEquations) {
  const ordered_json json = object_of({example("three-cranks"), "-p", "m_platform=12 kg"});
  EXPECT_NEAR(json.at("vdot").at(0).get<double>(), -15 * 9.81 / 14 * std::cos(0.7), 1e-12);
}

TEST_F(EquationsCommandTest, LatexIsADocumentOrItsBody) {
  const std::string whole = run({"equations", example("four-bar"), "--latex"}).output;
  EXPECT_EQ(whole.rfind("\\documentclass", 0), 0u);
  EXPECT_THAT(whole, HasSubstr("\\end{document}\n"));
  const std::string body = run({"equations", example("four-bar"), "--latex=fragment"}).output;
  EXPECT_EQ(body.rfind("\\section*{four-bar: the equations (6)--(9)", 0), 0u);
  EXPECT_THAT(body, Not(HasSubstr("\\begin{document}")));
}

TEST_F(EquationsCommandTest, TheResultCanGoToAFile) {
  const Result result = run({"equations", example("four-bar"), "-o", "equations.txt"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.output, IsEmpty());
  EXPECT_EQ(read_text(folder_ / "equations.txt"), run({"equations", example("four-bar")}).output);
  EXPECT_EQ(run({"equations", example("four-bar"), "-o", "no/such/folder/equations.txt"}).exit_code, 2);
}

TEST_F(EquationsCommandTest, WrongCommandLinesAreExitTwo) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"--latex=word"},
                                                    {"--latex", "--json"},
                                                    {"--at", "-1"},
                                                    {"--at", "soon"},
                                                    {"--inverze"}}) {
    std::vector<std::string> words = {"equations", example("four-bar")};
    words.insert(words.end(), arguments.begin(), arguments.end());
    const Result result = run(words);
    EXPECT_EQ(result.exit_code, 2) << arguments.front();
    EXPECT_THAT(result.output, IsEmpty());
    EXPECT_THAT(result.errors, Not(IsEmpty()));
  }
  EXPECT_EQ(run({"equations"}).exit_code, 2);
}

TEST_F(EquationsCommandTest, WhatCannotBeSolvedHasItsExitCodeAndOneObject) {
  const ordered_json undriven = object_of({example("pendulum-a01"), "--inverse"}, 3);
  EXPECT_EQ(undriven.at("status"), "bad_motion");
  EXPECT_EQ(undriven.at("diagnostics").at(0).at("code"), "F508");
  const std::string weightless = write("weightless.yaml", R"(ferrers: 1
name: weightless
bodies: {a: {mass: 0, com: [1, 0, 0]}}
joints: {j: {type: revolute, bodies: [ground, a], at: [0, 0, 0], axis: z}}
)")
                                     .string();
  const ordered_json singular = object_of({weightless}, 5);
  EXPECT_EQ(singular.at("status"), "singular_mass");
  EXPECT_EQ(singular.at("diagnostics").at(0).at("code"), "F505");
  EXPECT_EQ(singular.at("M").dump(), "[[0.0]]");
  EXPECT_THAT(run({"equations", weightless}).output, HasSubstr("No solution"));
  const std::string open = (kExamples / "bennett/model-perturbed.yaml").string();
  EXPECT_TRUE(object_of({open}, 4).at("status").is_null());
  EXPECT_TRUE(object_of({write("wrong.yaml", kWrongModel).string()}, 3).at("model").is_null());
}

}  // namespace
}  // namespace ferrers
