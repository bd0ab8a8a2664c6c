#include "ferrers/math/hyper_dual.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace ferrers {
namespace {

void expect_parts(const HyperDual& got, double a, double b, double c, double d) {
  const auto near = [](double x, double y) { return std::abs(x - y) <= 4e-15 * (1 + std::abs(y)); };
  EXPECT_TRUE(near(got.a, a) && near(got.b, b) && near(got.c, c) && near(got.d, d))
      << got.a << " " << got.b << " " << got.c << " " << got.d << ", wanted " << a << " " << b << " " << c << " " << d;
}

/// f(x(s, t)) with x = v + 2 s + 3 t + 5 s t has the parts f, 2 f', 3 f', 5 f' + 6 f''.
HyperDual argument(double v) { return {v, 2, 3, 5}; }
void expect_function(const HyperDual& got, double f, double slope, double curvature) {
  expect_parts(got, f, 2 * slope, 3 * slope, 5 * slope + 6 * curvature);
}

TEST(HyperDualTest, ArithmeticCarriesTheProductRuleTwice) {
  const HyperDual x(2, 1, 0), y(3, 0, 1);
  expect_parts(x + y, 5, 1, 1, 0);
  expect_parts(x - y, -1, 1, -1, 0);
  expect_parts(x * y, 6, 3, 2, 1);
  expect_parts(x * x * y, 12, 12, 4, 4);
  expect_parts(x / y, 2.0 / 3, 1.0 / 3, -2.0 / 9, -1.0 / 9);
  expect_parts(1 / (x * y), 1.0 / 6, -1.0 / 12, -1.0 / 18, 1.0 / 36);
  expect_parts(-x * 2 + 1, -3, -2, 0, 0);
}

TEST(HyperDualTest, FunctionsOfOneNumberHaveTheirTextbookDerivatives) {
  const double v = 0.6, s = std::sin(v), c = std::cos(v), t = std::tan(v), e = std::exp(v), sh = std::sinh(v),
               ch = std::cosh(v), th = std::tanh(v), r = 0.8;  // r = sqrt(1 - v²)
  const HyperDual x = argument(v);
  expect_function(sin(x), s, c, -s);
  expect_function(cos(x), c, -s, -c);
  expect_function(tan(x), t, 1 / (c * c), 2 * t / (c * c));
  expect_function(asin(x), std::asin(v), 1 / r, v / (r * r * r));
  expect_function(acos(x), std::acos(v), -1 / r, -v / (r * r * r));
  expect_function(atan(x), std::atan(v), 1 / 1.36, -1.2 / (1.36 * 1.36));
  expect_function(sinh(x), sh, ch, sh);
  expect_function(cosh(x), ch, sh, ch);
  expect_function(tanh(x), th, 1 - th * th, -2 * th * (1 - th * th));
  expect_function(exp(x), e, e, e);
  expect_function(log(x), std::log(v), 1 / v, -1 / (v * v));
  expect_function(log10(x), std::log10(v), 1 / (v * std::log(10)), -1 / (v * v * std::log(10)));
  expect_function(sqrt(x), std::sqrt(v), 0.5 * std::pow(v, -0.5), -0.25 * std::pow(v, -1.5));
  expect_function(abs(argument(-v)), v, -1, 0);
  expect_function(abs(x), v, 1, 0);
  expect_function(pow(x, 2.5), std::pow(v, 2.5), 2.5 * std::pow(v, 1.5), 3.75 * std::pow(v, 0.5));
  expect_function(pow(2.0, x), std::pow(2, v), std::log(2) * std::pow(2, v), std::pow(std::log(2), 2) * std::pow(2, v));
}

TEST(HyperDualTest, WholePowersHaveDerivativesAtZeroAndBelow) {
  expect_function(pow(argument(0), 0), 1, 0, 0);
  expect_function(pow(argument(0), 1), 0, 1, 0);
  expect_function(pow(argument(0), 2), 0, 0, 2);
  expect_function(pow(argument(-2), HyperDual(3)), -8, 12, -12);
}

TEST(HyperDualTest, FunctionsOfTwoNumbersHaveTheirTextbookDerivatives) {
  const HyperDual x(3, 1, 0), y(4, 0, 1);
  expect_parts(hypot(x, y), 5, 0.6, 0.8, -12.0 / 125);
  expect_parts(atan2(y, x), std::atan2(4, 3), -4.0 / 25, 3.0 / 25, 7.0 / 625);
  const double l = std::log(3);
  expect_parts(pow(x, y), 81, 108, 81 * l, 27 * (1 + 4 * l));
  const HyperDual both(3, 1, 1);  // the second derivative along x alone
  expect_parts(hypot(both, 4), 5, 0.6, 0.6, 16.0 / 125);
  expect_parts(atan2(HyperDual(4), both), std::atan2(4, 3), -4.0 / 25, -4.0 / 25, 24.0 / 625);
  expect_parts(pow(both, both), 27, 27 * (1 + l), 27 * (1 + l), 27 * (1 + l) * (1 + l) + 9);
}

template <class T>
T branched(const T& x, const T& y) {
  using std::cos, std::exp, std::max, std::sqrt;
  if (x < 1) return exp(x * y);
  return max(x, y) * sqrt(y) + cos(y);
}

TEST(HyperDualTest, TemplatesAreDifferentiatedAlongTheBranchTaken) {
  EXPECT_EQ(branched(0.5, 2.0), std::exp(1.0));
  expect_parts(branched(HyperDual(0.5, 1, 0), HyperDual(2, 0, 1)), std::exp(1.0), 2 * std::exp(1.0),
               0.5 * std::exp(1.0), 2 * std::exp(1.0));
  expect_parts(branched(HyperDual(9, 1, 0), HyperDual(4, 0, 1)), 18 + std::cos(4), 2, 9.0 / 4 - std::sin(4), 0.25);
  EXPECT_TRUE(HyperDual(1, 5, 5) == 1 && HyperDual(1) <= 1 && HyperDual(2) > HyperDual(1, 9, 9));
}

TEST(HyperDualTest, EigenMultipliesThem) {
  const Eigen::Vector2<HyperDual> v(HyperDual(2, 1, 0), HyperDual(3, 0, 1));
  Eigen::Matrix2<HyperDual> m;
  m << v[0], v[1], HyperDual(1), v[0] * v[1];
  // x³ + x y² + x y + x y³ at (2, 3)
  expect_parts(v.dot(m * v), 86, 51, 68, 34);
}

}  // namespace
}  // namespace ferrers
