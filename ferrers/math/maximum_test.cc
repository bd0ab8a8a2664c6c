#include "ferrers/math/maximum.h"

#include <gtest/gtest.h>

#include <limits>

namespace ferrers {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();

TEST(MaximumTest, OnceNotANumberAlwaysNotANumber) {
  EXPECT_EQ(max_keeping_nan(1, 2), 2);
  EXPECT_EQ(max_keeping_nan(2, 1), 2);
  EXPECT_EQ(max_keeping_nan(1, kInfinity), kInfinity);
  EXPECT_TRUE(std::isnan(max_keeping_nan(1, kNaN)));
  EXPECT_TRUE(std::isnan(max_keeping_nan(kNaN, 1)));
  EXPECT_TRUE(std::isnan(largest_magnitude(Eigen::Vector3d(kNaN, 1, 2))));
  EXPECT_TRUE(std::isnan(largest_magnitude(Eigen::Vector3d(1, kNaN, kInfinity))));
}

TEST(MaximumTest, TheLargestMagnitudeOfNothingIsZero) {
  EXPECT_EQ(largest_magnitude(Eigen::VectorXd()), 0);
  EXPECT_EQ(largest_magnitude(Eigen::Vector3d(1, -3, 2)), 3);
}

}  // namespace
}  // namespace ferrers
