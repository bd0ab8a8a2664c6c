#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "ferrers/testing/build_checks.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers {
namespace {

using namespace witness;  // NOLINT(google-build-using-namespace): a test's vocabulary
using testing::HasSubstr;

BodySpec posed(const std::string& name, const Point& position, const Point& axis = Point::UnitZ(), double angle = 0) {
  BodySpec body;
  body.name = name;
  RotationSpec rotation;
  rotation.axis_angle = {numbers(axis), Number(angle)};
  body.pose = PoseSpec{numbers(position), rotation, {}};
  return body;
}

/// Body a drawn, body b with a pose; one joint a-b and a free joint for a.
ModelSpec pair_with(JointSpec joint_spec) {
  ModelSpec spec;
  BodySpec a;
  a.name = "a";
  spec.bodies = {a, posed("b", Point(1, 2, 3), Point(1, 1, 0), 0.7)};
  JointSpec base = joint(JointType::kFree, "base", "ground", "a", Point::Zero());
  spec.joints = {base, std::move(joint_spec)};
  return spec;
}

JointSpec a_to_b(JointType type, const Point& at = Point(0.5, -1, 2), const Point& axis = Point(1, 2, 2)) {
  return joint(type, "pin", "a", "b", at, axis);
}

PlaceSpec on_both(const Point& on_a, const Point& on_b) {
  PlaceSpec place;
  place.on_body = {{NameRef("a"), numbers(on_a)}, {NameRef("b"), numbers(on_b)}};
  return place;
}

Pose X_WF(const Model& model) {
  const Joint& pin = model.joints().at(1);
  return model.body(pin.first).X_WB * pin.X_1F;
}

Pose X_WM(const Model& model) {
  const Joint& pin = model.joints().at(1);
  return model.body(pin.second).X_WB * pin.X_2M;
}

void expect_same(const Pose& a, const Pose& b) {
  EXPECT_LT((a.R - b.R).norm(), 1e-14);
  EXPECT_LT((a.p - b.p).norm(), 1e-14);
}

TEST(BuildJointsTest, DrawnFramesCoincideForEveryTypeWithOnePlace) {
  for (const JointType type :
       {JointType::kWeld, JointType::kRevolute, JointType::kPrismatic, JointType::kCylindrical, JointType::kSpherical,
        JointType::kPlanar, JointType::kPointOnLine, JointType::kPointOnPlane, JointType::kFree}) {
    JointSpec pin = a_to_b(type);
    pin.place.drawn = number3(0.5, -1, 2);
    const Model model = built(pair_with(pin));
    expect_same(X_WF(model), X_WM(model));
    EXPECT_LT((X_WF(model).p - Vector3d(0.5, -1, 2)).norm(), 1e-14);
    EXPECT_NEAR(X_WF(model).R.determinant(), 1.0, 1e-14);
    EXPECT_TRUE(model.joints()[1].drawn);
  }
}

TEST(BuildJointsTest, AxisIsNormalisedAndXComesFromTheLeastAlignedWorldAxis) {
  const Model model = built(pair_with(a_to_b(JointType::kRevolute)));
  EXPECT_LT((X_WF(model).R.col(2) - Vector3d(1, 2, 2) / 3).norm(), 1e-15);
  const Vector3d x = X_WF(model).R.col(0);
  EXPECT_NEAR(x.dot(Vector3d(1, 2, 2)), 0.0, 1e-15);
  EXPECT_GT(x.x(), 0.9);
}

TEST(BuildJointsTest, JointsWithoutAnAxisTakeTheWorldAxes) {
  for (const JointType type : {JointType::kWeld, JointType::kSpherical, JointType::kFree}) {
    EXPECT_LT((X_WF(built(pair_with(a_to_b(type)))).R - Matrix3d::Identity()).norm(), 1e-15);
  }
}

TEST(BuildJointsTest, KeyXTurnsTheFrame) {
  JointSpec spec = a_to_b(JointType::kRevolute, Point::Zero(), Point::UnitZ());
  spec.x = number3(0, 3, 5);
  EXPECT_LT((X_WF(built(pair_with(spec))).R.col(0) - Vector3d::UnitY()).norm(), 1e-15);
  spec.x = number3(0, 0, 5);
  EXPECT_EQ(build_codes(pair_with(spec)), Codes{"F319"});
}

TEST(BuildJointsTest, PlacesOnEachBodyAreInTheirOwnFrames) {
  JointSpec spec = a_to_b(JointType::kRevolute);
  spec.place = on_both(Point(1, 0, 0), Point(0, 1, 0));
  spec.axis = on_both(Point(0, 0, 1), Point(1, 0, 1));
  const Model model = built(pair_with(spec));
  const Pose X_WB = model.bodies()[2].X_WB;
  EXPECT_FALSE(model.joints()[1].drawn);
  EXPECT_EQ(model.joints()[1].X_1F.p, Vector3d(1, 0, 0));
  EXPECT_LT((model.joints()[1].X_2M.p - Vector3d(0, 1, 0)).norm(), 1e-15);
  EXPECT_LT((model.joints()[1].X_2M.R.col(2) - Vector3d(1, 0, 1).normalized()).norm(), 1e-15);
  // x of M is F's x as drawn, made perpendicular to M's z.
  const Vector3d z = X_WB.R * Vector3d(1, 0, 1).normalized(), x = X_WF(model).R.col(0);
  EXPECT_LT((X_WM(model).R.col(0) - (x - z * z.dot(x)).normalized()).norm(), 1e-14);
}

TEST(BuildJointsTest, DrawnAxisGoesWithPlacesOnEachBody) {
  JointSpec spec = a_to_b(JointType::kRevolute);
  spec.place = on_both(Point(1, 0, 0), Point(0, 1, 0));
  const Model model = built(pair_with(spec));
  EXPECT_LT((X_WF(model).R - X_WM(model).R).norm(), 1e-14);
  EXPECT_FALSE(model.joints()[1].drawn);
}

TEST(BuildJointsTest, PosesDrawnTogetherGiveZeroCoordinates) {
  JointSpec spec = a_to_b(JointType::kRevolute);
  const Model drawn = built(pair_with(spec));
  const Pose X_BW = drawn.bodies()[2].X_WB.inverse();
  spec.place = on_both(Point(0.5, -1, 2), X_BW * Point(0.5, -1, 2));
  spec.axis = on_both(Point(1, 2, 2), X_BW.R * Point(1, 2, 2));
  const Model each = built(pair_with(spec));
  expect_same(X_WF(each), X_WM(each));
  expect_same(X_WF(each), X_WF(drawn));
}

TEST(BuildJointsTest, PlacesOnOtherBodiesOrOnOneOnlyAreErrors) {
  JointSpec spec = a_to_b(JointType::kRevolute);
  spec.place = on_both(Point(1, 0, 0), Point(0, 1, 0));
  spec.place.on_body[1].first = "c";
  EXPECT_EQ(build_codes(pair_with(spec)), (Codes{"F320", "F320"}));
  spec.place.on_body[1].first = "a";
  EXPECT_EQ(build_codes(pair_with(spec)), (Codes{"F320", "F320"}));
  spec.place.on_body.pop_back();
  EXPECT_EQ(build_codes(pair_with(spec)), Codes{"F320"});
}

TEST(BuildJointsTest, MissingPlacesAndAxesAreErrors) {
  JointSpec spec = a_to_b(JointType::kRevolute);
  spec.place = {};
  spec.axis = {};
  EXPECT_EQ(build_codes(pair_with(spec)), (Codes{"F317", "F317"}));
  spec.type = JointType::kSpherical;
  EXPECT_EQ(build_codes(pair_with(spec)), Codes{"F317"});
}

TEST(BuildJointsTest, ZeroAxisIsAnError) {
  EXPECT_EQ(build_codes(pair_with(a_to_b(JointType::kPlanar, Point::Zero(), Point::Zero()))), Codes{"F318"});
}

TEST(BuildJointsTest, FreeJointSitsAtTheMassCentreElseAtThePose) {
  JointSpec spec = a_to_b(JointType::kFree);
  spec.place = {};
  ModelSpec model_spec = pair_with(spec);
  EXPECT_LT((X_WM(built(model_spec)).p - Vector3d(1, 2, 3)).norm(), 1e-15);
  model_spec.bodies[1].com = number3(0, 0, 4);
  const Model model = built(model_spec);
  EXPECT_LT((X_WM(model).p - model.bodies()[2].X_WB * Vector3d(0, 0, 4)).norm(), 1e-14);
  expect_same(X_WF(model), X_WM(model));
}

TEST(BuildJointsTest, UniversalJointHasZAlongTheFirstAndXAlongTheSecondAxis) {
  const Point first(1, 0, 0), second(0, 3, 4);
  const Model model = built(pair_with(universal_joint("pin", "a", "b", Point(1, 1, 1), first, second)));
  EXPECT_LT((X_WF(model).R.col(2) - first).norm(), 1e-15);
  EXPECT_LT((X_WF(model).R.col(0) - second / 5).norm(), 1e-15);
  expect_same(X_WF(model), X_WM(model));
}

TEST(BuildJointsTest, UniversalAxesDrawnAskewAreAnError) {
  const Point first(1, 0, 0);
  EXPECT_EQ(build_codes(pair_with(universal_joint("pin", "a", "b", Point(1, 1, 1), first, Point(1e-5, 1, 0)))),
            Codes{"F319"});
  EXPECT_EQ(build_codes(pair_with(universal_joint("pin", "a", "b", Point(1, 1, 1), first, Point(1e-8, 1, 0)))),
            Codes{});
}

TEST(BuildJointsTest, UniversalAxesGivenBodyByBodyBelongToTheirBody) {
  JointSpec spec = universal_joint("pin", "a", "b", Point(1, 1, 1), Point::UnitX(), Point::UnitY());
  spec.axis = spec.axis2 = {};
  spec.axis.on_body = {{NameRef("a"), number3(1, 0, 0)}};
  spec.axis2.on_body = {{NameRef("b"), number3(0, 1, 0)}};
  const Model model = built(pair_with(spec));
  EXPECT_LT((model.joints()[1].X_1F.R.col(2) - Vector3d::UnitX()).norm(), 1e-15);
  EXPECT_LT((model.joints()[1].X_2M.R.col(0) - Vector3d::UnitY()).norm(), 1e-15);
  spec.axis.on_body[0].first = "b";
  EXPECT_EQ(build_codes(pair_with(spec)), Codes{"F320"});
}

TEST(BuildJointsTest, LineOfAPointOnLineBelongsToTheFirstBodyAlone) {
  JointSpec spec = a_to_b(JointType::kPointOnLine);
  spec.place = on_both(Point(1, 0, 0), Point(0, 1, 0));
  spec.axis = {};
  spec.axis.on_body = {{NameRef("a"), number3(0, 1, 0)}};
  const Model model = built(pair_with(spec));
  EXPECT_LT((model.joints()[1].X_1F.R.col(2) - Vector3d::UnitY()).norm(), 1e-15);
  EXPECT_LT((model.joints()[1].X_2M.p - Vector3d(0, 1, 0)).norm(), 1e-15);
}

TEST(BuildJointsTest, DistanceHasZAlongTheRodAndItsDrawnLength) {
  const Model model = built(pair_with(distance_joint("pin", "a", "b", Point(1, 0, 0), Point(1, 3, 4))));
  EXPECT_EQ(model.joints()[1].constants.length_m, 5.0);
  EXPECT_LT((X_WF(model).R.col(2) - Vector3d(0, 0.6, 0.8)).norm(), 1e-15);
  EXPECT_LT((X_WM(model).p - Vector3d(1, 3, 4)).norm(), 1e-14);
  EXPECT_LT((X_WM(model).R - X_WF(model).R).norm(), 1e-14);
}

TEST(BuildJointsTest, DistanceOfCoincidingPointsNeedsALength) {
  JointSpec spec = distance_joint("pin", "a", "b", Point(1, 0, 0), Point(1, 0, 0));
  EXPECT_EQ(build_codes(pair_with(spec)), Codes{"F321"});
  spec.length = 2.0;
  EXPECT_EQ(built(pair_with(spec)).joints()[1].constants.length_m, 2.0);
  spec.length = -2.0;
  EXPECT_EQ(build_codes(pair_with(spec)), Codes{"F321"});
}

TEST(BuildJointsTest, ScrewNeedsALead) {
  JointSpec spec = a_to_b(JointType::kScrew);
  EXPECT_EQ(build_codes(pair_with(spec)), Codes{"F322"});
  spec.lead = -0.01;
  EXPECT_EQ(built(pair_with(spec)).joints()[1].constants.lead_m, -0.01);
}

TEST(BuildJointsTest, UnknownBodiesAndABodyWithItselfAreErrors) {
  JointSpec spec = a_to_b(JointType::kRevolute);
  spec.bodies = {"a", "bb"};
  ModelBuildResult result = build_model(pair_with(spec));
  EXPECT_EQ(codes(result.diagnostics), (Codes{"F303", "F315"}));
  EXPECT_THAT(result.diagnostics.items()[0].hint, HasSubstr("'b'"));
  spec.bodies = {"b", "b"};
  EXPECT_EQ(build_codes(pair_with(spec)), Codes{"F316"});
}

TEST(BuildJointsTest, StiffnessPartsNotGivenAreRigid) {
  JointSpec spec = a_to_b(JointType::kRevolute);
  spec.stiffness = StiffnessSpec{number3(1, 2, INFINITY), std::nullopt, {}};
  const Vector6d k = *built(pair_with(spec)).joints()[1].stiffness;
  EXPECT_EQ(k[1], 2.0);
  for (int i = 2; i < 6; ++i) EXPECT_TRUE(std::isinf(k[i]));
  spec.stiffness = StiffnessSpec{number3(1, 0, -3), std::nullopt, {}};
  EXPECT_EQ(build_codes(pair_with(spec)), (Codes{"F325", "F325"}));
}

TEST(BuildJointsTest, MisalignmentPartsNotGivenAreZero) {
  JointSpec spec = a_to_b(JointType::kRevolute);
  spec.misalignment = MisalignmentSpec{std::nullopt, number3(0.1, 0.2, 0.3), {}};
  const Vector6d delta = *built(pair_with(spec)).joints()[1].misalignment;
  EXPECT_EQ(delta.head<3>(), Vector3d::Zero());
  EXPECT_EQ(delta.tail<3>(), Vector3d(0.1, 0.2, 0.3));
}

TEST(BuildJointsTest, LimitsNeedOneCoordinateAndAnOrder) {
  JointSpec spec = a_to_b(JointType::kRevolute);
  spec.limits = {Number(-1.0), Number(2.0)};
  EXPECT_EQ((*built(pair_with(spec)).joints()[1].limits)[1], 2.0);
  spec.limits = {Number(2.0), Number(2.0)};
  EXPECT_EQ(build_codes(pair_with(spec)), Codes{"F326"});
  spec.type = JointType::kCylindrical;
  EXPECT_EQ(build_codes(pair_with(spec)), Codes{"F326"});
}

TEST(BuildJointsTest, FrictionIsNotNegative) {
  JointSpec spec = a_to_b(JointType::kRevolute);
  spec.friction = FrictionSpec{Number(0.1), Number(-0.2), Number(0.01), {}};
  EXPECT_EQ(build_codes(pair_with(spec)), Codes{"F311"});
  spec.friction->coulomb = Number(0.2);
  EXPECT_EQ(built(pair_with(spec)).joints()[1].friction->coulomb, 0.2);
}

}  // namespace
}  // namespace ferrers
