#include "ferrers/math/expression_algebra.h"

#include <bit>
#include <cmath>
#include <utility>

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
  Key key{node.op, node.args, std::bit_cast<std::uint64_t>(node.value), node.text};
  if (const auto found = made_.find(key); found != made_.end()) return found->second;
  if (node.op == Op::kAdd || node.op == Op::kMultiply) {  // b + a is a + b, in the order that came first
    std::swap(key.args[0], key.args[1]);
    if (const auto found = made_.find(key); found != made_.end()) return found->second;
    std::swap(key.args[0], key.args[1]);
  }
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

int ExpressionAlgebra::operation(Op op, int a, int b, int c) {
  ExpressionNode made;
  made.op = op;
  made.args = {a, b, c};
  return unique(made);
}

int ExpressionAlgebra::make(Op op, int a, int b, int c) {
  // What stays as it is keeps its unit.
  if ((op == Op::kMultiply || op == Op::kDivide || op == Op::kPower) && is(b, 1)) return a;
  if ((op == Op::kAdd || op == Op::kSubtract) && is(b, 0)) return a;
  if ((op == Op::kMultiply && is(a, 1)) || (op == Op::kAdd && is(a, 0))) return b;
  if (is_constant(a) && (b < 0 || is_constant(b)) && op != Op::kIf) {
    const double value = apply_expression_op(op, node(a).value, b < 0 ? 0 : node(b).value, 0);
    if (std::isfinite(value)) return number(value);
    if (b >= 0) return operation(op, a, b);  // nothing to gather
  }
  const int index = simple(op, a, b, c);
  return index >= 0 ? index : operation(op, a, b, c);
}

int ExpressionAlgebra::choose(Op comparison, int a, int b, int then_value, int else_value) {
  return then_value == else_value ? then_value : make(Op::kIf, make(comparison, a, b), then_value, else_value);
}

int ExpressionAlgebra::simple(Op op, int a, int b, int c) {
  switch (op) {
    case Op::kNegate:
      return simple_negation(a);
    case Op::kAdd:
    case Op::kSubtract:
      return simple_sum(op, a, b);
    case Op::kMultiply:
      return simple_product(a, b);
    case Op::kDivide:
      return simple_quotient(a, b);
    case Op::kPower:
      return simple_power(a, b);
    case Op::kIf:
      return simple_choice(a, b, c);
    case Op::kMin:
    case Op::kMax:
      return a == b ? a : -1;
    default:
      return b < 0 ? simple_function(op, a) : -1;
  }
}

// ---- numbers in front ----------------------------------------------------------------------------------------------

ExpressionAlgebra::Scaled ExpressionAlgebra::scaled(int index) const {
  Scaled result{1, index};
  while (true) {
    const ExpressionNode& n = node(result.rest);
    const bool is_product = n.op == Op::kMultiply && is_constant(n.args[0]);
    double factor = -1;
    if (is_constant(result.rest)) factor = n.value;
    if (is_product) factor = node(n.args[0]).value;
    if (!is_constant(result.rest) && !is_product && n.op != Op::kNegate) return result;
    if (!std::isnormal(result.factor * factor)) return result;
    result.factor *= factor;
    if (is_constant(result.rest)) return {result.factor, -1};
    result.rest = n.args[is_product ? 1 : 0];
  }
}

int ExpressionAlgebra::scale(double factor, int rest) {
  if (rest < 0) return number(factor);
  if (factor == 1) return rest;
  if (factor == -1) return operation(Op::kNegate, rest);
  return operation(Op::kMultiply, number(factor), rest);
}

bool ExpressionAlgebra::is_negative(int index) const { return scaled(index).factor < 0; }

int ExpressionAlgebra::opposite(int index) {
  const auto [factor, rest] = scaled(index);
  return scale(-factor, rest);
}

// ---- sums ----------------------------------------------------------------------------------------------------------

int ExpressionAlgebra::simple_negation(int a) {
  const ExpressionNode n = node(a);
  if (n.op == Op::kSubtract) return subtract(n.args[1], n.args[0]);
  if (n.op == Op::kDivide && is_constant(n.args[0])) return divide(number(-node(n.args[0]).value), n.args[1]);
  const auto [factor, rest] = scaled(a);
  return factor != 1 && rest >= 0 ? scale(-factor, rest) : -1;
}

int ExpressionAlgebra::simple_sum(Op op, int a, int b) {
  const bool minus = op == Op::kSubtract;
  if (is(a, 0)) return negate(b);  // a difference: make() has seen the sum
  const Scaled left = scaled(a), right = scaled(b);
  if (left.rest >= 0 && left.rest == right.rest) {
    const double factor = minus ? left.factor - right.factor : left.factor + right.factor;
    if (factor == 0) return zeros_ == Zeros::kRemove ? number(0) : -1;
    if (std::isnormal(factor)) return scale(factor, left.rest);
  }
  if (is_negative(b)) return make(minus ? Op::kAdd : Op::kSubtract, a, opposite(b));
  if (is_negative(a)) {
    if (!minus) return subtract(b, opposite(a));
    return left.rest >= 0 ? negate(add(opposite(a), b)) : -1;
  }
  return with_common_factor(op, a, b);
}

/// x*y + x*z is x*(y + z); x - y + (y - x) is 0; sin(x)^2 + cos(x)^2 is 1.
int ExpressionAlgebra::with_common_factor(Op op, int a, int b) {
  const ExpressionNode m = node(a), n = node(b);
  if (m.op == Op::kSubtract && n.op == Op::kSubtract && m.args[0] == n.args[1] && m.args[1] == n.args[0]) {
    if (op == Op::kSubtract) return multiply(number(2), a);
    return zeros_ == Zeros::kRemove ? number(0) : -1;
  }
  if (m.op == Op::kPower && n.op == Op::kPower && op == Op::kAdd && zeros_ == Zeros::kRemove) {
    const ExpressionNode &f = node(m.args[0]), &g = node(n.args[0]);
    const bool circular = (f.op == Op::kSin && g.op == Op::kCos) || (f.op == Op::kCos && g.op == Op::kSin);
    if (circular && f.args[0] == g.args[0] && is(m.args[1], 2) && is(n.args[1], 2)) return number(1);
  }
  if (m.op != Op::kMultiply || n.op != Op::kMultiply) return -1;
  for (const auto& [i, j] : {std::pair(0, 0), std::pair(0, 1), std::pair(1, 0), std::pair(1, 1)}) {
    if (m.args[i] == n.args[j]) return multiply(m.args[i], make(op, m.args[1 - i], n.args[1 - j]));
  }
  return -1;
}

// ---- products ------------------------------------------------------------------------------------------------------

int ExpressionAlgebra::simple_product(int a, int b) {
  if (is_constant(b)) std::swap(a, b);
  if (is(a, 0)) return zeros_ == Zeros::kRemove ? number(0) : operation(Op::kMultiply, a, b);
  if (is_constant(a)) return product_with_number(a, b);
  const Scaled left = scaled(a), right = scaled(b);
  const double factor = left.factor * right.factor;
  if (left.rest < 0 || right.rest < 0 || !std::isnormal(factor)) return -1;
  if (left.rest != a || right.rest != b) return multiply(number(factor), multiply(left.rest, right.rest));
  for (const auto& [with, other] : {std::pair(a, b), std::pair(b, a)}) {
    const ExpressionNode n = node(with);
    if (n.op == Op::kDivide && is_constant(n.args[0])) return multiply(n.args[0], divide(other, n.args[1]));
    if (n.op != Op::kMultiply) continue;
    if (n.args[0] == other) return multiply(square(other), n.args[1]);
    if (n.args[1] == other) return multiply(n.args[0], square(other));
  }
  return product_of_powers(a, b);
}

/// The number `a` times `b`.
int ExpressionAlgebra::product_with_number(int a, int b) {
  const double number_in_front = node(a).value;
  const Scaled right = scaled(b);
  const double factor = number_in_front * right.factor;
  if (number_in_front == -1 || (right.rest >= 0 && right.rest != b && std::isnormal(factor))) {
    return scale(factor, right.rest);
  }
  const ExpressionNode n = node(b);
  if (n.op == Op::kDivide) {
    const double upper = is_constant(n.args[0]) ? number_in_front * node(n.args[0]).value : 0;
    if (std::isnormal(upper)) return divide(number(upper), n.args[1]);
    const double over = is_constant(n.args[1]) ? number_in_front / node(n.args[1]).value : 0;
    if (std::isnormal(over)) return scale(over, n.args[0]);
  }
  return operation(Op::kMultiply, a, b);
}

int ExpressionAlgebra::simple_quotient(int a, int b) {
  if (is(b, 0)) return -1;
  if (is(a, 0)) return zeros_ == Zeros::kRemove ? number(0) : -1;
  const Scaled left = scaled(a), right = scaled(b);
  const double factor = left.factor / right.factor;
  if (!std::isnormal(factor)) return -1;
  if (right.rest < 0) {  // by a number: x/3 stays, as x * 0.333... is another value
    if (left.rest < 0) return -1;
    if (right.factor < 0) return negate(divide(a, number(-right.factor)));
    if (left.factor == -1) return negate(divide(left.rest, b));
    return left.factor == 1 ? -1 : scale(factor, left.rest);
  }
  if (left.rest < 0) return right.rest == b ? -1 : divide(number(factor), right.rest);
  if (left.rest == a && right.rest == b) return -1;
  return multiply(number(factor), divide(left.rest, right.rest));
}

// ---- powers and functions ------------------------------------------------------------------------------------------

/// The exponent of a power with a whole, not too large exponent, and its base; of anything else 1 and itself.
int ExpressionAlgebra::whole_exponent(int index, int& base) const {
  constexpr double kLargest = 1000;
  const ExpressionNode& n = node(index);
  base = index;
  if (n.op != Op::kPower || !node(n.args[1]).is_literal()) return 1;
  const double exponent = node(n.args[1]).value;
  if (exponent != std::floor(exponent) || std::abs(exponent) > kLargest) return 1;
  base = n.args[0];
  return static_cast<int>(exponent);
}

/// x*x is x^2, up to what is computed by products anyway. Exponents of unlike sign stay: x^2/x has no value at 0.
int ExpressionAlgebra::product_of_powers(int a, int b) {
  constexpr int kLargest = 4;
  int base_a = -1, base_b = -1;
  const int m = whole_exponent(a, base_a), n = whole_exponent(b, base_b);
  if (base_a != base_b || (m > 0) != (n > 0) || std::abs(m + n) > kLargest) return -1;
  return make(Op::kPower, base_a, number(m + n));
}

int ExpressionAlgebra::simple_power(int a, int b) {
  if (is(b, 0)) return number(1);
  int itself = -1;
  const int n = whole_exponent(operation(Op::kPower, a, b), itself);
  if (itself != a) return -1;
  int base = -1;
  const int inner = whole_exponent(a, base);
  if (base != a) return make(Op::kPower, base, number(static_cast<double>(inner) * n));
  const Scaled scaled_base = scaled(a);
  const double factor = std::pow(scaled_base.factor, n);
  if (scaled_base.rest == a || scaled_base.rest < 0 || !std::isnormal(factor)) return -1;
  return multiply(number(factor), make(Op::kPower, scaled_base.rest, b));
}

int ExpressionAlgebra::simple_function(Op op, int a) {
  if (is_constant(a) || !is_negative(a)) return -1;
  switch (op) {
    case Op::kSin:
    case Op::kTan:
    case Op::kAsin:
    case Op::kAtan:
    case Op::kSinh:
    case Op::kTanh:
    case Op::kSign:
      return negate(make(op, opposite(a)));
    case Op::kCos:
    case Op::kCosh:
    case Op::kAbs:
      return make(op, opposite(a));
    default:
      return -1;
  }
}

int ExpressionAlgebra::simple_choice(int condition, int then_value, int else_value) {
  if (zeros_ == Zeros::kRemove && then_value == else_value) return then_value;
  if (!is_constant(condition)) return -1;
  return node(condition).value != 0 ? then_value : else_value;
}

}  // namespace ferrers
