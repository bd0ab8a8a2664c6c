#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "ferrers/math/expression.h"
#include "ferrers/math/expression_node.h"

namespace ferrers {
namespace {

using Op = ExpressionOp;

/// What is known of a value: nothing, that it is built of bare numbers alone, or its dimension.
struct Kind {
  enum class Tag { kUnknown, kBare, kKnown } tag = Tag::kUnknown;
  Dimension dimension;

  static Kind unknown() { return {}; }
  static Kind bare() { return {Tag::kBare, {}}; }
  static Kind known(Dimension d) {
    constexpr int kMaxExponent = 1000;  // Keeps exponents far from overflow; nothing physical comes near.
    const int largest = std::max({std::abs(d.length), std::abs(d.mass), std::abs(d.time)});
    return largest > kMaxExponent ? unknown() : Kind{Tag::kKnown, d};
  }
  bool is_unknown() const { return tag == Tag::kUnknown; }
  bool is_bare() const { return tag == Tag::kBare; }
  bool is_known() const { return tag == Tag::kKnown; }
  bool is_quantity() const { return is_known() && dimension != kPureNumber; }
};

class Inference {
 public:
  using DimensionOf = std::function<std::optional<Dimension>(std::string_view)>;

  Inference(const ExpressionTree& tree, const DimensionOf& dimension_of, Diagnostics& diagnostics)
      : tree_(tree), dimension_of_(dimension_of), diagnostics_(diagnostics) {}

  Kind run() {
    kinds_.reserve(tree_.nodes.size());
    values_.reserve(tree_.nodes.size());
    for (const ExpressionNode& node : tree_.nodes) {
      values_.push_back(constant_of(node));
      kinds_.push_back(kind_of(node));
    }
    return kinds_.back();
  }

 private:
  Kind arg(const ExpressionNode& node, int i) const { return kinds_[node.args[i]]; }

  /// The node's value when no name stands in it, else NaN.
  double constant_of(const ExpressionNode& node) const {
    if (node.op == Op::kLiteral || node.op == Op::kPi) return node.value;
    const auto value = [&](int i) { return node.args[i] < 0 ? 0.0 : values_[node.args[i]]; };
    if (node.op == Op::kVariable || std::isnan(value(0)) || std::isnan(value(1)) || std::isnan(value(2))) return NAN;
    return apply_expression_op(node.op, value(0), value(1), value(2));
  }

  Kind kind_of(const ExpressionNode& node) {
    switch (node.op) {
      case Op::kLiteral:
        return node.text >= 0 ? Kind::known(parse_unit(tree_.texts[node.text])->dimension) : Kind::bare();
      case Op::kPi:
        return Kind::bare();
      case Op::kVariable: {
        const std::optional<Dimension> dimension = dimension_of_(tree_.texts[node.text]);
        return dimension ? Kind::known(*dimension) : Kind::unknown();
      }
      case Op::kNegate:
      case Op::kAbs:
        return arg(node, 0);
      case Op::kMultiply:
      case Op::kDivide:
        return product(node);
      case Op::kPower:
        return power(node);
      case Op::kSqrt:
        return raised(node, arg(node, 0), 0.5);
      case Op::kSign:
        return Kind::known(kPureNumber);
      case Op::kIf:
        return alike(node, arg(node, 1), arg(node, 2));
      case Op::kLess:
      case Op::kLessEqual:
      case Op::kGreater:
      case Op::kGreaterEqual:
      case Op::kAtan2:
        alike(node, arg(node, 0), arg(node, 1));
        return Kind::known(kPureNumber);
      case Op::kAdd:
      case Op::kSubtract:
      case Op::kHypot:
      case Op::kMod:
      case Op::kMin:
      case Op::kMax:
        return alike(node, arg(node, 0), arg(node, 1));
      default:
        return pure_function(node);
    }
  }

  Kind product(const ExpressionNode& node) const {
    const Kind a = arg(node, 0), b = arg(node, 1);
    if (a.is_unknown() || b.is_unknown()) return Kind::unknown();
    if (a.is_bare() && b.is_bare()) return Kind::bare();
    return Kind::known(node.op == Op::kMultiply ? a.dimension * b.dimension : a.dimension / b.dimension);
  }

  /// Two values that must have one dimension; what is not known takes the other's.
  Kind alike(const ExpressionNode& node, const Kind& a, const Kind& b) {
    if (a.is_known() && b.is_known()) {
      if (a.dimension == b.dimension) return a;
      wrong(node,
            fmt::format("'{}' joins {} and {}", expression_op_name(node.op), ferrers::to_string(a.dimension),
                        ferrers::to_string(b.dimension)),
            "both sides must have one dimension");
      return Kind::unknown();
    }
    if (a.is_known() || b.is_known()) return a.is_known() ? a : b;
    return a.is_bare() && b.is_bare() ? a : Kind::unknown();
  }

  Kind pure_function(const ExpressionNode& node) {
    const Kind a = arg(node, 0);
    if (a.is_quantity()) {
      wrong(
          node,
          fmt::format("'{}' wants a pure number, got {}", expression_op_name(node.op), ferrers::to_string(a.dimension)),
          "divide by a quantity of the same dimension");
    }
    return a.is_bare() ? a : Kind::known(kPureNumber);
  }

  Kind power(const ExpressionNode& node) {
    const Kind base = arg(node, 0), exponent = arg(node, 1);
    if (exponent.is_quantity()) {
      wrong(node, fmt::format("an exponent is a pure number, got {}", ferrers::to_string(exponent.dimension)),
            "divide by a quantity of the same dimension");
      return Kind::unknown();
    }
    const double value = values_[node.args[1]];
    if (!std::isnan(value)) return raised(node, base, value);
    if (base.is_quantity()) {
      wrong(node, fmt::format("{} to a power that is no constant has no dimension", ferrers::to_string(base.dimension)),
            "divide the base by a quantity of the same dimension, or write the exponent as a number");
      return Kind::unknown();
    }
    return base;
  }

  Kind raised(const ExpressionNode& node, const Kind& base, double exponent) {
    if (!base.is_quantity()) return base;
    const int exponents[] = {base.dimension.length, base.dimension.mass, base.dimension.time};
    int raised[3];
    for (int i = 0; i < 3; ++i) {
      constexpr double kMaxExponent = 1000, kRounding = 1e-9;
      const double wanted = exponents[i] * exponent;
      if (!(std::abs(wanted) <= kMaxExponent) || std::abs(wanted - std::round(wanted)) > kRounding) {
        wrong(node, fmt::format("{} to the power {} has no dimension", ferrers::to_string(base.dimension), exponent),
              "the exponents of m, kg and s must come out whole");
        return Kind::unknown();
      }
      raised[i] = static_cast<int>(std::lround(wanted));
    }
    return Kind::known({raised[0], raised[1], raised[2]});
  }

  void wrong(const ExpressionNode& node, std::string message, std::string hint) {
    diagnostics_.error("F204", node.at, std::move(message), std::move(hint));
  }

  const ExpressionTree& tree_;
  const DimensionOf& dimension_of_;
  Diagnostics& diagnostics_;
  std::vector<Kind> kinds_;
  std::vector<double> values_;
};

}  // namespace

std::optional<Dimension> Expression::dimension(
    const std::function<std::optional<Dimension>(std::string_view)>& dimension_of, Diagnostics& diagnostics) const {
  const Kind kind = Inference(*tree_, dimension_of, diagnostics).run();
  return kind.is_known() ? std::optional(kind.dimension) : std::nullopt;
}

}  // namespace ferrers
