#include <numbers>
#include <span>
#include <vector>

#include "ferrers/math/expression.h"
#include "ferrers/math/expression_algebra.h"
#include "ferrers/math/expression_node.h"

namespace ferrers {
namespace {

using Op = ExpressionOp;
using Algebra = ExpressionAlgebra;

/// f' of an elementary function, as a formula of u and of f(u) itself.
int outer_derivative(Algebra& x, Op op, int u, int f) {
  // Exact near 1, where the square would round away what is left.
  const auto asin_root = [&] {
    return x.make(Op::kSqrt, x.multiply(x.subtract(x.number(1), u), x.add(x.number(1), u)));
  };
  const auto inside_unit = [&](int slope) {  // the slope of a step between 0 and 1, flat outside
    const int below_one = x.choose(Op::kLess, u, x.number(1), slope, x.number(0));
    return x.choose(Op::kGreater, u, x.number(0), below_one, x.number(0));
  };
  switch (op) {
    case Op::kSin:
      return x.make(Op::kCos, u);
    case Op::kCos:
      return x.negate(x.make(Op::kSin, u));
    case Op::kTan:
      return x.add(x.number(1), x.square(f));
    case Op::kAsin:
      return x.divide(x.number(1), asin_root());
    case Op::kAcos:
      return x.divide(x.number(-1), asin_root());
    case Op::kAtan:
      return x.divide(x.number(1), x.add(x.number(1), x.square(u)));
    case Op::kSinh:
      return x.make(Op::kCosh, u);
    case Op::kCosh:
      return x.make(Op::kSinh, u);
    case Op::kTanh:
      return x.subtract(x.number(1), x.square(f));
    case Op::kExp:
      return f;
    case Op::kLog:
      return x.divide(x.number(1), u);
    case Op::kLog10:
      return x.divide(x.number(std::numbers::log10e), u);
    case Op::kSqrt:
      return x.divide(x.number(0.5), f);
    case Op::kAbs:
      return x.choose(Op::kLess, u, x.number(0), x.number(-1), x.number(1));
    case Op::kSmoothstep:
      return inside_unit(x.multiply(x.multiply(x.number(6), u), x.subtract(x.number(1), u)));
    case Op::kSmootherstep:
      return inside_unit(x.multiply(x.number(30), x.square(x.multiply(u, x.subtract(x.number(1), u)))));
    default:  // kSign, kFloor: flat between their jumps
      return x.number(0);
  }
}

/// (u^w)' = w u^(w-1) u' + u^w log(u) w'. The first term is 0 at w = 0, also where u^(w-1) is infinite: x^n has a
/// second derivative at x = 0 for n = 1. The second term is 0 at u = 0, its limit for w > 0, and wherever the exponent
/// stands still: of a negative u there is no logarithm, but its square has a slope.
int power_derivative(Algebra& x, int u, int w, int du, int dw, int f) {
  const int zero = x.number(0);
  int by_base = zero;
  if (!x.is(du, 0)) {
    const int lower = x.multiply(w, x.make(Op::kPower, u, x.subtract(w, x.number(1))));
    const bool is_settled = x.is_constant(w) || x.is_constant(u);
    by_base = x.multiply(is_settled ? lower : x.choose(Op::kGreater, x.make(Op::kAbs, w), zero, lower, zero), du);
  }
  if (x.is(dw, 0)) return by_base;
  const int slope = x.multiply(f, x.make(Op::kLog, u));
  if (x.is_constant(u) && x.node(u).value > 0) return x.add(by_base, x.multiply(slope, dw));
  const int off_zero = x.choose(Op::kGreater, x.make(Op::kAbs, u), zero, slope, zero);
  const int by_exponent = x.choose(Op::kGreater, x.make(Op::kAbs, dw), zero, x.multiply(off_zero, dw), zero);
  return x.add(by_base, by_exponent);
}

/// The derivative of an operation of two operands u, w with derivatives du, dw and value f.
int binary_derivative(Algebra& x, Op op, int u, int w, int du, int dw, int f) {
  switch (op) {
    case Op::kAdd:
      return x.add(du, dw);
    case Op::kSubtract:
      return x.subtract(du, dw);
    case Op::kMultiply:
      return x.add(x.multiply(du, w), x.multiply(u, dw));
    case Op::kDivide:
      return x.divide(x.subtract(du, x.multiply(f, dw)), w);
    case Op::kPower:
      return power_derivative(x, u, w, du, dw, f);
    case Op::kAtan2:
      return x.divide(x.subtract(x.multiply(w, du), x.multiply(u, dw)), x.add(x.square(u), x.square(w)));
    case Op::kHypot:
      return x.divide(x.add(x.multiply(u, du), x.multiply(w, dw)), f);
    case Op::kMod:
      return x.subtract(du, x.multiply(x.make(Op::kFloor, x.divide(u, w)), dw));
    case Op::kMin:
      return x.choose(Op::kLessEqual, u, w, du, dw);
    case Op::kMax:
      return x.choose(Op::kGreaterEqual, u, w, du, dw);
    default:  // comparisons
      return x.number(0);
  }
}

/// Differentiates every node of a tree, operands first. `rate_of_text[k]`: the derivative of the name that is text k,
/// or -1 where that does not change.
int derivative_of(Algebra& algebra, const ExpressionTree& tree, std::span<const int> rate_of_text) {
  const auto& nodes = tree.nodes;
  std::vector<bool> changes(nodes.size(), false), is_needed(nodes.size(), false);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const ExpressionNode& node = nodes[i];
    if (node.op == Op::kVariable) changes[i] = rate_of_text[node.text] >= 0;
    for (const int arg : node.args) changes[i] = changes[i] || (arg >= 0 && changes[arg]);
  }
  // Sums need no values of their operands; whatever else changes may need its own and theirs.
  for (std::size_t i = nodes.size(); i-- > 0;) {
    const ExpressionNode& node = nodes[i];
    const bool is_sum = node.op == Op::kAdd || node.op == Op::kSubtract || node.op == Op::kNegate;
    if (changes[i] && !is_sum && !node.is_leaf()) is_needed[i] = true;
    if (!is_needed[i]) continue;
    for (const int arg : node.args) {
      if (arg >= 0) is_needed[arg] = true;
    }
  }
  const int zero = algebra.number(0);
  std::vector<int> value(nodes.size(), -1), slope(nodes.size(), zero);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const ExpressionNode& node = nodes[i];
    const auto [a, b, c] = node.args;
    const auto value_of = [&value](int arg) { return arg < 0 ? -1 : value[arg]; };
    const int u = value_of(a), w = value_of(b);
    if (is_needed[i]) value[i] = node.is_leaf() ? algebra.leaf(tree, node) : algebra.make(node.op, u, w, value_of(c));
    if (!changes[i]) continue;
    if (node.op == Op::kVariable) {
      slope[i] = rate_of_text[node.text];
    } else if (node.op == Op::kIf) {
      const bool is_flat = algebra.is(slope[b], 0) && algebra.is(slope[c], 0);
      slope[i] = is_flat ? zero : algebra.make(Op::kIf, u, slope[b], slope[c]);
    } else if (node.op == Op::kNegate) {
      slope[i] = algebra.negate(slope[a]);
    } else if (algebra.is(slope[a], 0) && (b < 0 || algebra.is(slope[b], 0))) {
      slope[i] = zero;
    } else if (b >= 0) {
      slope[i] = binary_derivative(algebra, node.op, u, w, slope[a], slope[b], value[i]);
    } else {
      slope[i] = algebra.multiply(outer_derivative(algebra, node.op, u, value[i]), slope[a]);
    }
  }
  return slope.back();
}

}  // namespace

Expression Expression::derivative(std::string_view name) const {
  Algebra algebra(Algebra::Zeros::kRemove);
  std::vector<int> rates;
  for (const std::string& text : tree_->texts) rates.push_back(text == name ? algebra.number(1) : -1);
  return Expression(algebra.finish(derivative_of(algebra, *tree_, rates), tree_->at));
}

Expression Expression::rate(const std::function<std::optional<Expression>(std::string_view)>& rate_of) const {
  Algebra algebra(Algebra::Zeros::kRemove);
  constexpr int kUnasked = -2;
  std::vector<int> rates(tree_->texts.size(), kUnasked);
  for (const ExpressionNode& node : tree_->nodes) {
    if (node.op != Op::kVariable || rates[node.text] != kUnasked) continue;
    const std::optional<Expression> rate = rate_of(tree_->texts[node.text]);
    rates[node.text] = rate ? algebra.copy(*rate->tree_) : -1;
  }
  return Expression(algebra.finish(derivative_of(algebra, *tree_, rates), tree_->at));
}

}  // namespace ferrers
