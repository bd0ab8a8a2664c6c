#include "ferrers/core/units.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>

namespace ferrers {
namespace {

void expect_unit(std::string_view text, double si, Dimension dimension) {
  const std::optional<Unit> unit = parse_unit(text);
  ASSERT_TRUE(unit) << text;
  EXPECT_DOUBLE_EQ(unit->si, si) << text;
  EXPECT_EQ(unit->dimension, dimension) << text << ": " << to_string(unit->dimension);
}

TEST(UnitsTest, BaseAndDerivedUnitsHaveTheirSiValues) {
  expect_unit("m", 1, kLength);
  expect_unit("kg", 1, kMass);
  expect_unit("g", 1e-3, kMass);
  expect_unit("s", 1, kTime);
  expect_unit("min", 60, kTime);
  expect_unit("in", 0.0254, kLength);
  expect_unit("lbf", 4.4482216152605, kForce);
  expect_unit("MPa", 1e6, {-1, 1, -2});
  expect_unit("kW", 1e3, {2, 1, -3});
  expect_unit("µm", 1e-6, kLength);
  expect_unit("tonne", 1e3, kMass);
}

TEST(UnitsTest, AnglesArePureNumbers) {
  expect_unit("rad", 1, kPureNumber);
  expect_unit("deg", M_PI / 180, kPureNumber);
  expect_unit("°", M_PI / 180, kPureNumber);
  expect_unit("rev", 2 * M_PI, kPureNumber);
  expect_unit("rpm", 2 * M_PI / 60, kAngularVelocity);
}

TEST(UnitsTest, MillimetresTimesNewtonsAreTorques) { expect_unit("N*mm", 1e-3, kTorque); }

TEST(UnitsTest, CompoundUnitsWorkFromLeftToRight) {
  expect_unit("N/m", 1, kStiffness);
  expect_unit("N*s/m", 1, kDamping);
  expect_unit("N/m*s", 1, kDamping);
  expect_unit("N/m/s", 1, {0, 1, -3});
  expect_unit("kg*m^2", 1, kInertia);
  expect_unit("kg·mm²", 1e-6, kInertia);
  expect_unit("mm/s²", 1e-3, kAcceleration);
  expect_unit("s^-1", 1, kAngularVelocity);
  expect_unit("s⁻¹", 1, kAngularVelocity);
  expect_unit("1/s", 1, kAngularVelocity);
  expect_unit(" N * m / rad ", 1, kTorque);
}

TEST(UnitsTest, PowersOfTenAreExact) {
  EXPECT_EQ(parse_unit("mm^2")->si, 1e-6);
  EXPECT_EQ(parse_unit("kg*mm^2")->si, 1e-6);
  EXPECT_EQ(parse_unit("um*um*um")->si, 1e-18);
  EXPECT_EQ(to_si(0.7, *parse_unit("mm^2")), 7e-7);
  EXPECT_EQ(to_si(1.1, *parse_unit("mm")), 0.0011);
  EXPECT_EQ(to_si(5, *parse_unit("in")), 0.127);
  EXPECT_EQ(to_si(3, *parse_unit("km")), 3000.0);
}

TEST(UnitsTest, WhatIsNoUnitIsRefused) {
  for (const char* text :
       {"",    " ",  "x",     "M",   "mm2",  "m^",   "m^-", "m^^2",  "m**2", "N m", "N*", "/s",    "1",
        "2/s", "1/", "m^2.5", "kkg", "mmin", "kdeg", "Hz",  "m^100", "mm)",  "⁻",   "m⁻", "Tm^40", "pm^99"}) {
    EXPECT_FALSE(parse_unit(text)) << text;
  }
  EXPECT_FALSE(parse_unit(std::string("m\0", 2)));
}

TEST(UnitsTest, DimensionsSpeakTheFieldsWords) {
  EXPECT_EQ(to_string(kPureNumber), "a pure number");
  EXPECT_EQ(to_string(kStiffness), "N/m");
  EXPECT_EQ(to_string(kTorque), "N*m");
  EXPECT_EQ(to_string(kInertia), "kg*m^2");
  EXPECT_EQ(to_string(kAcceleration), "m/s^2");
  EXPECT_EQ(to_string(kAngularVelocity), "1/s");
  EXPECT_EQ(to_string(Dimension{-2, 0, -1}), "1/m^2/s");
}

RC_GTEST_PROP(UnitsTest, WordsOfADimensionReadBackAsIt, ()) {
  const auto exponent = rc::gen::inRange(-9, 10);
  const Dimension dimension{*exponent, *exponent, *exponent};
  RC_PRE(dimension != kPureNumber);
  const std::optional<Unit> unit = parse_unit(to_string(dimension));
  RC_ASSERT(unit.has_value());
  RC_ASSERT(unit->dimension == dimension);
  RC_ASSERT(unit->si == 1.0);
}

RC_GTEST_PROP(UnitsTest, NoTextBreaksTheReader, (const std::string& text)) {
  const std::optional<Unit> unit = parse_unit(text);
  RC_ASSERT(!unit || std::isnormal(unit->si));
}

}  // namespace
}  // namespace ferrers
