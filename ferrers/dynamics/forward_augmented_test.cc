#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <numbers>

#include "ferrers/dynamics/forward.h"
#include "ferrers/testing/compare.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/random_source.h"
#include "ferrers/testing/zoo.h"

/// What only the augmented Lagrangian form promises; what it shares is in forward_test.cc.
namespace ferrers::witness {
namespace {

std::unique_ptr<ForwardSolver> solver_without_selection(const EngineProbe& engine) {
  return make_forward_solver(Formulation::kAugmentedLagrangian, *engine.system, Selection{});
}

TEST(AugmentedLagrangianTest, NeedsNoSelection) {
  for (const ZooEntry& entry : zoo()) {
    SCOPED_TRACE(entry.name);
    EngineProbe engine(entry.spec);
    if (!engine.dynamics->massless_bodies.empty()) continue;
    const State state = engine.wandered(11, 0.2);
    ForwardResult got = make_forward_result(engine.eq);
    solver_without_selection(engine)->solve(engine.eq, got);
    ASSERT_EQ(got.status, ForwardStatus::kSolved);
    EXPECT_TRUE(matrices_near(got.vdot, engine.forward(state).vdot, 1e-9));
  }
}

// Multipliers in scaled units lie in the range of the scaled G: nothing that G cannot feel.
TEST(AugmentedLagrangianTest, MultipliersAreTheLeastInScaledUnits) {
  for (const ModelSpec& spec : {make_bricard(BricardRods::kBricks), make_parallel_cranks(), make_n_four_bar(4, 0.3)}) {
    EngineProbe engine(spec);
    engine.wandered(11, 0.2);
    ForwardResult got = make_forward_result(engine.eq);
    solver_without_selection(engine)->solve(engine.eq, got);
    const MatrixXd G = engine.scaling.rows.asDiagonal() * engine.eq.constraints.G;
    const VectorXd scaled = got.lambda.cwiseQuotient(engine.scaling.rows);
    const VectorXd load = engine.eq.M * got.vdot - engine.eq.force;
    const VectorXd least = G.transpose().completeOrthogonalDecomposition().solve(load);
    EXPECT_TRUE(matrices_near(scaled, least, 1e-9)) << spec.name;
  }
}

// Rows that contradict each other a little, as drift makes them: the motion takes the middle, nothing grows.
TEST(AugmentedLagrangianTest, ContradictoryRightSidesLeaveMultipliersInRange) {
  EngineProbe engine(make_parallel_cranks());
  engine.wandered(11, 0.2);
  const auto solver = solver_without_selection(engine);
  ForwardResult clean = make_forward_result(engine.eq), off = clean;
  solver->solve(engine.eq, clean);
  VectorXd gamma = engine.eq.constraints.gamma;
  for (long i = 0; i < gamma.size(); ++i) gamma[i] += 1e-8 * std::cos(3.0 * static_cast<double>(i));
  solver->resolve(engine.eq.force, gamma, off);
  EXPECT_EQ(off.status, ForwardStatus::kSolved);
  EXPECT_TRUE(matrices_near(off.vdot, clean.vdot, 1e-6));
  EXPECT_TRUE(matrices_near(off.lambda, clean.lambda, 1e-5));
}

TEST(AugmentedLagrangianTest, WhereSomeDirectionHardlyConvergesThatIsSaid) {
  EngineProbe engine(make_n_four_bar(2, std::numbers::pi / 2 - 1e-6));
  State state = make_drawn_state(*engine.system);
  state.v.setOnes();  // some right side that the constraints must answer
  engine.evaluate(state);
  ForwardResult got = make_forward_result(engine.eq);
  solver_without_selection(engine)->solve(engine.eq, got);
  EXPECT_EQ(got.status, ForwardStatus::kNotConverged);
}

}  // namespace
}  // namespace ferrers::witness
