// Many states at once against one after another, and one after another against the evaluation part by part.

#include "ferrers/dynamics/forward_batch.h"

#include <gtest/gtest.h>

#include "ferrers/testing/allocation_guard.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/zoo.h"

namespace ferrers::witness {
namespace {

struct Sampled {
  EngineProbe engine;
  std::vector<State> states;
  ForwardBatch::States columns;

  Sampled(const ModelSpec& spec, int count) : engine(spec) {
    const System& system = *engine.system;
    columns.q.resize(count, system.nq);
    columns.v.resize(count, system.nv);
    for (int i = 0; i < count; ++i) {
      states.push_back(engine.wandered(1 + i % 5, 0.02 + 0.0005 * i));
      columns.q.row(i) = states.back().q;
      columns.v.row(i) = states.back().v;
    }
  }
};

std::vector<std::pair<std::string, ModelSpec>> zoo() {
  return {{"four-bar", make_four_bar(FourBarJoints::kRevolute)},
          {"Andrews", make_andrews()},
          {"excavator", make_excavator()},  // with forces
          {"Bricard", make_bricard(BricardRods::kBricks)},
          {"four-bars", make_n_four_bar(12, 0.3)},
          {"flyball", make_flyball()}};
}

TEST(ForwardDynamicsTest, IsTheSolutionOfTheParts) {
  for (const auto& [name, spec] : zoo()) {
    Sampled sampled(spec, 6);
    EngineProbe& engine = sampled.engine;
    ForwardDynamics dynamics(engine.dynamics, sampled.states.front());
    EXPECT_EQ(dynamics.is_native(), has_machine_code()) << name;
    for (const State& state : sampled.states) {
      ASSERT_EQ(dynamics.evaluate(state), ForwardStatus::kSolved) << name;
      compute_equations(*engine.dynamics, state, engine.eq);
      ForwardResult parts = make_forward_result(engine.eq);
      make_forward_solver(Formulation::kSparse, *engine.system, dynamics.selection())->solve(engine.eq, parts);
      const double size = 1 + parts.vdot.norm(), load = 1 + parts.lambda.norm();
      EXPECT_LE((dynamics.result().vdot - parts.vdot).norm(), 1e-9 * size) << name;
      EXPECT_LE((dynamics.result().lambda - parts.lambda).norm(), 1e-9 * load) << name;
    }
  }
}

TEST(ForwardDynamicsTest, AnglesOfManyTurnsAreEvaluatedPartByPart) {
  Sampled sampled(make_four_bar(FourBarJoints::kRevolute), 1);
  ForwardDynamics dynamics(sampled.engine.dynamics, sampled.states.front());
  dynamics.evaluate(sampled.states.front());
  const VectorXd near = dynamics.result().vdot;
  State far = sampled.states.front();
  far.q[0] += 2e6 * 2 * M_PI;
  ASSERT_EQ(dynamics.evaluate(far), ForwardStatus::kSolved);
  EXPECT_LE((dynamics.result().vdot - near).norm(), 1e-7 * (1 + near.norm()));  // what q has lost of its digits
}

TEST(ForwardDynamicsTest, AllocatesNothing) {
  if (!AllocationGuard::available()) GTEST_SKIP() << "allocations are not counted in this build";
  for (const auto& [name, spec] : zoo()) {
    Sampled sampled(spec, 1);
    ForwardDynamics dynamics(sampled.engine.dynamics, sampled.states.front());
    const AllocationGuard guard;
    dynamics.evaluate(sampled.states.front());
    EXPECT_EQ(guard.count(), 0) << name;
  }
}

TEST(ForwardBatchTest, GivesWhatOneAfterAnotherGives) {
  for (const auto& [name, spec] : zoo()) {
    for (const int count : {1, 3, 64, 150}) {
      const Sampled sampled(spec, count);
      ForwardDynamics one(sampled.engine.dynamics, sampled.states.front());
      for (const int threads : {1, 3}) {
        ForwardBatch batch(sampled.engine.dynamics, sampled.states.front(), threads);
        EXPECT_EQ(batch.is_in_lanes(), has_machine_code()) << name;
        ForwardBatch::Results results;  // what is there before does not matter
        results.lambda.setConstant(count, sampled.engine.system->m, 7);
        for (int pass = 0; pass < 2; ++pass) batch.evaluate(sampled.columns, results);
        for (int i = 0; i < count; ++i) {
          const std::string what = name + ", state " + std::to_string(i);
          ASSERT_EQ(one.evaluate(sampled.states[static_cast<std::size_t>(i)]), ForwardStatus::kSolved);
          EXPECT_EQ(results.status[static_cast<std::size_t>(i)], ForwardStatus::kSolved) << what;
          EXPECT_LE((results.vdot.row(i).transpose() - one.result().vdot).norm(), 1e-9 * (1 + one.result().vdot.norm()))
              << what;
          EXPECT_LE((results.lambda.row(i).transpose() - one.result().lambda).norm(),
                    1e-9 * (1 + one.result().lambda.norm()))
              << what;
          EXPECT_NEAR(results.pivot_ratio[i], one.pivot_ratio(), 1e-9) << what;
          for (const int row : batch.selection().excluded_rows(sampled.engine.system->m)) {
            EXPECT_EQ(results.lambda(i, row), 0) << what;
          }
        }
      }
    }
  }
}

TEST(ForwardBatchTest, AFarStateAmongOthersIsExactToo) {
  Sampled sampled(make_four_bar(FourBarJoints::kRevolute), 6);
  ForwardBatch batch(sampled.engine.dynamics, sampled.states.front());
  ForwardBatch::Results near, far;
  batch.evaluate(sampled.columns, near);
  sampled.columns.q(2, 0) += 2e6 * 2 * M_PI;
  batch.evaluate(sampled.columns, far);
  EXPECT_LE((near.vdot - far.vdot).norm(), 1e-6 * (1 + near.vdot.norm()));
}

// A spring whose ends lie on each other has no direction: it pulls nowhere, and native code, which would divide by its
// length, leaves such states to the parts.
TEST(ForwardBatchTest, ASpringWithoutLengthPullsNowhere) {
  ModelSpec spec = make_four_bar(FourBarJoints::kRevolute);
  const ForwardResult without = [&] {
    Sampled sampled(spec, 1);
    ForwardDynamics dynamics(sampled.engine.dynamics, sampled.states.front());
    dynamics.evaluate(sampled.states.front());
    return dynamics.result();
  }();
  SpringSpec spring;
  spring.bodies = {NameRef("ground"), NameRef(spec.bodies[0].name)};  // both points at the pivot, the origin
  spring.stiffness = 100;
  ForceSpec force;
  force.name = "without_length";
  force.element = spring;
  spec.forces.push_back(force);
  Sampled sampled(spec, 5);
  ForwardDynamics dynamics(sampled.engine.dynamics, sampled.states.front());
  ASSERT_EQ(dynamics.evaluate(sampled.states.front()), ForwardStatus::kSolved);
  EXPECT_LE((dynamics.result().vdot - without.vdot).norm(), 1e-10 * without.vdot.norm());
  EXPECT_LE((dynamics.result().lambda - without.lambda).norm(), 1e-10 * without.lambda.norm());
  ForwardBatch batch(sampled.engine.dynamics, sampled.states.front());
  ForwardBatch::Results results;
  batch.evaluate(sampled.columns, results);
  EXPECT_LE((results.vdot.row(0).transpose() - without.vdot).norm(), 1e-10 * without.vdot.norm());
  EXPECT_LE((results.lambda.row(0).transpose() - without.lambda).norm(), 1e-10 * without.lambda.norm());
}

TEST(ForwardBatchTest, RefusesMatricesOfOtherSizes) {
  Sampled sampled(make_four_bar(FourBarJoints::kRevolute), 2);
  ForwardBatch batch(sampled.engine.dynamics, sampled.states.front());
  ForwardBatch::Results results;
  sampled.columns.v.resize(3, sampled.engine.system->nv);
  EXPECT_THROW(batch.evaluate(sampled.columns, results), std::invalid_argument);
}

}  // namespace
}  // namespace ferrers::witness
