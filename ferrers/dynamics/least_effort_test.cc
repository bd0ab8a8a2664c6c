#include "ferrers/dynamics/least_effort.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "ferrers/testing/random_source.h"

namespace ferrers::witness {
namespace {

MatrixXd random_matrix(RandomSource& random, long rows, long cols) {
  MatrixXd A(rows, cols);
  for (long i = 0; i < A.size(); ++i) A(i) = random.between(-1, 1);
  return A;
}

LeastEffort::Rows random_rows(RandomSource& random, long n, long r, long k) {
  LeastEffort::Rows rows;
  rows.G = random_matrix(random, r, n);
  rows.E = random_matrix(random, k, n);
  rows.G_scale = VectorXd::Ones(r);
  rows.E_scale = VectorXd::Constant(k, 2.0);
  rows.columns = VectorXd::Ones(n);
  rows.weights = VectorXd(k);
  for (long i = 0; i < k; ++i) rows.weights[i] = random.between(0.2, 3);
  return rows;
}

// min |W u| with [Gᵀ Eᵀ] (lambda, u) = b, through its Lagrange conditions.
VectorXd brute_force(const LeastEffort::Rows& rows, const VectorXd& b) {
  const long r = rows.G.rows(), k = rows.E.rows(), n = b.size();
  MatrixXd K = MatrixXd::Zero(r + k + n, r + k + n);
  K.block(r, r, k, k) = rows.weights.cwiseAbs2().asDiagonal();
  K.block(r + k, 0, n, r) = rows.G.transpose();
  K.block(r + k, r, n, k) = rows.E.transpose();
  K.topRightCorner(r + k, n) = K.bottomLeftCorner(n, r + k).transpose();
  VectorXd rhs = VectorXd::Zero(r + k + n);
  rhs.tail(n) = b;
  return K.fullPivLu().solve(rhs).head(r + k);
}

TEST(LeastEffortTest, EffortsAreTheLeastThatBalance) {
  RandomSource random(5);
  for (int trial = 0; trial < 20; ++trial) {
    const long n = 7, r = 4, k = 3 + trial % 4;
    const LeastEffort::Rows rows = random_rows(random, n, r, k);
    const LeastEffort least(rows, {0, 1, 2});
    const VectorXd b = random_matrix(random, n, 1);
    VectorXd lambda, u;
    ASSERT_TRUE(least.solve(b, lambda, u));
    EXPECT_LT((rows.G.transpose() * lambda + rows.E.transpose() * u - b).norm(), 1e-11);
    const VectorXd wanted = brute_force(rows, b);
    EXPECT_LT((u - wanted.tail(k)).norm(), 1e-9 * wanted.norm());
    EXPECT_EQ(least.idle_efforts().cols(), k - 3);
    EXPECT_LT((rows.G.transpose() * least.idle_lambda() + rows.E.transpose() * least.idle_efforts()).norm(), 1e-10);
    const std::vector<bool> shared = least.shared();
    EXPECT_EQ(std::count(shared.begin(), shared.end(), true), k > 3 ? k : 0);
  }
}

TEST(LeastEffortTest, ADriveThatNoOtherCanReplaceIsUnique) {
  LeastEffort::Rows rows;  // two motions; two drives on the first, one on the second
  rows.G = MatrixXd::Zero(0, 2);
  rows.G_scale = VectorXd();
  rows.E = MatrixXd(3, 2);
  rows.E << 1, 0, 1, 0, 0, 1;
  rows.E_scale = rows.weights = VectorXd::Ones(3);
  rows.weights[1] = 2;
  rows.columns = VectorXd::Ones(2);
  const LeastEffort least(rows, {0, 2});
  EXPECT_EQ(least.shared(), (std::vector<bool>{true, true, false}));
  VectorXd lambda, u;
  ASSERT_TRUE(least.solve(Eigen::Vector2d(5, 7), lambda, u));
  EXPECT_NEAR(u[0], 4, 1e-14);  // weights 1 and 2: shares as 4 to 1
  EXPECT_NEAR(u[1], 1, 1e-14);
  EXPECT_NEAR(u[2], 7, 1e-14);
}

TEST(LeastEffortTest, AtASingularPoseOnlyLoadsThatCanBeHeldAreHeld) {
  LeastEffort::Rows rows;  // no drive on the second motion
  rows.G = MatrixXd::Zero(0, 2);
  rows.G_scale = VectorXd();
  rows.E = MatrixXd(2, 2);
  rows.E << 1, 0, 1, 0;
  rows.E_scale = rows.weights = VectorXd::Ones(2);
  rows.columns = VectorXd::Ones(2);
  const LeastEffort least(rows, {});
  VectorXd lambda, u;
  EXPECT_FALSE(least.solve(Eigen::Vector2d(5, 7), lambda, u));
  ASSERT_TRUE(least.solve(Eigen::Vector2d(6, 0), lambda, u));
  EXPECT_NEAR(u[0], 3, 1e-14);
  EXPECT_NEAR(u[1], 3, 1e-14);
  EXPECT_EQ(least.shared(), (std::vector<bool>{true, true}));
}

}  // namespace
}  // namespace ferrers::witness
