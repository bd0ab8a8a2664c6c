#include "ferrers/math/expression.h"
#include "ferrers/math/expression_algebra.h"
#include "ferrers/math/expression_node.h"

namespace ferrers {

/// Sees the trees of its operands.
class ExpressionOperators {
 public:
  static Expression apply(ExpressionOp op, const Expression& a, const Expression& b) {
    ExpressionAlgebra algebra(ExpressionAlgebra::Zeros::kRemove);
    const int left = algebra.copy(*a.tree_), right = algebra.copy(*b.tree_);
    return Expression(algebra.finish(algebra.make(op, left, right), a.at()));
  }
  static Expression negate(const Expression& a) {
    ExpressionAlgebra algebra(ExpressionAlgebra::Zeros::kRemove);
    return Expression(algebra.finish(algebra.negate(algebra.copy(*a.tree_)), a.at()));
  }
  static Expression sum(std::span<const Expression> terms) {
    ExpressionAlgebra algebra(ExpressionAlgebra::Zeros::kRemove);
    int sum = algebra.number(0);
    for (const Expression& term : terms) sum = algebra.add(sum, algebra.copy(*term.tree_));
    return Expression(algebra.finish(sum, {}));
  }
};

Expression operator+(const Expression& a, const Expression& b) {
  return ExpressionOperators::apply(ExpressionOp::kAdd, a, b);
}
Expression operator-(const Expression& a, const Expression& b) {
  return ExpressionOperators::apply(ExpressionOp::kSubtract, a, b);
}
Expression operator*(const Expression& a, const Expression& b) {
  return ExpressionOperators::apply(ExpressionOp::kMultiply, a, b);
}
Expression operator/(const Expression& a, const Expression& b) {
  return ExpressionOperators::apply(ExpressionOp::kDivide, a, b);
}
Expression operator-(const Expression& a) { return ExpressionOperators::negate(a); }
Expression sum_of(std::span<const Expression> terms) { return ExpressionOperators::sum(terms); }

Expression Expression::simplified() const {
  ExpressionAlgebra algebra(ExpressionAlgebra::Zeros::kKeep);
  std::vector<int> value;
  value.reserve(tree_->nodes.size());
  const auto operand = [&value](int arg) { return arg < 0 ? -1 : value[arg]; };
  for (const ExpressionNode& node : tree_->nodes) {
    const auto [a, b, c] = node.args;
    value.push_back(node.is_leaf() ? algebra.leaf(*tree_, node)
                                   : algebra.make(node.op, operand(a), operand(b), operand(c)));
  }
  return Expression(algebra.finish(value.back(), tree_->at));
}

}  // namespace ferrers
