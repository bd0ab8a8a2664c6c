#include <bit>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include "ferrers/math/expression.h"
#include "ferrers/math/expression_node.h"

namespace ferrers {
namespace {

using Op = ExpressionOp;

/// Builds nodes in simplest form, each operation on the same operands once.
class Algebra {
 public:
  explicit Algebra(const ExpressionTree& tree) : tree_(tree) {}

  const ExpressionNode& node(int index) const { return builder_.node(index); }
  bool is_constant(int index) const { return node(index).op == Op::kLiteral || node(index).op == Op::kPi; }
  bool is(int index, double value) const { return is_constant(index) && node(index).value == value; }
  std::shared_ptr<const ExpressionTree> finish(int root) { return builder_.finish(root, tree_.at); }

  int number(double value) {
    return unique(Op::kLiteral, {-1, -1, -1}, value, -1, [&] { return builder_.literal(value); });
  }

  /// A leaf of the tree being differentiated. Quantities keep their unit.
  int leaf(const ExpressionNode& source) {
    ExpressionNode copy = source;
    if (copy.text >= 0) copy.text = builder_.text(tree_.texts[copy.text]);
    return unique(copy.op, copy.args, copy.value, copy.text, [&] { return builder_.add(copy); });
  }

  int make(Op op, int a, int b = -1, int c = -1) {
    if (const int simple = simplified(op, a, b, c); simple >= 0) return simple;
    if (is_constant(a) && (b < 0 || is_constant(b)) && op != Op::kIf) {
      const double value = apply_expression_op(op, node(a).value, b < 0 ? 0 : node(b).value, 0);
      if (std::isfinite(value)) return number(value);
    }
    ExpressionNode made;
    made.op = op;
    made.args = {a, b, c};
    return unique(op, made.args, 0, -1, [&] { return builder_.add(made); });
  }

  int negate(int a) { return make(Op::kNegate, a); }
  int add(int a, int b) { return make(Op::kAdd, a, b); }
  int subtract(int a, int b) { return make(Op::kSubtract, a, b); }
  int multiply(int a, int b) { return make(Op::kMultiply, a, b); }
  int divide(int a, int b) { return make(Op::kDivide, a, b); }
  int square(int a) { return make(Op::kPower, a, number(2)); }
  int choose(Op comparison, int a, int b, int then_value, int else_value) {
    return then_value == else_value ? then_value : make(Op::kIf, make(comparison, a, b), then_value, else_value);
  }

 private:
  /// The rules that need no arithmetic; -1 when none fits.
  int simplified(Op op, int a, int b, int c) {
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
        if (is(a, 0) || is(b, 0)) return number(0);
        if (is(a, 1)) return b;
        if (is(b, 1)) return a;
        if (is(a, -1)) return negate(b);
        return is(b, -1) ? negate(a) : -1;
      case Op::kDivide:
        if (is(a, 0) && !is(b, 0)) return number(0);
        return is(b, 1) ? a : -1;
      case Op::kPower:
        if (is(b, 0)) return number(1);
        return is(b, 1) ? a : -1;
      case Op::kIf:
        if (b == c) return b;
        if (!is_constant(a)) return -1;
        return node(a).value != 0 ? b : c;
      default:
        return -1;
    }
  }

  template <class Make>
  int unique(Op op, const std::array<int, 3>& args, double value, int text, Make make_node) {
    const auto key = std::tuple(op, args, std::bit_cast<std::uint64_t>(value), text);
    const auto found = made_.find(key);
    return found != made_.end() ? found->second : made_.emplace(key, make_node()).first->second;
  }

  const ExpressionTree& tree_;
  ExpressionTreeBuilder builder_;
  std::map<std::tuple<Op, std::array<int, 3>, std::uint64_t, int>, int> made_;
};

/// f' of an elementary function, as a formula of u and of f(u) itself.
int outer_derivative(Algebra& x, Op op, int u, int f) {
  const auto one_minus_square = [&](int a) { return x.subtract(x.number(1), x.square(a)); };
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
      return x.divide(x.number(1), x.make(Op::kSqrt, one_minus_square(u)));
    case Op::kAcos:
      return x.divide(x.number(-1), x.make(Op::kSqrt, one_minus_square(u)));
    case Op::kAtan:
      return x.divide(x.number(1), x.add(x.number(1), x.square(u)));
    case Op::kSinh:
      return x.make(Op::kCosh, u);
    case Op::kCosh:
      return x.make(Op::kSinh, u);
    case Op::kTanh:
      return one_minus_square(f);
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

/// (u^w)' = w u^(w-1) u' + u^w log(u) w'. The second term is 0 at u = 0, its limit for w > 0.
int power_derivative(Algebra& x, int u, int w, int du, int dw, int f) {
  const int lower = x.make(Op::kPower, u, x.subtract(w, x.number(1)));
  const int by_base = x.is(du, 0) ? x.number(0) : x.multiply(x.multiply(w, lower), du);
  if (x.is(dw, 0)) return by_base;
  const int slope = x.multiply(f, x.make(Op::kLog, u));
  const int guarded =
      x.is_constant(u) ? slope : x.choose(Op::kGreater, x.make(Op::kAbs, u), x.number(0), slope, x.number(0));
  return x.add(by_base, x.multiply(guarded, dw));
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

}  // namespace

Expression Expression::derivative(std::string_view name) const {
  Algebra algebra(*tree_);
  std::vector<int> value, slope;  // Per node of this tree: the node itself, and its derivative.
  for (const ExpressionNode& node : tree_->nodes) {
    const auto [a, b, c] = node.args;
    if (node.is_leaf()) {
      value.push_back(algebra.leaf(node));
      slope.push_back(algebra.number(node.op == Op::kVariable && tree_->texts[node.text] == name ? 1 : 0));
      continue;
    }
    const int u = value[a], w = b < 0 ? -1 : value[b];
    const int f = algebra.make(node.op, u, w, c < 0 ? -1 : value[c]);
    value.push_back(f);
    const auto flat = [&](int arg) { return arg < 0 || algebra.is(slope[arg], 0); };
    if (node.op == Op::kIf ? flat(b) && flat(c) : flat(a) && flat(b)) {
      slope.push_back(algebra.number(0));
    } else if (node.op == Op::kIf) {
      slope.push_back(algebra.make(Op::kIf, u, slope[b], slope[c]));
    } else if (node.op == Op::kNegate) {
      slope.push_back(algebra.negate(slope[a]));
    } else if (b >= 0) {
      slope.push_back(binary_derivative(algebra, node.op, u, w, slope[a], slope[b], f));
    } else {
      slope.push_back(algebra.multiply(outer_derivative(algebra, node.op, u, f), slope[a]));
    }
  }
  return Expression(algebra.finish(slope.back()));
}

}  // namespace ferrers
