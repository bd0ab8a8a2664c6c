#include "ferrers/math/expression_graph.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

namespace ferrers {

using Op = ExpressionOp;

int ExpressionGraph::unique(const Value& value) {
  const auto bits = std::bit_cast<std::uint64_t>(value.constant);
  std::uint64_t hash = bits + static_cast<std::uint64_t>(value.op);
  for (const int arg : value.args) hash = mixed(hash ^ static_cast<std::uint32_t>(arg));
  const int next = static_cast<int>(values_.size());
  const int number = index_.find_or_add(hash, next, [&](int known) {
    const Value& one = values_[known];
    return one.op == value.op && one.args == value.args && std::bit_cast<std::uint64_t>(one.constant) == bits;
  });
  if (number == next) values_.push_back(value);
  return number;
}

int ExpressionGraph::constant(double value) { return unique({Op::kLiteral, {-1, -1, -1}, value}); }
int ExpressionGraph::input(int index) { return unique({Op::kVariable, {index, -1, -1}, 0}); }

/// The value where every operand is constant, else -1.
int ExpressionGraph::folded(Op op, int a, int b, int c) {
  double operands[3] = {0, 0, 0};
  const int args[] = {a, b, c};
  for (int i = 0; i < 3; ++i) {
    if (args[i] < 0) continue;
    if (!values_[args[i]].is_constant()) return -1;
    operands[i] = values_[args[i]].constant;
  }
  return constant(apply_expression_op(op, operands[0], operands[1], operands[2]));
}

int ExpressionGraph::operation(Op op, int a, int b, int c) {
  if (const int value = folded(op, a, b, c); value >= 0) return value;
  switch (op) {
    case Op::kNegate:
      return negation(a);
    case Op::kAdd:
      return sum(a, b);
    case Op::kSubtract:
      return difference(a, b);
    case Op::kMultiply:
      return product(a, b);
    case Op::kDivide:
      return quotient(a, b);
    case Op::kPower:
      return power(a, b);
    case Op::kGreater:
      return unique({Op::kLess, {b, a, -1}, 0});
    case Op::kGreaterEqual:
      return unique({Op::kLessEqual, {b, a, -1}, 0});
    case Op::kIf:
      if (values_[a].is_constant() && !std::isnan(values_[a].constant)) return values_[a].constant != 0 ? b : c;
      return unique({op, {a, b, c}, 0});
    default:
      return unique({op, {a, b, c}, 0});
  }
}

int ExpressionGraph::negation(int a) {
  return values_[a].op == Op::kNegate ? values_[a].args[0] : unique({Op::kNegate, {a, -1, -1}, 0});
}

int ExpressionGraph::sum(int a, int b) {
  if (values_[b].op == Op::kNegate) return difference(a, values_[b].args[0]);
  if (values_[a].op == Op::kNegate) return difference(b, values_[a].args[0]);
  if (a > b) std::swap(a, b);
  return unique({Op::kAdd, {a, b, -1}, 0});
}

int ExpressionGraph::difference(int a, int b) {
  if (values_[b].is_constant() && values_[b].constant == 0 && !std::signbit(values_[b].constant)) return a;
  if (values_[b].op == Op::kNegate) return sum(a, values_[b].args[0]);
  return unique({Op::kSubtract, {a, b, -1}, 0});
}

int ExpressionGraph::product(int a, int b) {
  const auto is = [this](int index, double value) {
    return values_[index].is_constant() && values_[index].constant == value;
  };
  if (is(a, 1)) return b;
  if (is(b, 1)) return a;
  if (is(a, -1)) return negation(b);
  if (is(b, -1)) return negation(a);
  if (values_[a].op == Op::kNegate) return negation(product(values_[a].args[0], b));
  if (values_[b].op == Op::kNegate) return negation(product(a, values_[b].args[0]));
  if (a > b) std::swap(a, b);
  return unique({Op::kMultiply, {a, b, -1}, 0});
}

int ExpressionGraph::quotient(int a, int b) {
  if (values_[a].op == Op::kNegate) return negation(quotient(values_[a].args[0], b));
  if (values_[b].op == Op::kNegate) return negation(quotient(a, values_[b].args[0]));
  if (values_[b].is_constant()) {
    // Dividing by a power of two is multiplying by its inverse, to the last bit.
    int exponent = 0;
    const double divisor = values_[b].constant, inverse = 1 / divisor;
    if (std::isnormal(divisor) && std::isnormal(inverse) && std::abs(std::frexp(divisor, &exponent)) == 0.5) {
      return product(a, constant(inverse));
    }
  }
  return unique({Op::kDivide, {a, b, -1}, 0});
}

/// As `power_of` computes it.
int ExpressionGraph::power(int a, int b) {
  if (values_[b].is_constant()) {
    const double exponent = values_[b].constant;
    if (exponent == 0) return constant(1);
    if (exponent == 1) return a;
    if (std::abs(exponent) <= 4 && exponent != -3 && exponent != -4 && exponent == std::floor(exponent)) {
      const int square = product(a, a);
      if (exponent == 2) return square;
      if (exponent == 3) return product(square, a);
      if (exponent == 4) return product(square, square);
      return quotient(constant(1), exponent == -1 ? a : square);
    }
  }
  return unique({Op::kPower, {a, b, -1}, 0});
}

int ExpressionGraph::add(const ExpressionTree& tree, std::span<const int> input_of_text) {
  std::vector<int> moved;
  moved.reserve(tree.nodes.size());
  const auto operand = [&moved](int arg) { return arg < 0 ? -1 : moved[static_cast<std::size_t>(arg)]; };
  for (const ExpressionNode& node : tree.nodes) {
    if (node.op == Op::kVariable) {
      moved.push_back(input(input_of_text[static_cast<std::size_t>(node.text)]));
    } else if (node.is_leaf()) {
      moved.push_back(constant(node.value));
    } else {
      moved.push_back(operation(node.op, operand(node.args[0]), operand(node.args[1]), operand(node.args[2])));
    }
  }
  return moved.back();
}

}  // namespace ferrers
