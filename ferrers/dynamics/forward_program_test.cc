// A whole evaluation as one piece of native code against the evaluation of its parts.

#include "ferrers/dynamics/forward_program.h"

#include <gtest/gtest.h>

#include "ferrers/redundancy/selection.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/needs_machine_code.h"
#include "ferrers/testing/random_mechanism.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_large.h"

namespace ferrers::witness {
namespace {

// In the order that suits the last equations.
SparseKkt chosen_order(const EngineProbe& engine) {
  KktStructure structure = make_kkt_structure(*engine.system, engine.selection.rows);
  take_values(engine.selection.rows, engine.eq.constraints.G, structure);
  return {structure, engine.selection.rows, engine.scaling.columns};
}

bool agrees_with_parts(EngineProbe& engine, const State& state, const std::string& what) {
  const ForwardResult parts = engine.forward(state, Formulation::kSparse);
  if (parts.status != ForwardStatus::kSolved) return false;
  const SparseKkt kkt = chosen_order(engine);
  const ForwardProgram program(*engine.dynamics, kkt, ForwardProgram::Extent::kClosure);
  EXPECT_TRUE(program.is_native());
  Kernel::Board board = program.make_board();
  ForwardResult native = make_forward_result(engine.eq);
  Equations eq = make_equations(*engine.dynamics);
  VectorXd applied;
  compute_untraced_forces(*engine.dynamics, state, eq, applied);
  ForwardProgram::Watched watched;
  const long m = engine.system->m, n = engine.system->nv;
  ForwardProgram::Closure closure{VectorXd::Zero(m), VectorXd::Zero(m), VectorXd::Zero(n), VectorXd::Zero(n)};
  for (int i = 0; i < 2; ++i) {  // nothing is left of the first
    EXPECT_EQ(program.evaluate(state, applied, board, native, watched, &closure), ForwardStatus::kSolved) << what;
  }
  const double pivot = watched.smallest_pivot;
  const ConstraintKinematics& rows = engine.eq.constraints;
  EXPECT_LE((closure.phi - rows.phi).norm(), 1e-12 * (1 + rows.phi.norm())) << what;
  EXPECT_LE((closure.rate - rows.rate).norm(), 1e-12 * (1 + rows.rate.norm())) << what;
  for (const int row : engine.selection.rows) {
    EXPECT_NEAR(rows.G.row(row).dot(closure.dq), -rows.phi[row], 1e-10 * (1 + rows.phi.norm()) / std::min(1.0, pivot));
    EXPECT_NEAR(rows.G.row(row).dot(closure.dv), -rows.rate[row],
                1e-10 * (1 + rows.rate.norm()) / std::min(1.0, pivot));
  }
  const double all = state.v.dot(engine.eq.force + engine.eq.h);
  EXPECT_NEAR(watched.power + applied.dot(state.v), all, 1e-10 * (1 + std::abs(all))) << what;
  const double size = 1 + parts.vdot.cwiseAbs().maxCoeff();
  EXPECT_LE((native.vdot - parts.vdot).cwiseAbs().maxCoeff(), 1e-10 * size / std::min(1.0, pivot)) << what;
  if (parts.lambda.size() > 0) {
    const double load = 1 + parts.lambda.cwiseAbs().maxCoeff();
    EXPECT_LE((native.lambda - parts.lambda).cwiseAbs().maxCoeff(), 1e-10 * load / std::min(1.0, pivot)) << what;
  }
  return true;
}

TEST(ForwardProgramTest, IsTheSolutionOfTheParts) {
  NEEDS_MACHINE_CODE();
  const std::vector<std::pair<std::string, ModelSpec>> zoo = {{"four-bar", make_four_bar(FourBarJoints::kRevolute)},
                                                              {"cranks", make_parallel_cranks()},
                                                              {"four-bars", make_n_four_bar(7, 0.3)},
                                                              {"excavator", make_excavator()},
                                                              {"scissors", make_scissor_lift(3)},
                                                              {"Andrews", make_andrews()},
                                                              {"Bricard", make_bricard(BricardRods::kBricks)},
                                                              {"Sarrus", make_sarrus(0.7)},
                                                              {"Bennett", make_bennett()},
                                                              {"flyball", make_flyball()}};
  for (const auto& [name, spec] : zoo) {
    EngineProbe engine(spec);
    EXPECT_TRUE(agrees_with_parts(engine, engine.wandered(1, 0.1), name)) << name;
  }
}

TEST(ForwardProgramTest, OfRandomMechanismsToo) {
  NEEDS_MACHINE_CODE();
  int checked = 0;
  for (int seed = 0; seed < 120; ++seed) {
    EngineProbe engine(make_random_mechanism(seed).spec);
    if (!ForwardProgram::knows(*engine.dynamics)) continue;
    checked += agrees_with_parts(engine, engine.wandered(seed), "seed " + std::to_string(seed)) ? 1 : 0;
  }
  EXPECT_GT(checked, 60);
}

TEST(ForwardProgramTest, AFourBarInThePlaneIsLittleCode) {
  NEEDS_MACHINE_CODE();
  // Nothing of a four-bar in the plane z = 0 reaches the rows across it: they are constants, and so no code.
  EngineProbe engine(make_four_bar(FourBarJoints::kRevolute));
  engine.forward(engine.start(), Formulation::kSparse);
  const SparseKkt kkt = chosen_order(engine);
  const ForwardProgram program(*engine.dynamics, kkt, ForwardProgram::Extent::kAccelerations);
  EXPECT_LT(program.code_bytes(), 4000U);
}

TEST(ForwardProgramTest, MostOfAChainIsDoneFourLoopsAtATime) {
  NEEDS_MACHINE_CODE();
  const auto program = [](int count) {
    EngineProbe engine(make_n_four_bar(count, 0.3));
    engine.forward(engine.start(), Formulation::kSparse);
    const SparseKkt kkt = chosen_order(engine);
    return ForwardProgram(*engine.dynamics, kkt, ForwardProgram::Extent::kAccelerations);
  };
  EXPECT_GT(program(40).shared_part(), 0.8);
}

TEST(ForwardProgramTest, IsNotMadeOfTanglesThatItWouldSlowDown) {
  EngineProbe chain(make_n_four_bar(100, 0.3)), tangle(make_ball_tangle(40, 20));
  for (EngineProbe* engine : {&chain, &tangle}) {
    const ConstraintBlocks blocks = compute_constraint_blocks(*engine->system, engine->start());
    engine->selection =
        select_rows_and_coordinates(*engine->system, decide_clusters(*engine->system, engine->scaling, blocks));
    compute_equations(*engine->dynamics, engine->start(), engine->eq);
  }
  EXPECT_TRUE(ForwardProgram::pays(chosen_order(chain)));
  EXPECT_FALSE(ForwardProgram::pays(chosen_order(tangle)));
}

TEST(ForwardProgramTest, IsFoundAgainByTheModelButNotByItsCopy) {
  NEEDS_MACHINE_CODE();
  EngineProbe engine(make_bricard(BricardRods::kBricks));
  engine.forward(engine.start(), Formulation::kSparse);
  const SparseKkt kkt = chosen_order(engine);
  const auto found = [&](const DynamicsModel& model) {
    return model.programs->find_or_make(model, kkt, ForwardProgram::Extent::kClosure);
  };
  const auto first = found(*engine.dynamics);
  EXPECT_EQ(found(*engine.dynamics), first);
  const DynamicsModel copy = *engine.dynamics;
  EXPECT_NE(found(copy), first);
}

}  // namespace
}  // namespace ferrers::witness
