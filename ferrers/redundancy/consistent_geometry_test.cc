#include "ferrers/redundancy/consistent_geometry.h"

#include <gtest/gtest.h>

#include <random>

#include "ferrers/model/joints/joint_type.h"
#include "ferrers/model/pose_spec.h"
#include "ferrers/redundancy/mechanism_analysis.h"
#include "ferrers/testing/zoo.h"

namespace ferrers {
namespace {

using namespace witness;  // NOLINT(google-build-using-namespace): a test's vocabulary

/// The mechanism with its joints given by frames that are off by up to `noise` (m times the size, rad) in every number.
ModelSpec with_noise(const ModelSpec& spec, double noise, unsigned seed) {
  const Model model = *build_model(spec).model;
  const double length = characteristic_length(model);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> off(-noise, noise);
  const auto shaken = [&](const Pose& X) {
    const Vector3d turn(off(random), off(random), off(random)), shift(off(random), off(random), off(random));
    return pose_spec({X.R * quaternion_exp(turn).toRotationMatrix(), X.p + length * shift});
  };
  ModelSpec out = spec;
  for (std::size_t j = 0; j < out.joints.size(); ++j) {
    JointSpec& joint = out.joints[j];
    const PlacementRule rule = joint_type_info(joint.type).placement;
    if (rule == PlacementRule::kTwoPoints || rule == PlacementRule::kMesh) continue;
    joint.place = joint.axis = joint.axis2 = {};
    joint.x.reset();
    joint.frames = {shaken(model.joints()[j].X_1F), shaken(model.joints()[j].X_2M)};
  }
  return out;
}

ConsistentGeometry found(const ModelSpec& spec, double tolerance) {
  return find_consistent_geometry(*build_model(spec).model, tolerance);
}

RedundancyReport report_of(const ModelSpec& spec) {
  return *analyze_mechanism(*make_system(*build_model(spec).model)).redundancy;
}

struct Named {
  const char* name;
  ModelSpec spec;
};

std::vector<Named> overconstrained() {
  return {{"four-bar", make_four_bar(FourBarJoints::kRevolute)},
          {"three four-bars", make_n_four_bar(3, 0.3)},
          {"Bricard", make_bricard(BricardRods::kBricks)},
          {"three cranks", make_parallel_cranks()},
          {"Andrews", make_andrews()}};
}

TEST(ConsistentGeometryTest, NoisyMechanismsHaveTheRedundancyOfExactOnes) {
  for (const Named& one : overconstrained()) {
    const RedundancyReport exact = report_of(one.spec);
    for (const double noise : {1e-8, 1e-6}) {
      const ConsistentGeometry geometry = found(with_noise(one.spec, noise, 1), 1e-5);
      ASSERT_EQ(geometry.verdict, GeometryVerdict::kFound) << one.name << " " << noise << ": " << geometry.text;
      EXPECT_EQ(geometry.redundant, exact.redundant) << one.name;
      const MechanismAnalysis analysis = analyze_mechanism(*make_system(*build_model(*geometry.spec).model));
      ASSERT_EQ(analysis.closure.verdict, ClosureVerdict::kCloses) << one.name;
      EXPECT_EQ(analysis.redundancy->redundant, exact.redundant) << one.name;
      EXPECT_EQ(analysis.redundancy->mobility, exact.mobility) << one.name;
      EXPECT_TRUE(analysis.redundancy->decision.confident) << one.name;
      EXPECT_EQ(analysis.permanence->kind, Permanence::kPermanent) << one.name;
    }
  }
}

TEST(ConsistentGeometryTest, SeatsMoveByNoMoreThanTheNoise) {
  for (const Named& one : overconstrained()) {
    const double noise = 1e-6;
    const ModelSpec noisy = with_noise(one.spec, noise, 2);
    const double length = characteristic_length(*build_model(noisy).model);
    const ConsistentGeometry geometry = found(noisy, 1e-5);
    ASSERT_EQ(geometry.verdict, GeometryVerdict::kFound) << one.name;
    ASSERT_FALSE(geometry.moves.empty()) << one.name;
    for (const SeatMove& move : geometry.moves) {
      EXPECT_LT(move.distance_m, 10 * noise * length) << one.name << " " << move.joint;
      EXPECT_LT(move.angle_rad, 10 * noise) << one.name << " " << move.joint;
    }
  }
}

TEST(ConsistentGeometryTest, ExactNumbersAreLeftAlone) {
  for (const Named& one : overconstrained()) {
    const ConsistentGeometry geometry = found(one.spec, 1e-6);
    EXPECT_EQ(geometry.verdict, GeometryVerdict::kExact) << one.name;
    EXPECT_TRUE(geometry.text.empty()) << geometry.text;
  }
}

TEST(ConsistentGeometryTest, WithoutToleranceNothingIsAsked) {
  const ConsistentGeometry geometry = found(with_noise(make_four_bar(FourBarJoints::kRevolute), 1e-6, 1), 0);
  EXPECT_EQ(geometry.verdict, GeometryVerdict::kExact);
}

TEST(ConsistentGeometryTest, NoiseAboveTheToleranceIsNoNoise) {
  const ConsistentGeometry geometry = found(with_noise(make_bricard(BricardRods::kBricks), 1e-2, 1), 1e-7);
  EXPECT_NE(geometry.verdict, GeometryVerdict::kFound) << geometry.text;
  EXPECT_FALSE(geometry.spec.has_value());
}

TEST(ConsistentGeometryTest, AxesThatWereNearlyParallelAreTold) {
  const ConsistentGeometry geometry = found(with_noise(make_four_bar(FourBarJoints::kRevolute), 1e-6, 3), 1e-5);
  ASSERT_EQ(geometry.verdict, GeometryVerdict::kFound);
  ASSERT_EQ(geometry.parallel.size(), 1);
  EXPECT_EQ(geometry.parallel[0].joints.size(), 4);
  EXPECT_GT(geometry.parallel[0].angle_rad, 1e-7);
  EXPECT_LT(geometry.parallel[0].angle_rad, 1e-5);
}

TEST(ConsistentGeometryTest, WhatTheNumbersSayAsWrittenIsTold) {
  const ModelSpec noisy = with_noise(make_four_bar(FourBarJoints::kRevolute), 1e-6, 4);
  const ConsistentGeometry geometry = found(noisy, 1e-5);
  EXPECT_EQ(geometry.redundant, 3);
  EXPECT_EQ(geometry.mobility, 1);
  EXPECT_FALSE(geometry.as_written.confident);
  EXPECT_NE(geometry.text.find("as written"), std::string::npos) << geometry.text;
  EXPECT_GT(geometry.misclosure_m, 0);
}

}  // namespace
}  // namespace ferrers
