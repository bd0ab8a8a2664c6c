#include "ferrers/math/extrapolated_difference.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ferrers {
namespace {

DifferenceResult of(double (*f)(double), double step) {
  return compute_extrapolated_difference(
      [f](double x, Eigen::VectorXd& out) {
        out[0] = f(x);
        return std::isfinite(out[0]);
      },
      1, step);
}

TEST(ExtrapolatedDifferenceTest, SmoothFunctionsLoseAFewRoundingsOnly) {
  const DifferenceResult sine = of([](double x) { return std::sin(1 + x); }, 0.1);
  ASSERT_TRUE(sine.valid);
  EXPECT_NEAR(sine.value[0], std::cos(1), 1e-13);
  const DifferenceResult power = of([](double x) { return std::exp(3 * x) / (1 + x); }, 0.1);
  EXPECT_NEAR(power.value[0], 2, 1e-12);
}

TEST(ExtrapolatedDifferenceTest, TheErrorEstimateCoversTheError) {
  const auto check = [](const DifferenceResult& got, double wanted) {
    ASSERT_TRUE(got.valid);
    EXPECT_LE(std::abs(got.value[0] - wanted), 10 * got.error[0] + 1e-15) << "estimate " << got.error[0];
    EXPECT_LE(got.error[0], 1e-9 * std::abs(wanted));
  };
  check(of([](double x) { return std::sqrt(1e-1 + x); }, 0.08), 0.5 / std::sqrt(1e-1));
  check(of([](double x) { return 1 / (0.05 + x * x + x); }, 0.08), -1 / (0.05 * 0.05));
  check(of([](double x) { return std::tan(1.4 + x); }, 0.08), 1 + std::tan(1.4) * std::tan(1.4));
}

TEST(ExtrapolatedDifferenceTest, AScaleMuchSmallerThanTheStepIsFound) {
  const DifferenceResult got = of([](double x) { return std::tanh(x / 1e-3); }, 1);
  ASSERT_TRUE(got.valid);
  EXPECT_NEAR(got.value[0], 1e3, 1e-6);
}

TEST(ExtrapolatedDifferenceTest, WhereTheFunctionEndsTheStepShrinks) {
  const DifferenceResult got = of([](double x) { return std::log(0.01 + x); }, 1);
  ASSERT_TRUE(got.valid);
  EXPECT_NEAR(got.value[0], 100, 1e-6);
  EXPECT_FALSE(of([](double) { return std::nan(""); }, 1).valid);
}

TEST(ExtrapolatedDifferenceTest, EntriesAreJudgedEachByItself) {
  const DifferenceResult got = compute_extrapolated_difference(
      [](double x, Eigen::VectorXd& out) {
        out << 1e9 * std::sin(x), 1e-9 * std::cos(1 + x), 5;
        return true;
      },
      3, 0.1);
  EXPECT_NEAR(got.value[0], 1e9, 1e-3);
  EXPECT_NEAR(got.value[1], -1e-9 * std::sin(1), 1e-21);
  EXPECT_EQ(got.value[2], 0);
}

}  // namespace
}  // namespace ferrers
