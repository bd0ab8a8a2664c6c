// Ten thousand random formulas of three variables against two witnesses that share nothing with them but their meaning:
// every formula is put together twice, as a text for the parser and as a function of hyper-dual numbers.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <string>

#include "ferrers/math/expression.h"
#include "ferrers/math/hyper_dual.h"
#include "ferrers/testing/random_formula.h"
#include "ferrers/testing/random_source.h"

namespace ferrers {
namespace {

using expression_testing::parsed;
using witness::RandomSource;

constexpr int kVariables = 3;
const char* const kNames[kVariables] = {"x", "y", "z"};
const char* const kRates[kVariables] = {"vx", "vy", "vz"};

/// What happens inside a formula while it is evaluated.
struct Course {
  double largest = 0;         ///< The largest part of any number met.
  double to_kink = HUGE_VAL;  ///< How near an argument came to a place where the formula bends or jumps.
  std::size_t sides = 0;      ///< A number for all the sides on which it was.
  std::array<HyperDual, kVariables> variables;

  HyperDual seen(const HyperDual& value) {
    for (const double part : {value.a, value.b, value.c, value.d}) {
      largest = std::isfinite(part) ? std::max(largest, std::abs(part)) : HUGE_VAL;
    }
    return value;
  }
  /// A place where the formula bends or jumps, so far away, and on which side of it one is.
  void bends_at(double distance, double side) {
    to_kink = std::min(to_kink, std::abs(distance));
    sides = (sides ^ std::hash<double>()(side)) * 0x9e3779b97f4a7c15u;
  }
  void bends_at(double distance) { bends_at(distance, distance > 0 ? 1 : -1); }
};

using Function = std::function<HyperDual(Course&)>;

struct Formula {
  std::string text;
  Function function;
};

HyperDual step(Course& at, const HyperDual& x, bool smoother) {
  at.bends_at(x.a);
  at.bends_at(x.a - 1);
  if (x <= 0) return 0;
  if (x >= 1) return 1;
  return smoother ? x * x * x * (10.0 + x * (6.0 * x - 15.0)) : x * x * (3.0 - 2.0 * x);
}

HyperDual rounded_down(Course& at, const HyperDual& x) {
  at.bends_at(x.a - std::round(x.a), std::floor(x.a));
  return std::floor(x.a);
}

class FormulaSource {
 public:
  explicit FormulaSource(std::uint64_t seed) : random_(seed) {}

  Formula next(int depth) {
    if (depth == 0 || random_.chance(0.08)) return leaf();
    switch (random_.below(10)) {
      case 0:
      case 1:
      case 2:
        return sum_or_product(next(depth - 1), next(depth - 1));
      case 3:
      case 4:
      case 5:
        return function_of_one(next(depth - 1));
      case 6:
        return function_of_two(next(depth - 1), next(depth - 1));
      case 7:
        return whole_power(next(depth - 1));
      case 8:
        return wrap("-(", next(depth - 1), ")", [](Course&, const HyperDual& u) { return -u; });
      default:
        return choice(next(depth - 1), next(depth - 1), next(depth - 1), next(depth - 1));
    }
  }

  RandomSource& random() { return random_; }

 private:
  using Unary = HyperDual (*)(Course&, const HyperDual&);
  using Binary = HyperDual (*)(Course&, const HyperDual&, const HyperDual&);

  static Formula wrap(const std::string& head, Formula u, const std::string& tail, Unary f) {
    return {head + u.text + tail, [f, g = std::move(u.function)](Course& at) { return at.seen(f(at, g(at))); }};
  }
  static Formula join(const std::string& head, Formula u, const std::string& middle, Formula w, Binary f) {
    return {head + u.text + middle + w.text + ")",
            [f, g = std::move(u.function), h = std::move(w.function)](Course& at) {
              const HyperDual first = g(at);
              return at.seen(f(at, first, h(at)));
            }};
  }

  Formula leaf() {
    const int pick = random_.below(5);
    if (pick < kVariables) {
      return {kNames[pick], [pick](Course& at) { return at.variables[static_cast<std::size_t>(pick)]; }};
    }
    const double number = 0.25 * (1 + random_.below(14));
    return {std::to_string(number), [number](Course&) { return HyperDual(number); }};
  }

  Formula sum_or_product(Formula u, Formula w) {
    switch (random_.below(4)) {
      case 0:
        return join("(", u, " + ", w, [](Course&, const HyperDual& a, const HyperDual& b) { return a + b; });
      case 1:
        return join("(", u, " - ", w, [](Course&, const HyperDual& a, const HyperDual& b) { return a - b; });
      case 2:
        return join("(", u, "*", w, [](Course&, const HyperDual& a, const HyperDual& b) { return a * b; });
      default:
        return join("(", u, "/", w, [](Course&, const HyperDual& a, const HyperDual& b) { return a / b; });
    }
  }

  Formula function_of_one(Formula u) {
    static const std::pair<const char*, Unary> kFunctions[] = {
        {"sin", [](Course&, const HyperDual& a) { return sin(a); }},
        {"cos", [](Course&, const HyperDual& a) { return cos(a); }},
        {"tan", [](Course&, const HyperDual& a) { return tan(a); }},
        {"asin", [](Course&, const HyperDual& a) { return asin(a); }},
        {"acos", [](Course&, const HyperDual& a) { return acos(a); }},
        {"atan", [](Course&, const HyperDual& a) { return atan(a); }},
        {"sinh", [](Course&, const HyperDual& a) { return sinh(a); }},
        {"cosh", [](Course&, const HyperDual& a) { return cosh(a); }},
        {"tanh", [](Course&, const HyperDual& a) { return tanh(a); }},
        {"exp", [](Course&, const HyperDual& a) { return exp(a); }},
        {"log", [](Course&, const HyperDual& a) { return log(a); }},
        {"log10", [](Course&, const HyperDual& a) { return log10(a); }},
        {"sqrt", [](Course&, const HyperDual& a) { return sqrt(a); }},
        {"abs",
         [](Course& at, const HyperDual& a) {
           at.bends_at(a.a);
           return abs(a);
         }},
        {"sign",
         [](Course& at, const HyperDual& a) {
           at.bends_at(a.a);
           return HyperDual(a > 0 ? 1 : a < 0 ? -1 : a.a);
         }},
        {"floor", rounded_down},
        {"smoothstep", [](Course& at, const HyperDual& a) { return step(at, a, false); }},
        {"smootherstep", [](Course& at, const HyperDual& a) { return step(at, a, true); }},
    };
    const auto& [name, f] = kFunctions[random_.below(static_cast<int>(std::size(kFunctions)))];
    return wrap(std::string(name) + "(", std::move(u), ")", f);
  }

  Formula function_of_two(Formula u, Formula w) {
    static const std::pair<const char*, Binary> kFunctions[] = {
        {"atan2", [](Course&, const HyperDual& a, const HyperDual& b) { return atan2(a, b); }},
        {"hypot", [](Course&, const HyperDual& a, const HyperDual& b) { return hypot(a, b); }},
        {"pow", [](Course&, const HyperDual& a, const HyperDual& b) { return pow(a, b); }},
        {"mod", [](Course& at, const HyperDual& a, const HyperDual& b) { return a - b * rounded_down(at, a / b); }},
        {"min",
         [](Course& at, const HyperDual& a, const HyperDual& b) {
           at.bends_at(a.a - b.a);
           return b < a ? b : a;
         }},
        {"max",
         [](Course& at, const HyperDual& a, const HyperDual& b) {
           at.bends_at(a.a - b.a);
           return b > a ? b : a;
         }},
    };
    const auto& [name, f] = kFunctions[random_.below(static_cast<int>(std::size(kFunctions)))];
    return join(std::string(name) + "(", std::move(u), ", ", std::move(w), f);
  }

  Formula whole_power(Formula u) {
    const int exponent = random_.below(8) - 2;
    return {"((" + u.text + ")^" + std::to_string(exponent) + ")",
            [exponent, g = std::move(u.function)](Course& at) { return at.seen(pow(g(at), exponent)); }};
  }

  Formula choice(Formula a, Formula b, Formula u, Formula w) {
    const bool less = random_.chance(0.5);
    return {"if(" + a.text + (less ? " < " : " >= ") + b.text + ", " + u.text + ", " + w.text + ")",
            [less, left = std::move(a.function), right = std::move(b.function), yes = std::move(u.function),
             no = std::move(w.function)](Course& at) {
              const HyperDual p = left(at), q = right(at);
              at.bends_at(p.a - q.a);
              if (!(std::isfinite(p.a) && std::isfinite(q.a))) at.seen(NAN);
              return (p < q) == less ? yes(at) : no(at);
            }};
  }

  RandomSource random_;
};

using Point = std::array<double, kVariables>;

/// The formula with ε₁ along `u`, ε₂ along `w`.
HyperDual parts(const Formula& formula, const Point& at, const Point& u, const Point& w, Course& course) {
  for (std::size_t i = 0; i < kVariables; ++i) course.variables[i] = HyperDual(at[i], u[i], w[i]);
  return course.seen(formula.function(course));
}

Point axis(std::size_t i) {
  Point unit{};
  unit[i] = 1;
  return unit;
}

/// All that is compared: value, gradient, Hessian row by row, and the first and second rate along `v`.
struct Jet {
  double value = 0;
  Point gradient{};
  std::array<double, kVariables * kVariables> hessian{};
  double rate = 0, second_rate = 0;

  std::vector<double> numbers() const {
    std::vector<double> all{value, value};
    all.insert(all.end(), gradient.begin(), gradient.end());
    all.insert(all.end(), hessian.begin(), hessian.end());
    all.insert(all.end(), {rate, second_rate});
    return all;
  }
};

Jet hyper_dual_jet(const Formula& formula, const Point& at, const Point& v, Course& course) {
  Jet jet;
  for (std::size_t i = 0; i < kVariables; ++i) {
    for (std::size_t j = i; j < kVariables; ++j) {
      const HyperDual p = parts(formula, at, axis(i), axis(j), course);
      jet.value = p.a;
      jet.gradient[i] = p.b;
      jet.gradient[j] = p.c;
      jet.hessian[kVariables * i + j] = jet.hessian[kVariables * j + i] = p.d;
    }
  }
  const HyperDual along = parts(formula, at, v, v, course);
  jet.rate = along.b;
  jet.second_rate = along.d;
  return jet;
}

/// The same outputs as formulas.
std::vector<Expression> exact_jet(const Expression& e) {
  std::vector<Expression> outputs{e, e.simplified()};
  for (const char* name : kNames) outputs.push_back(e.derivative(name));
  for (std::size_t i = 0; i < kVariables; ++i) {
    for (const char* name : kNames) outputs.push_back(outputs[2 + i].derivative(name));
  }
  const auto rate_of = [](std::string_view name) -> std::optional<Expression> {
    for (int i = 0; i < kVariables; ++i) {
      if (name == kNames[i]) return Expression::variable(kRates[i]);
    }
    return std::nullopt;
  };
  outputs.push_back(e.rate(rate_of));
  outputs.push_back(outputs.back().rate(rate_of));
  return outputs;
}

struct Difference {
  double value = 0, error = 0;
};

/// Takes errors in even powers of the step away, from three steps each half of the one before.
template <class Quotient>
Difference extrapolated(double h, Quotient quotient) {
  const double coarse = quotient(h), middle = quotient(h / 2), fine = quotient(h / 4);
  const double first = (4 * middle - coarse) / 3, second = (4 * fine - middle) / 3, third = (16 * second - first) / 15;
  return {third, std::abs(third - second) + 1e-3 * std::abs(second - first)};
}

/// First derivative along `u` (h small against every scale of the formulas drawn), second along `u` and `w`.
Difference first_difference(const std::function<double(const Point&)>& f, const Point& at, const Point& u) {
  const auto moved = [&](double s) {
    Point p = at;
    for (std::size_t i = 0; i < kVariables; ++i) p[i] += s * u[i];
    return f(p);
  };
  return extrapolated(4e-3, [&](double h) { return (moved(h) - moved(-h)) / (2 * h); });
}

Difference second_difference(const std::function<double(const Point&)>& f, const Point& at, const Point& u,
                             const Point& w) {
  const auto moved = [&](double s, double t) {
    Point p = at;
    for (std::size_t i = 0; i < kVariables; ++i) p[i] += s * u[i] + t * w[i];
    return f(p);
  };
  return extrapolated(
      1e-2, [&](double h) { return (moved(h, h) - moved(h, -h) - moved(-h, h) + moved(-h, -h)) / (4 * h * h); });
}

class ExpressionWitnessTest : public testing::Test {
 protected:
  static constexpr int kFormulas = 10000;
  static constexpr int kDepth = 4;
  static constexpr double kWild = 1e5;     ///< Beyond it a formula amplifies its roundings too much to be compared.
  static constexpr double kAtKink = 1e-9;  ///< Nearer than that, roundings decide on which side one is.

  struct Case {
    Formula formula;
    Point at, v;
    Course course;
    Jet jet;
  };

  /// The next formula at a point where it is finite, tame and smooth; counts what it passes over.
  Case next() {
    while (true) {
      Case c{source_.next(kDepth), {}, {}, {}, {}};
      for (double& value : c.at) value = source_.random().between(-2, 2);
      for (double& value : c.v) value = source_.random().between(-1, 1);
      c.jet = hyper_dual_jet(c.formula, c.at, c.v, c.course);
      ++drawn_;
      if (!std::isfinite(c.course.largest)) {
        ++skipped_["not finite"];
      } else if (c.course.largest > kWild) {
        ++skipped_["wild"];
      } else if (c.course.to_kink < kAtKink) {
        ++skipped_["at a kink"];
      } else {
        return c;
      }
    }
  }

  void expect_few_skipped(double share) {
    int all = 0;
    for (const auto& [reason, count] : skipped_) {
      all += count;
      RecordProperty(reason, count);
      std::printf("  passed over, %s: %d of %d\n", reason.c_str(), count, drawn_);
    }
    EXPECT_LE(all, share * drawn_);
  }

  FormulaSource source_{20240611};
  std::map<std::string, int> skipped_;
  int drawn_ = 0;
};

TEST_F(ExpressionWitnessTest, ValuesAndDerivativesAreThoseOfHyperDualNumbers) {
  const std::vector<std::string> inputs{"x", "y", "z", "vx", "vy", "vz"};
  double worst = 0;
  for (int k = 0; k < kFormulas; ++k) {
    const Case c = next();
    const ExpressionProgram program(exact_jet(parsed(c.formula.text)), inputs);
    const double values[] = {c.at[0], c.at[1], c.at[2], c.v[0], c.v[1], c.v[2]};
    std::vector<double> got(static_cast<std::size_t>(program.output_count()));
    program.evaluate(values, got.data());
    const std::vector<double> wanted = c.jet.numbers();
    ASSERT_EQ(got.size(), wanted.size());
    for (std::size_t i = 0; i < got.size(); ++i) {
      const double error = std::abs(got[i] - wanted[i]) / (1 + c.course.largest);
      ASSERT_LE(error, 1e-11) << c.formula.text << "\n at " << c.at[0] << " " << c.at[1] << " " << c.at[2]
                              << ", output " << i << ": " << got[i] << ", witness " << wanted[i];
      worst = std::max(worst, error);
    }
  }
  std::printf("  largest difference: %.2g\n", worst);
  expect_few_skipped(0.4);
}

TEST_F(ExpressionWitnessTest, DerivativesAgreeWithDifferencesOfTheWitness) {
  const std::vector<std::string> inputs{"x", "y", "z", "vx", "vy", "vz"};
  for (int k = 0; k < kFormulas; ++k) {
    const Case c = next();
    Course here;
    parts(c.formula, c.at, {}, {}, here);
    const std::function<double(const Point&)> f = [&, sides = here.sides](const Point& p) {
      Course course;
      const double value = parts(c.formula, p, {}, {}, course).a;
      return std::isfinite(course.largest) && course.sides == sides ? value : NAN;
    };
    const ExpressionProgram program(exact_jet(parsed(c.formula.text)), inputs);
    const double values[] = {c.at[0], c.at[1], c.at[2], c.v[0], c.v[1], c.v[2]};
    std::vector<double> got(static_cast<std::size_t>(program.output_count()));
    program.evaluate(values, got.data());
    const auto check = [&](std::size_t output, const Difference& difference, double tolerance) {
      // A pole or a scale within reach of the step betrays itself by steps that contradict each other.
      if (std::isnan(difference.value)) {
        ++skipped_["a kink or no value within a step"];
      } else if (!(difference.error <= tolerance * (1 + std::abs(difference.value)))) {
        ++skipped_["rough within a step"];
      } else {
        EXPECT_NEAR(got[output], difference.value, 30 * tolerance * (1 + std::abs(difference.value)))
            << c.formula.text << "\n at " << c.at[0] << " " << c.at[1] << " " << c.at[2] << ", output " << output;
      }
      ++drawn_;
    };
    for (std::size_t i = 0; i < kVariables; ++i) {
      check(2 + i, first_difference(f, c.at, axis(i)), 1e-6);
      for (std::size_t j = 0; j < kVariables; ++j) {
        check(5 + kVariables * i + j, second_difference(f, c.at, axis(i), axis(j)), 1e-4);
      }
    }
    check(14, first_difference(f, c.at, c.v), 1e-6);
    check(15, second_difference(f, c.at, c.v, c.v), 1e-4);
    if (HasFailure()) return;
  }
  expect_few_skipped(0.06);
}

}  // namespace
}  // namespace ferrers
