#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "ferrers/math/expression.h"
#include "ferrers/testing/random_formula.h"

namespace ferrers {
namespace {

using expression_testing::parsed;
using expression_testing::value_at;

TEST(ExpressionArithmeticTest, FormulasAreJoinedInSimplestForm) {
  const Expression x = parsed("x"), y = parsed("y"), zero, one = Expression::constant(1);
  EXPECT_EQ((x + y).to_string(), "x + y");
  EXPECT_EQ((x - y).to_string(), "x - y");
  EXPECT_EQ((x * y).to_string(), "x * y");
  EXPECT_EQ((x / y).to_string(), "x / y");
  EXPECT_EQ((-x).to_string(), "-x");
  EXPECT_EQ((zero + x).to_string(), "x");
  EXPECT_EQ((x - zero).to_string(), "x");
  EXPECT_EQ((one * x).to_string(), "x");
  EXPECT_EQ((x * zero).to_string(), "0");
  EXPECT_EQ((x / one).to_string(), "x");
  EXPECT_EQ((-(-x)).to_string(), "x");
  EXPECT_EQ((one + one).to_string(), "2");
}

TEST(ExpressionArithmeticTest, OperandsKeepTheirUnits) {
  EXPECT_EQ((parsed("5 mm") * parsed("x + 2 rad")).to_string(), "5 mm * (x + 2 rad)");
}

TEST(ExpressionArithmeticTest, EqualPartsAreShared) {
  Expression doubled = parsed("sin(x)");
  for (int i = 0; i < 60; ++i) doubled = doubled + doubled * parsed("y");
  const std::vector<std::string> inputs{"x", "y"};
  EXPECT_LE(ExpressionProgram(doubled, inputs).instruction_count(), 2 * 60 + 1);
  EXPECT_NEAR(value_at(doubled, 0.5, 1), std::sin(0.5) * 0x1p60, 1e3);
}

TEST(ExpressionArithmeticTest, ASumTakesItsTermsInOrder) {
  const std::vector<Expression> terms{parsed("x"), Expression(), parsed("y*x"), parsed("3")};
  EXPECT_EQ(sum_of(terms).to_string(), "x + y * x + 3");
  EXPECT_EQ(sum_of({}).to_string(), "0");
}

TEST(ExpressionArithmeticTest, SimplifyingHidesNoMissingValue) {
  for (const char* text : {"0*log(x)", "0/log(x)", "if(log(x) < 0, 1, 1)", "log(x) - log(x)", "log(x)/log(x)"}) {
    EXPECT_TRUE(std::isnan(value_at(parsed(text), -1, 0))) << text;
    EXPECT_TRUE(std::isnan(value_at(parsed(text).simplified(), -1, 0))) << text;
  }
}

TEST(ExpressionArithmeticTest, SimplestFormGathersNumbersSignsTermsAndFactors) {
  const std::pair<const char*, const char*> cases[] = {
      {"2*(3*x)", "6 * x"},
      {"-(2*x)", "-2 * x"},
      {"x*3", "3 * x"},
      {"(2*x)*(y*3)", "6 * (x * y)"},
      {"x + x", "2 * x"},
      {"2*x - 5*x", "-3 * x"},
      {"x - x", "x - x"},
      {"2*x - x*2", "2 * x - 2 * x"},
      {"x*y - y*x", "x * y - x * y"},
      {"x*y + x*sin(x)", "x * (y + sin(x))"},
      {"(x - y) - (y - x)", "2 * (x - y)"},
      {"(-x)*y", "-(x * y)"},
      {"(-x)*(-y)", "x * y"},
      {"x + -3*y", "x - 3 * y"},
      {"-x + y", "y - x"},
      {"-x - y", "-(x + y)"},
      {"-(x - y)", "y - x"},
      {"x - -y", "x + y"},
      {"x + -2", "x - 2"},
      {"x/3", "x / 3"},
      {"x/-3", "-(x / 3)"},
      {"6*x/3", "2 * x"},
      {"3*(x/2)", "1.5 * x"},
      {"2*x/(4*y)", "0.5 * (x / y)"},
      {"1/(4*y)", "0.25 / y"},
      {"-x/-y", "x / y"},
      {"x*(1/y)", "x / y"},
      {"x/x", "x / x"},
      {"x*x", "x^2"},
      {"y*x*x", "y * x^2"},
      {"x^2*x", "x^3"},
      {"x^2*x^2", "x^4"},
      {"x^3*x^2", "x^3 * x^2"},
      {"x^2/x", "x^2 / x"},
      {"x^2*x^-2", "x^2 * x^-2"},
      {"x^0.5*x^0.5", "(x^0.5)^2"},
      {"(x^2)^3", "x^6"},
      {"(x^0.5)^2", "(x^0.5)^2"},
      {"(-x)^2", "x^2"},
      {"(-x)^3", "-x^3"},
      {"(3*x)^2", "9 * x^2"},
      {"x^y*x", "x^y * x"},
      {"sin(-x)", "-sin(x)"},
      {"cos(-2*x)", "cos(2 * x)"},
      {"sin(x)^2 + cos(x)^2", "sin(x)^2 + cos(x)^2"},
      {"min(x, x)", "x"},
      {"5 mm*x*1", "5 mm * x"},
      {"0 + 2 deg", "2 deg"},
      {"1e300*(1e300*x)", "1e+300 * (1e+300 * x)"},
      {"1e-300*(1e-300*x)", "1e-300 * (1e-300 * x)"},
      {"0*x + y", "0 * x + y"},
      {"x*0", "0 * x"},
  };
  for (const auto& [formula, simplest] : cases)
    EXPECT_EQ(parsed(formula).simplified().to_string(), simplest) << formula;
}

TEST(ExpressionArithmeticTest, WhatCancelsInADerivativeIsGone) {
  EXPECT_EQ((parsed("x*y") - parsed("y*x")).to_string(), "0");
  EXPECT_EQ((parsed("x - y") + parsed("y - x")).to_string(), "0");
  EXPECT_EQ(parsed("(v*sin(x))^2 + (v*cos(x))^2").derivative("v").to_string(), "2 * v");
}

}  // namespace
}  // namespace ferrers
