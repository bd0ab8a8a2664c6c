#include "ferrers/model/joint_change.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ferrers/model/joints/joint_type.h"
#include "ferrers/model/pose_spec.h"
#include "ferrers/testing/build_checks.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers {
namespace {

using testing::HasSubstr;
using witness::box_body;
using witness::built;
using witness::joint;
using witness::Point;
using witness::values;

const JointSpec& joint_of(const ModelSpec& spec, const std::string& name) {
  for (const JointSpec& joint : spec.joints) {
    if (joint.name.name == name) return joint;
  }
  throw std::invalid_argument(name);
}

// Two arms on hinges; everything that can speak of a joint coordinate speaks of `hinge`.
ModelSpec make_talkative() {
  using namespace witness;
  ModelSpec spec;
  spec.bodies = {bar_body("arm", {0, 0, 0}, {1, 0, 0}, 1, 0.02), bar_body("tip", {1, 0, 0}, {2, 0, 0}, 1, 0.02)};
  spec.joints = {joint(JointType::kRevolute, "hinge", "ground", "arm", {0, 0, 0}),
                 joint(JointType::kRevolute, "elbow", "arm", "tip", {1, 0, 0})};
  CouplingSpec coupling;
  coupling.name = "chain";
  coupling.coordinates = {{NameRef("hinge"), ""}, {NameRef("elbow"), ""}};
  coupling.coefficients = {Number(1), Number(2)};
  spec.couplings = {coupling};
  spec.drives = {coordinate_drive("motor", "hinge", "", "3*hinge.position - hinge.velocity + elbow.angle.velocity")};
  spec.drives[0].motion.clear();
  TorsionSpringSpec spring;
  spring.coordinate.joint = NameRef("hinge");
  spring.stiffness = Number(5);
  ForceSpec force;
  force.name = "spring";
  force.element = spring;
  spec.forces = {force};
  spec.initial = {initial_velocity("hinge", 2)};
  EventSpec event;
  event.name = "stop";
  event.when = *law("hinge.angle - 1").expression;
  spec.events = {event};
  return spec;
}

TEST(JointChangeTest, ReferencesFollowTheCoordinateToItsNewName) {
  for (const JointType to : {JointType::kCylindrical, JointType::kUniversal, JointType::kPlanar}) {
    const JointChangeResult result = change_joints(
        make_talkative(), {{"hinge", to, to == JointType::kUniversal ? Vector3d(1, 0, 0) : Vector3d(0, 0, 0)}});
    ASSERT_TRUE(result.spec) << result.reason;
    const std::string name = to == JointType::kUniversal ? "angle_1" : "angle";
    EXPECT_EQ(result.spec->couplings[0].coordinates[0].coordinate, name);
    EXPECT_EQ(result.spec->couplings[0].coordinates[1].coordinate, "");
    EXPECT_EQ(result.spec->drives[0].coordinate->coordinate, name);
    EXPECT_EQ(std::get<TorsionSpringSpec>(result.spec->forces[0].element).coordinate.coordinate, name);
    EXPECT_EQ(result.spec->initial[0].coordinate, name);
    EXPECT_THAT(result.spec->events[0].when.to_string(), HasSubstr("hinge." + name));
    EXPECT_THAT(result.spec->drives[0].effort[0].expression->to_string(), HasSubstr("hinge." + name + ".velocity"));
    const Model model = built(*result.spec);
    const Model before = built(make_talkative());
    EXPECT_EQ(model.drives()[0].coordinate.joint, before.drives()[0].coordinate.joint);
    EXPECT_EQ(model.initial()[0].velocity, before.initial()[0].velocity);
  }
}

TEST(JointChangeTest, AChangeThatLosesACoordinateInUseIsRefusedWithTheReason) {
  const JointChangeResult result = change_joints(make_talkative(), {{"hinge", JointType::kSpherical, {}}});
  EXPECT_FALSE(result.spec);
  EXPECT_THAT(result.reason, HasSubstr("'chain'"));
  EXPECT_THAT(result.reason, HasSubstr("'angle'"));
  EXPECT_FALSE(CoordinateUses(make_talkative()).obstacle("elbow", JointType::kSpherical).empty());
  EXPECT_TRUE(CoordinateUses(make_talkative()).obstacle("elbow", JointType::kCylindrical).empty());
}

TEST(JointChangeTest, EveryKnownChangeBuildsAgainAtTheSamePlace) {
  int tried = 0;
  for (const JointTypeInfo* from : all_joint_types()) {
    for (const JointTypeInfo* to : all_joint_types()) {
      const ChangeKind kind = joint_change_kind(from->type, to->type);
      if (kind == ChangeKind::kImpossible) continue;
      ModelSpec spec;
      spec.bodies = {witness::box_body("a", {0.5, 0, 0}, {1, 1, 1}, 1)};
      JointSpec joint = witness::joint(from->type, "j", "ground", "a", {0.1, 0.2, 0.3}, {1, 2, 2});
      if (from->type == JointType::kUniversal) {
        joint = witness::universal_joint("j", "ground", "a", {0.1, 0.2, 0.3}, {0, 0, 1}, {1, 0, 0});
      }
      if (from->type == JointType::kWeld || from->type == JointType::kSpherical) joint.axis = {};
      if (from->type == JointType::kScrew) joint.lead = Number(0.01);
      spec.joints = {joint};
      const Vector3d direction = kind == ChangeKind::kDirected ? Vector3d(0.6, 0.8, 0) : Vector3d(0, 0, 0);
      const JointChangeResult result = change_joints(spec, {{"j", to->type, direction}});
      ASSERT_TRUE(result.spec) << from->name << " to " << to->name << ": " << result.reason;
      const Joint before = built(spec).joints()[0], after = built(*result.spec).joints()[0];
      EXPECT_EQ(after.type, to->type);
      EXPECT_NEAR((after.X_1F.p - before.X_1F.p).norm(), 0, 1e-15);
      ++tried;
    }
  }
  EXPECT_GE(tried, 30);
}

TEST(JointChangeTest, TheSecondAxisOfACrossIsFixedToTheSecondBodyInItsOwnFrame) {
  ModelSpec spec;
  spec.bodies = {witness::box_body("a", {0.5, 0, 0}, {1, 1, 1}, 1)};
  PoseSpec pose;
  pose.position = number3(1, 2, 3);
  pose.rotation = RotationSpec{};
  pose.rotation->axis_angle = {number3(1, 1, 0), Number(0.7)};
  spec.bodies[0].pose = pose;
  JointSpec joint = witness::joint(JointType::kRevolute, "j", "ground", "a", {0, 0, 0});
  joint.place = {};
  joint.place.on_body = {{NameRef("ground"), number3(0, 0, 0)}, {NameRef("a"), number3(0.5, 0, 0)}};
  joint.axis = {};
  joint.axis.on_body = {{NameRef("ground"), number3(0, 0, 1)}, {NameRef("a"), number3(0, 1, 1)}};
  spec.joints = {joint};
  const JointChangeResult result = change_joints(spec, {{"j", JointType::kUniversal, Vector3d(0.6, 0.8, 0)}});
  ASSERT_TRUE(result.spec) << result.reason;
  const Model before = built(spec), after = built(*result.spec);
  const Vector3d wanted = before.joints()[0].X_2M.R * Vector3d(0.6, 0.8, 0);
  EXPECT_NEAR((after.joints()[0].X_2M.R.col(0) - wanted).norm(), 0, 1e-12);
}

TEST(JointChangeTest, StiffnessTurnsWithTheFrameOrIsLeftOutAndSaid) {
  ModelSpec spec = make_talkative();
  spec.couplings.clear(), spec.drives.clear(), spec.forces.clear(), spec.initial.clear(), spec.events.clear();
  JointSpec& hinge = spec.joints[0];
  hinge.axis.drawn = number3(1, 0, 0);  // its frame: z along the world's x, x along the world's y
  hinge.stiffness = StiffnessSpec{number3(1, 2, 3), number3(7, 7, 7), {}};
  hinge.limits = {Number(-1), Number(1)};
  JointChangeResult result = change_joints(spec, {{"hinge", JointType::kSpherical, {}}});
  ASSERT_TRUE(result.spec) << result.reason;
  const Number3 force = *joint_of(*result.spec, "hinge").stiffness->force;
  EXPECT_EQ(force[0].value, 3);
  EXPECT_EQ(force[1].value, 1);
  EXPECT_EQ(force[2].value, 2);
  ASSERT_EQ(result.notes.size(), 1u);
  EXPECT_THAT(result.notes[0], HasSubstr("limits"));
  spec.joints[0].axis.drawn = number3(1, 2, 3);
  result = change_joints(spec, {{"hinge", JointType::kSpherical, {}}});
  EXPECT_FALSE(joint_of(*result.spec, "hinge").stiffness.has_value());
  EXPECT_EQ(result.notes.size(), 2u);
}

TEST(JointChangeTest, AMeshKeepsTheAxisAndCentresThatItReadOffAHinge) {
  ModelSpec spec = witness::make_planetary(1);
  for (JointSpec& joint : spec.joints) {
    if (joint.type == JointType::kGearMesh) joint.centers.reset();
  }
  const JointChangeResult result = change_joints(spec, {{"sun_bearing", JointType::kPlanar, {}}});
  ASSERT_TRUE(result.spec) << result.reason;
  const Model before = built(spec), after = built(*result.spec);
  for (std::size_t j = 0; j < before.joints().size(); ++j) {
    EXPECT_FALSE(after.joints()[j].constants.mesh_holds_as_drawn_only);
    EXPECT_NEAR(after.joints()[j].constants.base_radius_1_m, before.joints()[j].constants.base_radius_1_m, 1e-12);
  }
}

/// A triangle of parts that welds with `merge` hold, one weld more than needed, and a fourth part on the third.
ModelSpec welded_triangle() {
  ModelSpec spec;
  for (const char* name : {"a", "b", "c", "lid"}) spec.bodies.push_back(box_body(name, {1, 0, 0}, {1, 1, 1}, 1));
  spec.joints = {joint(JointType::kRevolute, "pin", "ground", "a", Point::Zero())};
  const auto weld = [&](const std::string& name, const std::string& first, const std::string& second) {
    JointSpec one = joint(JointType::kWeld, name, first, second, Point(0.5, 0.2, 0));
    one.axis = {};
    one.merge = true;
    spec.joints.push_back(one);
  };
  weld("cap", "c", "lid");
  weld("ab", "a", "b");
  weld("bc", "b", "c");
  weld("ac", "a", "c");
  return spec;
}

TEST(JointChangeTest, AWeldInALoopOfMergedWeldsCanBeChangedAndTheOthersStayJoints) {
  const ModelSpec spec = welded_triangle();
  ASSERT_EQ(built(spec).joints().size(), 4u);
  const JointChangeResult result = change_joints(spec, {{"ab", JointType::kFree, Vector3d::Zero()}});
  ASSERT_TRUE(result.spec) << result.reason;
  const Model after = built(*result.spec);
  EXPECT_EQ(after.joints().size(), 4u);
  EXPECT_EQ(after.joint(*after.find_joint("ab")).type, JointType::kFree);
  EXPECT_TRUE(after.find_joint("bc"));
  EXPECT_EQ(after.find_body("lid"), after.find_body("c"));
}

TEST(JointChangeTest, AxesOfPartsAreGivenAsTheyAreDrawn) {
  // The plate is drawn as the arm is, and sits on it turned by a quarter about z.
  ModelSpec spec;
  for (const char* name : {"arm", "plate", "end"}) spec.bodies.push_back(box_body(name, {1, 0, 0}, {1, 1, 1}, 1));
  JointSpec bolt = joint(JointType::kWeld, "bolt", "arm", "plate", Point::Zero());
  bolt.place = bolt.axis = {};
  bolt.merge = true;
  bolt.frames = {pose_spec({Eigen::AngleAxisd(EIGEN_PI / 2, Point::UnitZ()).toRotationMatrix(), Point::Zero()}), {}};
  JointSpec ball = joint(JointType::kSpherical, "ball", "plate", "end", Point(1, 0, 0));
  ball.axis = {};
  spec.joints = {joint(JointType::kRevolute, "pin", "ground", "arm", Point::Zero()), bolt, ball};
  const JointChangeResult result = change_joints(spec, {{"ball", JointType::kRevolute, Vector3d::UnitX()}});
  ASSERT_TRUE(result.spec) << result.reason;
  EXPECT_LT((values(*result.spec->joints[2].axis.drawn) - Point::UnitX()).norm(), 1e-12);
}

}  // namespace
}  // namespace ferrers
