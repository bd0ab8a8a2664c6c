#include "ferrers/math/expression_algebra.h"

#include <bit>
#include <cmath>

namespace ferrers {

using Op = ExpressionOp;

std::size_t ExpressionAlgebra::KeyHash::operator()(const Key& key) const {
  std::uint64_t hash = key.bits + static_cast<std::uint64_t>(key.op) + (static_cast<std::uint64_t>(key.text + 1) << 8);
  for (const int arg : key.args) {
    hash = (hash ^ static_cast<std::uint32_t>(arg)) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 29;
  }
  return static_cast<std::size_t>(hash);
}

int ExpressionAlgebra::unique(const ExpressionNode& node) {
  const Key key{node.op, node.args, std::bit_cast<std::uint64_t>(node.value), node.text};
  if (const auto found = made_.find(key); found != made_.end()) return found->second;
  return made_.emplace(key, builder_.add(node)).first->second;
}

int ExpressionAlgebra::number(double value) {
  ExpressionNode node;
  node.value = value;
  return unique(node);
}

int ExpressionAlgebra::leaf(const ExpressionTree& tree, const ExpressionNode& source) {
  ExpressionNode copy = source;
  if (copy.text >= 0) copy.text = builder_.text(tree.texts[copy.text]);
  return unique(copy);
}

int ExpressionAlgebra::copy(const ExpressionTree& tree) {
  std::vector<int> moved;
  moved.reserve(tree.nodes.size());
  for (const ExpressionNode& source : tree.nodes) {
    if (source.is_leaf()) {
      moved.push_back(leaf(tree, source));
      continue;
    }
    ExpressionNode node = source;
    for (int& arg : node.args) {
      if (arg >= 0) arg = moved[arg];
    }
    moved.push_back(unique(node));
  }
  return moved.back();
}

int ExpressionAlgebra::make(Op op, int a, int b, int c) {
  if (const int simple = simplified(op, a, b, c); simple >= 0) return simple;
  if (is_constant(a) && (b < 0 || is_constant(b)) && op != Op::kIf) {
    const double value = apply_expression_op(op, node(a).value, b < 0 ? 0 : node(b).value, 0);
    if (std::isfinite(value)) return number(value);
  }
  ExpressionNode made;
  made.op = op;
  made.args = {a, b, c};
  return unique(made);
}

int ExpressionAlgebra::choose(Op comparison, int a, int b, int then_value, int else_value) {
  return then_value == else_value ? then_value : make(Op::kIf, make(comparison, a, b), then_value, else_value);
}

/// The rules that need no arithmetic; -1 when none fits.
int ExpressionAlgebra::simplified(Op op, int a, int b, int c) {
  switch (op) {
    case Op::kNegate:
      return node(a).op == Op::kNegate ? node(a).args[0] : -1;
    case Op::kAdd:
      if (is(a, 0)) return b;
      if (is(b, 0)) return a;
      return node(b).op == Op::kNegate ? subtract(a, node(b).args[0]) : -1;
    case Op::kSubtract:
      if (is(b, 0)) return a;
      if (is(a, 0)) return negate(b);
      return node(b).op == Op::kNegate ? add(a, node(b).args[0]) : -1;
    case Op::kMultiply:
      if (zeros_ == Zeros::kRemove && (is(a, 0) || is(b, 0))) return number(0);
      if (is(a, 1)) return b;
      if (is(b, 1)) return a;
      if (is(a, -1)) return negate(b);
      return is(b, -1) ? negate(a) : -1;
    case Op::kDivide:
      if (zeros_ == Zeros::kRemove && is(a, 0) && !is(b, 0)) return number(0);
      return is(b, 1) ? a : -1;
    case Op::kPower:
      if (is(b, 0)) return number(1);
      return is(b, 1) ? a : -1;
    case Op::kIf:
      if (zeros_ == Zeros::kRemove && b == c) return b;
      if (!is_constant(a)) return -1;
      return node(a).value != 0 ? b : c;
    default:
      return -1;
  }
}

}  // namespace ferrers
