#include "ferrers/dynamics/friction.h"

#include <gtest/gtest.h>

#include <cmath>

#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/random_mechanism.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {
namespace {

void rub(JointSpec& joint, double mu, double radius = 0) {
  FrictionSpec friction;
  friction.coulomb = Number(mu);
  if (radius > 0) friction.radius = Number(radius);
  joint.friction = friction;
}

/// One evaluation with friction.
struct Rubbing {
  EngineProbe engine;
  FrictionSolver friction;
  std::unique_ptr<ForwardSolver> solver;
  ForwardResult result;
  DistributionOptions distribution;

  explicit Rubbing(const ModelSpec& spec, const DistributionOptions& options = {})
      : engine(spec), friction(engine.dynamics, options), distribution(options) {}

  FrictionStatus evaluate(const State& state) {
    engine.evaluate(state);
    solver = make_forward_solver(Formulation::kNullSpace, *engine.system, engine.selection);
    result = make_forward_result(*engine.system);
    solver->solve(engine.eq, result);
    EXPECT_EQ(result.status, ForwardStatus::kSolved);
    return friction.solve(state, engine.eq, engine.selection, *solver, result);
  }
  /// How far M vdot = force + Gᵀ lambda is from holding, and friction from its law; both relative.
  double law_error(const State& state) const {
    const auto reactions =
        ReactionSolver(engine.dynamics, distribution)
            .solve(state, engine.eq, engine.selection, result.vdot, result.lambda, engine.eq.u, ReactionAxes::kJoint);
    double error = 0;
    for (const BoundFriction& f : engine.dynamics->frictions) {
      double forces = 0, moments = 0, square = 0;
      for (const int k : f.forces) forces += std::pow(reactions[f.joint.index()].value[k], 2);
      for (const int k : f.moments) moments += std::pow(reactions[f.joint.index()].value[k], 2);
      const double pressing = std::sqrt(forces) + (f.moments.empty() ? 0 : std::sqrt(moments) / f.radius_m);
      const VectorXd slip = FrictionSolver(engine.dynamics).slip_rows(engine.eq).middleRows(f.first, f.slips) * state.v;
      for (int i = 0; i < f.slips; ++i) {
        square = std::max(
            square, std::abs(engine.eq.friction[f.first + i] +
                             f.coulomb * pressing * std::tanh(slip.norm() / f.slip_scale) * slip[i] / slip.norm()));
      }
      error = std::max(error, square / (f.coulomb * pressing));
    }
    return error;
  }
};

TEST(FrictionTest, ABlockSlidesDownAnInclineAsTheClosedFormSays) {
  const double angle = 0.6, mu = 0.3, g = 9.81;
  ModelSpec spec;
  spec.name = "incline";
  spec.bodies = {box_body("block", {0, 0, 0}, {0.1, 0.1, 0.1}, 2.5)};
  spec.joints = {
      joint(JointType::kPrismatic, "slope", "ground", "block", {0, 0, 0}, {std::cos(angle), 0, -std::sin(angle)})};
  rub(spec.joints[0], mu);
  Rubbing block(spec);
  State state = make_drawn_state(*block.engine.system);
  state.v[0] = 0.5;
  ASSERT_EQ(block.evaluate(state), FrictionStatus::kSolved);
  EXPECT_NEAR(block.result.vdot[0], g * (std::sin(angle) - mu * std::cos(angle)), 1e-13);
  EXPECT_NEAR(block.friction.power(), -0.5 * mu * 2.5 * g * std::cos(angle), 1e-12);
  state.v[0] = -0.5;
  ASSERT_EQ(block.evaluate(state), FrictionStatus::kSolved);
  EXPECT_NEAR(block.result.vdot[0], g * (std::sin(angle) + mu * std::cos(angle)), 1e-13);
  state.v[0] = 0;
  ASSERT_EQ(block.evaluate(state), FrictionStatus::kSolved);
  EXPECT_NEAR(block.result.vdot[0], g * std::sin(angle), 1e-13);
}

// A block too steep for its friction slides, a flat one creeps at s_0 atanh(tan(angle)/mu).
TEST(FrictionTest, WhatSticksCreepsAtTheRegularisationSpeed) {
  const double angle = 0.2, mu = 0.3;
  ModelSpec spec;
  spec.name = "incline";
  spec.bodies = {box_body("block", {0, 0, 0}, {0.1, 0.1, 0.1}, 2.5)};
  spec.joints = {
      joint(JointType::kPrismatic, "slope", "ground", "block", {0, 0, 0}, {std::cos(angle), 0, -std::sin(angle)})};
  rub(spec.joints[0], mu);
  Rubbing block(spec);
  State state = make_drawn_state(*block.engine.system);
  state.v[0] = kSlipSpeed * std::atanh(std::tan(angle) / mu);
  ASSERT_EQ(block.evaluate(state), FrictionStatus::kSolved);
  EXPECT_NEAR(block.result.vdot[0], 0, 1e-12);
}

// m l² q'' = −m g l sin q − mu r |F| sign q', with F the reaction of the hinge: two equations for q'' and |F|.
TEST(FrictionTest, APendulumOnABearingDeceleratesAsItsOwnEquationSays) {
  const double mu = 0.4, r = 0.05, g = 9.81;
  ModelSpec spec = make_pendulum();
  spec.bodies[0].mass = Number(2.0);
  rub(spec.joints[0], mu, r);
  Rubbing pendulum(spec);
  State state = make_drawn_state(*pendulum.engine.system);
  for (const double q : {0.3, 1.2, -2.0}) {
    for (const double v : {1.7, -0.6, 4.0}) {
      state.q[0] = q;
      state.v[0] = v;
      ASSERT_EQ(pendulum.evaluate(state), FrictionStatus::kSolved);
      // Drawn along +x with gravity in −y: the angle q is above the horizontal.
      const double along = v * v - g * std::sin(q);  // F/m towards the hinge
      double a = -g * std::cos(q);
      for (int i = 0; i < 200; ++i) {
        const double across = a + g * std::cos(q);
        a = -g * std::cos(q) - mu * r * std::hypot(along, across) * std::tanh(v / kSlipRate);
      }
      EXPECT_NEAR(pendulum.result.vdot[0], a, 1e-12 * std::abs(a));
      EXPECT_LT(pendulum.law_error(state), 1e-12);
      EXPECT_LE(pendulum.friction.power(), 0);
    }
  }
}

TEST(FrictionTest, FrictionKeepsItsLawInEveryJointTypeThatHasIt) {
  for (const JointType type : {JointType::kRevolute, JointType::kPrismatic, JointType::kCylindrical,
                               JointType::kSpherical, JointType::kPlanar}) {
    ModelSpec spec;
    spec.name = "chain";
    spec.bodies = {box_body("a", {0.4, 0, 0}, {0.8, 0.1, 0.2}, 2), box_body("b", {1.1, 0.2, 0}, {0.5, 0.2, 0.1}, 1)};
    spec.joints = {joint(JointType::kRevolute, "base", "ground", "a", {0, 0, 0}, {0, 1, 0.3}),
                   joint(type, "second", "a", "b", {0.8, 0, 0}, {0.2, 1, 0.4})};
    rub(spec.joints[0], 0.2, 0.03);
    rub(spec.joints[1], 0.3, 0.1);
    Rubbing chain(spec);
    const State state = chain.engine.wandered(7, 0.4, 2);
    ASSERT_EQ(chain.evaluate(state), FrictionStatus::kSolved) << chain.friction.message();
    EXPECT_LT(chain.law_error(state), 1e-12) << joint_type_info(type).name;
    EXPECT_LT(chain.friction.power(), 0);
  }
}

// Which joint is cut is the engine's choice and must not show.
TEST(FrictionTest, FrictionInACutJointIsThatOfATreeJoint) {
  ModelSpec spec = make_slider_crank(SliderCrankJoints::kSphericalCylindrical);
  for (JointSpec& one : spec.joints) rub(one, 0.2, 0.02);
  Rubbing crank(spec);
  const State state = crank.engine.wandered(3, 0.3, 4);
  ASSERT_EQ(crank.evaluate(state), FrictionStatus::kSolved) << crank.friction.message();
  EXPECT_LT(crank.law_error(state), 1e-11);
  EXPECT_LT(crank.friction.power(), 0);
  // The same with the joints in another order, which cuts another one.
  ModelSpec other = spec;
  std::reverse(other.joints.begin(), other.joints.end());
  Rubbing turned(other);
  const State same = tree_state(*turned.engine.system, absolute_state(*crank.engine.system, state));
  ASSERT_EQ(turned.evaluate(same), FrictionStatus::kSolved);
  EXPECT_NEAR(turned.friction.power(), crank.friction.power(), 1e-9 * std::abs(crank.friction.power()));
}

TEST(FrictionTest, FrictionOnAnUndeterminedReactionIsRefusedByName) {
  ModelSpec spec = make_four_bar(FourBarJoints::kRevolute);
  rub(spec.joints[1], 0.2, 0.02);
  Rubbing bar(spec);
  const State state = bar.engine.wandered(3);
  EXPECT_EQ(bar.evaluate(state), FrictionStatus::kUndetermined);
  EXPECT_NE(bar.friction.message().find("'" + spec.joints[1].name.name + "'"), std::string::npos)
      << bar.friction.message();
}

TEST(FrictionTest, StiffnessMakesFrictionOfAnOverconstrainedMechanismDefinite) {
  ModelSpec spec = make_four_bar(FourBarJoints::kRevolute);
  for (JointSpec& one : spec.joints) {
    rub(one, 0.2, 0.02);
    StiffnessSpec stiffness;
    stiffness.force = number3(1e7, 1e7, 1e7);
    stiffness.moment = number3(1e5, 1e5, 1e5);
    one.stiffness = stiffness;
  }
  Rubbing bar(spec);
  const State state = bar.engine.wandered(3, 0.3, 2);
  ASSERT_EQ(bar.evaluate(state), FrictionStatus::kSolved) << bar.friction.message();
  EXPECT_LT(bar.law_error(state), 1e-9);
  EXPECT_LT(bar.friction.power(), 0);
  // The stiffness of all joints times a factor divides alike.
  for (JointSpec& one : spec.joints) {
    one.stiffness->force = number3(3e6, 3e6, 3e6);
    one.stiffness->moment = number3(3e4, 3e4, 3e4);
  }
  Rubbing softer(spec);
  ASSERT_EQ(softer.evaluate(state), FrictionStatus::kSolved);
  EXPECT_LT((softer.result.vdot - bar.result.vdot).norm(), 1e-9 * bar.result.vdot.norm());
}

// A rod pushed along a rough floor, leaning forward: its friction presses it down harder the more it brakes, and above
// mu = (1 + 3 cos²)/(3 sin cos) no motion is possible (Painlevé's rod, with a slide as the contact).
TEST(FrictionTest, ARodThatJamsIsSaidToJam) {
  const double lean = 1.0;  // from the floor
  ModelSpec spec;
  spec.name = "painleve";
  const Point top(std::cos(lean), std::sin(lean), 0);
  spec.gravity = number3(0, -9.81, 0);
  spec.bodies = {rod_body("rod", {0, 0, 0}, top, 1), box_body("shoe", {0, 0, 0}, {1e-3, 1e-3, 1e-3}, 1e-6)};
  spec.joints = {joint(JointType::kPrismatic, "floor", "ground", "shoe", {0, 0, 0}, {1, 0, 0}),
                 joint(JointType::kRevolute, "pin", "shoe", "rod", {0, 0, 0}, {0, 0, 1})};
  const double c = std::cos(lean), s = std::sin(lean);
  const double critical = (1 + 3 * c * c) / (3 * s * c);
  for (const double share : {0.9, 1.5}) {
    rub(spec.joints[0], share * critical);
    Rubbing rod(spec);
    State state = make_drawn_state(*rod.engine.system);
    state.v[rod.engine.system->access({JointId(0), 0}).v] = -1;
    const FrictionStatus status = rod.evaluate(state);
    EXPECT_EQ(status, share < 1 ? FrictionStatus::kSolved : FrictionStatus::kJammed) << rod.friction.message();
  }
}

/// A random mechanism with friction in every joint that can have it.
ModelSpec rubbing_mechanism(std::uint64_t seed) {
  ModelSpec spec = make_random_mechanism(seed).spec;
  for (JointSpec& one : spec.joints) {
    Joint probe;
    probe.type = one.type;
    probe.constants.lead_m = one.type == JointType::kScrew ? 1 : 0;
    BoundFriction friction;
    friction.radius_m = 0.3;
    if (find_slips(probe, friction).empty()) rub(one, 0.05, 0.3);
  }
  return spec;
}

// Without stiffness only where the reactions are unique; with it nearly everywhere.
TEST(FrictionTest, RandomMechanismsDissipateAndKeepTheLaw) {
  int unique = 0, divided = 0;
  DistributionOptions equal;
  equal.by = DistributionBy::kEqualStiffness;
  for (std::uint64_t seed = 1; seed <= 25; ++seed) {
    for (const bool stiff : {false, true}) {
      Rubbing rubbing(rubbing_mechanism(seed), stiff ? equal : DistributionOptions());
      ASSERT_TRUE(rubbing.engine.dynamics->unsupported.empty()) << rubbing.engine.dynamics->unsupported.front();
      const State state = tree_state(*rubbing.engine.system, wandered(*rubbing.engine.system->model, seed));
      const FrictionStatus status = rubbing.evaluate(state);
      const bool redundant = static_cast<int>(rubbing.engine.selection.rows.size()) < rubbing.engine.system->m;
      EXPECT_TRUE(redundant || status != FrictionStatus::kUndetermined) << seed;
      EXPECT_FALSE(stiff && status == FrictionStatus::kUndetermined) << seed << rubbing.friction.message();
      if (status != FrictionStatus::kSolved) continue;
      ++(stiff ? divided : unique);
      EXPECT_LE(rubbing.friction.power(), 0) << seed;
      EXPECT_LT(rubbing.law_error(state), 1e-9) << seed << " " << stiff;
    }
  }
  EXPECT_GE(unique, 3);
  EXPECT_GE(divided, 22);
}

}  // namespace
}  // namespace ferrers::witness
