#include "ferrers/dynamics/stability.h"

#include <gtest/gtest.h>

namespace ferrers {
namespace {

EstimatedMatrix exact(const MatrixXd& K) { return {K, MatrixXd::Zero(K.rows(), K.cols())}; }

StabilityVerdict judge(const MatrixXd& K, double force = 1) {
  const MatrixXd unit = MatrixXd::Identity(K.rows(), K.cols());
  return judge_stability(exact(K), unit, unit, force, 1);
}

TEST(StabilityTest, SignsOfThePrincipalStiffnessesDecide) {
  EXPECT_EQ(judge(Eigen::Vector2d(3, 5).asDiagonal()).stability, Stability::kStable);
  EXPECT_EQ(judge(Eigen::Vector2d(3, 0).asDiagonal()).stability, Stability::kNeutral);
  const StabilityVerdict saddle = judge(Eigen::Vector3d(-3, 0, 5).asDiagonal());
  EXPECT_EQ(saddle.stability, Stability::kUnstable);
  EXPECT_EQ(saddle.unstable, 1);
  EXPECT_EQ(saddle.neutral, 1);
  EXPECT_EQ(saddle.stable, 1);
  EXPECT_TRUE(saddle.confident);
}

TEST(StabilityTest, AStiffnessThatHoldsNothingOfTheForcesIsNone) {
  EXPECT_EQ(judge(1e-14 * MatrixXd::Identity(1, 1), 10).stability, Stability::kNeutral);
  EXPECT_EQ(judge(1e-5 * MatrixXd::Identity(1, 1), 10).stability, Stability::kStable);
  EXPECT_EQ(judge(1e-14 * MatrixXd::Identity(1, 1), 0).stability, Stability::kStable);  // nothing else acts
  EXPECT_EQ(judge(MatrixXd::Zero(2, 2), 0).neutral, 2);
}

TEST(StabilityTest, BetweenStiffAndNothingTheDoubtIsSaid) {
  EXPECT_FALSE(judge(Eigen::Vector2d(1, 1e-8).asDiagonal()).confident);
}

TEST(StabilityTest, ForcesWithoutAPotentialMayFlutter) {
  const MatrixXd follower = (Eigen::Matrix2d() << 3, 2, -2, 3).finished();
  const StabilityVerdict verdict = judge(follower);
  EXPECT_FALSE(verdict.conservative);
  EXPECT_EQ(verdict.stability, Stability::kUnstable);
  const MatrixXd mild = (Eigen::Matrix2d() << 3, 1, 0.2, 5).finished();  // real, positive
  EXPECT_EQ(judge(mild).stability, Stability::kStable);
}

TEST(StabilityTest, AMechanismThatCannotMoveIsStable) {
  EXPECT_EQ(judge(MatrixXd::Zero(0, 0)).stability, Stability::kStable);
}

}  // namespace
}  // namespace ferrers
