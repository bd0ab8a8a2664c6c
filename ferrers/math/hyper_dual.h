#pragma once

#include <Eigen/Core>
#include <cmath>
#include <compare>

namespace ferrers {

/// A number a + b ε₁ + c ε₂ + d ε₁ε₂ with ε₁² = ε₂² = 0, ε₁ε₂ ≠ 0: arithmetic on it carries two first derivatives and
/// the second one along, exact to rounding [fike2011]:
///
///     f(x + ε₁ u + ε₂ w) = f(x) + ε₁ ∇f·u + ε₂ ∇f·w + ε₁ε₂ uᵀ (∇²f) w
///
/// Given f as a template over its number type, with its functions called unqualified:
///
///     template <class T> T energy(const T& x, const T& y) { using std::sin; return x * sin(y); }
///     const HyperDual e = energy(HyperDual(2, 1, 0), HyperDual(3, 0, 1));  // e.b = ∂/∂x, e.c = ∂/∂y, e.d = ∂²/∂x∂y
///
/// Comparisons see the value only, so that a branch is differentiated as it was taken. At a kink `abs` takes the upper
/// side; where a derivative is unbounded (sqrt at 0) it is infinite or NaN. Cost: about four times that of f.
struct HyperDual {
  double a = 0;  ///< Value.
  double b = 0;  ///< Derivative along the first direction.
  double c = 0;  ///< Derivative along the second direction.
  double d = 0;  ///< Second derivative along both.

  constexpr HyperDual() = default;
  constexpr HyperDual(double value) : a(value) {}  // Implicit: constants are numbers
  constexpr HyperDual(double value, double first, double second, double both = 0)
      : a(value), b(first), c(second), d(both) {}

  bool is_constant() const { return b == 0 && c == 0 && d == 0; }

  HyperDual& operator+=(const HyperDual& o) { return *this = {a + o.a, b + o.b, c + o.c, d + o.d}; }
  HyperDual& operator-=(const HyperDual& o) { return *this = {a - o.a, b - o.b, c - o.c, d - o.d}; }
  HyperDual& operator*=(const HyperDual& o) {
    return *this = {a * o.a, a * o.b + b * o.a, a * o.c + c * o.a, a * o.d + b * o.c + c * o.b + d * o.a};
  }
  HyperDual& operator/=(const HyperDual& o) {
    const double q = a / o.a, qb = (b - q * o.b) / o.a, qc = (c - q * o.c) / o.a;
    return *this = {q, qb, qc, (d - qb * o.c - qc * o.b - q * o.d) / o.a};
  }
  friend HyperDual operator+(HyperDual x, const HyperDual& y) { return x += y; }
  friend HyperDual operator-(HyperDual x, const HyperDual& y) { return x -= y; }
  friend HyperDual operator*(HyperDual x, const HyperDual& y) { return x *= y; }
  friend HyperDual operator/(HyperDual x, const HyperDual& y) { return x /= y; }
  friend HyperDual operator+(const HyperDual& x) { return x; }
  friend HyperDual operator-(const HyperDual& x) { return {-x.a, -x.b, -x.c, -x.d}; }

  friend bool operator==(const HyperDual& x, const HyperDual& y) { return x.a == y.a; }
  friend std::partial_ordering operator<=>(const HyperDual& x, const HyperDual& y) { return x.a <=> y.a; }
};

/// f(x), where f, f' and f'' at the value of x are given: with it users add functions of their own.
inline HyperDual chain(const HyperDual& x, double f, double slope, double curvature) {
  return {f, slope * x.b, slope * x.c, slope * x.d + curvature * x.b * x.c};
}

/// The partial derivatives of a function of two numbers.
struct HyperDualPartials {
  double f, fx, fy, fxx, fxy, fyy;
};

inline HyperDual chain(const HyperDual& x, const HyperDual& y, const HyperDualPartials& p) {
  return {p.f, p.fx * x.b + p.fy * y.b, p.fx * x.c + p.fy * y.c,
          p.fx * x.d + p.fy * y.d + p.fxx * x.b * x.c + p.fxy * (x.b * y.c + y.b * x.c) + p.fyy * y.b * y.c};
}

inline HyperDual sin(const HyperDual& x) {
  const double s = std::sin(x.a), c = std::cos(x.a);
  return chain(x, s, c, -s);
}
inline HyperDual cos(const HyperDual& x) {
  const double s = std::sin(x.a), c = std::cos(x.a);
  return chain(x, c, -s, -c);
}
inline HyperDual tan(const HyperDual& x) {
  const double t = std::tan(x.a), slope = 1 + t * t;
  return chain(x, t, slope, 2 * t * slope);
}
inline HyperDual asin(const HyperDual& x) {
  const double square = (1 - x.a) * (1 + x.a), slope = 1 / std::sqrt(square);
  return chain(x, std::asin(x.a), slope, x.a * slope / square);
}
inline HyperDual acos(const HyperDual& x) {
  const double square = (1 - x.a) * (1 + x.a), slope = -1 / std::sqrt(square);
  return chain(x, std::acos(x.a), slope, x.a * slope / square);
}
inline HyperDual atan(const HyperDual& x) {
  const double slope = 1 / (1 + x.a * x.a);
  return chain(x, std::atan(x.a), slope, -2 * x.a * slope * slope);
}
inline HyperDual sinh(const HyperDual& x) {
  const double s = std::sinh(x.a);
  return chain(x, s, std::cosh(x.a), s);
}
inline HyperDual cosh(const HyperDual& x) {
  const double c = std::cosh(x.a);
  return chain(x, c, std::sinh(x.a), c);
}
inline HyperDual tanh(const HyperDual& x) {
  const double t = std::tanh(x.a), over = 1 / std::cosh(x.a), slope = over * over;
  return chain(x, t, slope, -2 * t * slope);
}
inline HyperDual exp(const HyperDual& x) {
  const double e = std::exp(x.a);
  return chain(x, e, e, e);
}
inline HyperDual log(const HyperDual& x) {
  const double slope = 1 / x.a;
  return chain(x, std::log(x.a), slope, -slope * slope);
}
inline HyperDual log10(const HyperDual& x) {
  constexpr double kLog10OfE = 0.43429448190325182765;
  const double slope = 1 / x.a;
  return chain(x, std::log10(x.a), kLog10OfE * slope, -kLog10OfE * slope * slope);
}
inline HyperDual sqrt(const HyperDual& x) {
  const double root = std::sqrt(x.a), slope = 0.5 / root;
  return chain(x, root, slope, -0.5 * slope / x.a);
}
inline HyperDual abs(const HyperDual& x) { return x.a < 0 ? -x : x; }
inline HyperDual fabs(const HyperDual& x) { return abs(x); }

inline HyperDual atan2(const HyperDual& y, const HyperDual& x) {
  const double square = x.a * x.a + y.a * y.a, u = x.a / square, w = y.a / square;
  return chain(y, x, {std::atan2(y.a, x.a), u, -w, -2 * u * w, w * w - u * u, 2 * u * w});
}
inline HyperDual hypot(const HyperDual& x, const HyperDual& y) {
  const double h = std::hypot(x.a, y.a), u = x.a / h, w = y.a / h;
  return chain(x, y, {h, u, w, w * w / h, -u * w / h, u * u / h});
}

inline HyperDual pow(const HyperDual& x, const HyperDual& y) {
  const double n = y.a, f = std::pow(x.a, n);
  const auto lower = [&](double factor, int less) { return factor == 0 ? 0 : factor * std::pow(x.a, n - less); };
  const double fx = lower(n, 1), fxx = lower(n * (n - 1), 2);
  if (y.is_constant()) return chain(x, f, fx, fxx);
  const double l = std::log(x.a);
  if (x.is_constant()) return chain(y, f, l * f, l * l * f);
  return chain(x, y, {f, fx, l * f, fxx, lower(1 + n * l, 1), l * l * f});
}
inline HyperDual pow(const HyperDual& x, double y) { return pow(x, HyperDual(y)); }
inline HyperDual pow(double x, const HyperDual& y) { return pow(HyperDual(x), y); }

}  // namespace ferrers

/// Eigen's matrices of hyper-dual numbers.
template <>
struct Eigen::NumTraits<ferrers::HyperDual> : NumTraits<double> {
  using Real = ferrers::HyperDual;
  using NonInteger = ferrers::HyperDual;
  using Nested = ferrers::HyperDual;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = 4,
    AddCost = 4,
    MulCost = 9
  };
};
