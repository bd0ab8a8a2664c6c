#include "ferrers/model/relation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "ferrers/testing/build_checks.h"
#include "ferrers/testing/finite_difference.h"

namespace ferrers {
namespace {

using namespace witness;  // NOLINT(google-build-using-namespace): a test's vocabulary

FormulaScalars two_scalars() {
  FormulaScalars scalars;
  scalars.scalars = {StateScalar{{JointId(0), 0}}, StateScalar{{JointId(1), 0}}};
  scalars.values = {"x", "y"};
  scalars.rates = {"x.velocity", "y.velocity"};
  return scalars;
}

Expression parsed(const std::string& text) { return *formula(text).expression; }

/// A motion: x = sin 2t, y = 1 + t²; with its rates and accelerations.
std::map<std::string, double> motion(double t) {
  return {
      {"x", std::sin(2 * t)}, {"y", 1 + t * t}, {"x.velocity", 2 * std::cos(2 * t)}, {"y.velocity", 2 * t}, {"t", t}};
}
constexpr double kYAcceleration = 2;
double x_acceleration(double t) { return -4 * std::sin(2 * t); }

double value(const Expression& e, double t) {
  const std::map<std::string, double> at = motion(t);
  std::vector<std::string> names;
  std::vector<double> values;
  for (const auto& [name, number] : at) {
    names.push_back(name);
    values.push_back(number);
  }
  const ExpressionProgram program(std::vector<Expression>{e}, names);
  double out = 0;
  program.evaluate(values.data(), &out);
  return out;
}

TEST(RelationTest, RatesAndAccelerationsAreThoseAlongAMotion) {
  const Relation relation = make_relation(parsed("x^2*sin(y) + exp(x)*t - y*t^2"), two_scalars());
  ASSERT_FALSE(relation.on_velocities);
  const double t = 0.4;
  const auto phi = [&](double s) { return value(relation.residual, s); };
  const auto rate = [&](double s) {
    const auto at = motion(s);
    return value(relation.gradient[0], s) * at.at("x.velocity") + value(relation.gradient[1], s) * at.at("y.velocity") +
           value(relation.offset, s);
  };
  EXPECT_NEAR(rate(t), differentiate(phi, t, 3e-3), 1e-10);
  const double acceleration = value(relation.gradient[0], t) * x_acceleration(t) +
                              value(relation.gradient[1], t) * kYAcceleration + value(relation.bias, t);
  EXPECT_NEAR(acceleration, differentiate(rate, t, 3e-3), 1e-9);
}

TEST(RelationTest, ARelationOnVelocitiesKeepsItsOffsetAndHasItsBias) {
  const auto relation = make_velocity_relation(parsed("sin(y)*x.velocity - x*y*y.velocity + 3*t*x"), two_scalars());
  ASSERT_TRUE(relation.has_value());
  ASSERT_TRUE(relation->on_velocities);
  const double t = 0.7;
  const auto at = motion(t);
  EXPECT_NEAR(value(relation->gradient[0], t), std::sin(at.at("y")), 1e-15);
  EXPECT_NEAR(value(relation->gradient[1], t), -at.at("x") * at.at("y"), 1e-15);
  EXPECT_NEAR(value(relation->offset, t), 3 * t * at.at("x"), 1e-15);
  const auto rate = [](double s) { return value(parsed("sin(y)*x.velocity - x*y*y.velocity + 3*t*x"), s); };
  const double acceleration = value(relation->gradient[0], t) * x_acceleration(t) +
                              value(relation->gradient[1], t) * kYAcceleration + value(relation->bias, t);
  EXPECT_NEAR(acceleration, differentiate(rate, t, 3e-3), 1e-9);
}

TEST(RelationTest, WhatIsNotLinearInVelocitiesIsNoRelationOnThem) {
  EXPECT_FALSE(make_velocity_relation(parsed("x.velocity^2 - y"), two_scalars()));
  EXPECT_FALSE(make_velocity_relation(parsed("x.velocity*y.velocity"), two_scalars()));
  EXPECT_FALSE(make_velocity_relation(parsed("sin(x.velocity)"), two_scalars()));
  EXPECT_TRUE(make_velocity_relation(parsed("x^3*x.velocity + 2*y.velocity"), two_scalars()));
}

TEST(RelationTest, LagrangesEquationsAreMassTimesAccelerationAndBias) {
  // T with a term that is linear in the rates and one that knows time.
  const Expression T =
      parsed("(2 + cos(x))*x.velocity^2/2 + x*x.velocity*y.velocity + (1 + t^2)*y.velocity^2 + y*x.velocity");
  const Expression V = parsed("x^2*y + 3*sin(y)"), R = parsed("0.3*x.velocity^2");
  const Lagrangian made = make_lagrangian(T, V, R, {parsed("2*t"), Expression()}, two_scalars());
  const double t = 0.3;
  const double accelerations[] = {x_acceleration(t), kYAcceleration};
  double given[] = {0, 0};
  for (const Lagrangian::MassEntry& entry : made.mass) {
    given[entry.row] += value(entry.value, t) * accelerations[entry.column];
    if (entry.row != entry.column) given[entry.column] += value(entry.value, t) * accelerations[entry.row];
  }
  const char* names[] = {"x", "y"};
  for (int k = 0; k < 2; ++k) {
    const Expression momentum = T.derivative(std::string(names[k]) + ".velocity");
    const double wanted = differentiate([&](double s) { return value(momentum, s); }, t) -
                          value(T.derivative(names[k]), t) + value(V.derivative(names[k]), t);
    EXPECT_NEAR(given[k] + value(made.bias[k], t), wanted, 1e-9) << names[k];
  }
  EXPECT_NEAR(value(made.force[0], t), 2 * t - 0.6 * motion(t).at("x.velocity"), 1e-14);
  EXPECT_TRUE(made.has_forces());
}

}  // namespace
}  // namespace ferrers
