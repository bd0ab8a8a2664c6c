#include "ferrers/redundancy/reaction_bounds.h"

#include <gtest/gtest.h>

#include <cmath>

#include "ferrers/redundancy/analysis.h"
#include "ferrers/testing/elastic_joints.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/zoo.h"

namespace ferrers::witness {
namespace {

/// A mechanism under multipliers lambda_p, its components along the joints' frames, and the distribution for any
/// factors of the springs' stiffness.
struct Case {
  EngineProbe engine;
  State state;
  AllRows rows;
  std::vector<ComponentMap> maps;
  MatrixXd Z, targets;
  JointSprings springs;
  VectorXd lambda_p, delta;

  explicit Case(const ModelSpec& spec) : engine(spec) {
    state = make_drawn_state(*engine.system);
    engine.evaluate(state);
    rows = make_all_rows(*engine.system, engine.scaling);
    const auto joints = compute_joint_frame_wrenches(*engine.system, state, engine.eq.pos);
    maps = compute_component_maps(*engine.system, joints);
    Z = complete_self_stresses(*engine.system, engine.scaling, rows, engine.eq.pos, joints,
                               self_stresses_of_selection(*engine.system, engine.selection, engine.eq.constraints.G));
    springs = make_joint_springs(*engine.system, DistributionBy::kJointStiffness, engine.scaling.length_m);
    targets = MatrixXd::Zero(6 * static_cast<long>(maps.size()), rows.size());
    for (std::size_t j = 0; j < maps.size(); ++j) {
      targets.block(6 * static_cast<long>(j), rows.first[j], 6, rows.count[j]) = maps[j];
    }
    RandomSource random(5);
    lambda_p.resize(rows.size());
    for (int i = 0; i < rows.size(); ++i) lambda_p[i] = random.between(-10, 10) * rows.scale[i];
    delta = misalignment_of_rows(rows, maps, springs);
  }

  ForceMethod method_with(const JointSprings& changed) const {
    return make_force_method(rows, maps, changed, Z, engine.scaling.length_m);
  }
  ForceMethod method() const { return method_with(springs); }
  VectorXd solve(const JointSprings& changed) const {
    return solve_distribution(method_with(changed), rows, maps, lambda_p, delta).lambda;
  }
  ReactionBounds bounds(const StiffnessRange& range) const {
    return bound_reactions(method(), rows, maps, solve(springs), targets, range);
  }
  /// Stiffness times factors that `factor` gives for each entry.
  template <class Factor>
  VectorXd values(const Factor& factor) const {
    JointSprings changed = springs;
    for (Vector6d& c : changed.compliance) {
      for (double& entry : c) entry /= factor();
    }
    return targets * solve(changed);
  }
};

void expect_all_inside(const Case& test, const ReactionBounds& bounds, const StiffnessRange& range, int samples) {
  RandomSource random(9);
  const double width = std::log(range.high / range.low), size = bounds.high.cwiseAbs().maxCoeff();
  for (int n = 0; n < samples; ++n) {
    const bool corner = n % 2 == 0;
    const VectorXd values = test.values([&] {
      const double x = corner ? random.below(2) : random.between(0, 1);
      return range.low * std::exp(x * width);
    });
    ASSERT_LE((bounds.low - values).maxCoeff(), 1e-10 * size) << n;
    ASSERT_LE((values - bounds.high).maxCoeff(), 1e-10 * size) << n;
  }
}

ModelSpec make_elastic_door() {
  ModelSpec spec = make_door(2);
  for (JointSpec& joint : spec.joints) set_stiffness(joint, number3(2e6, 2e6, 1e6), number3(4e4, 4e4, kRigid));
  return spec;
}

TEST(ReactionBoundsTest, EveryStiffnessInTheRangeStaysInsideAndCornersAttainIt) {
  const Case test(make_elastic_door());
  ASSERT_EQ(test.method().springs.size(), 10u);
  const StiffnessRange range{0.25, 3};
  const ReactionBounds bounds = test.bounds(range);
  EXPECT_EQ(bounds.method, BoundsMethod::kExact);
  expect_all_inside(test, bounds, range, 1000);
  // All corners once more, each solved from the beginning.
  VectorXd low = VectorXd::Constant(bounds.low.size(), INFINITY), high = -low;
  for (unsigned corner = 0; corner < 1024; ++corner) {
    JointSprings changed = test.springs;
    const ForceMethod method = test.method();
    for (std::size_t i = 0; i < method.springs.size(); ++i) {
      const SpringComponent& s = method.springs[i];
      changed.compliance[s.joint][s.component] /= (corner >> i & 1U) != 0 ? range.high : range.low;
    }
    const VectorXd values = test.targets * test.solve(changed);
    low = low.cwiseMin(values);
    high = high.cwiseMax(values);
  }
  const double size = high.cwiseAbs().maxCoeff();
  EXPECT_LT((low - bounds.low).cwiseAbs().maxCoeff(), 1e-11 * size);
  EXPECT_LT((high - bounds.high).cwiseAbs().maxCoeff(), 1e-11 * size);
  EXPECT_GT((high - low).maxCoeff(), 0.1 * size) << "the range does not bear on anything";
}

// Two springs side by side: the share of one runs from 1/(1 + high/low) to its complement.
TEST(ReactionBoundsTest, TheAxialShareOfADoorHingeIsAQuotientOfItsStiffnesses) {
  ModelSpec spec = make_door(2);
  for (JointSpec& joint : spec.joints) {
    set_stiffness(joint, number3(kRigid, kRigid, 1e6), number3(kRigid, kRigid, kRigid));
  }
  Case test(spec);
  test.lambda_p.setZero();
  for (int r = 0; r < test.rows.size(); ++r) {
    if (test.rows.names[r] == "hinge1/force_z") test.lambda_p[r] = 100;
  }
  const ReactionBounds bounds = test.bounds({0.5, 2});
  EXPECT_EQ(bounds.method, BoundsMethod::kExact);
  EXPECT_NEAR(bounds.low[2], 20, 1e-11);
  EXPECT_NEAR(bounds.high[2], 80, 1e-11);
  EXPECT_NEAR(bounds.low[8], 20, 1e-11);
  EXPECT_NEAR(bounds.high[8], 80, 1e-11);
}

// Thirty springs, one self-stress: too many corners to visit, but no local extreme that is not a global one.
TEST(ReactionBoundsTest, OneSelfStressIsBoundedExactlyByClimbing) {
  ModelSpec spec = make_bricard(BricardRods::kBricks);
  set_random_stiffness(spec, 4, 3, 6);
  const Case test(spec);
  ASSERT_EQ(test.Z.cols(), 1);
  ASSERT_GT(test.method().springs.size(), static_cast<std::size_t>(kMostEnumerated));
  const ReactionBounds bounds = test.bounds({0.1, 10});
  EXPECT_EQ(bounds.method, BoundsMethod::kExact);
  expect_all_inside(test, bounds, {0.1, 10}, 1000);
}

// Many springs and self-stresses: what is found was attained, and no sample gets beyond it.
TEST(ReactionBoundsTest, ASearchSaysThatItIsOne) {
  ModelSpec spec = make_door(3);
  for (JointSpec& joint : spec.joints) set_stiffness(joint, number3(2e6, 2e6, 1e6), number3(4e4, 4e4, kRigid));
  set_misalignment(spec.joints[1], number3(1e-5, 0, 2e-5), number3(0, 0, 0));
  const Case test(spec);
  const ReactionBounds bounds = test.bounds({0.5, 2});
  EXPECT_EQ(bounds.method, BoundsMethod::kSearch);
  expect_all_inside(test, bounds, {0.5, 2}, 1000);
}

TEST(ReactionBoundsTest, WithoutARangeThereIsOneValue) {
  const Case test(make_elastic_door());
  const ReactionBounds bounds = test.bounds({1, 1});
  const VectorXd values = test.targets * test.solve(test.springs);
  EXPECT_LT((bounds.low - values).cwiseAbs().maxCoeff(), 1e-11 * values.cwiseAbs().maxCoeff());
  EXPECT_LT((bounds.high - values).cwiseAbs().maxCoeff(), 1e-11 * values.cwiseAbs().maxCoeff());
}

TEST(ReactionBoundsTest, WhatWouldTakeTooLongIsRefused) {
  ModelSpec spec = make_door(40);
  for (JointSpec& joint : spec.joints) set_stiffness(joint, 1e6, 1e4);
  EXPECT_EQ(Case(spec).bounds({0.5, 2}).method, BoundsMethod::kTooLarge);
}

TEST(ReactionBoundsTest, RangesAreInOrder) {
  const Case test(make_elastic_door());
  EXPECT_THROW(test.bounds({2, 1}), std::invalid_argument);
  EXPECT_THROW(test.bounds({0, 1}), std::invalid_argument);
  EXPECT_THROW(test.bounds({1, INFINITY}), std::invalid_argument);
}

}  // namespace
}  // namespace ferrers::witness
