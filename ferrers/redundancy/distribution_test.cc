#include "ferrers/redundancy/distribution.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>

#include "ferrers/redundancy/analysis.h"
#include "ferrers/redundancy/joint_jacobian.h"
#include "ferrers/testing/compare.h"
#include "ferrers/testing/elastic_joints.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/random_mechanism.h"
#include "ferrers/testing/transforms.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {
namespace {

/// A mechanism at one state with everything that the force method takes.
struct Pose {
  EngineProbe engine;
  State state;
  AllRows rows;
  JointWrenches joints;
  std::vector<ComponentMap> maps;
  MatrixXd Z;
  JointSprings springs;
  ForceMethod method;

  explicit Pose(const ModelSpec& spec, const TopologyOptions& options = {}, std::uint64_t wander = 0,
                DistributionBy by = DistributionBy::kJointStiffness)
      : engine(spec, options) {
    state = wander > 0 ? engine.wandered(wander) : make_drawn_state(*engine.system);
    engine.evaluate(state);
    rows = make_all_rows(*engine.system, engine.scaling);
    joints = compute_joint_frame_wrenches(*engine.system, state, engine.eq.pos);
    maps = compute_component_maps(*engine.system, joints);
    Z = complete_self_stresses(*engine.system, engine.scaling, rows, engine.eq.pos, joints,
                               self_stresses_of_selection(*engine.system, engine.selection, engine.eq.constraints.G));
    springs = make_joint_springs(*engine.system, by, engine.scaling.length_m);
    method = make_force_method(rows, maps, springs, Z, engine.scaling.length_m);
  }

  VectorXd random_multipliers(std::uint64_t seed) const {
    RandomSource random(seed);
    VectorXd lambda(rows.size());
    for (int i = 0; i < rows.size(); ++i) lambda[i] = random.between(-1, 1) * rows.scale[i];
    return lambda;
  }
  VectorXd solve(const VectorXd& lambda_p) const {
    return solve_distribution(method, rows, maps, lambda_p, misalignment_of_rows(rows, maps, springs)).lambda;
  }
};

/// What the solution must be, without self-stresses: the load is balanced, and the springs' displacement C lambda +
/// delta is one that motions of the bodies give the joints.
void expect_elastic_equilibrium(const Pose& pose, const VectorXd& lambda_p, const VectorXd& lambda) {
  const MatrixXd G =
      compute_scaled_joint_jacobian(*pose.engine.system, pose.state, pose.rows, pose.engine.scaling.length_m);
  const VectorXd change = pose.rows.scale.cwiseInverse().cwiseProduct(lambda - lambda_p);
  EXPECT_LT((G.transpose() * change).norm(), 1e-11 * (1 + change.norm()));
  VectorXd displacement = misalignment_of_rows(pose.rows, pose.maps, pose.springs);
  double size = displacement.norm();
  for (std::size_t j = 0; j < pose.joints.size(); ++j) {
    const auto& T = pose.joints[j].T;
    const Matrix3d& R = pose.joints[j].motion.R_F;
    const Vector6d& c = pose.springs.compliance[j];
    const auto part = lambda.segment(pose.rows.first[j], pose.rows.count[j]);
    Eigen::Matrix<double, 6, 1> give = T * part;
    give.head<3>() = (R * c.tail<3>().asDiagonal() * R.transpose() * give.head<3>()).eval();
    give.tail<3>() = (R * c.head<3>().asDiagonal() * R.transpose() * give.tail<3>()).eval();
    displacement.segment(pose.rows.first[j], pose.rows.count[j]) += T.transpose() * give;
  }
  displacement = displacement.cwiseProduct(pose.rows.scale).eval();
  size = std::max(size, displacement.norm());
  const MatrixXd independent =
      Eigen::ColPivHouseholderQR<MatrixXd>(G).householderQ() * MatrixXd::Identity(G.rows(), G.rows() - pose.Z.cols());
  const VectorXd incompatible = displacement - independent * (independent.transpose() * displacement);
  EXPECT_LT(incompatible.norm(), 1e-10 * size);
}

bool has_mesh(const ModelSpec& spec) {
  return std::any_of(spec.joints.begin(), spec.joints.end(),
                     [](const JointSpec& j) { return j.type == JointType::kGearMesh; });
}

TEST(DistributionTest, ItIsTheElasticEquilibriumOfRandomMechanisms) {
  int redundant = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    RandomMechanism mechanism = make_random_mechanism(seed);
    if (has_mesh(mechanism.spec)) continue;
    SCOPED_TRACE(mechanism.description);
    set_random_stiffness(mechanism.spec, seed, 3, 6);
    set_misalignment(mechanism.spec.joints.front(), number3(1e-6, -2e-6, 1e-6), number3(1e-6, 2e-6, 0));
    const Pose pose(mechanism.spec, {}, seed);
    if (pose.method.remaining.cols() > 0) continue;  // doubled couplings
    const VectorXd lambda_p = pose.random_multipliers(seed);
    expect_elastic_equilibrium(pose, lambda_p, pose.solve(lambda_p));
    if (pose.Z.cols() > 0) ++redundant;
  }
  EXPECT_GE(redundant, 15);
}

TEST(DistributionTest, ItDoesNotDependOnTheParticularSolution) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    RandomMechanism mechanism = make_random_mechanism(seed);
    set_random_stiffness(mechanism.spec, seed, 2, 9);
    const Pose pose(mechanism.spec);
    if (pose.Z.cols() == 0 || pose.method.remaining.cols() > 0) continue;
    SCOPED_TRACE(mechanism.description);
    const VectorXd lambda_p = pose.random_multipliers(seed), one = pose.solve(lambda_p);
    const VectorXd other = pose.solve(lambda_p + 100 * pose.Z * VectorXd::Ones(pose.Z.cols()));
    EXPECT_TRUE(matrices_near(other, one, 1e-9));
    EXPECT_TRUE(matrices_near(pose.solve(one), one, 1e-9));
  }
}

// Springs side by side take the load in the ratio of their stiffness, to rounding of the whole load.
TEST(DistributionTest, StiffnessesMayDifferByTenOrdersOfMagnitude) {
  ModelSpec spec = make_door(3);
  const double k[3] = {1e-1, 3e4, 1e9};
  for (int i = 0; i < 3; ++i) {
    set_stiffness(spec.joints[i], number3(kRigid, kRigid, k[i]), number3(kRigid, kRigid, kRigid));
  }
  const Pose pose(spec);
  VectorXd lambda_p = VectorXd::Zero(pose.rows.size());
  for (int r = 0; r < pose.rows.size(); ++r) {
    if (pose.rows.names[r] == "hinge1/force_z") lambda_p[r] = 196.2;
  }
  const VectorXd lambda = pose.solve(lambda_p);
  const double sum = k[0] + k[1] + k[2];
  for (int i = 0; i < 3; ++i) {
    const double axial = pose.maps[i].row(2).dot(lambda.segment(pose.rows.first[i], pose.rows.count[i]));
    EXPECT_NEAR(axial, 196.2 * k[i] / sum, 1e-14 * 196.2) << i;
  }
}

TEST(DistributionTest, WhichSelfStressesAreFixedDoesNotDependOnTheSizeOfStiffness) {
  for (const double k : {1e-12, 1.0, 1e20}) {
    ModelSpec spec = make_door(2);
    set_stiffness(spec.joints[0], number3(k, kRigid, kRigid), number3(kRigid, kRigid, kRigid));
    set_stiffness(spec.joints[1], number3(kRigid, kRigid, 1e3 * k), number3(kRigid, kRigid, kRigid));
    const Pose pose(spec);
    EXPECT_EQ(pose.Z.cols(), 5);
    EXPECT_EQ(pose.method.fixed.cols(), 2) << k;
    EXPECT_EQ(pose.method.remaining.cols(), 3) << k;
    EXPECT_TRUE(pose.method.decision.confident);
  }
}

// The axial couple is the only one with springs: shared; the rest stays open.
TEST(DistributionTest, WhatStaysRigidStaysUndetermined) {
  ModelSpec spec = make_door(2);
  for (JointSpec& joint : spec.joints) {
    set_stiffness(joint, number3(kRigid, kRigid, 1e6), number3(kRigid, kRigid, kRigid));
  }
  const Pose pose(spec);
  for (int j = 0; j < 2; ++j) {
    for (int k = 0; k < 6; ++k) {
      const auto wanted = k == 2   ? ReactionStatus::kDistributed
                          : k == 5 ? ReactionStatus::kUnique
                                   : ReactionStatus::kUndetermined;
      EXPECT_EQ(judge_component(pose.maps[j].row(k), component_unit(k, pose.engine.scaling.length_m),
                                pose.Z.middleRows(pose.rows.first[j], pose.rows.count[j]),
                                pose.method.remaining.middleRows(pose.rows.first[j], pose.rows.count[j])),
                wanted)
          << j << kComponentNames[k];
    }
  }
}

TEST(DistributionTest, StiffnessOfOneBricardJointFixesAllOfThem) {
  ModelSpec spec = make_bricard(BricardRods::kBricks);
  set_stiffness(spec.joints[2], 1e5, 1e3);
  const Pose one(spec);
  ASSERT_EQ(one.Z.cols(), 1);
  EXPECT_EQ(one.method.fixed.cols(), 1);
  const VectorXd lambda_p = one.random_multipliers(3);
  expect_elastic_equilibrium(one, lambda_p, one.solve(lambda_p));
}

TEST(DistributionTest, EqualStiffnessIsTheLeastSumOfSquaresWithMomentsOverTheLength) {
  const Pose pose(make_four_bar(FourBarJoints::kRevolute), {}, 4, DistributionBy::kEqualStiffness);
  ASSERT_EQ(pose.Z.cols(), 3);
  ASSERT_EQ(pose.method.fixed.cols(), 3);
  const VectorXd lambda_p = pose.random_multipliers(2), lambda = pose.solve(lambda_p);
  const double L = pose.engine.scaling.length_m;
  const auto square = [&](const VectorXd& all) {
    double sum = 0;
    for (std::size_t j = 0; j < pose.joints.size(); ++j) {
      const Eigen::Matrix<double, 6, 1> w = pose.joints[j].T * all.segment(pose.rows.first[j], pose.rows.count[j]);
      sum += w.head<3>().squaredNorm() / (L * L) + w.tail<3>().squaredNorm();
    }
    return sum;
  };
  const double least = square(lambda);
  EXPECT_LT(least, square(lambda_p));
  for (int i = 0; i < 3; ++i) {
    for (const double step : {-1e-3, 1e-3}) {
      const double more = square(lambda + step * pose.Z.col(i)) - least;
      EXPECT_GT(more, 0);
      EXPECT_NEAR(more, square(step * pose.Z.col(i)), 1e-10 * least) << "not the stationary point";
    }
  }
}

TEST(DistributionTest, PreloadDoesNotDependOnTheCut) {
  ModelSpec spec = make_four_bar(FourBarJoints::kRevolute);
  set_random_stiffness(spec, 8, 2, 8);
  set_misalignment(spec.joints[1], number3(1e-4, 2e-4, -1e-4), number3(1e-4, 1e-4, 0));
  std::vector<VectorXd> wrenches;
  for (std::size_t cut = 0; cut < spec.joints.size(); ++cut) {
    TopologyOptions options;
    options.cut.assign(spec.joints.size(), false);
    options.cut[cut] = true;
    const Pose pose(spec, options);
    const VectorXd lambda = pose.solve(VectorXd::Zero(pose.rows.size()));
    VectorXd all(24);
    for (int j = 0; j < 4; ++j) {
      all.segment<6>(6 * j) = pose.maps[j] * lambda.segment(pose.rows.first[j], pose.rows.count[j]);
    }
    wrenches.push_back(all / all.norm());
  }
  for (const VectorXd& other : wrenches) EXPECT_TRUE(matrices_near(other, wrenches.front(), 1e-10));
}

TEST(DistributionTest, TeethGiveWayAlongTheirLineOfActionOnly) {
  ModelSpec spec = make_planetary(3);
  for (JointSpec& joint : spec.joints) {
    if (joint.type == JointType::kGearMesh) {
      set_stiffness(joint, number3(2e7, kRigid, kRigid), number3(kRigid, kRigid, kRigid));
    }
  }
  const Pose pose(spec, {}, 5);
  for (const SpringComponent& spring : pose.method.springs) EXPECT_EQ(spring.component, 0);
  for (std::size_t j = 0; j < pose.maps.size(); ++j) {
    if (spec.joints[j].type != JointType::kGearMesh) continue;
    EXPECT_GT(std::abs(pose.maps[j](0, 0)), 0.5);
    EXPECT_LT(pose.maps[j].bottomRows<5>().norm(), 1e-12);
  }
  EXPECT_EQ(pose.method.fixed.cols(), 2) << "the shares of the planets";
}

TEST(DistributionTest, NamesOfWaysToDistribute) {
  for (const auto by : {DistributionBy::kJointStiffness, DistributionBy::kEqualStiffness, DistributionBy::kNothing}) {
    EXPECT_EQ(find_distribution(to_string(by)), by);
  }
  EXPECT_FALSE(find_distribution("norm"));
}

TEST(DistributionTest, WrongSizesAreACallersBug) {
  const Pose pose(make_door(2));
  EXPECT_THROW(make_force_method(pose.rows, pose.maps, pose.springs, MatrixXd::Zero(3, 1), 1), std::invalid_argument);
  EXPECT_THROW(pose.solve(VectorXd::Zero(3)), std::invalid_argument);
}

}  // namespace
}  // namespace ferrers::witness
