#include "ferrers/formats/asmt_law.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "ferrers/testing/build_checks.h"

namespace ferrers {
namespace {

double value_at(const std::string& text, double time, double factor = 1) {
  Diagnostics diagnostics;
  const auto law = read_asmt_law(text, {1, 1, 1}, factor, diagnostics);
  EXPECT_TRUE(law) << text << "\n" << witness::messages(diagnostics);
  if (!law) return std::nan("");
  const std::array<std::string, 1> inputs = {"t"};
  return ExpressionProgram(*law, inputs).evaluate(&time);
}

TEST(AsmtLawTest, FormulasOfTime) {
  const double pi = std::numbers::pi;
  EXPECT_DOUBLE_EQ(value_at("4.0d*pi*time", 0.5), 2 * pi);
  EXPECT_DOUBLE_EQ(value_at("30.000000*pi/180.0", 0), pi / 6);
  EXPECT_DOUBLE_EQ(value_at("1.5e-3 + 2d2*time", 2), 400.0015);
  EXPECT_DOUBLE_EQ(value_at("arcsin(0.5) + arctan(1) + asin(1)", 0), pi / 6 + pi / 4 + pi / 2);
  EXPECT_DOUBLE_EQ(value_at("sin(time)^2 + abs(-cos(time))", 0.3), std::pow(std::sin(0.3), 2) + std::cos(0.3));
  EXPECT_DOUBLE_EQ(value_at("10*time", 3, 1e-3), 0.03);
  EXPECT_DOUBLE_EQ(value_at("", 1), 0);
  EXPECT_DOUBLE_EQ(value_at("  ", 1), 0);
}

TEST(AsmtLawTest, ASignAfterAnOperatorBelongsToTheNumber) {
  EXPECT_DOUBLE_EQ(value_at("2*-3^2", 0), 18);
  EXPECT_DOUBLE_EQ(value_at("-3^2", 0), -9);
  EXPECT_DOUBLE_EQ(value_at("2^-1", 0), 0.5);
  EXPECT_DOUBLE_EQ(value_at("2^3^2", 0), 512);
  EXPECT_DOUBLE_EQ(value_at("8/2/2 - 1 - 1", 0), 0);
}

TEST(AsmtLawTest, WhatIsNotUnderstoodIsRefusedAtItsPlace) {
  struct Wrong {
    std::string text, code;
    int column;
  };
  const std::vector<Wrong> all = {{"2*rampstep(0,1,2,3)", "F602", 12},
                                  {"spline(time)", "F602", 10},
                                  {"2*tme", "F401", 12},
                                  {"2 time", "F401", 12},
                                  {"2 & 3", "F401", 12},
                                  {"1..2", "F401", 10},
                                  {"sin(", "F401", 10},
                                  {"(1", "F401", 10},
                                  {"1e999", "F401", 10},
                                  {"1e99999999999", "F401", 10},
                                  {"*", "F401", 10},
                                  {"time)", "F401", 10}};
  for (const Wrong& one : all) {
    Diagnostics diagnostics;
    EXPECT_FALSE(read_asmt_law(one.text, {7, 10, 3}, 1, diagnostics)) << one.text;
    ASSERT_EQ(witness::codes(diagnostics), witness::Codes{one.code}) << one.text << witness::messages(diagnostics);
    EXPECT_EQ(diagnostics.items()[0].at.line, 7) << one.text;
    EXPECT_EQ(diagnostics.items()[0].at.column, one.column) << one.text;
  }
}

}  // namespace
}  // namespace ferrers
