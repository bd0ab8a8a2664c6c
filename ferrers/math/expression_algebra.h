#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <unordered_map>

#include "ferrers/math/expression_node.h"

namespace ferrers {

/// Builds formulas in simplest form, each operation on the same operands once. Private to expression*.cc.
class ExpressionAlgebra {
 public:
  /// What a factor of 0 does. In derivatives and sums built from them, a 0 is there because something does not matter:
  /// it removes what it multiplies. In a formula that somebody wrote, 0*x must stay, or NaN in x would be hidden.
  enum class Zeros { kRemove, kKeep };

  explicit ExpressionAlgebra(Zeros zeros) : zeros_(zeros) {}

  const ExpressionNode& node(int index) const { return builder_.node(index); }
  bool is_constant(int index) const { return node(index).is_literal() || node(index).op == ExpressionOp::kPi; }
  bool is(int index, double value) const { return is_constant(index) && node(index).value == value; }
  std::shared_ptr<const ExpressionTree> finish(int root, SourceRange at) { return builder_.finish(root, at); }

  int number(double value);
  int leaf(const ExpressionTree& tree, const ExpressionNode& source);  ///< Quantities keep their unit.
  int copy(const ExpressionTree& tree);  ///< A whole formula as it is; the index of its root.

  /// An operation; the rules for it are in expression_algebra.cc.
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

  int simplified(ExpressionOp op, int a, int b, int c);
  int unique(const ExpressionNode& node);

  Zeros zeros_;
  ExpressionTreeBuilder builder_;
  std::unordered_map<Key, int, KeyHash> made_;
};

}  // namespace ferrers
