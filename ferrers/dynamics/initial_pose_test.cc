#include "ferrers/dynamics/initial_pose.h"

#include <gtest/gtest.h>

#include "ferrers/dynamics/equilibrium.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {
namespace {

/// Two bodies joined to each other, which hang on a bushing: no joint leads to ground.
ModelSpec make_hung_pair() {
  ModelSpec spec;
  spec.name = "hung-pair";
  spec.gravity = number3(0, -9.81, 0);
  spec.bodies = {box_body("a", {0, 0, 0}, {0.5, 0.2, 0.1}, 1), box_body("b", {1, 0, 0}, {0.3, 0.3, 0.1}, 1)};
  spec.joints = {joint(JointType::kRevolute, "j", "a", "b", {0.5, 0, 0})};
  BushingSpec bushing;
  bushing.bodies = {NameRef("ground"), NameRef("a")};
  bushing.place.drawn = number3(0, 0, 0);
  bushing.axis.drawn = number3(0, 0, 1);
  bushing.force_stiffness = number3(100, 100, 100);
  bushing.moment_stiffness = number3(100, 100, 100);
  bushing.force_damping = bushing.moment_damping = number3(5, 5, 5);
  ForceSpec force;
  force.name = "s";
  force.element = bushing;
  spec.forces = {force};
  return spec;
}

/// Poses of all bodies as two states have them.
void expect_same_poses(const EngineProbe& a, const State& at_a, const EngineProbe& b, const State& at_b, double bound) {
  const AbsoluteState x = absolute_state(*a.system, at_a), y = absolute_state(*b.system, at_b);
  ASSERT_EQ(x.poses.size(), y.poses.size());
  for (std::size_t i = 0; i < x.poses.size(); ++i) {
    EXPECT_LT((x.poses[i].p - y.poses[i].p).norm(), bound) << i;
    EXPECT_LT((x.poses[i].R - y.poses[i].R).norm(), bound) << i;
  }
}

TEST(InitialPoseTest, ABodyThatFloatsRestsWhereTheModelIsWritten) {
  const ModelSpec spec = make_hung_pair();
  const EngineProbe before(spec);
  const EquilibriumResult rest = solve_equilibrium(*before.dynamics, before.start());
  ASSERT_EQ(rest.status, EquilibriumStatus::kFound) << rest.message;
  const ModelSpec written = with_initial_pose(spec, *before.system, rest.state);
  ASSERT_EQ(written.joints.size(), 2U);
  EXPECT_EQ(written.joints[1].name.name, "float_a");
  EXPECT_EQ(written.joints[1].type, JointType::kFree);
  EngineProbe after(written);
  const State start = after.start();
  expect_same_poses(before, rest.state, after, start, 1e-12);
  EXPECT_LT(start.v.norm(), 1e-12);
  // 2 kg on 100 N/m.
  EXPECT_NEAR(absolute_state(*after.system, start).poses[1].p.y(), -2 * 9.81 / 100, 1e-9);
  EXPECT_LT(after.forward(start).vdot.norm(), 1e-7);
}

TEST(InitialPoseTest, AnyPoseOfAFloatingLoopIsWritten) {
  ModelSpec spec = make_driven_four_bar();
  spec.drives.clear();
  spec.initial.clear();
  BodySpec base = box_body("base", {0.5, -0.5, 0}, {1, 0.1, 0.1}, 2);
  spec.bodies.push_back(base);
  for (JointSpec& one : spec.joints) {
    for (NameRef& body : one.bodies) {
      if (body.name == "ground") body = NameRef("base");
    }
  }
  EngineProbe before(spec);
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const State state = before.wandered(seed);
    const EngineProbe after(with_initial_pose(spec, *before.system, state));
    expect_same_poses(before, state, after, after.start(), 1e-9);
  }
}

TEST(InitialPoseTest, TheNameOfTheJointAddedIsNoOtherOne) {
  ModelSpec spec = make_hung_pair();
  spec.joints[0].name = "float_a";
  const EngineProbe engine(spec);
  const ModelSpec written = with_initial_pose(spec, *engine.system, engine.start());
  EXPECT_EQ(written.joints[1].name.name, "float_a_");
}

}  // namespace
}  // namespace ferrers::witness
