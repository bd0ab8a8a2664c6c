#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "ferrers/testing/build_checks.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers {
namespace {

using namespace witness;  // NOLINT(google-build-using-namespace): a test's vocabulary
using testing::HasSubstr;

constexpr double kPressureAngle = 20 * M_PI / 180;

/// Line of action of teeth that touch at direction `psi` from the first centre, in the xy plane.
Point line_of_action(double psi, double pressure_angle = kPressureAngle) {
  const Point radial(std::cos(psi), std::sin(psi), 0), tangential(-std::sin(psi), std::cos(psi), 0);
  return std::sin(pressure_angle) * radial + std::cos(pressure_angle) * tangential;
}

BodySpec named(const std::string& name) {
  BodySpec body;
  body.name = name;
  return body;
}

JointSpec bare_mesh(const std::string& first, const std::string& second, const Point& at, const Point& line) {
  JointSpec spec = mesh_joint("mesh", first, second, at, line, Point::UnitZ(), Point::Zero(), Point::Zero());
  spec.axis = {};
  spec.centers.reset();
  return spec;
}

/// Gears a of radius 0.2 at the origin and b of radius 0.3 at (0.5, 0, 0.7), both on ground, meshing at (0.2, 0, 0.1).
ModelSpec gear_pair() {
  ModelSpec spec;
  spec.bodies = {named("a"), named("b")};
  spec.joints = {joint(JointType::kRevolute, "ja", "ground", "a", Point(0, 0, 0)),
                 joint(JointType::kRevolute, "jb", "b", "ground", Point(0.5, 0, 0.7), -Point::UnitZ()),
                 bare_mesh("a", "b", Point(0.2, 0, 0.1), line_of_action(0))};
  return spec;
}

/// Sun, carrier and one planet in a ring fixed to ground; the ring's mesh is the last joint.
ModelSpec planetary(double psi) {
  const Point radial(std::cos(psi), std::sin(psi), 0);
  ModelSpec spec;
  spec.bodies = {named("sun"), named("carrier"), named("planet")};
  spec.joints = {joint(JointType::kRevolute, "js", "ground", "sun", Point::Zero()),
                 joint(JointType::kRevolute, "jc", "ground", "carrier", Point(0, 0, 1)),
                 joint(JointType::kRevolute, "jp", "carrier", "planet", 0.5 * radial),
                 bare_mesh("sun", "planet", 0.2 * radial, line_of_action(psi)),
                 bare_mesh("ground", "planet", 0.8 * radial, line_of_action(psi, -kPressureAngle))};
  spec.joints[4].name = "ring";
  return spec;
}

TEST(BuildMeshesTest, CentresAndAxisComeFromTheGearsBearings) {
  const Model model = built(gear_pair());
  const Joint& mesh = model.joints()[2];
  EXPECT_FALSE(mesh.constants.mesh_holds_as_drawn_only);
  EXPECT_LT((mesh.X_1F.p - Vector3d(0, 0, 0.1)).norm(), 1e-15);
  EXPECT_LT((mesh.X_2M.p - Vector3d(0.5, 0, 0.1)).norm(), 1e-15);
  EXPECT_LT((mesh.X_1F.R.col(2) - Vector3d::UnitZ()).norm(), 1e-15);
  EXPECT_LT((mesh.X_1F.R.col(0) - line_of_action(0)).norm(), 1e-15);
}

TEST(BuildMeshesTest, BaseRadiiAreSignedPitchRadiiTimesTheCosineOfThePressureAngle) {
  const Model model = built(gear_pair());
  const JointConstants& c = model.joints()[2].constants;
  EXPECT_NEAR(c.base_radius_1_m, 0.2 * std::cos(kPressureAngle), 1e-15);
  EXPECT_NEAR(c.base_radius_2_m, -0.3 * std::cos(kPressureAngle), 1e-15);
  EXPECT_EQ(c.mesh_side, 1.0);
  EXPECT_LT((c.line_of_action_F - Vector3d::UnitX()).norm(), 1e-15);
}

TEST(BuildMeshesTest, PitchPointIsGivenInTheFirstFrame) {
  const Joint mesh = built(gear_pair()).joints()[2];
  EXPECT_LT((mesh.X_1F * mesh.constants.pitch_point_F_m - Vector3d(0.2, 0, 0.1)).norm(), 1e-15);
}

TEST(BuildMeshesTest, MirroredLineOfActionHasTheOtherSide) {
  ModelSpec spec = gear_pair();
  spec.joints[2].line_of_action = numbers(line_of_action(0, -kPressureAngle));
  EXPECT_EQ(built(spec).joints()[2].constants.mesh_side, -1.0);
}

TEST(BuildMeshesTest, GivenAxisAndCentresAreTaken) {
  ModelSpec spec = gear_pair();
  spec.joints[2] = mesh_joint("mesh", "a", "b", Point(0.2, 0, 0), line_of_action(0), -Point::UnitZ(), Point::Zero(),
                              Point(0.6, 0, 0));
  const Joint mesh = built(spec).joints()[2];
  EXPECT_LT((mesh.X_2M.p - Vector3d(0.6, 0, 0)).norm(), 1e-15);
  EXPECT_NEAR(mesh.constants.base_radius_1_m, -0.2 * std::cos(kPressureAngle), 1e-15);
}

TEST(BuildMeshesTest, CentresAloneGiveTheAxisOfFloatingGears) {
  ModelSpec spec = gear_pair();
  spec.joints[0] = joint(JointType::kFree, "ja", "ground", "a", Point::Zero());
  spec.joints[1] = joint(JointType::kFree, "jb", "ground", "b", Point::Zero());
  spec.joints[2].centers = std::array<Number3, 2>{number3(0, 0, 0.1), number3(0.5, 0, 0.1)};
  const Joint mesh = built(spec).joints()[2];
  EXPECT_FALSE(mesh.constants.mesh_holds_as_drawn_only);
  EXPECT_NEAR(std::abs(mesh.X_1F.R(2, 2)), 1.0, 1e-15);
}

TEST(BuildMeshesTest, FixedRingTurnsAboutTheAxisOfThePlanetsCarrier) {
  const Model model = built(planetary(0.3));
  const Joint& sun = model.joints()[3];
  const Joint& ring = model.joints()[4];
  EXPECT_FALSE(ring.constants.mesh_holds_as_drawn_only);
  EXPECT_LT(ring.X_1F.p.norm(), 1e-15);
  EXPECT_LT((ring.X_2M.p - 0.5 * Vector3d(std::cos(0.3), std::sin(0.3), 0)).norm(), 1e-15);
  EXPECT_NEAR(ring.constants.base_radius_1_m, 0.8 * std::cos(kPressureAngle), 1e-15);
  EXPECT_NEAR(ring.constants.base_radius_2_m, 0.3 * std::cos(kPressureAngle), 1e-15);
  EXPECT_LT(sun.X_1F.p.norm(), 1e-15);
}

TEST(BuildMeshesTest, GearWeldedToItsShaftIsCarriedByTheShaft) {
  ModelSpec spec = gear_pair();
  spec.bodies.push_back(named("shaft"));
  spec.joints[0].bodies = {"ground", "shaft"};
  spec.joints.push_back(joint(JointType::kWeld, "key", "shaft", "a", Point::Zero()));
  EXPECT_FALSE(built(spec).joints()[2].constants.mesh_holds_as_drawn_only);
}

TEST(BuildMeshesTest, WithoutBearingsTheMeshHoldsAsDrawnOnlyAndSaysSo) {
  ModelSpec spec = gear_pair();
  spec.joints[1] = joint(JointType::kFree, "jb", "ground", "b", Point::Zero());
  const ModelBuildResult result = build_model(spec);
  EXPECT_EQ(codes(result.diagnostics), Codes{"F324"});
  EXPECT_FALSE(result.diagnostics.has_errors());
  ASSERT_TRUE(result.model);
  const Joint& mesh = result.model->joints()[2];
  EXPECT_TRUE(mesh.constants.mesh_holds_as_drawn_only);
  EXPECT_LT((mesh.X_1F.p - Vector3d(0.2, 0, 0.1)).norm(), 1e-15);
  EXPECT_LT((mesh.X_2M.p - Vector3d(0.2, 0, 0.1)).norm(), 1e-15);
  EXPECT_LT((mesh.X_1F.R.col(0) - line_of_action(0)).norm(), 1e-15);
}

TEST(BuildMeshesTest, TwoPossibleAxesAreNotGuessed) {
  ModelSpec spec = gear_pair();
  spec.joints.push_back(joint(JointType::kRevolute, "other", "a", "b", Point(0.3, 0.3, 0)));
  EXPECT_EQ(build_codes(spec), Codes{"F324"});
}

TEST(BuildMeshesTest, ImpossibleLinesOfActionAreErrors) {
  ModelSpec spec = gear_pair();
  spec.joints[2].line_of_action = number3(0, 1, 0);
  ModelBuildResult result = build_model(spec);
  ASSERT_EQ(codes(result.diagnostics), Codes{"F323"});
  EXPECT_THAT(result.diagnostics.items()[0].message, HasSubstr("pressure angle zero"));
  spec.joints[2].line_of_action = number3(1, 0, 0);
  EXPECT_EQ(build_codes(spec), Codes{"F323"});
  PlaceSpec axis;
  axis.drawn = number3(0, 0, 1);
  spec.joints[2].axis = axis;
  spec.joints[2].line_of_action = number3(0.3, 1, 0.1);
  spec.joints[2].centers = std::array<Number3, 2>{number3(0, 0, 0), number3(0.5, 0, 0)};
  EXPECT_EQ(build_codes(spec), Codes{"F323"});
}

TEST(BuildMeshesTest, MissingLineOfActionIsAnError) {
  ModelSpec spec = gear_pair();
  spec.joints[2].line_of_action.reset();
  EXPECT_EQ(build_codes(spec), Codes{"F317"});
}

}  // namespace
}  // namespace ferrers
