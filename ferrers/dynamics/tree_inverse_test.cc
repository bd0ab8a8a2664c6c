#include "ferrers/dynamics/tree_inverse.h"

#include <gtest/gtest.h>

#include "ferrers/testing/allocation_guard.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/needs_machine_code.h"
#include "ferrers/testing/random_mechanism.h"
#include "ferrers/testing/zoo.h"

namespace ferrers::witness {
namespace {

VectorXd random_accelerations(RandomSource& random, long nv) {
  VectorXd out(nv);
  for (double& x : out) x = random.between(-5, 5);
  return out;
}

void expect_mass_times_acceleration(EngineProbe& engine, const State& state, RandomSource& random) {
  TreeInverse inverse(engine.dynamics);
  compute_equations(*engine.dynamics, state, engine.eq);
  const VectorXd vdot = random_accelerations(random, engine.system->nv);
  const VectorXd wanted = engine.eq.M * vdot + engine.eq.h;
  EXPECT_LT((inverse.evaluate(state, vdot) - wanted).norm(), 1e-12 * (1 + wanted.norm())) << engine.model().name();
}

TEST(TreeInverseTest, GivesMassTimesAccelerationAndBiasWithoutTheMassMatrix) {
  RandomSource random(11);
  for (const ZooEntry& entry : zoo()) {
    EngineProbe engine(entry.spec);
    if (!engine.dynamics->lagrangian.scalars.empty()) continue;
    expect_mass_times_acceleration(engine, engine.start(), random);
    expect_mass_times_acceleration(engine, engine.wandered(3, 0.2, 2), random);
  }
}

// Far turned angles are not done by native code: both ways give the same.
TEST(TreeInverseTest, NativeCodeGivesWhatNumbersGive) {
  NEEDS_MACHINE_CODE();
  RandomSource random(12);
  EngineProbe engine(make_bricard(BricardRods::kBricks));
  TreeInverse inverse(engine.dynamics);
  ASSERT_TRUE(inverse.is_native());
  State state = make_drawn_state(*engine.system);
  for (double& v : state.v) v = random.between(-3, 3);
  const VectorXd vdot = random_accelerations(random, engine.system->nv);
  const VectorXd near = inverse.evaluate(state, vdot);
  state.q[0] += 2 * 3.14159265358979323846 * 400000;  // beyond what polynomials turn
  const VectorXd far = inverse.evaluate(state, vdot);
  EXPECT_LT((near - far).norm(), 1e-8 * (1 + near.norm()));
  EXPECT_GT((near - far).norm(), 0) << "the angle itself is rounded there";
}

TEST(TreeInverseTest, AllocatesNothing) {
  if (!AllocationGuard::available()) GTEST_SKIP() << "allocations are not counted in this build";
  RandomSource random(13);
  EngineProbe engine(make_bricard(BricardRods::kBricks));
  TreeInverse inverse(engine.dynamics);
  const State state = engine.start();
  const VectorXd vdot = random_accelerations(random, engine.system->nv);
  const AllocationGuard guard;
  inverse.evaluate(state, vdot);
  EXPECT_EQ(guard.count(), 0);
}

}  // namespace
}  // namespace ferrers::witness
