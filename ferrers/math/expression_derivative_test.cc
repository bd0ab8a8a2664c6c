#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "ferrers/math/expression.h"
#include "ferrers/testing/random_formula.h"

namespace ferrers {
namespace {

using expression_testing::parsed;
using expression_testing::random_formula;
using expression_testing::value_at;

TEST(ExpressionDerivativeTest, SimpleFormulasHaveSimpleDerivatives) {
  const std::pair<const char*, const char*> cases[] = {
      {"x", "1"},
      {"y", "0"},
      {"3*x", "3"},
      {"x^2", "2 * x"},
      {"x^3", "3 * x^2"},
      {"sin(x)", "cos(x)"},
      {"cos(x)", "-sin(x)"},
      {"exp(x)", "exp(x)"},
      {"log(x)", "1 / x"},
      {"x + y", "1"},
      {"y - x", "-1"},
      {"x*y", "y"},
      {"y/2", "0"},
      {"1/0 + x", "1"},
      {"floor(x)", "0"},
      {"if(x < 1, x, 2*x)", "if(x < 1, 1, 2)"},
      {"2*pi*y + x/1", "1"},
      {"hypot(y, 2)", "0"},
      {"5 mm*x", "5 mm"},
  };
  for (const auto& [formula, derivative] : cases) {
    EXPECT_EQ(parsed(formula).derivative("x").to_string(), derivative) << formula;
  }
}

TEST(ExpressionDerivativeTest, KinksGiveOneSidesSlope) {
  EXPECT_EQ(std::abs(value_at(parsed("abs(x)").derivative("x"), 0, 0)), 1);
  EXPECT_EQ(value_at(parsed("max(x, 0)").derivative("x"), 0, 0), 1);
  EXPECT_EQ(value_at(parsed("x^2").derivative("x"), 0, 0), 0);
  EXPECT_EQ(value_at(parsed("x^y").derivative("y"), 0, 2), 0);
}

TEST(ExpressionDerivativeTest, DottedNamesAreOneName) {
  EXPECT_EQ(parsed("main.position^2").derivative("main.position").to_string(), "2 * main.position");
  EXPECT_EQ(parsed("main.position^2").derivative("main").to_string(), "0");
}

/// The derivative by Richardson's extrapolation of central differences, with an estimate of its error.
struct Difference {
  double value, error;
};

Difference central_difference(const Expression& e, double x, double y, double h) {
  const auto slope = [&](double step) { return (value_at(e, x + step, y) - value_at(e, x - step, y)) / (2 * step); };
  const double coarse = slope(h), middle = slope(h / 2), fine = slope(h / 4);
  const double first = (4 * middle - coarse) / 3, second = (4 * fine - middle) / 3;
  return {second, std::abs(second - first) + std::abs(fine - middle) * 1e-3};
}

RC_GTEST_PROP(ExpressionDerivativeTest, DerivativesAgreeWithDifferences, ()) {
  const std::string text = random_formula(3);
  const Expression e = parsed(text);
  const double x = *rc::gen::inRange(-2000, 2000) * 1e-3 + 0.000317,
               y = *rc::gen::inRange(-2000, 2000) * 1e-3 + 0.000713;
  const double exact = value_at(e.derivative("x"), x, y), value = value_at(e, x, y);
  const Difference numeric = central_difference(e, x, y, 1e-4);
  // Formulas that are not smooth or not tame near the point are no witnesses; those that jump within the step (a
  // remainder of something small) betray themselves with another one.
  const Difference closer = central_difference(e, x, y, 3.1e-6);
  RC_PRE(std::isfinite(value) && std::abs(value) < 1e4 && std::isfinite(numeric.value) && std::isfinite(exact));
  RC_PRE(numeric.error < 1e-4 * (1 + std::abs(numeric.value)));
  RC_PRE(std::abs(closer.value - numeric.value) <
         1e-3 * (1 + std::abs(numeric.value)) + 1e-10 * std::abs(value) / 1e-6);
  RC_CLASSIFY(numeric.value != 0, "depends on x");
  RC_LOG() << text << " at x = " << x << ", y = " << y << ": exact " << exact << ", difference " << numeric.value;
  const double tolerance = 1e-6 * (1 + std::abs(numeric.value)) + 10 * numeric.error + 1e-10 * std::abs(value) / 1e-4;
  RC_ASSERT(std::abs(exact - numeric.value) <= tolerance);
}

TEST(ExpressionDerivativeTest, EveryOperationAgreesWithDifferencesTwice) {
  for (const char* text : {"x + x*y",
                           "x*x - y/x",
                           "x/(y + x^2)",
                           "x^3",
                           "x^-2",
                           "x^2.5",
                           "y^x",
                           "x^x",
                           "sin(x)",
                           "cos(2*x)",
                           "tan(x)",
                           "asin(x/2)",
                           "acos(x/2)",
                           "atan(x*y)",
                           "sinh(x)",
                           "cosh(x)",
                           "tanh(x)",
                           "exp(x*y)",
                           "log(x)",
                           "log10(x)",
                           "sqrt(x)",
                           "abs(x - 3)*x",
                           "sign(x)*x^2",
                           "floor(x)*x^2",
                           "mod(x^2, y)",
                           "mod(3, x)",
                           "smoothstep(x/2)",
                           "smootherstep(x/2)",
                           "atan2(x, y)",
                           "atan2(y, x^2)",
                           "hypot(x, y)",
                           "min(x^2, y)",
                           "max(x^2, y)",
                           "if(x < y, x^3, x^2)",
                           "-x^4"}) {
    const Expression e = parsed(text), slope = e.derivative("x"), curvature = slope.derivative("x");
    for (const double x : {0.317, 0.731, 1.413}) {
      const double y = 0.9;
      const Difference first = central_difference(e, x, y, 1e-3), second = central_difference(slope, x, y, 1e-3);
      EXPECT_NEAR(value_at(slope, x, y), first.value, 1e-8 * (1 + std::abs(first.value))) << text << " at " << x;
      EXPECT_NEAR(value_at(curvature, x, y), second.value, 1e-7 * (1 + std::abs(second.value))) << text << " at " << x;
    }
  }
}

TEST(ExpressionDerivativeTest, DerivativesOfHostileFormulasStaySmall) {
  std::string product = "x", nested = "x", powers = "x";
  for (int i = 0; i < 4000; ++i) product += "*x";
  for (int i = 0; i < 190; ++i) nested = "sin(" + nested + ")";
  for (int i = 0; i < 190; ++i) powers += "^x";
  for (const std::string& text : {product, nested, powers}) {
    const Expression twice = parsed(text).derivative("x").derivative("x");
    const std::vector<std::string> names{"x"};
    const ExpressionProgram program(twice, names);
    const double x = 1;
    EXPECT_TRUE(std::isfinite(program.evaluate(&x))) << text.substr(0, 10);
  }
  EXPECT_NEAR(value_at(parsed(product).derivative("x").derivative("x"), 1, 0), 4001.0 * 4000.0, 1e-3);
}

TEST(ExpressionDerivativeTest, ARateFollowsNamesThatChange) {
  const auto rate = [](std::string_view name) -> std::optional<Expression> {
    if (name == "x") return parsed("vx");
    if (name == "y") return parsed("2*x");
    return std::nullopt;
  };
  EXPECT_EQ(parsed("x*c").rate(rate).to_string(), "vx * c");
  EXPECT_EQ(parsed("sin(x + y)").rate(rate).to_string(), "cos(x + y) * (vx + 2 * x)");
  EXPECT_EQ(parsed("c^2").rate(rate).to_string(), "0");
}

TEST(ExpressionDerivativeTest, PowersHaveSlopesWhereTheirExponentStandsStill) {
  EXPECT_EQ(value_at(parsed("(-1.5)^if(x < 1, x, 2)").derivative("x"), 2, 0), 0);
  EXPECT_EQ(value_at(parsed("y^if(x < 1, x, 2)").derivative("x"), 2, -3), 0);
  EXPECT_EQ(value_at(parsed("y^if(x < 1, x, 2)").derivative("y"), 2, -3), -6);
  EXPECT_TRUE(std::isnan(value_at(parsed("(-1.5)^x").derivative("x"), 2, 0)));
}

TEST(ExpressionDerivativeTest, PowersWithANamedExponentAreSmoothAtZero) {
  const Expression curvature = parsed("x^y").derivative("x").derivative("x"), third = curvature.derivative("x");
  EXPECT_EQ(value_at(curvature, 0, 1), 0);
  EXPECT_EQ(value_at(curvature, 0, 2), 2);
  EXPECT_EQ(value_at(third, 0, 1), 0);
  EXPECT_EQ(value_at(third, 0, 2), 0);
  EXPECT_EQ(value_at(third, 0, 3), 6);
}

TEST(ExpressionDerivativeTest, ArcSlopesAreExactNearTheirEnds) {
  for (const double gap : {1e-3, 1e-6, 1e-9, 1e-12}) {
    const double x = 1 - gap, exact = 1 / std::sqrt((1 - x) * (1 + x));
    EXPECT_NEAR(value_at(parsed("asin(x)").derivative("x"), x, 0) / exact, 1, 1e-15);
    EXPECT_NEAR(value_at(parsed("acos(x)").derivative("x"), x, 0) / exact, -1, 1e-15);
  }
}

}  // namespace
}  // namespace ferrers
