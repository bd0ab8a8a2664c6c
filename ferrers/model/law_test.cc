#include "ferrers/model/law.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace ferrers {
namespace {

Expression parsed(const std::string& text) {
  Diagnostics diagnostics;
  const std::optional<Expression> expression = Expression::parse(text, {}, diagnostics);
  EXPECT_TRUE(expression.has_value()) << text;
  return expression.value_or(Expression());
}

Law law_of_time(const std::string& text) { return Law(parsed(text), {"t"}, {LawInput{}}); }

LawInput input(LawInput::Kind kind, int joint) { return {kind, {JointId(joint), 0}}; }

std::vector<double> grid(int intervals) {
  std::vector<double> times;
  for (int i = 0; i <= intervals; ++i) times.push_back(2.0 * i / intervals);
  return times;
}

Law sine_samples(int intervals) {
  std::vector<double> values;
  for (const double t : grid(intervals)) values.push_back(std::sin(M_PI * t));
  return Law::sampled(grid(intervals), values);
}

TEST(LawTest, DefaultIsZeroWithoutInputs) {
  const Law law;
  EXPECT_EQ(law.value(nullptr), 0.0);
  EXPECT_TRUE(law.inputs().empty());
  EXPECT_EQ(law.motion(3.0).acceleration, 0.0);
}

TEST(LawTest, MotionHasTheExactDerivatives) {
  const Law law = law_of_time("2*t^3 + sin(3*t)");
  const Law::Motion m = law.motion(0.7);
  EXPECT_NEAR(m.value, 2 * 0.343 + std::sin(2.1), 1e-14);
  EXPECT_NEAR(m.rate, 6 * 0.49 + 3 * std::cos(2.1), 1e-13);
  EXPECT_NEAR(m.acceleration, 12 * 0.7 - 9 * std::sin(2.1), 1e-13);
  EXPECT_TRUE(law.only_time());
}

TEST(LawTest, ConstantFormulaNeedsNoInputs) {
  const Law law(parsed("3*4"), {}, {});
  EXPECT_EQ(law.value(nullptr), 12.0);
  EXPECT_EQ(law.motion(1.0).value, 12.0);
  EXPECT_EQ(law.motion(1.0).rate, 0.0);
}

TEST(LawTest, ReadsItsInputsInTheirOrder) {
  using Kind = LawInput::Kind;
  const std::vector<LawInput> inputs = {input(Kind::kVelocity, 2), LawInput{}, input(Kind::kPosition, 1)};
  const Law law(parsed("10*a.position + 100*t + b.velocity"), {"b.velocity", "t", "a.position"}, inputs);
  const double values[3] = {1.0, 2.0, 3.0};
  EXPECT_EQ(law.value(values), 30.0 + 200.0 + 1.0);
  EXPECT_EQ(law.inputs(), inputs);
  EXPECT_FALSE(law.only_time());
}

TEST(LawTest, LawOfCoordinatesHasNoMotionOfItsOwn) {
  const Law law(parsed("a.position"), {"a.position"}, {input(LawInput::Kind::kPosition, 0)});
  EXPECT_THROW(law.motion(0.0), std::invalid_argument);
}

TEST(LawTest, NamesAndInputsMustMatch) {
  EXPECT_THROW(Law(parsed("t"), {"t"}, {}), std::invalid_argument);
  EXPECT_THROW(Law(parsed("t + u"), {"t"}, {LawInput{}}), std::invalid_argument);
}

TEST(SampledLawTest, PassesThroughItsSamples) {
  const std::vector<double> times = {0.0, 0.5, 0.6, 2.0}, values = {1.0, -2.0, 5.0, 0.25};
  const Law law = Law::sampled(times, values);
  for (std::size_t k = 0; k < times.size(); ++k) {
    EXPECT_NEAR(law.motion(times[k]).value, values[k], 1e-14);
    EXPECT_NEAR(law.value(&times[k]), values[k], 1e-14);
  }
}

TEST(SampledLawTest, IsTwiceContinuouslyDifferentiableAtItsKnots) {
  const Law law = Law::sampled({0.0, 0.5, 0.6, 2.0}, {1.0, -2.0, 5.0, 0.25});
  for (const double knot : {0.0, 0.5, 0.6, 2.0}) {
    const Law::Motion left = law.motion(knot - 1e-9), right = law.motion(knot + 1e-9);
    EXPECT_NEAR(left.value, right.value, 1e-6);
    EXPECT_NEAR(left.rate, right.rate, 1e-4);
    EXPECT_NEAR(left.acceleration, right.acceleration, 1e-3);
  }
  EXPECT_NEAR(law.motion(0.0).acceleration, 0.0, 1e-12);
  EXPECT_NEAR(law.motion(2.0).acceleration, 0.0, 1e-12);
}

TEST(SampledLawTest, RateAndAccelerationAreTheDerivativesOfTheValue) {
  const Law law = Law::sampled({0.0, 0.5, 0.6, 2.0}, {1.0, -2.0, 5.0, 0.25});
  for (const double t : {-0.4, 0.2, 0.55, 1.1, 1.9, 2.7}) {
    const double h = 1e-5;
    EXPECT_NEAR(law.motion(t).rate, (law.motion(t + h).value - law.motion(t - h).value) / (2 * h), 1e-5) << t;
    EXPECT_NEAR(law.motion(t).acceleration, (law.motion(t + h).rate - law.motion(t - h).rate) / (2 * h), 1e-5) << t;
  }
}

TEST(SampledLawTest, ContinuesAlongItsEndTangents) {
  const Law law = Law::sampled({0.0, 1.0, 2.0}, {0.0, 1.0, 0.0});
  EXPECT_EQ(law.motion(3.0).rate, law.motion(5.0).rate);
  EXPECT_EQ(law.motion(3.0).acceleration, 0.0);
  EXPECT_NEAR(law.motion(-1.0).value, -law.motion(0.0).rate, 1e-14);
}

TEST(SampledLawTest, TwoSamplesAreAStraightLine) {
  const Law law = Law::sampled({1.0, 3.0}, {2.0, 6.0});
  EXPECT_NEAR(law.motion(2.0).value, 4.0, 1e-15);
  EXPECT_NEAR(law.motion(10.0).value, 20.0, 1e-14);
  EXPECT_EQ(law.motion(2.0).rate, 2.0);
}

TEST(SampledLawTest, ErrorFallsWithTheFourthPowerOfTheSpacing) {
  // sin(πt) on [0, 2] has vanishing second derivatives at both ends, so the natural spline is of full order.
  const auto error = [](int intervals) {
    const Law law = sine_samples(intervals);
    double largest = 0;
    for (int i = 0; i <= 1000; ++i) {
      const double t = 0.002 * i;
      largest = std::max(largest, std::abs(law.motion(t).value - std::sin(M_PI * t)));
    }
    return largest;
  };
  EXPECT_NEAR(std::log2(error(40) / error(80)), 4.0, 0.2);
}

TEST(SampledLawTest, RefusesWhatIsNoFunctionOfTime) {
  EXPECT_THROW(Law::sampled({0.0}, {1.0}), std::invalid_argument);
  EXPECT_THROW(Law::sampled({0.0, 1.0}, {1.0}), std::invalid_argument);
  EXPECT_THROW(Law::sampled({0.0, 0.0}, {1.0, 2.0}), std::invalid_argument);
  EXPECT_THROW(Law::sampled({0.0, NAN}, {1.0, 2.0}), std::invalid_argument);
}

}  // namespace
}  // namespace ferrers
