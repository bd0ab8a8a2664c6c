#pragma once

#include <Eigen/Core>
#include <vector>

#include "ferrers/math/expression_graph.h"

/// Problem: algorithms on numbers are to be written down once as straight-line code of one mechanism, and then run as
/// native code.
///
/// Given: an algorithm, as a template over its number. Wanted: the operations that it does, as a graph. A `Traced` is a
/// value of that graph, or a constant; arithmetic on it adds operations. What constants make superfluous is left out:
/// products with 0 and 1, sums with 0, operations on constants. (Values are taken to be finite: 0 · x is 0.) Branches
/// must not depend on traced values. `Kernel` (math/kernel.h) makes native code of the graph.
namespace ferrers {

class Trace;

class Traced {
 public:
  Traced() = default;
  Traced(double constant) : constant_(constant) {}  // constants are numbers

  bool is_constant() const { return value_ < 0; }
  bool is_zero() const { return is_constant() && constant_ == 0; }
  double constant() const { return constant_; }  ///< Of a constant.

  Traced& operator+=(const Traced& o);
  Traced& operator-=(const Traced& o);
  Traced& operator*=(const Traced& o);
  Traced& operator/=(const Traced& o);

 private:
  friend class Trace;
  friend Traced operator-(const Traced& a, const Traced& b);
  Traced(int value, std::nullptr_t) : value_(value) {}

  double constant_ = 0;
  int value_ = -1;  ///< Of the graph, or −1: `constant_`.
};

Traced operator-(const Traced& a);
Traced operator+(const Traced& a, const Traced& b);
Traced operator-(const Traced& a, const Traced& b);
Traced operator*(const Traced& a, const Traced& b);
Traced operator/(const Traced& a, const Traced& b);
/// Sine and cosine are written out as sums and products; they are exact to the last digit or two for angles up to
/// `kFarthestAngle`, and wrong beyond.
Traced sin(const Traced& a);
Traced cos(const Traced& a);
inline constexpr double kFarthestAngle = 1e6;
Traced acos(const Traced& a);
Traced sqrt(const Traced& a);
Traced floor(const Traced& a);
Traced round(const Traced& a);  ///< To the nearest whole number.
Traced atan2(const Traced& a, const Traced& b);

/// The graph that the traced numbers of this thread are values of, while it lives. Not nested.
class Trace {
 public:
  Trace();
  ~Trace();
  Trace(const Trace&) = delete;
  Trace& operator=(const Trace&) = delete;

  Traced input(int index);
  /// The value of the graph that a number is.
  int value_of(const Traced& number);
  const ExpressionGraph& graph() const { return graph_; }

 private:
  friend Traced operator-(const Traced& a);
  friend Traced operator+(const Traced& a, const Traced& b);
  friend Traced operator-(const Traced& a, const Traced& b);
  friend Traced operator*(const Traced& a, const Traced& b);
  friend Traced operator/(const Traced& a, const Traced& b);
  friend Traced traced_operation(ExpressionOp op, const Traced& a, const Traced& b);

  static Trace& current();
  Traced operation(ExpressionOp op, const Traced& a, const Traced& b = Traced());

  ExpressionGraph graph_;
};

}  // namespace ferrers

template <>
struct Eigen::NumTraits<ferrers::Traced> : Eigen::GenericNumTraits<ferrers::Traced> {
  using Real = ferrers::Traced;
  using NonInteger = ferrers::Traced;
  using Nested = ferrers::Traced;
  using Literal = double;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = 1,
    AddCost = 3,
    MulCost = 3
  };
};
