#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "ferrers/core/diagnostics.h"

/// The syntax tree of formulas. Private to expression*.cc.
///
/// A tree is a flat array in which operands stand before their operators and the root stands last. So every algorithm
/// is a loop over the array: no recursion, no bound on depth, and shared subtrees are visited once.
namespace ferrers {

// clang-format off
enum class ExpressionOp : std::uint8_t {
  kLiteral, kPi, kVariable,                                          // leaves
  kNegate, kAdd, kSubtract, kMultiply, kDivide, kPower,              // operators
  kSin, kCos, kTan, kAsin, kAcos, kAtan, kSinh, kCosh, kTanh,        // functions of one pure number
  kExp, kLog, kLog10, kFloor, kSmoothstep, kSmootherstep,
  kSqrt, kAbs, kSign,                                                // functions of one quantity
  kAtan2, kHypot, kMod, kMin, kMax,                                  // functions of two
  kLess, kLessEqual, kGreater, kGreaterEqual, kIf,                   // comparisons (1 or 0), and the choice
};
// clang-format on

struct ExpressionNode {
  ExpressionOp op = ExpressionOp::kLiteral;
  std::array<int, 3> args{-1, -1, -1};  ///< Indices of the operands in the tree, unused ones -1.
  double value = 0;                     ///< kLiteral, kPi: in SI.
  double written = 0;                   ///< kLiteral with a unit: the number before the unit.
  int text = -1;   ///< kVariable: its name; kLiteral: its unit, or -1. Index into the tree's texts.
  SourceRange at;  ///< The leaf, the operator, or the function's name.

  bool is_literal() const { return op == ExpressionOp::kLiteral; }
  bool is_leaf() const { return op <= ExpressionOp::kVariable; }
};

struct ExpressionTree {
  std::vector<ExpressionNode> nodes;
  std::vector<std::string> texts;
  SourceRange at;

  const ExpressionNode& root() const { return nodes.back(); }
};

struct ExpressionFunction {
  std::string_view name;
  ExpressionOp op;
  int min_arguments, max_arguments;
};

inline constexpr int kManyArguments = 1000;

/// Every function of the language.
std::span<const ExpressionFunction> expression_functions();
const ExpressionFunction* find_expression_function(std::string_view name);  ///< Null when there is none.
std::string_view expression_op_name(ExpressionOp op);                       ///< As written: "sin", "+", "<=".

/// Collects nodes, operands before operators; `finish` keeps what the root needs, in evaluation order.
class ExpressionTreeBuilder {
 public:
  int add(ExpressionNode node);
  int literal(double value);
  int variable(std::string_view name, SourceRange at);
  int text(std::string_view text);  ///< Index of the text, the same for the same text.
  const ExpressionNode& node(int index) const { return tree_.nodes[index]; }

  std::shared_ptr<const ExpressionTree> finish(int root, SourceRange at);

 private:
  ExpressionTree tree_;
  std::unordered_map<std::string, int> text_index_;
};

/// The nodes that `root` needs, each once, operands first, in the order a recursive evaluation would reach them.
std::vector<int> evaluation_order(const std::vector<ExpressionNode>& nodes, int root);

/// a to the power b. Small whole exponents are products: faster, and as exact as a few roundings are.
inline double power_of(double a, double b) {
  if (b == 2) return a * a;
  if (b == 3) return a * a * a;
  if (b == 4) return (a * a) * (a * a);
  if (b == -1) return 1 / a;
  if (b == -2) return 1 / (a * a);
  return std::pow(a, b);
}

// clang-format off
/// The value of one operation; the only place that says what an operation computes. NaN operands give NaN.
inline double apply_expression_op(ExpressionOp op, double a, double b, double c) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  switch (op) {
    case ExpressionOp::kNegate: return -a;
    case ExpressionOp::kAdd: return a + b;
    case ExpressionOp::kSubtract: return a - b;
    case ExpressionOp::kMultiply: return a * b;
    case ExpressionOp::kDivide: return a / b;
    case ExpressionOp::kPower: return power_of(a, b);
    case ExpressionOp::kSin: return std::sin(a);
    case ExpressionOp::kCos: return std::cos(a);
    case ExpressionOp::kTan: return std::tan(a);
    case ExpressionOp::kAsin: return std::asin(a);
    case ExpressionOp::kAcos: return std::acos(a);
    case ExpressionOp::kAtan: return std::atan(a);
    case ExpressionOp::kSinh: return std::sinh(a);
    case ExpressionOp::kCosh: return std::cosh(a);
    case ExpressionOp::kTanh: return std::tanh(a);
    case ExpressionOp::kExp: return std::exp(a);
    case ExpressionOp::kLog: return std::log(a);
    case ExpressionOp::kLog10: return std::log10(a);
    case ExpressionOp::kFloor: return std::floor(a);
    case ExpressionOp::kSmoothstep: return a <= 0 ? 0 : a >= 1 ? 1 : a * a * (3 - 2 * a);
    case ExpressionOp::kSmootherstep: return a <= 0 ? 0 : a >= 1 ? 1 : a * a * a * (10 + a * (6 * a - 15));
    case ExpressionOp::kSqrt: return std::sqrt(a);
    case ExpressionOp::kAbs: return std::abs(a);
    case ExpressionOp::kSign: return a > 0 ? 1 : a < 0 ? -1 : a;
    case ExpressionOp::kAtan2: return std::atan2(a, b);
    case ExpressionOp::kHypot: return std::hypot(a, b);
    case ExpressionOp::kMod: return a - b * std::floor(a / b);
    case ExpressionOp::kMin: return a <= b ? a : b < a ? b : kNan;
    case ExpressionOp::kMax: return a >= b ? a : b > a ? b : kNan;
    case ExpressionOp::kLess: return a < b ? 1 : a >= b ? 0 : kNan;
    case ExpressionOp::kLessEqual: return a <= b ? 1 : a > b ? 0 : kNan;
    case ExpressionOp::kGreater: return a > b ? 1 : a <= b ? 0 : kNan;
    case ExpressionOp::kGreaterEqual: return a >= b ? 1 : a < b ? 0 : kNan;
    case ExpressionOp::kIf: return a != 0 ? (a == a ? b : kNan) : c;
    case ExpressionOp::kLiteral:
    case ExpressionOp::kPi:
    case ExpressionOp::kVariable: break;
  }
  return kNan;
}
// clang-format on

}  // namespace ferrers
