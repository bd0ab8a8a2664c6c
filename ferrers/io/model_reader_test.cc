#include "ferrers/io/model_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace ferrers {
namespace {

namespace fs = std::filesystem;

constexpr const char* kArm =
    "ferrers: 1\n"
    "parameters: {r: 120 mm, m: {value: 2 kg, max: 5 kg}}\n"
    "bodies:\n"
    "  arm: {mass: = m, com: [= r/2, 0, 0]}\n"
    "joints:\n"
    "  pin: {type: revolute, bodies: [ground, arm], at: [0, 0, 0], axis: z}\n";

std::vector<std::string> codes_of(const ModelReadResult& result) {
  std::vector<std::string> codes;
  for (const Diagnostic& one : result.diagnostics.items()) codes.push_back(one.code);
  return codes;
}

ModelReadResult read_with(const ReadModelOptions& options) { return read_model_text(kArm, "arm.yaml", options); }

TEST(ModelReaderTest, UnitsBecomeSiAndFormulasUseParameters) {
  const ModelReadResult result = read_model_text(kArm, "arm.yaml");
  ASSERT_TRUE(result.model.has_value());
  EXPECT_EQ(result.model->name(), "arm");
  EXPECT_EQ(result.model->bodies()[1].mass_kg, 2.0);
  EXPECT_DOUBLE_EQ(result.model->bodies()[1].com_m.x(), 0.06);
  EXPECT_EQ(result.spec.parameters[0].dimension, std::optional<Dimension>(kLength));
  EXPECT_EQ(result.model->gravity(), Vector3d(0, 0, -9.81));
}

TEST(ModelReaderTest, JsonGivesTheSameModel) {
  const ModelReadResult result = read_model_text(
      R"({"ferrers": 1, "parameters": {"r": "120 mm"}, "bodies": {"arm": {"mass": 2, "com": ["= r/2", 0, 0]}},
          "joints": {"pin": {"type": "revolute", "bodies": ["ground", "arm"], "at": [0, 0, 0], "axis": "z"}}})",
      "arm.json");
  ASSERT_TRUE(result.model.has_value());
  EXPECT_DOUBLE_EQ(result.model->bodies()[1].com_m.x(), 0.06);
}

TEST(ModelReaderTest, ParametersCanBeSetFromOutsideWithUnits) {
  ReadModelOptions options;
  options.parameters["m"] = 3;
  options.parameter_texts = {"r=20 cm"};
  const ModelReadResult result = read_with(options);
  ASSERT_TRUE(result.model.has_value());
  EXPECT_EQ(result.model->bodies()[1].mass_kg, 3.0);
  EXPECT_DOUBLE_EQ(result.model->bodies()[1].com_m.x(), 0.1);
}

TEST(ModelReaderTest, WrongParametersFromOutsideAreErrors) {
  ReadModelOptions options;
  options.parameter_texts = {"q=1", "r=2 kg", "r", "r=long"};
  EXPECT_THAT(codes_of(read_with(options)), testing::UnorderedElementsAre("F216", "F204", "F216", "F203"));
  options.parameter_texts.clear();
  options.parameters = {{"q", 1}, {"r", std::nan("")}};
  EXPECT_THAT(codes_of(read_with(options)), testing::UnorderedElementsAre("F310", "F309"));
}

TEST(ModelReaderTest, FieldsCanBeSetFromOutside) {
  ReadModelOptions options;
  options.edits = {"bodies.arm.mass=1500 g", "bodies.arm.com[1]== r", "joints.pin.limits=[-1, 1]", "parameters.r=1 m"};
  const ModelReadResult result = read_with(options);
  ASSERT_TRUE(result.model.has_value()) << result.diagnostics.items().front().message;
  EXPECT_EQ(result.model->bodies()[1].mass_kg, 1.5);
  EXPECT_EQ(result.model->bodies()[1].com_m.y(), 1.0);
  EXPECT_TRUE(result.model->joints()[0].limits.has_value());
}

TEST(ModelReaderTest, AnUnknownPathIsAnErrorAndSoIsAWrongValue) {
  ReadModelOptions options;
  options.edits = {"bodies.leg.mass=1",  "bodies.leg={}",       "bodies.arm.mas=1", "bodies.arm.com[3]=1", "bodies",
                   "bodies.arm.mass=[1", "bodies.arm.mass=1 m", "a..b=1",           "parameters.r.value=1"};
  const ModelReadResult result = read_with(options);
  EXPECT_THAT(codes_of(result),
              testing::UnorderedElementsAre("F217", "F217", "F201", "F217", "F217", "F217", "F204", "F217", "F217"));
  for (const Diagnostic& one : result.diagnostics.items()) {
    EXPECT_EQ(one.message.rfind("--set '", 0), 0U) << one.message;
    EXPECT_FALSE(one.at.known());
  }
}

TEST(ModelReaderTest, AFileThatIsNotThereIsADiagnostic) {
  EXPECT_THAT(codes_of(read_model_file("/nowhere/model.yaml")), testing::ElementsAre("F101"));
  EXPECT_THAT(codes_of(read_model_file(FERRERS_SOURCE_DIR)), testing::ElementsAre("F101"));
}

TEST(ModelReaderTest, TooManyErrorsAreCut) {
  std::string text = "ferrers: 1\nbodies: {}\n";
  for (int i = 0; i < 1000; ++i) text += "unknown_" + std::to_string(i) + ": 1\n";
  const ModelReadResult result = read_model_text(text, "many.yaml");
  EXPECT_LT(result.diagnostics.items().size(), 300U);
  EXPECT_EQ(result.diagnostics.items().back().code, "F218");
}

TEST(ModelReaderTest, ALongFormulaOverSeveralLinesIsRead) {
  const ModelReadResult result = read_model_text(
      "ferrers: 1\nparameters:\n  a: >-\n    = 1 +\n    2\n  b: = 2 *\n    3\nbodies: {}\n", "folded.yaml");
  ASSERT_TRUE(result.model.has_value());
  EXPECT_EQ(result.model->parameters()[0].value, 3.0);
  EXPECT_EQ(result.model->parameters()[1].value, 6.0);
}

TEST(ModelReaderTest, PlacesInAFormulaOverSeveralLinesAreExact) {
  const ModelReadResult result = read_model_text(
      "ferrers: 1\nparameters:\n  a: = 1 +\n    foo\n  b: \"= 2 *\n    bar\"\nbodies: {}\n", "folded.yaml");
  ASSERT_EQ(codes_of(result), (std::vector<std::string>{"F403", "F403"}));
  EXPECT_EQ(result.diagnostics.items()[0].at, (SourceRange{4, 5, 3}));
  EXPECT_EQ(result.diagnostics.items()[1].at, (SourceRange{6, 5, 3}));
}

TEST(ModelReaderTest, StiffnessOfOneNumberStandsForThreeAndRigidForInfinity) {
  const ModelReadResult result = read_model_text(
      "ferrers: 1\nbodies: {a: {}}\njoints: {w: {type: weld, bodies: [ground, a], at: [0, 0, 0], "
      "stiffness: {force: 1e6, moment: [rigid, 2, rigid]}}}\n",
      "stiff.yaml");
  ASSERT_TRUE(result.spec.joints[0].stiffness.has_value());
  EXPECT_EQ((*result.spec.joints[0].stiffness->force)[2].value, 1e6);
  ASSERT_TRUE(result.model.has_value());
  const Vector6d& stiffness = *result.model->joints()[0].stiffness;
  EXPECT_TRUE(std::isinf(stiffness[3]));
  EXPECT_EQ(stiffness[4], 2.0);
}

/// A folder of its own for each test, removed afterwards.
class LawFileTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(testing::TempDir()) / (std::string("ferrers_law_") + info->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "model" / "laws");
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const fs::path& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }

  ModelReadResult read(const std::string& law) const {
    write("model/arm.yaml", std::string(kArm) + "drives: {motor: {joint: pin, motion: " + law + "}}\n");
    return read_model_file(folder_ / "model" / "arm.yaml");
  }

  fs::path folder_;
};

TEST_F(LawFileTest, AColumnIsReadWithItsTimes) {
  write("model/laws/a.csv", "t,x,y\r\n# note\r\n0, 1, 5\r\n0.5, +2, 6\r\n\r\n1, 3e0, 7\r\n");
  const ModelReadResult result = read("{file: laws/a.csv, column: 3}");
  ASSERT_TRUE(result.model.has_value()) << result.diagnostics.items().front().message;
  const auto& samples = *result.spec.drives[0].motion[0].samples;
  EXPECT_EQ(samples.first, (std::vector<double>{0, 0.5, 1}));
  EXPECT_EQ(samples.second, (std::vector<double>{5, 6, 7}));
}

TEST_F(LawFileTest, MistakesInTheFileAreNamedWithTheirLine) {
  const std::pair<const char*, const char*> cases[] = {
      {"0,1\n1,abc\n", "a.csv:2: "},  {"0,1\n1\n", "a.csv:2: "},        {"0,1\n2,1\n1,1\n", "a.csv:3: "},
      {"0,1\n", "at least two rows"}, {"t,x\nt,x\n0,1\n", "a.csv:2: "}, {"0,1\nnan,1\n", "a.csv:2: "},
      {"0,1\n0x1,1\n", "a.csv:2: "},
  };
  for (const auto& [text, wanted] : cases) {
    write("model/a.csv", text);
    const ModelReadResult result = read("{file: a.csv}");
    ASSERT_EQ(codes_of(result), std::vector<std::string>{"F215"}) << text;
    EXPECT_NE(result.diagnostics.items()[0].message.find(wanted), std::string::npos) << text;
  }
}

TEST_F(LawFileTest, NoPathLeadsOutOfTheFolder) {
  write("secret.csv", "0,1\n1,2\n");
  fs::create_symlink(folder_ / "secret.csv", folder_ / "model" / "link.csv");
  fs::create_directory_symlink(folder_, folder_ / "model" / "up");
  write("model/laws/inner.csv", "0,1\n1,2\n");
  fs::create_symlink(folder_ / "model" / "laws" / "inner.csv", folder_ / "model" / "inside.csv");
  for (const char* path : {"../secret.csv", "link.csv", "up/secret.csv", "laws/../../secret.csv", "/etc/passwd"}) {
    EXPECT_EQ(codes_of(read(std::string("{file: ") + path + "}")), std::vector<std::string>{"F214"}) << path;
  }
  EXPECT_TRUE(read("{file: inside.csv}").model.has_value());
  EXPECT_EQ(codes_of(read("{file: laws}")), std::vector<std::string>{"F213"});
}

}  // namespace
}  // namespace ferrers
