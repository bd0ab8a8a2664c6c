#include "ferrers/dynamics/equilibrium.h"

#include <gtest/gtest.h>

#include <cmath>

#include "ferrers/dynamics/named_coordinates.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/random_mechanism.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers {
namespace {

using namespace witness;  // NOLINT(google-build-using-namespace)

constexpr double kGravity = 9.81;

double position(const EngineProbe& probe, const State& state, const std::string& name) {
  for (const NamedCoordinate& one : measure_positions(*probe.system, state)) {
    if (one.name == name) return one.value;
  }
  ADD_FAILURE() << "no coordinate " << name;
  return NAN;
}

/// Largest acceleration of a body by the witness, which knows no tree and no selection; m/s² and L·rad/s².
double witness_acceleration(const EngineProbe& probe, const State& state) {
  const AbsoluteState absolute = absolute_state(*probe.system, state);
  const AbsoluteMotion motion =
      solve_absolute(probe.model(), absolute, applied_wrenches(probe.model(), absolute, state.t));
  double largest = 0;
  for (const Vector6d& a : motion.accelerations) {
    largest = std::max({largest, a.head<3>().norm() * probe.scaling.length_m, a.tail<3>().norm()});
  }
  return largest;
}

ForceSpec spring(const std::string& name, const std::string& body, const Point& on_ground, const Point& on_body,
                 double stiffness, double free_length) {
  SpringSpec element;
  element.bodies = {NameRef("ground"), NameRef(body)};
  element.points = {numbers(on_ground), numbers(on_body)};
  element.stiffness = Number(stiffness);
  element.free_length = Number(free_length);
  ForceSpec spec;
  spec.name = name;
  spec.element = element;
  return spec;
}

ForceSpec constant_torque(const std::string& body, double z) {
  LoadSpec element;
  element.body = body;
  element.is_torque = true;
  element.components = {law("0"), law("0"), law(std::to_string(z))};
  ForceSpec spec;
  spec.name = "torque";
  spec.element = element;
  return spec;
}

TEST(EquilibriumTest, APendulumComesToRestBelowItsPivotAndItsPivotCarriesIt) {
  const EngineProbe probe(make_pendulum());
  const EquilibriumResult rest = solve_equilibrium(*probe.dynamics, probe.start());
  ASSERT_EQ(rest.status, EquilibriumStatus::kFound) << rest.message;
  EXPECT_NEAR(position(probe, rest.state, "pivot.angle"), -M_PI / 2, 1e-14);
  EXPECT_EQ(rest.stability.stability, Stability::kStable);
  EXPECT_NEAR(rest.stiffness.value(0, 0), kGravity, 1e-10);
  EXPECT_NEAR(rest.energy.total(), -kGravity, 1e-12);
  const auto reactions = compute_rest_reactions(probe.dynamics, rest, ReactionAxes::kWorld, {});
  EXPECT_NEAR(reactions[0].value[1], kGravity, 1e-12);
  EXPECT_EQ(reactions[0].status[1], ReactionStatus::kUnique);
}

TEST(EquilibriumTest, AnUprightPendulumIsAtRestAndUnstable) {
  ModelSpec spec = make_pendulum();
  spec.bodies[0].com = number3(0, 1, 0);
  const EngineProbe probe(spec);
  const EquilibriumResult rest = solve_equilibrium(*probe.dynamics, probe.start());
  ASSERT_EQ(rest.status, EquilibriumStatus::kFound);
  EXPECT_EQ(position(probe, rest.state, "pivot.angle"), 0);
  EXPECT_EQ(rest.stability.stability, Stability::kUnstable);
  EXPECT_EQ(rest.stability.unstable, 1);
  spec.bodies[0].com = number3(1e-3, 1, 0);  // a little beside: it falls
  const EngineProbe beside(spec);
  const EquilibriumResult fallen = solve_equilibrium(*beside.dynamics, beside.start());
  ASSERT_EQ(fallen.status, EquilibriumStatus::kFound) << fallen.message;
  EXPECT_EQ(fallen.stability.stability, Stability::kStable);
  EXPECT_NEAR(position(beside, fallen.state, "pivot.angle"), -(M_PI - std::atan(1e-3)), 1e-12);
}

TEST(EquilibriumTest, WhatNothingResistsIsNeutralOrHasNoRest) {
  ModelSpec spec = make_door(2);  // gravity along its hinges
  const EngineProbe door(spec);
  const EquilibriumResult rest = solve_equilibrium(*door.dynamics, door.start());
  ASSERT_EQ(rest.status, EquilibriumStatus::kFound);
  EXPECT_EQ(rest.stability.stability, Stability::kNeutral);
  EXPECT_TRUE(rest.stability.confident);
  spec.forces = {constant_torque("door", 3)};
  const EngineProbe driven(spec);
  const EquilibriumResult none = solve_equilibrium(*driven.dynamics, driven.start());
  EXPECT_EQ(none.status, EquilibriumStatus::kNotFound);
  EXPECT_NE(none.message.find("hinge1.angle ("), std::string::npos) << none.message;
}

TEST(EquilibriumTest, ADoorIsHeldByATorsionSpringWhereTheTorquesBalance) {
  ModelSpec spec = make_door(3);
  spec.gravity = number3(0, -3, -9);  // the hinge line leans
  TorsionSpringSpec closer;
  closer.coordinate.joint = "hinge2";
  closer.stiffness = Number(40.0);
  closer.free_angle = Number(0.3);
  ForceSpec force;
  force.name = "closer";
  force.element = closer;
  spec.forces = {force};
  const EngineProbe probe(spec);
  const EquilibriumResult rest = solve_equilibrium(*probe.dynamics, probe.start());
  ASSERT_EQ(rest.status, EquilibriumStatus::kFound) << rest.message;
  double angle = 0;  // 40 (q − 0.3) = −20·3·0.45 cos q
  for (int i = 0; i < 60; ++i) {
    angle -= (40 * (angle - 0.3) + 27 * std::cos(angle)) / (40 - 27 * std::sin(angle));
  }
  EXPECT_NEAR(position(probe, rest.state, "hinge1.angle"), angle, 1e-13);
  EXPECT_NEAR(rest.stiffness.value(0, 0), 40 - 27 * std::sin(angle), 1e-9);
}

TEST(EquilibriumTest, ABodyInThePlaneHangsOnThreeSpringsAsSymmetrySays) {
  ModelSpec spec;
  spec.name = "hung";
  spec.gravity = number3(0, -kGravity, 0);
  spec.bodies = {box_body("plate", {0, 0, 0}, {0.4, 0.2, 0.1}, 4)};
  spec.joints = {joint(JointType::kPlanar, "plane", "ground", "plate", {0, 0, 0}, {0, 0, 1})};
  spec.forces = {spring("left", "plate", {-1, 1, 0}, {-0.2, 0.1, 0}, 300, 1.0),
                 spring("right", "plate", {1, 1, 0}, {0.2, 0.1, 0}, 300, 1.0)};
  const EngineProbe probe(spec);
  const EquilibriumResult rest = solve_equilibrium(*probe.dynamics, probe.start());
  ASSERT_EQ(rest.status, EquilibriumStatus::kFound) << rest.message;
  // Both springs span 0.8 m to the side and d down: 2·300·(l − 1)·d/l = m g.
  double d = 0.9;
  for (int i = 0; i < 100; ++i) {
    const double l = std::hypot(0.8, d), f = 600 * (l - 1) * d / l - 4 * kGravity;
    d -= f / (600 * (1 - 0.64 / (l * l * l)));
  }
  const Vector3d place = absolute_state(*probe.system, rest.state).poses[1].p;
  EXPECT_NEAR(place.y(), 0.9 - d, 1e-12);
  EXPECT_NEAR(place.x(), 0, 1e-12);
  EXPECT_EQ(rest.stability.stability, Stability::kStable);
  EXPECT_EQ(rest.stability.stable, 3);
}

TEST(EquilibriumTest, TheZooComesToRestAndTheWitnessSeesNothingAccelerate) {
  int found = 0;
  for (const ZooEntry& entry : zoo()) {
    const EngineProbe probe(entry.spec);
    if (!probe.dynamics->massless_bodies.empty()) continue;
    const EquilibriumResult rest = solve_equilibrium(*probe.dynamics, probe.start());
    if (rest.status != EquilibriumStatus::kFound) {
      EXPECT_FALSE(rest.message.empty());
      continue;
    }
    ++found;
    const double acceleration = witness_acceleration(probe, rest.state);
    EXPECT_LE(acceleration, 1e-10 * kGravity) << entry.name;
  }
  EXPECT_GE(found, 25);
}

TEST(EquilibriumTest, RandomMechanismsComeToRest) {
  int found = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const EngineProbe probe(make_random_mechanism(seed).spec);
    const EquilibriumResult rest = solve_equilibrium(*probe.dynamics, make_drawn_state(*probe.system));
    ++all;
    if (rest.status != EquilibriumStatus::kFound) {
      EXPECT_NE(rest.message.find("accelerating"), std::string::npos) << rest.message;
      continue;
    }
    ++found;
    const double acceleration = witness_acceleration(probe, rest.state) / kGravity;
    const bool singular = rest.stability.stability == Stability::kUnknown;
    EXPECT_LE(acceleration, singular ? 1e-5 : 1e-9) << seed;
    EXPECT_NE(rest.stability.stability, Stability::kUnstable) << seed;
  }
  EXPECT_GE(found, all / 2);
}

}  // namespace
}  // namespace ferrers
