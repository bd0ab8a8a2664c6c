#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <unordered_map>

#include "ferrers/math/expression_node.h"

namespace ferrers {

/// Builds formulas in simplest form, each operation on the same operands once. Private to expression*.cc.
///
/// Simplest form: a product has its number in front and signs before that; numbers are worked out; equal terms and
/// factors are gathered as far as one operation sees them (x + x, x*y + x*z, x*x, but not x + y + x). No rule gives a
/// finite value where the operation as written has none (x - x and x/x stay), save by an intermediate overflow; what
/// `Zeros` allows is said there.
class ExpressionAlgebra {
 public:
  /// What a factor of 0 does. In derivatives and what is built from them, a 0 is there because something does not
  /// matter: it removes what it multiplies, and x - x is such a 0; sin(x)^2 + cos(x)^2 is 1. In a formula that
  /// somebody wrote, 0*x must stay, or NaN in x would be hidden.
  enum class Zeros { kRemove, kKeep };

  explicit ExpressionAlgebra(Zeros zeros) : zeros_(zeros) {}

  const ExpressionNode& node(int index) const { return builder_.node(index); }
  bool is_constant(int index) const { return node(index).is_literal() || node(index).op == ExpressionOp::kPi; }
  bool is(int index, double value) const { return is_constant(index) && node(index).value == value; }
  std::shared_ptr<const ExpressionTree> finish(int root, SourceRange at) { return builder_.finish(root, at); }

  int number(double value);
  int leaf(const ExpressionTree& tree, const ExpressionNode& source);  ///< Quantities keep their unit.
  int copy(const ExpressionTree& tree);                                ///< A whole formula as it is; its root.

  int make(ExpressionOp op, int a, int b = -1, int c = -1);

  int negate(int a) { return make(ExpressionOp::kNegate, a); }
  int add(int a, int b) { return make(ExpressionOp::kAdd, a, b); }
  int subtract(int a, int b) { return make(ExpressionOp::kSubtract, a, b); }
  int multiply(int a, int b) { return make(ExpressionOp::kMultiply, a, b); }
  int divide(int a, int b) { return make(ExpressionOp::kDivide, a, b); }
  int square(int a) { return make(ExpressionOp::kPower, a, number(2)); }
  int choose(ExpressionOp comparison, int a, int b, int then_value, int else_value);

 private:
  struct Key {
    ExpressionOp op;
    std::array<int, 3> args;
    std::uint64_t bits;
    int text;
    bool operator==(const Key&) const = default;
  };
  struct KeyHash {
    std::size_t operator()(const Key& key) const;
  };

  /// factor * rest; a rest of -1 is 1.
  struct Scaled {
    double factor = 1;
    int rest = -1;
  };

  int unique(const ExpressionNode& node);
  int operation(ExpressionOp op, int a, int b = -1, int c = -1);  ///< As it is.

  // Each of these returns -1 where no rule fits.
  int simple(ExpressionOp op, int a, int b, int c);
  int simple_negation(int a);
  int simple_sum(ExpressionOp op, int a, int b);
  int with_common_factor(ExpressionOp op, int a, int b);
  int simple_product(int a, int b);
  int product_with_number(int a, int b);
  int simple_quotient(int a, int b);
  int simple_power(int a, int b);
  int simple_function(ExpressionOp op, int a);
  int simple_choice(int condition, int then_value, int else_value);
  int product_of_powers(int a, int b);

  bool is_negative(int index) const;  ///< Whether a sign or a negative number stands in front.
  int opposite(int index);            ///< Of what is negative.
  Scaled scaled(int index) const;
  int scale(double factor, int rest);
  int whole_exponent(int index, int& base) const;

  Zeros zeros_;
  ExpressionTreeBuilder builder_;
  std::unordered_map<Key, int, KeyHash> made_;
};

}  // namespace ferrers
