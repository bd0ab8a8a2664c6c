#include "ferrers/math/sparse_basis.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace ferrers {
namespace {

using Eigen::MatrixXd;

MatrixXd orthonormal(const MatrixXd& A) {
  const Eigen::HouseholderQR<MatrixXd> qr(A);
  return qr.householderQ() * MatrixXd::Identity(A.rows(), A.cols());
}

TEST(SparseBasisTest, SpansTheSameSubspaceWithUnitVectors) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 50; ++trial) {
    MatrixXd A(5 + trial % 30, 1 + trial % 5);
    for (double& x : A.reshaped()) x = normal(random);
    const MatrixXd Q = orthonormal(A), S = make_sparse_basis(Q);
    EXPECT_LT((S - Q * (Q.transpose() * S)).norm(), 1e-12);
    const Eigen::JacobiSVD<MatrixXd> svd(S);
    EXPECT_GT(svd.singularValues().minCoeff(), 0.02) << "its vectors are far from dependent";
    for (int k = 0; k < S.cols(); ++k) EXPECT_NEAR(S.col(k).norm(), 1, 1e-12);
  }
}

TEST(SparseBasisTest, FindsVectorsThatWereMixed) {
  // Three vectors on disjoint rows, rotated among each other.
  MatrixXd A = MatrixXd::Zero(12, 3);
  for (int k = 0; k < 3; ++k) A.block(4 * k, k, 4, 1) << 1, -2, 0.5, 1;
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  MatrixXd mix(3, 3);
  for (double& x : mix.reshaped()) x = normal(random);
  const MatrixXd S = make_sparse_basis(orthonormal(A * mix));
  EXPECT_EQ((S.array() != 0).count(), 12);
}

TEST(SparseBasisTest, NegligibleEntriesAreExactlyZero) {
  MatrixXd A(4, 1);
  A << 1, 1e-14, 0, 1;
  const MatrixXd S = make_sparse_basis(A.normalized());
  EXPECT_EQ(S(1, 0), 0);
}

TEST(SparseBasisTest, OfNothingIsNothing) { EXPECT_EQ(make_sparse_basis(MatrixXd(4, 0)).cols(), 0); }

}  // namespace
}  // namespace ferrers
