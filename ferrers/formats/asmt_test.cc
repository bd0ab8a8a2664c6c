#include "ferrers/formats/asmt.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "ferrers/formats/formats.h"
#include "ferrers/testing/asmt_text.h"
#include "ferrers/testing/build_checks.h"
#include "ferrers/testing/third_party.h"

namespace ferrers {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using witness::AsmtText;

struct Read {
  ImportedModel model;
  Diagnostics diagnostics;
};

Read read(const std::string& text) {
  Read result;
  const ImportOptions options;
  const FileLoader none;
  result.model = read_asmt(text, {options, none, result.diagnostics});
  return result;
}

Eigen::Vector3d vector(const Number3& numbers) { return {numbers[0].value, numbers[1].value, numbers[2].value}; }

const Eigen::Matrix3d kQuarter = Eigen::AngleAxisd(EIGEN_PI / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();

AsmtText two_parts() {
  AsmtText file;
  file.marker("base");
  file.part("crank", {kQuarter, {100, 20, 0}}, 2);
  file.part_marker("crank", "pin", {Eigen::Matrix3d::Identity(), {10, 0, 0}});
  return file;
}

TEST(AsmtTest, MillimetresOfOndselSolverAndMetresOfAskoh) {
  AsmtText file = two_parts();
  const Read ondsel = read(file.text());
  ASSERT_FALSE(ondsel.diagnostics.has_errors()) << witness::messages(ondsel.diagnostics);
  ASSERT_EQ(ondsel.model.spec.bodies.size(), 1U);
  const BodySpec& crank = ondsel.model.spec.bodies[0];
  EXPECT_EQ(crank.name.name, "crank");
  EXPECT_EQ(vector(crank.pose->position), Eigen::Vector3d(0.1, 0.02, 0));
  EXPECT_NEAR((*crank.pose->rotation->quaternion)[0].value, std::sqrt(0.5), 1e-15);
  EXPECT_EQ(crank.mass->value, 2);
  EXPECT_TRUE(vector(crank.inertia.moments).isApprox(Eigen::Vector3d(8e-6, 9e-6, 10e-6), 1e-15));
  EXPECT_EQ(vector(ondsel.model.spec.gravity), Eigen::Vector3d(0, 0, -9.81));

  file.header = "freeCAD: 3D CAD with Motion Simulation  by  askoh.com";
  file.gravity = "0.0 \t0.0 \t-9.81 ";
  const Read askoh = read(file.text());
  EXPECT_EQ(vector(askoh.model.spec.bodies[0].pose->position), Eigen::Vector3d(100, 20, 0));
  EXPECT_EQ(vector(askoh.model.spec.gravity), Eigen::Vector3d(0, 0, -9.81));
  EXPECT_THAT(witness::messages(askoh.diagnostics), HasSubstr("lengths are read as metres"));
}

TEST(AsmtTest, PlaceholdersOfFreeCadAreWarnedAbout) {
  AsmtText file;
  file.part("plate", {}, 1, "1\t1\t1\t");
  file.part("true", {}, 1, "1\t1\t2\t");
  const Read result = read(file.text());
  EXPECT_THAT(witness::messages(result.diagnostics), HasSubstr("1 of 2 parts have mass 1 kg"));
}

TEST(AsmtTest, APartThatNoJointHoldsFloats) {
  AsmtText file;
  file.part("a", Pose());
  file.part("b", Pose());
  file.part_marker("a", "I");
  file.part_marker("b", "J");
  file.joint("RevoluteJoint", "k", "a/I", "b/J");
  const Read result = read(file.text());
  ASSERT_EQ(result.model.spec.joints.size(), 2U) << witness::messages(result.diagnostics);
  EXPECT_EQ(result.model.spec.joints[1].type, JointType::kFree);
  EXPECT_EQ(result.model.spec.joints[1].bodies[1].name, "a");
  EXPECT_THAT(witness::messages(result.diagnostics), HasSubstr("no joint holds 'a'"));
}

TEST(AsmtTest, APartOfMassZeroHasMassZero) {
  AsmtText file;
  file.part("ghost", {}, 0, "0\t0\t0");
  const Read result = read(file.text());
  EXPECT_EQ(result.model.spec.bodies[0].mass->value, 0);
  EXPECT_EQ(result.model.spec.bodies[0].inertia.kind, InertiaSpec::Kind::kPoint);
  EXPECT_THAT(witness::messages(result.diagnostics), HasSubstr("1 of 1 parts have mass 0"));
}

TEST(AsmtTest, NamesLoseTheDocumentThatAllShare) {
  AsmtText file;
  file.marker("marker-Doc#Base");
  file.part("Doc#Base");
  file.part_marker("Doc#Base", "FixingMarker");
  file.joint("FixedJoint", "", "marker-Doc#Base", "Doc#Base/FixingMarker");
  const Read result = read(file.text());
  ASSERT_FALSE(result.diagnostics.has_errors()) << witness::messages(result.diagnostics);
  EXPECT_EQ(result.model.spec.bodies[0].name.name, "Base");
  EXPECT_EQ(result.model.spec.joints[0].name.name, "marker_Doc_Base");
  EXPECT_EQ(result.model.spec.joints[0].bodies[0].name, "ground");
  EXPECT_EQ(result.model.spec.joints[0].bodies[1].name, "Base");
}

TEST(AsmtTest, MarkersStandInTheFrameOfTheirRefPoint) {
  std::string text = two_parts().text();
  const std::string plain = "Position3D\n\t\t\t\t\t\t0\t0\t0";
  text.replace(text.rfind(plain), plain.size(), "Position3D\n\t\t\t\t\t\t0\t5\t0");
  const std::string joint = "\t\tJoints\n";
  text.insert(text.find(joint) + joint.size(),
              "\t\t\tSphericalJoint\n\t\t\t\tName\n\t\t\t\t\tball\n\t\t\t\tMarkerI\n\t\t\t\t\t/A/base\n"
              "\t\t\t\tMarkerJ\n\t\t\t\t\t/A/crank/pin\n");
  const Read result = read(text);
  ASSERT_FALSE(result.diagnostics.has_errors()) << witness::messages(result.diagnostics);
  EXPECT_EQ(vector((*result.model.spec.joints[0].frames)[1].position), Eigen::Vector3d(0.01, 0.005, 0));
}

TEST(AsmtTest, AMatrixThatIsNearlyARotationBecomesTheNearestOne) {
  AsmtText file;
  Eigen::Matrix3d off = Eigen::Matrix3d::Identity();
  off(0, 1) = 2e-6;
  file.part("plate", {off, Eigen::Vector3d::Zero()});
  const Read result = read(file.text());
  ASSERT_FALSE(result.diagnostics.has_errors());
  EXPECT_THAT(witness::messages(result.diagnostics), HasSubstr("1 rotation matrix is off by up to 1e-06"));
  EXPECT_NEAR((*result.model.spec.bodies[0].pose->rotation->quaternion)[3].value, -0.5e-6, 1e-12);
}

TEST(AsmtTest, WhatIsLeftOutIsTold) {
  AsmtText file = two_parts();
  file.after =
      "\tSimulationParameters\n\t\ttstart\n\t\t\t0\n\t\ttend\n\t\t\t2\n\t\thout\n\t\t\t0.1\n"
      "\tAnimationParameters\n\t\tnframe\n\t\t\t3\n\tNovelty\n\t\t1\nTimeSeries\nNumber\tInput\t1\nTime\tInput\t0\n";
  const Read result = read(file.text());
  ASSERT_FALSE(result.diagnostics.has_errors()) << witness::messages(result.diagnostics);
  const std::string told = witness::messages(result.diagnostics);
  EXPECT_THAT(told, HasSubstr("the file asks for 0 to 2 s in steps of 0.1 s"));
  EXPECT_THAT(told, HasSubstr("results of an earlier run, 3 lines from here on, are not read"));
  EXPECT_THAT(told, HasSubstr("'Novelty' in 'Assembly' is not read"));
  EXPECT_THAT(told, testing::Not(HasSubstr("nframe")));
}

struct Broken {
  std::string from, to, code;
  int line, column;
};

// A hinged crank with a motor: the text is changed in one place each.
std::string hinged() {
  AsmtText file = two_parts();
  file.joint("RevoluteJoint", "hinge", "base", "crank/pin");
  file.motion("RotationalMotion", "motor", {{"MotionJoint", "/A/hinge"}, {"RotationZ", "2*time"}});
  file.limit("RotationLimit", "stop", {{"MotionJoint", "/A/hinge"}, {"Limit", "1"}, {"Type", "=<"}, {"Tol", "1e-9"}});
  return file.text();
}

TEST(AsmtTest, BrokenFilesAreRefusedAtTheirPlace) {
  ASSERT_FALSE(read(hinged()).diagnostics.has_errors()) << witness::messages(read(hinged()).diagnostics);
  const std::vector<Broken> all = {
      {"OndselSolver", "SolidThing", "F605", 1, 1},
      {"Assembly\n", "Assemblage\n", "F605", 2, 1},
      {"100\t20\t0", "100\t2o\t0", "F206", 38, 5},
      {"100\t20\t0", "100\t20", "F208", 38, 5},
      {"100\t20\t0", "1e999\t20\t0", "F206", 38, 5},
      {"Position3D\n\t\t\t\t100", "Place\n\t\t\t\t100", "F202", 34, 3},
      {"MomentOfInertias", "Moments", "F202", 43, 4},
      {"\t\t\t\t\t2\n", "\t\t\t\t\ttwo\n", "F206", 53, 6},
      {"MarkerJ\n\t\t\t\t\t/A/crank/pin", "MarkerJ\n\t\t\t\t\t/A/crank/pan", "F604", 87, 6},
      {"MarkerJ\n\t\t\t\t\t/A/crank/pin", "MarkerJ\n\t\t\t\t\t/A/base", "F604", 81, 4},
      {"MarkerI\n", "Marker\n", "F202", 81, 4},
      {"RevoluteJoint", "RevolutionJoint", "F602", 81, 4},
      {"RotationalMotion", "GeneralMotion", "F602", 89, 4},
      {"MotionJoint\n\t\t\t\t\t/A/hinge\n\t\t\t\tRotationZ", "MotionJoint\n\t\t\t\t\t/A/hinges\n\t\t\t\tRotationZ",
       "F604", 93, 6},
      {"2*time", "2*tide", "F401", 95, 8},
      {"=<", "==", "F209", 105, 6},
      {"Limit\n\t\t\t\t\t1", "Limit\n\t\t\t\t\ttime", "F602", 103, 6},
      {"GeneralConstraintSets\n", "GeneralConstraintSets\n\t\t\tCam\n", "F602", 109, 4},
      {"ForceTorques\n", "ForceTorques\n\t\tForceTorque\n", "F602", 110, 3},
      {"\t-9810", "", "F208", 111, 3},
  };
  for (const Broken& one : all) {
    std::string text = hinged();
    const std::size_t place = text.find(one.from);
    ASSERT_NE(place, std::string::npos) << one.from;
    text.replace(place, one.from.size(), one.to);
    const Read result = read(text);
    std::vector<Diagnostic> errors;
    for (const Diagnostic& item : result.diagnostics.items()) {
      if (item.severity == Severity::kError) errors.push_back(item);
    }
    ASSERT_FALSE(errors.empty()) << one.to;
    EXPECT_EQ(errors[0].code, one.code) << one.to << "\n" << witness::messages(result.diagnostics);
    EXPECT_EQ(errors[0].at.line, one.line) << one.to;
    EXPECT_EQ(errors[0].at.column, one.column) << one.to;
  }
}

TEST(AsmtTest, MatricesThatAreNoRotationsAreRefused) {
  Eigen::Matrix3d skewed = Eigen::Matrix3d::Identity(), mirrored = Eigen::Matrix3d::Identity();
  skewed(0, 1) = 0.01;
  mirrored(2, 2) = -1;
  for (const Eigen::Matrix3d& matrix : {skewed, mirrored, Eigen::Matrix3d(Eigen::Matrix3d::Zero())}) {
    AsmtText file;
    file.part("plate", {matrix, Eigen::Vector3d::Zero()});
    const Read result = read(file.text());
    EXPECT_TRUE(result.diagnostics.has_errors());
    EXPECT_THAT(witness::messages(result.diagnostics), HasSubstr("F206"));
  }
}

TEST(AsmtTest, TwoPartsOfOneNameAreAmbiguousWhereTheyAreMeant) {
  AsmtText file = two_parts();
  file.part("crank");
  file.part_marker("crank", "pin");
  EXPECT_FALSE(read(file.text()).diagnostics.has_errors());
  file.joint("FixedJoint", "weld", "base", "crank/pin");
  EXPECT_THAT(witness::messages(read(file.text()).diagnostics), HasSubstr("F604: 3 markers are called '/A/crank/pin'"));
}

TEST(AsmtTest, AChainOfFiveHundredWeldsIsReadInMuchLessThanASecond) {
  AsmtText file;
  file.marker("m0");
  constexpr int kParts = 500;
  std::string before = "m0";
  for (int i = 0; i < kParts; ++i) {
    const std::string name = "Doc#Body" + std::to_string(i);
    file.part(name, {Eigen::Matrix3d::Identity(), {10.0 * i, 0, 0}});
    file.part_marker(name, "near");
    file.part_marker(name, "far", {Eigen::Matrix3d::Identity(), {10, 0, 0}});
    file.joint("FixedJoint", "", before, name + "/near");
    before = name + "/far";
  }
  const std::string text = file.text();
  const auto start = std::chrono::steady_clock::now();
  const Read result = read(text);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  ASSERT_FALSE(result.diagnostics.has_errors()) << witness::messages(result.diagnostics);
  EXPECT_EQ(result.model.spec.joints.size(), static_cast<std::size_t>(kParts));
  EXPECT_LT(taken.count(), 1.0);
}

TEST(AsmtTest, FilesOfOthersAreRead) {
  const auto models = witness::third_party("ondsel");
  if (!models) GTEST_SKIP() << witness::kNoThirdPartyModels;
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(*models)) {
    if (entry.path().extension() != ".asmt") continue;
    const ModelFile file = read_any_model_file(entry.path());
    EXPECT_EQ(file.format, ModelFormat::kAsmt);
    EXPECT_TRUE(file.read.model.has_value()) << entry.path() << "\n" << witness::messages(file.read.diagnostics);
    ++count;
  }
  EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace ferrers
