#pragma once

#include <Eigen/Core>
#include <cmath>

namespace ferrers::witness {

/// A number a + ε b with ε² = 0: arithmetic on it carries one exact derivative along.
///
/// The witnesses differentiate their constraint rows along a motion with it, so that their gamma shares neither a
/// formula nor a step size with the engine. Only what the rows need is defined.
struct Dual {
  double a = 0;  ///< Value.
  double b = 0;  ///< Derivative.

  Dual() = default;
  Dual(double value) : a(value) {}  // Implicit: constants are written as numbers
  Dual(double value, double derivative) : a(value), b(derivative) {}

  Dual& operator+=(const Dual& o) { return *this = {a + o.a, b + o.b}; }
  Dual& operator-=(const Dual& o) { return *this = {a - o.a, b - o.b}; }
  Dual& operator*=(const Dual& o) { return *this = {a * o.a, a * o.b + b * o.a}; }
  Dual& operator/=(const Dual& o) { return *this = {a / o.a, (b - a / o.a * o.b) / o.a}; }
  friend Dual operator+(Dual x, const Dual& y) { return x += y; }
  friend Dual operator-(Dual x, const Dual& y) { return x -= y; }
  friend Dual operator*(Dual x, const Dual& y) { return x *= y; }
  friend Dual operator/(Dual x, const Dual& y) { return x /= y; }
  friend Dual operator-(const Dual& x) { return {-x.a, -x.b}; }
};

inline Dual sqrt(const Dual& x) {
  const double root = std::sqrt(x.a);
  return {root, 0.5 * x.b / root};
}

inline double value_of(double x) { return x; }
inline double value_of(const Dual& x) { return x.a; }

template <class T>
using Vec3 = Eigen::Matrix<T, 3, 1>;
template <class T>
using Mat3 = Eigen::Matrix<T, 3, 3>;

}  // namespace ferrers::witness

namespace Eigen {
template <>
struct NumTraits<ferrers::witness::Dual> : NumTraits<double> {
  using Real = ferrers::witness::Dual;
  using NonInteger = ferrers::witness::Dual;
  using Nested = ferrers::witness::Dual;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = 2,
    AddCost = 2,
    MulCost = 4
  };
};
}  // namespace Eigen
