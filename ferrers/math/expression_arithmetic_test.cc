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

}  // namespace
}  // namespace ferrers
