#include "ferrers/dynamics/reactions.h"

#include <gtest/gtest.h>

#include <cmath>

#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {
namespace {

constexpr ReactionStatus kUnique = ReactionStatus::kUnique, kUndetermined = ReactionStatus::kUndetermined;

/// force_x … moment_z, all unique.
void expect_reaction(const JointReaction& r, const std::array<double, 6>& wanted, double tolerance) {
  for (int k = 0; k < 6; ++k) {
    EXPECT_EQ(r.status[k], kUnique) << kComponentNames[k];
    EXPECT_NEAR(r.value[k], wanted[k], tolerance) << kComponentNames[k];
  }
}

// Closed form: the pivot gives the bob m (a − g), where a = −ω² e_r − g cos φ e_φ for the angle φ from the horizontal.
TEST(ReactionsTest, ThePivotOfAPendulumCarriesItsWeightAndPull) {
  EngineProbe engine(make_pendulum());
  State state = make_drawn_state(*engine.system);
  const double phi = 0.6, w = 2, g = 9.81;
  state.q[0] = phi;
  state.v[0] = w;
  const ForwardResult result = engine.forward(state);
  EXPECT_NEAR(result.vdot[0], -g * std::cos(phi), 1e-14);
  const double along = -w * w, across = -g * std::cos(phi);
  const double a_x = along * std::cos(phi) - across * std::sin(phi);
  const double a_y = along * std::sin(phi) + across * std::cos(phi);
  expect_reaction(engine.reactions(state, result)[0], {a_x, a_y + g, 0, 0, 0, 0}, 1e-13);
  // The joint's frame stays with ground: same components here, since its z and the world's agree up to the x axis.
  const JointReaction own = engine.reactions(state, result, ReactionAxes::kJoint)[0];
  EXPECT_NEAR(std::hypot(own.value[0], own.value[1]), std::hypot(a_x, a_y + g), 1e-13);
}

// Closed form: the spherical hinge takes the weight m g, and both the couple force H = m g b / h.
TEST(ReactionsTest, ADeterminateDoorLoadsItsHingesByTheLever) {
  ModelSpec spec = make_door(2);
  spec.joints = {joint(JointType::kSpherical, "lower", "ground", "door", {0, 0, 0}),
                 joint(JointType::kPointOnLine, "upper", "ground", "door", {0, 0, 1.7})};
  EngineProbe engine(spec);
  const State state = make_drawn_state(*engine.system);
  const ForwardResult result = engine.forward(state);
  EXPECT_LT(result.vdot.norm(), 1e-12);
  const auto reactions = engine.reactions(state, result);
  constexpr double kCouple = 51.935294118, kWeight = 196.2;
  expect_reaction(reactions[0], {kCouple, 0, kWeight, 0, 0, 0}, 1e-9);
  expect_reaction(reactions[1], {-kCouple, 0, 0, 0, 0, 0}, 1e-9);
}

// Every hinge alone would do: nothing but the moment about the hinge line, which no hinge carries, is determined.
TEST(ReactionsTest, ADoorOnTwoFullHingesSharesItsLoadInNoKnownWay) {
  EngineProbe engine(make_door(2));
  const State state = make_drawn_state(*engine.system);
  for (const JointReaction& r : engine.reactions(state, engine.forward(state))) {
    for (int k = 0; k < 5; ++k) EXPECT_EQ(r.status[k], kUndetermined) << kComponentNames[k];
    EXPECT_EQ(r.status[5], kUnique);
    EXPECT_NEAR(r.value[5], 0, 1e-12);
  }
}

TEST(ReactionsTest, APlanarLoopLeavesItsOutOfPlaneLoadsUndetermined) {
  EngineProbe engine(make_four_bar(FourBarJoints::kRevolute));
  const State state = engine.wandered(3);
  const std::array<ReactionStatus, 6> wanted = {kUnique, kUnique, kUndetermined, kUndetermined, kUndetermined, kUnique};
  for (const JointReaction& r : engine.reactions(state, engine.forward(state))) EXPECT_EQ(r.status, wanted);
}

/// With spherical and cylindrical joints everything is determined, and the in-plane forces are the same.
TEST(ReactionsTest, DeterminateAndRedundantFourBarsShareTheirInPlaneForces) {
  EngineProbe redundant(make_four_bar(FourBarJoints::kRevolute));
  EngineProbe determinate(make_four_bar(FourBarJoints::kSphericalCylindrical));
  const State state = redundant.wandered(5);
  const State same = tree_state(*determinate.system, absolute_state(*redundant.system, state));
  const auto a = redundant.reactions(state, redundant.forward(state));
  const auto b = determinate.reactions(same, determinate.forward(same));
  for (std::size_t j = 0; j < a.size(); ++j) {
    for (int k = 0; k < 6; ++k) EXPECT_EQ(b[j].status[k], kUnique) << j << kComponentNames[k];
    for (const int k : {0, 1}) EXPECT_NEAR(a[j].value[k], b[j].value[k], 1e-10) << j << kComponentNames[k];
  }
}

// Effort, spring and damping in a joint are not part of its reaction: along the freedom it stays zero.
TEST(ReactionsTest, DriveAndSpringEffortsAreNotReactions) {
  ModelSpec spec = make_pendulum();
  spec.drives = {coordinate_drive("motor", "pivot", "", "9.81 + 5")};
  TorsionSpringSpec spring;
  spring.coordinate = {NameRef("pivot"), ""};
  spring.stiffness = Number(5);
  spring.free_angle = Number(1);  // gives +5 at angle 0
  ForceSpec force;
  force.name = "spring";
  force.element = spring;
  spec.forces = {force};
  EngineProbe engine(spec);
  const State state = make_drawn_state(*engine.system);
  const ForwardResult result = engine.forward(state);
  EXPECT_NEAR(result.vdot[0], 10, 1e-13);
  expect_reaction(engine.reactions(state, result)[0], {0, 9.81 + 10, 0, 0, 0, 0}, 1e-13);
}

TEST(ReactionsTest, WrongSizesAreACallersBug) {
  EngineProbe engine(make_pendulum());
  const State state = make_drawn_state(*engine.system);
  ForwardResult result = engine.forward(state);
  result.vdot.resize(2);
  EXPECT_THROW(engine.reactions(state, result), std::invalid_argument);
}

TEST(ReactionsTest, StatusesHaveNames) {
  EXPECT_EQ(to_string(ReactionStatus::kUnique), "unique");
  EXPECT_EQ(to_string(ReactionStatus::kDistributed), "distributed");
  EXPECT_EQ(to_string(ReactionStatus::kUndetermined), "undetermined");
}

}  // namespace
}  // namespace ferrers::witness
