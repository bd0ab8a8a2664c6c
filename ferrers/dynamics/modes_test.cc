#include "ferrers/dynamics/modes.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

namespace ferrers {
namespace {

EstimatedMatrix exact(const MatrixXd& K) { return {K, MatrixXd::Zero(K.rows(), K.cols())}; }

// Three equal masses in a row, joined by two springs and dashpots: free at both ends.
const Eigen::Matrix3d kChain = (Eigen::Matrix3d() << 1, -1, 0, -1, 2, -1, 0, -1, 1).finished();

TEST(ModesTest, AFreeChainHasOneNeutralModeAndTwoFrequencies) {
  const MatrixXd M = MatrixXd::Identity(3, 3);
  for (const double c : {0.0, 0.1}) {
    const ModalAnalysis modal = analyze_modes_at_rest(M, exact(7 * kChain), exact(c * kChain), 1, 0);
    EXPECT_EQ(modal.undamped, c == 0);
    ASSERT_EQ(modal.modes.size(), 3u);
    EXPECT_EQ(modal.eigenvalues.size(), 6u);
    EXPECT_EQ(modal.modes[0].kind, ModeKind::kNeutral);
    EXPECT_EQ(modal.modes[0].eigenvalue, 0.0);
    const double wanted[] = {std::sqrt(7.0), std::sqrt(21.0)};
    for (int k = 0; k < 2; ++k) {
      EXPECT_NEAR(modal.modes[k + 1].frequency_rad_s(), wanted[k], 1e-13);
      EXPECT_NEAR(modal.modes[k + 1].damping_ratio(), c / 14 * wanted[k], 1e-13);
    }
    const Eigen::VectorXcd& first = modal.modes[1].shape;  // ends against each other, the middle stands
    EXPECT_LT(std::abs(first[1] / first[0]), 1e-12);
    EXPECT_LT(std::abs(first[2] / first[0] + 1.0), 1e-12);
  }
}

TEST(ModesTest, AMotionThatIsDampedButNotHeldHasOneZero) {
  const MatrixXd one = MatrixXd::Identity(1, 1);
  const ModalAnalysis modal = analyze_modes_at_rest(2 * one, exact(0 * one), exact(6 * one), 1, 0);
  ASSERT_EQ(modal.modes.size(), 2u);
  EXPECT_EQ(modal.modes[0].kind, ModeKind::kNeutral);
  EXPECT_EQ(modal.modes[1].kind, ModeKind::kDecay);
  EXPECT_NEAR(modal.modes[1].eigenvalue.real(), -3, 1e-14);
  EXPECT_EQ(modal.eigenvalues.size(), 2u);
}

TEST(ModesTest, GrowthAndDecayComeInPairsWhereNothingDamps) {
  const MatrixXd one = MatrixXd::Identity(1, 1);
  const ModalAnalysis modal = analyze_modes_at_rest(one, exact(-4 * one), exact(0 * one), 0, 1);
  ASSERT_EQ(modal.modes.size(), 2u);
  EXPECT_NEAR(std::abs(modal.modes[0].eigenvalue.real()), 2, 1e-14);
  EXPECT_NE(modal.modes[0].kind, modal.modes[1].kind);
}

TEST(ModesTest, TheGeneralWayAgreesWithTheSymmetricOne) {
  const MatrixXd M = (Eigen::Matrix2d() << 2, 0.5, 0.5, 1).finished();
  const MatrixXd K = (Eigen::Matrix2d() << 30, -4, -4, 9).finished();
  const ModalAnalysis symmetric = analyze_modes_at_rest(M, exact(K), exact(MatrixXd::Zero(2, 2)), 0, 0);
  MatrixXd A = MatrixXd::Zero(4, 4);
  A.topRightCorner(2, 2).setIdentity();
  A.bottomLeftCorner(2, 2) = -M.inverse() * K;
  const ModalAnalysis general = analyze_modes(M, A);
  ASSERT_EQ(general.modes.size(), 2u);
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(general.modes[k].frequency_rad_s(), symmetric.modes[k].frequency_rad_s(), 1e-13);
    EXPECT_NEAR(general.modes[k].damping_ratio(), 0, 1e-13);
  }
}

}  // namespace
}  // namespace ferrers
