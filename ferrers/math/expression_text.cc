#include <fmt/format.h>

#include <cmath>
#include <variant>

#include "ferrers/math/expression.h"
#include "ferrers/math/expression_node.h"

namespace ferrers {
namespace {

using Op = ExpressionOp;

/// How tightly a formula's outermost operation binds.
enum Binding { kSum = 1, kProduct, kSigned, kPower, kQuantity, kAtom };

Binding binding(const ExpressionNode& node) {
  switch (node.op) {
    case Op::kAdd:
    case Op::kSubtract:
      return kSum;
    case Op::kMultiply:
    case Op::kDivide:
      return kProduct;
    case Op::kNegate:
      return kSigned;
    case Op::kPower:
      return Binding::kPower;
    case Op::kLiteral:
      if (std::signbit(node.value)) return kSigned;
      return node.text >= 0 ? kQuantity : kAtom;
    default:
      return kAtom;
  }
}

/// What is still to be written: a piece of text, or a subtree that must bind at least so tightly.
struct Subtree {
  int index;
  int at_least;
};
using Piece = std::variant<std::string_view, Subtree>;

/// Writes with an explicit stack, so that depth does not matter.
class Writer {
 public:
  explicit Writer(const ExpressionTree& tree) : tree_(tree) {}

  std::string write() {
    pending_.push_back(Subtree{static_cast<int>(tree_.nodes.size()) - 1, kSum});
    while (!pending_.empty()) {
      const Piece piece = pending_.back();
      pending_.pop_back();
      if (const auto* text = std::get_if<std::string_view>(&piece)) {
        out_ += *text;
      } else {
        write_subtree(std::get<Subtree>(piece));
      }
    }
    return std::move(out_);
  }

 private:
  void write_subtree(const Subtree& subtree) {
    const ExpressionNode& node = tree_.nodes[subtree.index];
    const bool parentheses = binding(node) < subtree.at_least;
    if (parentheses) out_ += '(';
    if (parentheses) pending_.push_back(std::string_view(")"));
    switch (node.op) {
      case Op::kLiteral:
        out_ +=
            node.text >= 0 ? fmt::format("{} {}", node.written, tree_.texts[node.text]) : fmt::format("{}", node.value);
        break;
      case Op::kVariable:
        out_ += tree_.texts[node.text];
        break;
      case Op::kNegate:
        out_ += '-';
        pending_.push_back(Subtree{node.args[0], kSigned});
        break;
      case Op::kAdd:
        return infix(node, kSum, " + ", kProduct);
      case Op::kSubtract:
        return infix(node, kSum, " - ", kProduct);
      case Op::kMultiply:
        return infix(node, kProduct, " * ", kSigned);
      case Op::kDivide:
        return infix(node, kProduct, " / ", kSigned);
      case Op::kPower:
        return infix(node, kAtom, "^", kSigned);
      case Op::kLess:
        return infix(node, kSum, " < ", kSum);
      case Op::kLessEqual:
        return infix(node, kSum, " <= ", kSum);
      case Op::kGreater:
        return infix(node, kSum, " > ", kSum);
      case Op::kGreaterEqual:
        return infix(node, kSum, " >= ", kSum);
      default:
        out_ += expression_op_name(node.op);
        if (!node.is_leaf()) write_arguments(node);
    }
  }

  void infix(const ExpressionNode& node, int left, std::string_view sign, int right) {
    pending_.push_back(Subtree{node.args[1], right});
    pending_.push_back(sign);
    pending_.push_back(Subtree{node.args[0], left});
  }

  /// min(min(a, b), c) is written min(a, b, c), as it was read.
  void write_arguments(const ExpressionNode& node) {
    out_ += '(';
    pending_.push_back(std::string_view(")"));
    const bool joins = node.op == Op::kMin || node.op == Op::kMax;
    const ExpressionNode* current = &node;
    while (true) {
      for (int i = 2; i >= 1; --i) {
        if (current->args[i] < 0) continue;
        pending_.push_back(Subtree{current->args[i], kSum});
        pending_.push_back(std::string_view(", "));
      }
      const ExpressionNode& first = tree_.nodes[current->args[0]];
      if (!joins || first.op != node.op) break;
      current = &first;
    }
    pending_.push_back(Subtree{current->args[0], kSum});
  }

  const ExpressionTree& tree_;
  std::vector<Piece> pending_;
  std::string out_;
};

}  // namespace

std::string Expression::to_string() const { return Writer(*tree_).write(); }

}  // namespace ferrers
