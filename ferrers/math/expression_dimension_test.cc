#include <gtest/gtest.h>

#include "ferrers/math/expression.h"
#include "ferrers/testing/random_formula.h"

namespace ferrers {
namespace {

using expression_testing::parsed;

std::optional<Dimension> dimension_of(std::string_view name) {
  if (name == "r" || name == "l") return kLength;
  if (name == "m") return kMass;
  if (name == "T") return kTime;
  if (name == "angle") return kPureNumber;
  return std::nullopt;  // `u` and all others: unknown
}

std::optional<Dimension> inferred(std::string_view text) {
  Diagnostics diagnostics;
  const auto dimension = parsed(text).dimension(dimension_of, diagnostics);
  EXPECT_TRUE(diagnostics.empty()) << text << ": " << diagnostics.items()[0].message;
  return dimension;
}

TEST(ExpressionDimensionTest, ProductsAndPowersMultiplyDimensions) {
  EXPECT_EQ(inferred("3*r"), kLength);
  EXPECT_EQ(inferred("r*l"), (Dimension{2, 0, 0}));
  EXPECT_EQ(inferred("m*r^2"), kInertia);
  EXPECT_EQ(inferred("r/l"), kPureNumber);
  EXPECT_EQ(inferred("1/T"), kAngularVelocity);
  EXPECT_EQ(inferred("2*pi*r"), kLength);
  EXPECT_EQ(inferred("200 N/m * r"), kForce);
  EXPECT_EQ(inferred("r^-1*m"), (Dimension{-1, 1, 0}));
  EXPECT_EQ(inferred("(r^2 + l^2)^(1/2)"), kLength);
  EXPECT_EQ(inferred("sqrt(r*l)"), kLength);
  EXPECT_EQ(inferred("r^(6/3)"), (Dimension{2, 0, 0}));
}

TEST(ExpressionDimensionTest, ABareNumberIsATermOfAnyDimension) {
  EXPECT_EQ(inferred("r + 0.1"), kLength);
  EXPECT_EQ(inferred("0.1 - r"), kLength);
  EXPECT_EQ(inferred("r + 2*0.1"), kLength);
  EXPECT_EQ(inferred("max(r, 0)"), kLength);
  EXPECT_EQ(inferred("if(r > 0.2, r, 0)"), kLength);
  EXPECT_EQ(inferred("0.1"), std::nullopt);
  EXPECT_EQ(inferred("2*pi"), std::nullopt);
  EXPECT_EQ(inferred("sqrt(2)*0.1"), std::nullopt);
}

TEST(ExpressionDimensionTest, UnknownNamesMatchAnything) {
  EXPECT_EQ(inferred("u"), std::nullopt);
  EXPECT_EQ(inferred("u*r"), std::nullopt);
  EXPECT_EQ(inferred("u + r"), kLength);
  EXPECT_EQ(inferred("sin(2*pi*u)*r"), kLength);
  EXPECT_EQ(inferred("u^3"), std::nullopt);
}

TEST(ExpressionDimensionTest, FunctionsOfPureNumbersAndAngles) {
  EXPECT_EQ(inferred("sin(angle)"), kPureNumber);
  EXPECT_EQ(inferred("sin(30 deg)"), kPureNumber);
  EXPECT_EQ(inferred("atan2(r, l)"), kPureNumber);
  EXPECT_EQ(inferred("exp(r/l)*m"), kMass);
  EXPECT_EQ(inferred("hypot(r, l)"), kLength);
  EXPECT_EQ(inferred("sign(r)*l"), kLength);
  EXPECT_EQ(inferred("abs(-r)"), kLength);
  EXPECT_EQ(inferred("mod(r, l)"), kLength);
}

TEST(ExpressionDimensionTest, ContradictionsAreReportedAtTheirPlace) {
  struct Case {
    const char* text;
    int column;
    const char* message;
  };
  for (const Case& c : {
           Case{"r + m", 3, "'+' joins m and kg"},
           Case{"2*r - 3 kg", 5, "'-' joins m and kg"},
           Case{"1 + sin(r)", 5, "'sin' wants a pure number, got m"},
           Case{"exp(5 mm)", 1, "'exp' wants a pure number"},
           Case{"r^0.5", 2, "m to the power 0.5"},
           Case{"sqrt(r)", 1, "m to the power 0.5"},
           Case{"r^angle", 2, "no constant"},
           Case{"2^r", 2, "an exponent is a pure number, got m"},
           Case{"min(r, 1, m)", 1, "'min' joins m and kg"},
           Case{"if(r < m, 1, 2)", 6, "'<' joins m and kg"},
           Case{"if(r < 1, r, m)", 1, "'if' joins m and kg"},
           Case{"atan2(r, m)", 1, "'atan2' joins m and kg"},
           Case{"r + 30 deg", 3, "'+' joins m and a pure number"},
           Case{"r^1e9", 2, "to the power"},
       }) {
    SCOPED_TRACE(c.text);
    Diagnostics diagnostics;
    parsed(c.text).dimension(dimension_of, diagnostics);
    ASSERT_EQ(diagnostics.items().size(), 1u);
    const Diagnostic& d = diagnostics.items()[0];
    EXPECT_EQ(d.code, "F204");
    EXPECT_EQ(d.at.column, c.column);
    EXPECT_NE(d.message.find(c.message), std::string::npos) << d.message;
    EXPECT_FALSE(d.hint.empty());
  }
}

TEST(ExpressionDimensionTest, AllContradictionsAreReportedAndNoneTwice) {
  Diagnostics diagnostics;
  EXPECT_EQ(parsed("(r + m)*l + sin(r)").dimension(dimension_of, diagnostics), kPureNumber);
  EXPECT_EQ(diagnostics.items().size(), 2u);
}

TEST(ExpressionDimensionTest, HugeExponentsDoNotOverflow) {
  Diagnostics diagnostics;
  parsed("((r^999)^999)^999").dimension(dimension_of, diagnostics);
  std::string towers = "r";
  for (int i = 0; i < 150; ++i) towers = "(" + towers + ")^30";
  parsed(towers).dimension(dimension_of, diagnostics);
  std::string product = "r^900";
  for (int i = 0; i < 2000; ++i) product += "*r^900";
  parsed(product).dimension(dimension_of, diagnostics);
  EXPECT_TRUE(diagnostics.has_errors());
}

}  // namespace
}  // namespace ferrers
