#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "ferrers/testing/build_checks.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers {
namespace {

using namespace witness;  // NOLINT(google-build-using-namespace): a test's vocabulary
using testing::HasSubstr;
using Kind = LawInput::Kind;

/// A chain of bodies on ground: hinge (revolute), tube (cylindrical), ball (spherical).
ModelSpec chain() {
  ModelSpec spec;
  for (const char* name : {"a", "b", "c"}) {
    BodySpec body;
    body.name = name;
    spec.bodies.push_back(body);
  }
  spec.joints = {joint(JointType::kRevolute, "hinge", "ground", "a", Point::Zero()),
                 joint(JointType::kCylindrical, "tube", "a", "b", Point::Zero()),
                 joint(JointType::kSpherical, "ball", "b", "c", Point::Zero())};
  spec.parameters = {parameter("k", 5.0)};
  return spec;
}

ModelSpec with_effort(const std::string& text) {
  ModelSpec spec = chain();
  spec.drives = {coordinate_drive("motor", "hinge", "", text)};
  return spec;
}

ModelSpec with_motion(const std::string& text) {
  ModelSpec spec = chain();
  spec.drives = {coordinate_drive("motor", "hinge", text)};
  return spec;
}

TEST(BuildLawsTest, ParametersBecomeNumbersAndCoordinatesInputs) {
  const Model model = built(with_effort("-k*hinge.position + 2*hinge.velocity + t"));
  const Law law = model.drives().at(0).effort.at(0);
  ASSERT_EQ(law.inputs().size(), 3U);
  std::vector<double> values;
  for (const LawInput& input : law.inputs()) {
    values.push_back(input.kind == Kind::kTime ? 100.0 : input.kind == Kind::kPosition ? 3.0 : 10.0);
    EXPECT_TRUE(input.kind == Kind::kTime || input.scalar.coordinate == (JointCoordinate{JointId(0), 0}));
  }
  EXPECT_EQ(law.value(values.data()), -15.0 + 20.0 + 100.0);
}

TEST(BuildLawsTest, CoordinatesHaveTheirNames) {
  const auto only_input = [](const std::string& text) {
    return built(with_effort(text)).drives().at(0).effort.at(0).inputs().at(0);
  };
  EXPECT_EQ(only_input("hinge.angle"), (LawInput{Kind::kPosition, {JointId(0), 0}}));
  EXPECT_EQ(only_input("hinge.angle.velocity"), (LawInput{Kind::kVelocity, {JointId(0), 0}}));
  EXPECT_EQ(only_input("tube.displacement"), (LawInput{Kind::kPosition, {JointId(1), 1}}));
  EXPECT_EQ(only_input("tube.displacement.velocity"), (LawInput{Kind::kVelocity, {JointId(1), 1}}));
  EXPECT_EQ(only_input("ball.omega_y"), (LawInput{Kind::kVelocity, {JointId(2), 1}}));
}

TEST(BuildLawsTest, WhatAJointDoesNotHaveIsAnErrorThatListsWhatItHas) {
  const ModelBuildResult result = build_model(with_effort("tube.position"));
  ASSERT_EQ(codes(result.diagnostics), Codes{"F305"});
  EXPECT_THAT(result.diagnostics.items()[0].hint, HasSubstr("displacement"));
  EXPECT_EQ(build_codes(with_effort("ball.qx")), Codes{"F305"});
  EXPECT_EQ(build_codes(with_effort("hinge.angel")), Codes{"F305"});
  EXPECT_EQ(build_codes(with_effort("henge.angle")), Codes{"F304"});
}

TEST(BuildLawsTest, EveryWrongNameIsReported) {
  EXPECT_EQ(build_codes(with_effort("kk + henge.angle + ball.qw")), (Codes{"F403", "F304", "F305"}));
}

TEST(BuildLawsTest, PrescribedMotionKnowsTimeOnly) {
  EXPECT_EQ(build_codes(with_motion("2*pi*t + k")), Codes{});
  EXPECT_EQ(build_codes(with_motion("tube.angle")), Codes{"F330"});
}

TEST(BuildLawsTest, MotionOfParametersIsConstantInTime) {
  const Law law = built(with_motion("k^2")).drives().at(0).motion.at(0);
  EXPECT_EQ(law.motion(7.0).value, 25.0);
  EXPECT_EQ(law.motion(7.0).rate, 0.0);
}

TEST(BuildLawsTest, DimensionOfALawIsThatOfItsTarget) {
  ModelSpec spec = with_motion("k*t/t");
  EXPECT_EQ(build_codes(spec), Codes{});
  spec.parameters[0].dimension = kForce;
  spec.drives[0].motion[0] = law("k + 0*t");
  EXPECT_EQ(build_codes(spec), Codes{"F204"});
}

TEST(BuildLawsTest, ConstantWithoutAFiniteValueIsAnError) {
  ModelSpec spec = with_effort("1/k");
  spec.parameters[0].value = 0.0;
  EXPECT_EQ(build_codes(spec), Codes{"F408"});
}

TEST(BuildLawsTest, SampledLawsAreChecked) {
  ModelSpec spec = with_motion("0");
  LawSpec sampled;
  sampled.samples = {{0, 1, 2}, {0, 1, 4}};
  spec.drives[0].motion = {sampled};
  EXPECT_NEAR(built(spec).drives()[0].motion[0].motion(1.0).value, 1.0, 1e-15);
  spec.drives[0].motion[0].samples = {{0, 2, 1}, {0, 1, 4}};
  EXPECT_EQ(build_codes(spec), Codes{"F330"});
  spec.drives[0].motion[0].samples = {{0}, {0}};
  EXPECT_EQ(build_codes(spec), Codes{"F330"});
  spec.drives[0].motion[0].samples = {{0, 1}, {0, NAN}};
  EXPECT_EQ(build_codes(spec), Codes{"F309"});
  spec.drives[0].motion[0].samples.reset();
  EXPECT_EQ(build_codes(spec), Codes{"F330"});
}

}  // namespace
}  // namespace ferrers
