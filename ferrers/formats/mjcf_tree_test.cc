#include <cmath>

#include "ferrers/formats/mjcf_test_model.h"

namespace ferrers {
namespace {

using mjcf_testing::body_of;
using mjcf_testing::build;
using mjcf_testing::joint_of;
using mjcf_testing::messages;
using mjcf_testing::places;
using mjcf_testing::pose_at;
using mjcf_testing::read_text;
using mjcf_testing::same;
using mjcf_testing::values;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kPi = 3.14159265358979323846;

Pose turned(double angle, const Vector3d& axis, const Vector3d& p = Vector3d::Zero()) {
  return {Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix(), p};
}

/// A body of the world with this orientation.
Pose drawn(const std::string& orientation, const std::string& compiler = "") {
  const Model model = build("<mujoco><compiler " + compiler + "/><worldbody><body name='a' pos='1 2 3' " + orientation +
                            "><geom size='1'/></body></worldbody></mujoco>");
  return model.body(*model.find_body("a")).X_WB;
}

TEST(MjcfTreeTest, EveryOrientationMeansItsRotation) {
  const Vector3d p(1, 2, 3);
  EXPECT_TRUE(same(drawn(""), Pose(Matrix3d::Identity(), p)));
  EXPECT_TRUE(same(drawn("quat='2 0 0 2'"), turned(kPi / 2, Vector3d::UnitZ(), p)));
  EXPECT_TRUE(same(drawn("axisangle='0 3 0 90'"), turned(kPi / 2, Vector3d::UnitY(), p)));
  EXPECT_TRUE(same(drawn("axisangle='0 3 0 0.5'", "angle='radian'"), turned(0.5, Vector3d::UnitY(), p)));
  EXPECT_TRUE(same(drawn("xyaxes='0 2 0  -3 1 0'"), turned(kPi / 2, Vector3d::UnitZ(), p)));
  EXPECT_TRUE(same(drawn("zaxis='0 -1 0'"), turned(kPi / 2, Vector3d::UnitX(), p)));
  EXPECT_TRUE(same(drawn("zaxis='0 0 -2'"), turned(kPi, Vector3d::UnitX(), p)));
}

TEST(MjcfTreeTest, EulerAnglesFollowTheirSequence) {
  const Vector3d p(1, 2, 3);
  const Pose x = turned(0.1, Vector3d::UnitX()), y = turned(0.2, Vector3d::UnitY()), z = turned(0.3, Vector3d::UnitZ());
  const Pose at(Matrix3d::Identity(), p);
  EXPECT_TRUE(same(drawn("euler='0.1 0.2 0.3'", "angle='radian'"), at * x * y * z));
  EXPECT_TRUE(same(drawn("euler='0.1 0.2 0.3'", "angle='radian' eulerseq='XYZ'"), at * z * y * x));
  EXPECT_TRUE(same(drawn("euler='0.3 0.2 0.1'", "angle='radian' eulerseq='zyx'"), at * z * y * x));
  EXPECT_TRUE(same(drawn("euler='0.1 0.2 0.3'", "angle='radian' eulerseq='xYz'"), at * y * x * z));
}

TEST(MjcfTreeTest, JointsOfOneBodyActInTheirOrderWithMasslessBodiesBetween) {
  const Model model = build(R"(<mujoco><compiler angle="radian"/><worldbody>
    <body name="a" pos="0 0 1">
      <joint name="up" type="slide" axis="0 0 2"/>
      <joint name="turn" axis="0 1 0" pos="0.5 0 0"/>
      <joint name="roll" axis="1 0 0"/>
      <geom size="0.1"/>
    </body></worldbody></mujoco>)");
  ASSERT_EQ(model.joints().size(), 3U);
  EXPECT_EQ(model.body(*model.find_body("a_after_up")).mass_kg, 0);
  const Pose at(Matrix3d::Identity(), {0, 0, 1});
  const Pose up(Matrix3d::Identity(), {0, 0, 0.3});
  const Pose there(Matrix3d::Identity(), {0.5, 0, 0});
  const Pose expected =
      at * up * there * turned(0.4, Vector3d::UnitY()) * there.inverse() * turned(0.7, Vector3d::UnitX());
  EXPECT_TRUE(same(pose_at(model, {{"up", {0.3}}, {"turn", {0.4}}, {"roll", {0.7}}}, "a"), expected));
}

TEST(MjcfTreeTest, CoordinatesAreThoseOfTheFileAlsoWithAReference) {
  const std::string text = R"(<mujoco><worldbody><body name="a">
      <joint name="turn" axis="0 0 1" ref="30" range="-10 90"/><geom size="1" pos="1 0 0"/>
      <body name="b" pos="1 0 0"><joint name="push" type="slide" axis="1 0 0" ref="0.2"/><geom size="1"/></body>
    </body></worldbody></mujoco>)";
  const Model model = build(text);
  EXPECT_TRUE(same(pose_at(model, {}, "b"), Pose(Matrix3d::Identity(), {1, 0, 0})));
  const Pose expected = turned(kPi / 3, Vector3d::UnitZ()) * Pose(Matrix3d::Identity(), {1.3, 0, 0});
  EXPECT_TRUE(same(pose_at(model, {{"turn", {kPi / 2}}, {"push", {0.5}}}, "b"), expected));
  const auto limits = *model.joint(*model.find_joint("turn")).limits;
  EXPECT_NEAR(limits[0], -kPi / 18, 1e-15);
  EXPECT_NEAR(limits[1], kPi / 2, 1e-15);
}

TEST(MjcfTreeTest, AFreeJointHasTheCoordinatesOfTheWorld) {
  const Model model = build(R"(<mujoco><worldbody><body name="a" pos="1 2 3" euler="0 0 90"><freejoint name="f"/>
    <geom size="1"/></body></worldbody></mujoco>)");
  EXPECT_TRUE(same(pose_at(model, {}, "a"), turned(kPi / 2, Vector3d::UnitZ(), {1, 2, 3})));
  EXPECT_TRUE(same(pose_at(model, {{"f", {4, 5, 6, 0, 1, 0, 0}}}, "a"), turned(kPi, Vector3d::UnitX(), {4, 5, 6})));
}

TEST(MjcfTreeTest, ABodyWithoutJointsIsWeldedToItsParent) {
  const auto read = read_text(
      "<mujoco><worldbody><body name='a'><joint/><geom size='1'/><body name='b' pos='0 0 "
      "1'/></body></worldbody></mujoco>");
  EXPECT_EQ(joint_of(read.model.spec, "b_weld").type, JointType::kWeld);
  EXPECT_EQ(joint_of(read.model.spec, "b_weld").bodies[0].name, "a");
  EXPECT_EQ(joint_of(read.model.spec, "a_joint").type, JointType::kRevolute);
}

TEST(MjcfTreeTest, ClassesPassOnWhatElementsDoNotSay) {
  const auto read = read_text(R"(<mujoco><default><joint axis="1 0 0" range="0 1"/>
      <default class="slow"><joint damping="3"/><default class="slower"><joint damping="4" type="slide"/></default></default>
    </default>
    <worldbody><body name="a" childclass="slow"><joint name="j"/><geom size="1"/>
      <body name="b"><joint name="k" class="slower"/><geom size="1"/></body>
      <body name="c" childclass="slower"><joint name="l" class="main"/><geom size="1"/></body>
    </body></worldbody></mujoco>)");
  EXPECT_FALSE(read.diagnostics.has_errors()) << messages(read.diagnostics);
  ASSERT_EQ(read.model.spec.forces.size(), 2U);
  const auto damping = [&](std::size_t i) {
    return std::get<JointDampingSpec>(read.model.spec.forces[i].element).damping.value;
  };
  EXPECT_EQ(damping(0), 3);
  EXPECT_EQ(damping(1), 4);
  EXPECT_EQ(joint_of(read.model.spec, "k").type, JointType::kPrismatic);
  EXPECT_EQ(joint_of(read.model.spec, "l").type, JointType::kRevolute);
  EXPECT_NEAR((*joint_of(read.model.spec, "j").limits)[1].value, kPi / 180, 1e-15);
  EXPECT_EQ((*joint_of(read.model.spec, "k").limits)[1].value, 1);
}

TEST(MjcfTreeTest, FramesAndCopiesAreWorkedOut) {
  const Model model = build(R"(<mujoco><worldbody>
      <frame pos="0 0 2" euler="0 0 90">
        <replicate count="11" offset="1 0 0" sep="-"><body name="a" pos="0 1 0"><joint name="j"/><geom size="1"/></body></replicate>
      </frame></worldbody></mujoco>)");
  ASSERT_EQ(model.bodies().size(), 12U);
  EXPECT_TRUE(same(model.body(*model.find_body("a_10")).X_WB, turned(kPi / 2, Vector3d::UnitZ(), {-1, 10, 2})));
  EXPECT_TRUE(model.find_joint("j_03").has_value());
  const Model ring = build(R"(<mujoco><worldbody><replicate count="4" euler="0 0 90">
      <body name="a" pos="1 0 0"><joint/><geom size="0.1"/></body></replicate></worldbody></mujoco>)");
  EXPECT_TRUE(same(ring.body(*ring.find_body("a3")).X_WB, turned(-kPi / 2, Vector3d::UnitZ(), {0, -1, 0})));
}

TEST(MjcfTreeTest, IncludedFilesStandInPlaceAndTheirMistakesAreToldAtTheInclude) {
  const auto read =
      read_text("<mujoco><worldbody>\n  <include file='arm.xml'/></worldbody></mujoco>", {},
                {{"arm.xml", "<mujocoinclude>\n <body name='a'>\n<joint axis='0 0 0'/></body></mujocoinclude>"}});
  ASSERT_TRUE(read.diagnostics.has_errors());
  EXPECT_THAT(places(read.diagnostics), ElementsAre("F318:2:4"));
  EXPECT_THAT(messages(read.diagnostics), HasSubstr("(line 3, column 14 of 'arm.xml')"));
}

TEST(MjcfTreeTest, MassesComeFromInertialFromGeomsOrFromBoth) {
  const std::string body =
      "<worldbody><body name='a'><joint/><geom type='box' size='1 1 1' pos='1 0 0'/>"
      "<inertial pos='0 0 1' mass='2' diaginertia='1 1 1'/></body></worldbody></mujoco>";
  EXPECT_EQ(body_of(read_text("<mujoco>" + body).model.spec, "a").mass->value, 2);
  EXPECT_EQ(body_of(read_text("<mujoco><compiler inertiafromgeom='true'/>" + body).model.spec, "a").mass->value, 8000);
  EXPECT_EQ(body_of(read_text("<mujoco><compiler settotalmass='5'/>" + body).model.spec, "a").mass->value, 5);
  const auto by_group = read_text("<mujoco><compiler inertiafromgeom='true' inertiagrouprange='1 2'/>" + body);
  EXPECT_EQ(body_of(by_group.model.spec, "a").mass->value, 0);
}

TEST(MjcfTreeTest, ASpannedCapsuleLiesBetweenItsPoints) {
  const auto read = read_text(
      "<mujoco><worldbody><body name='a'><joint/>"
      "<geom type='capsule' fromto='0 0 0 2 0 0' size='0.1' mass='3'/></body></worldbody></mujoco>");
  const BodySpec& body = body_of(read.model.spec, "a");
  EXPECT_EQ(values(*body.com), (std::array<double, 3>{1, 0, 0}));
  EXPECT_LT(body.inertia.moments[0].value, 0.02);
  EXPECT_NEAR(body.inertia.moments[1].value, body.inertia.moments[2].value, 1e-15);
  ASSERT_EQ(read.model.visuals.size(), 1U);
  EXPECT_EQ(read.model.visuals[0].size[1], 2);
}

TEST(MjcfTreeTest, AMassThatDependsOnAMeshIsNotInvented) {
  const auto read = read_text(
      "<mujoco><asset><mesh name='m' file='m.stl'/></asset><worldbody>"
      "<body name='a'><joint/><geom type='mesh' mesh='m'/></body></worldbody></mujoco>");
  EXPECT_FALSE(read.diagnostics.has_errors());
  EXPECT_FALSE(body_of(read.model.spec, "a").mass.has_value());
  EXPECT_THAT(messages(read.diagnostics), HasSubstr("the mass of the body 'a' is not known"));
}

TEST(MjcfTreeTest, TheBaseIsFixedOrFreedAsAsked) {
  const std::string text =
      "<mujoco><worldbody><body name='a' pos='0 0 1'><freejoint/><geom size='1'/></body><body "
      "name='b'/></worldbody></mujoco>";
  ImportOptions fixed, free;
  fixed.base = ImportBase::kFixed;
  free.base = ImportBase::kFree;
  EXPECT_EQ(joint_of(read_text(text).model.spec, "a_joint").type, JointType::kFree);
  EXPECT_EQ(joint_of(read_text(text, fixed).model.spec, "a_joint").type, JointType::kWeld);
  EXPECT_EQ(joint_of(read_text(text, free).model.spec, "b_joint").type, JointType::kFree);
}

}  // namespace
}  // namespace ferrers
