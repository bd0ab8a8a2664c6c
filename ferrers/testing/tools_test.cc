#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <memory>

#include "ferrers/testing/allocation_guard.h"
#include "ferrers/testing/compare.h"
#include "ferrers/testing/finite_difference.h"

namespace ferrers::witness {
namespace {

TEST(AllocationGuardTest, CountsNewAndWhatEigenAllocates) {
  if (!AllocationGuard::available()) GTEST_SKIP() << "allocations are not counted in this build";
  AllocationGuard guard;
  const auto number = std::make_unique<double>(1.0);
  EXPECT_EQ(guard.count(), 1);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Constant(40, 40, *number);
  EXPECT_EQ(guard.count(), 2);
  const Eigen::MatrixXd product = matrix * matrix;
  EXPECT_GT(guard.count(), 2);
  EXPECT_EQ(product(0, 0), 40);
}

TEST(AllocationGuardTest, StaysAtZeroForWorkInPlace) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Random(30, 30), b = Eigen::MatrixXd::Zero(30, 30);
  AllocationGuard guard;
  b = a + 2 * a.transpose();
  EXPECT_EQ(guard.count(), 0);
  EXPECT_NEAR(b(0, 0), 3 * a(0, 0), 1e-15);
}

TEST(FiniteDifferenceTest, DerivativesOfSmoothFunctionsAreGoodToElevenDigits) {
  EXPECT_NEAR(differentiate([](double x) { return std::sin(x); }, 0.7), std::cos(0.7), 1e-12);
  const auto f = [](const Eigen::VectorXd& x) { return Eigen::VectorXd(Eigen::Vector2d(x[0] * x[1], std::exp(x[0]))); };
  Eigen::Matrix2d wanted;
  wanted << 2, 0.5, std::exp(0.5), 0;
  EXPECT_TRUE(matrices_near(difference_jacobian(f, Eigen::Vector2d(0.5, 2)), wanted, 1e-11));
}

TEST(CompareTest, NamesTheEntryThatDiffers) {
  Eigen::Matrix2d a = Eigen::Matrix2d::Identity(), b = a;
  EXPECT_TRUE(matrices_near(a, b, 0));
  b(1, 0) = 0.5;
  const ::testing::AssertionResult result = matrices_near(a, b, 1e-3, "G");
  EXPECT_FALSE(result);
  EXPECT_NE(std::string(result.message()).find("G differs most at (1, 0)"), std::string::npos);
}

TEST(CompareTest, NotANumberIsNeverNear) {
  Eigen::Vector3d a(1, std::numeric_limits<double>::quiet_NaN(), 2);
  EXPECT_FALSE(matrices_near(a, a, 1));
  EXPECT_FALSE(matrices_near(a.head<2>(), a, 1));
}

TEST(CompareTest, SpansAreComparedAsSpaces) {
  const Eigen::MatrixXd plane = (Eigen::MatrixXd(3, 2) << 1, 0, 0, 1, 0, 0).finished();
  const Eigen::MatrixXd same = (Eigen::MatrixXd(3, 2) << 2, 1, 1, -1, 0, 0).finished();
  const Eigen::MatrixXd other = (Eigen::MatrixXd(3, 2) << 1, 0, 0, 1, 0, 0.1).finished();
  EXPECT_TRUE(same_span(plane, same, 1e-12));
  EXPECT_FALSE(same_span(plane, other, 1e-3));
}

}  // namespace
}  // namespace ferrers::witness
