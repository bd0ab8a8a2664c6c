#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ferrers/model/model.h"
#include "ferrers/model/pose_spec.h"
#include "ferrers/testing/build_checks.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers {
namespace {

using namespace witness;  // NOLINT(google-build-using-namespace): a test's vocabulary
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

JointSpec merged(const std::string& name, const std::string& first, const std::string& second) {
  JointSpec weld = joint(JointType::kWeld, name, first, second, Point(0.1, 0.2, 0.3));
  weld.axis = {};
  weld.merge = true;
  return weld;
}

/// A pendulum of three boxes in a row along x, turning about z; the last box has a frame of its own.
ModelSpec three_boxes() {
  ModelSpec spec;
  spec.bodies = {box_body("a", {1, 0, 0}, {1, 0.1, 0.1}, 2), box_body("b", {2, 0, 0}, {1, 0.1, 0.1}, 3), {}};
  BodySpec& c = spec.bodies[2];
  c = box_body("c", {0, 0, 1}, {0.1, 0.1, 1}, 4);  // along z of its frame
  c.pose = pose_spec({Eigen::AngleAxisd(EIGEN_PI / 2, Point::UnitY()).toRotationMatrix(), Point(2, 0, 0)});
  spec.joints = {joint(JointType::kRevolute, "pin", "ground", "a", Point::Zero()), merged("ab", "a", "b"),
                 merged("bc", "b", "c")};
  return spec;
}

std::vector<std::string> part_names(const Body& body) {
  std::vector<std::string> names;
  for (const Part& part : body.parts) names.push_back(part.name);
  return names;
}

TEST(BuildGroupsTest, WeldedPartsAreOneBodyWithTheNameAndFrameOfTheFirst) {
  const Model model = built(three_boxes());
  ASSERT_EQ(model.bodies().size(), 2u);
  ASSERT_EQ(model.joints().size(), 1u);
  const Body& body = model.bodies()[1];
  EXPECT_EQ(body.name, "a");
  EXPECT_THAT(part_names(body), ElementsAre("a", "b", "c"));
  EXPECT_THAT(body.merged_welds, ElementsAre("ab", "bc"));
  EXPECT_EQ(model.find_body("c"), BodyId(1));
  EXPECT_LT((model.part("c").X_BP.p - Point(2, 0, 0)).norm(), 1e-15);
}

TEST(BuildGroupsTest, MassesAddUpAboutTheCommonMassCentre) {
  const Body body = built(three_boxes()).bodies()[1];
  EXPECT_DOUBLE_EQ(body.mass_kg, 9);
  EXPECT_LT((body.com_m - Point((2 * 1 + 3 * 2 + 4 * 3) / 9.0, 0, 0)).norm(), 1e-15);
  const double x = body.com_m.x(), box = (1 + 0.01) / 12;
  const double wanted = 9 * box + 2 * (1 - x) * (1 - x) + 3 * (2 - x) * (2 - x) + 4 * (3 - x) * (3 - x);
  EXPECT_NEAR(body.inertia_kgm2(2, 2), wanted, 1e-14);
  EXPECT_NEAR(body.inertia_kgm2(0, 0), 9 * 0.02 / 12, 1e-15);
}

TEST(BuildGroupsTest, APartOfTheGroundIsGround) {
  ModelSpec spec = three_boxes();
  spec.joints[0] = merged("foot", "ground", "a");
  spec.joints.push_back(joint(JointType::kRevolute, "pin", "b", "rest", Point::Zero()));
  spec.bodies.push_back(box_body("rest", {1, 1, 0}, {1, 1, 1}, 1));
  const Model model = built(spec);
  ASSERT_EQ(model.bodies().size(), 2u);
  EXPECT_THAT(part_names(model.bodies()[0]), ElementsAre("ground", "a", "b", "c"));
  EXPECT_EQ(model.joints()[0].first, kGround);
}

TEST(BuildGroupsTest, WhatStandsOnAPartStandsOnTheGroup) {
  ModelSpec spec = three_boxes();
  spec.joints.push_back(joint(JointType::kSpherical, "end", "c", "rest", Point(3.5, 0, 0)));
  spec.joints.back().axis = {};
  spec.bodies.push_back(box_body("rest", {4, 0, 0}, {1, 1, 1}, 1));
  spec.records = {record("tip", "c", Point(0, 0, 1.5))};
  SpringSpec spring;
  spring.bodies = {NameRef("ground"), NameRef("c")};
  spring.points = {number3(0, 1, 0), number3(0, 0, 1)};
  spring.stiffness = 10;
  LoadSpec load;
  load.body = "c";
  load.place = number3(0, 0, 1);
  load.components = {law("1"), law("2"), law("3")};
  load.in_body_axes = true;
  spec.forces = {{"spring", spring, {}}, {"load", load, {}}};
  const Model model = built(spec);
  EXPECT_EQ(model.joints()[1].first, BodyId(1));
  EXPECT_LT((model.joints()[1].X_1F.p - Point(3.5, 0, 0)).norm(), 1e-15);
  EXPECT_EQ(model.records()[0].body, BodyId(1));
  EXPECT_LT((model.records()[0].point_m - Point(3.5, 0, 0)).norm(), 1e-15);
  const auto& stretched = std::get<Spring>(model.forces()[0].element);
  EXPECT_LT((stretched.point_2_m - Point(3, 0, 0)).norm(), 1e-15);
  EXPECT_NEAR(stretched.free_length_m, std::sqrt(10.0), 1e-15);
  const auto& pushed = std::get<Load>(model.forces()[1].element);
  EXPECT_LT((pushed.point_m - Point(3, 0, 0)).norm(), 1e-15);
  EXPECT_LT((pushed.R_BP * Point::UnitZ() - Point::UnitX()).norm(), 1e-15);
}

/// The same with a lid welded to the last box.
ModelSpec with_lid() {
  ModelSpec spec = three_boxes();
  spec.bodies.push_back(box_body("lid", {3, 1, 0}, {1, 1, 0.1}, 1));
  spec.joints.push_back(merged("cap", "c", "lid"));
  return spec;
}

TEST(BuildGroupsTest, WeldsInALoopOfWeldsStayJoints) {
  ModelSpec spec = with_lid();
  spec.joints.push_back(merged("ac", "a", "c"));
  const Model model = built(spec);
  ASSERT_EQ(model.bodies().size(), 4u);  // ground, a, b, c with the lid
  EXPECT_EQ(model.joints().size(), 4u);
  EXPECT_THAT(part_names(model.bodies()[3]), ElementsAre("c", "lid"));
  EXPECT_TRUE(model.find_joint("ac"));
  EXPECT_FALSE(model.find_joint("cap"));
}

TEST(BuildGroupsTest, TwoWeldsBetweenTheSamePartsStayJoints) {
  ModelSpec spec = three_boxes();
  spec.joints.push_back(merged("ab_2", "b", "a"));
  const Model model = built(spec);
  EXPECT_EQ(model.bodies().size(), 3u);
  EXPECT_TRUE(model.find_joint("ab"));
  EXPECT_TRUE(model.find_joint("ab_2"));
}

TEST(BuildGroupsTest, WeldsBesideAnotherJointOfTheirGroupStayJoints) {
  ModelSpec spec = with_lid();
  spec.joints.push_back(joint(JointType::kRevolute, "hinge", "a", "c", Point::Zero()));
  const Model model = built(spec);
  EXPECT_EQ(model.bodies().size(), 4u);
  EXPECT_TRUE(model.find_joint("ab"));
  EXPECT_TRUE(model.find_joint("bc"));
  EXPECT_FALSE(model.find_joint("cap"));
}

TEST(BuildGroupsTest, OnlyPlainWeldsCanBeMerged) {
  ModelSpec spec = three_boxes();
  spec.joints[0].merge = true;
  EXPECT_THAT(messages(build_model(spec).diagnostics), HasSubstr("F211: 'pin' cannot be merged"));
}

TEST(BuildGroupsTest, MistakesInAWeldThatIsToBeMergedAreTold) {
  ModelSpec spec = three_boxes();
  spec.joints[1].place = {};
  PoseSpec wrong;
  wrong.rotation.emplace();
  wrong.rotation->quaternion = std::array<Number, 4>{Number(2), Number(0), Number(0), Number(0)};
  spec.joints[1].frames = {wrong, PoseSpec()};
  EXPECT_THAT(messages(build_model(spec).diagnostics), HasSubstr("F327"));
}

TEST(BuildGroupsTest, AMergedWeldIsNoJointThatOthersMayName) {
  ModelSpec spec = three_boxes();
  spec.initial = {initial_velocity("ab", 1)};
  EXPECT_THAT(messages(build_model(spec).diagnostics), HasSubstr("F304"));
}

TEST(BuildGroupsTest, AGroupThatNothingHoldsIsAnError) {
  ModelSpec spec = three_boxes();
  spec.joints.erase(spec.joints.begin());
  EXPECT_THAT(messages(build_model(spec).diagnostics), HasSubstr("F315"));
}

TEST(BuildGroupsTest, ParametersMoveTheParts) {
  ModelSpec spec = three_boxes();
  ParameterSpec mass;
  mass.name = "m";
  mass.value = 4;
  spec.parameters = {mass};
  spec.bodies[2].mass = formula("m");
  const Model model = built(spec);
  EXPECT_DOUBLE_EQ(model.bodies()[1].mass_kg, 9);
  const ModelBuildResult heavier = model.with_parameters({{"m", 5}});
  ASSERT_TRUE(heavier.model);
  EXPECT_DOUBLE_EQ(heavier.model->bodies()[1].mass_kg, 10);
  EXPECT_EQ(heavier.model->spec().joints.size(), 3u);
}

}  // namespace
}  // namespace ferrers
