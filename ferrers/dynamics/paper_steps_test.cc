#include "ferrers/dynamics/paper_steps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ferrers/dynamics/forward.h"
#include "ferrers/dynamics/inverse.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/random_mechanism.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers {
namespace {

using namespace witness;  // NOLINT(google-build-using-namespace)

/// Rows as decided, but the coordinates that the drives move as the independent ones.
Selection with_driven_coordinates(const DynamicsModel& model, const Selection& decided) {
  Selection s = decided;
  s.independent.clear();
  s.dependent.clear();
  for (int k = 0; k < model.system->nv; ++k) {
    const bool driven =
        std::any_of(model.drives.begin(), model.drives.end(), [k](const auto& drive) { return drive.access.v == k; });
    (driven ? s.independent : s.dependent).push_back(k);
  }
  return s;
}

// Parallel cranks: all turn alike, and the platform's hinge turns back by as much.
TEST(PaperStepsTest, DependentCoordinatesOfParallelCranksAreThoseOfTheClosedForm) {
  ModelSpec spec = make_parallel_cranks();
  spec.drives = {coordinate_drive("motor", "foot1", "0.3*t")};
  EngineProbe probe(spec);
  State state = probe.start();
  probe.evaluate(state);
  const Selection s = with_driven_coordinates(*probe.dynamics, probe.selection);
  ASSERT_EQ(s.independent.size(), 1u);
  const int crank = s.independent[0];
  state.q[crank] = 0.3;
  state.v[crank] = 0.7;
  const PositionSolution solution = solve_dependent_positions(*probe.dynamics, s, state);
  EXPECT_TRUE(solution.closed);
  for (int k = 0; k < probe.system->nv; ++k) EXPECT_NEAR(std::abs(state.q[k]), 0.3, 1e-14);
  solve_dependent_velocities(*probe.dynamics, s, state);
  for (int k = 0; k < probe.system->nv; ++k) EXPECT_NEAR(state.v[k], state.q[k] > 0 ? 0.7 : -0.7, 1e-13);
  compute_equations(*probe.dynamics, state, probe.eq);
  const VectorXd vdot = solve_dependent_accelerations(probe.eq, s, VectorXd::Constant(1, 2.0));
  for (int k = 0; k < probe.system->nv; ++k) EXPECT_NEAR(vdot[k], state.q[k] > 0 ? 2.0 : -2.0, 1e-12);
}

TEST(PaperStepsTest, NewtonsMethodDoublesTheDigits) {
  EngineProbe probe(make_driven_four_bar());
  State state = probe.start();
  probe.evaluate(state);
  const Selection s = with_driven_coordinates(*probe.dynamics, probe.selection);
  state.q[s.independent[0]] = 0.3;
  const PositionSolution solution = solve_dependent_positions(*probe.dynamics, s, state);
  ASSERT_TRUE(solution.closed);
  ASSERT_GE(solution.residuals.size(), 4u);
  for (std::size_t i = 0; i + 1 < solution.residuals.size(); ++i) {
    EXPECT_LE(solution.residuals[i + 1], 3 * solution.residuals[i] * solution.residuals[i] + 1e-14) << i;
  }
}

TEST(PaperStepsTest, APositionOutOfReachIsNotClosed) {
  EngineProbe probe(make_driven_four_bar());
  State state = probe.start();
  probe.evaluate(state);
  const Selection s = with_driven_coordinates(*probe.dynamics, probe.selection);
  state.q[s.independent[0]] = 3.0;  // A to B is then 5 m, coupler and rocker reach over 5.6 m: still closed
  EXPECT_TRUE(solve_dependent_positions(*probe.dynamics, s, state).closed);
  ModelSpec longer = make_four_bar(FourBarJoints::kRevolute);
  EngineProbe rocker(longer);
  State far = rocker.start();
  rocker.evaluate(far);
  far.q[rocker.selection.independent[0]] += 3.0;
  EXPECT_FALSE(solve_dependent_positions(*rocker.dynamics, rocker.selection, far).closed);
}

// The direct problem instant by instant, as `ferrers inverse` solves it.
TEST(PaperStepsTest, TheFiveStepsOfTheDirectProblemAgreeWithTheEngine) {
  EngineProbe probe(make_driven_four_bar());
  const DynamicsModel& model = *probe.dynamics;
  State state = probe.start();
  probe.evaluate(state);
  const Selection s = with_driven_coordinates(model, probe.selection);
  PrescribedMotion engine(probe.dynamics, state);
  for (int l = 0; l <= 8; ++l) {
    state.t = 0.1 * l;
    const Law::Motion law = model.drives[0].motion->motion(state.t);
    state.q[s.independent[0]] = law.value;
    state.v[s.independent[0]] = law.rate;
    ASSERT_TRUE(solve_dependent_positions(model, s, state).closed);
    solve_dependent_velocities(model, s, state);
    compute_equations(model, state, probe.eq);
    const VectorXd vdot = solve_dependent_accelerations(probe.eq, s, VectorXd::Constant(1, law.acceleration));
    const MotionForces forces = solve_multipliers_and_efforts(probe.eq, s, vdot);
    const PrescribedResult expected = engine.solve(state.t);
    ASSERT_EQ(expected.status, PrescribedStatus::kSolved);
    EXPECT_LT((state.q - expected.state.q).cwiseAbs().maxCoeff(), 1e-12) << state.t;
    EXPECT_LT((state.v - expected.state.v).cwiseAbs().maxCoeff(), 1e-11) << state.t;
    EXPECT_LT((vdot - expected.vdot).cwiseAbs().maxCoeff(), 1e-10) << state.t;
    EXPECT_NEAR(forces.u[0], expected.u[0], 1e-9) << state.t;
    const VectorXd balance = probe.eq.M * vdot + probe.eq.h - probe.eq.tau -
                             probe.eq.B_transposed.transpose() * forces.u -
                             probe.eq.constraints.G.transpose() * forces.lambda;
    EXPECT_LT(balance.cwiseAbs().maxCoeff(), 1e-11) << state.t;
  }
}

TEST(PaperStepsTest, HeldAccelerationsMoveTheIndependentCoordinatesOnly) {
  EngineProbe probe(make_driven_four_bar());
  State state = probe.start();
  probe.evaluate(state);
  const Selection s = with_driven_coordinates(*probe.dynamics, probe.selection);
  state.v[s.independent[0]] = 0.4;
  const VectorXd vdot = VectorXd::Constant(3, 1.5);
  const State next = hold_accelerations(*probe.system, s, state, vdot, 0.2);
  EXPECT_DOUBLE_EQ(next.t, 0.2);
  EXPECT_DOUBLE_EQ(next.q[s.independent[0]], 0.4 * 0.2 + 0.5 * 1.5 * 0.04);
  EXPECT_DOUBLE_EQ(next.v[s.independent[0]], 0.4 + 1.5 * 0.2);
  for (const int k : s.dependent) {
    EXPECT_EQ(next.q[k], state.q[k]);
    EXPECT_EQ(next.v[k], state.v[k]);
  }
}

// Whatever the joints: dependent velocities and accelerations from the independent ones are those of the forward
// problem, from which these were taken.
TEST(PaperStepsTest, StepsAgreeWithTheForwardProblemOfRandomMechanisms) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    EngineProbe probe(make_random_mechanism(seed).spec);
    State state = probe.wandered(seed);
    const ForwardResult result = probe.forward(state);
    if (result.status != ForwardStatus::kSolved) continue;
    const Selection& s = probe.selection;
    const VectorXd v = state.v;
    state.v(s.dependent).setZero();
    solve_dependent_velocities(*probe.dynamics, s, state);
    EXPECT_LT((state.v - v).norm(), 1e-9 * (1 + v.norm()));
    const VectorXd vdot = solve_dependent_accelerations(probe.eq, s, result.vdot(s.independent));
    EXPECT_LT((vdot - result.vdot).norm(), 1e-8 * (1 + result.vdot.norm()));
    const VectorXd q = state.q;
    EXPECT_TRUE(solve_dependent_positions(*probe.dynamics, s, state).closed);
    EXPECT_LT((state.q - q).norm(), 1e-9);
  }
}

TEST(PaperStepsTest, ASelectionOfAnotherMechanismIsTheCallersBug) {
  EngineProbe probe(make_driven_four_bar());
  State state = probe.start();
  probe.evaluate(state);
  Selection wrong = probe.selection;
  wrong.dependent.pop_back();
  EXPECT_THROW(solve_dependent_velocities(*probe.dynamics, wrong, state), std::invalid_argument);
  EXPECT_THROW(solve_dependent_positions(*probe.dynamics, Selection(), state), std::invalid_argument);
  EXPECT_THROW(solve_dependent_accelerations(probe.eq, probe.selection, VectorXd(4)), std::invalid_argument);
  const EngineProbe undriven(make_four_bar(FourBarJoints::kRevolute));
  Equations eq = make_equations(*undriven.dynamics);
  EXPECT_THROW(solve_multipliers_and_efforts(eq, probe.selection, VectorXd::Zero(3)), std::invalid_argument);
}

}  // namespace
}  // namespace ferrers
