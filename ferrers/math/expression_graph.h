#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "ferrers/math/expression_node.h"
#include "ferrers/math/number_index.h"

namespace ferrers {

/// The values that several formulas need, each once: what an `ExpressionProgram` computes. Private to expression*.cc.
///
/// Values are numbered: the same operation on the same operands is one value, whichever formula asks for it. Operands
/// stand before their operations. Rewriting is limited to what gives the same bits as `apply_expression_op` on the
/// formula as written (NaN stays NaN, of whatever sign): operations on constants are carried out, operands of sums and
/// products are ordered, signs move outwards, small whole powers become products.
class ExpressionGraph {
 public:
  struct Value {
    ExpressionOp op = ExpressionOp::kLiteral;  ///< kLiteral: `constant`; kVariable: the input number args[0].
    std::array<int, 3> args{-1, -1, -1};
    double constant = 0;

    bool is_constant() const { return op == ExpressionOp::kLiteral; }
    bool is_operation() const { return op > ExpressionOp::kVariable; }
  };

  /// Adds a formula; its value's index. `input_of_text[k]`: the input number of the tree's k-th text, where it is a
  /// name.
  int add(const ExpressionTree& tree, std::span<const int> input_of_text);

  int constant(double value);
  int input(int index);
  int operation(ExpressionOp op, int a, int b, int c);

  const std::vector<Value>& values() const { return values_; }

 private:
  int negation(int a);
  int sum(int a, int b);
  int difference(int a, int b);
  int product(int a, int b);
  int quotient(int a, int b);
  int power(int a, int b);
  int folded(ExpressionOp op, int a, int b, int c);
  int unique(const Value& value);

  std::vector<Value> values_;
  NumberIndex index_;
};

}  // namespace ferrers
