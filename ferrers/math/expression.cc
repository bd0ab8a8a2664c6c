#include "ferrers/math/expression.h"

#include <utility>

#include "ferrers/core/checks.h"
#include "ferrers/math/expression_node.h"

namespace ferrers {

using Op = ExpressionOp;

bool is_expression_keyword(std::string_view name) {
  return name == expression_op_name(Op::kPi) || find_expression_function(name) != nullptr;
}

Expression::Expression() {
  static const Expression zero = constant(0);
  tree_ = zero.tree_;
}

Expression::Expression(std::shared_ptr<const ExpressionTree> tree) : tree_(std::move(tree)) {}

Expression Expression::constant(double value) {
  require(std::isfinite(value), "Expression::constant: the value must be finite");
  ExpressionTreeBuilder builder;
  return Expression(builder.finish(builder.literal(value), {}));
}

Expression Expression::variable(std::string_view name) {
  ExpressionTreeBuilder builder;
  return Expression(builder.finish(builder.variable(name, {}), {}));
}

std::vector<ExpressionName> Expression::names() const {
  std::vector<ExpressionName> names;
  std::vector<bool> seen(tree_->texts.size(), false);
  for (const ExpressionNode& node : tree_->nodes) {
    if (node.op != Op::kVariable || seen[node.text]) continue;
    seen[node.text] = true;
    names.push_back({tree_->texts[node.text], node.at});
  }
  return names;
}

bool Expression::depends_on(std::string_view name) const {
  for (const ExpressionNode& node : tree_->nodes) {
    if (node.op == Op::kVariable && tree_->texts[node.text] == name) return true;
  }
  return false;
}

std::optional<double> Expression::constant_value() const {
  for (const ExpressionNode& node : tree_->nodes) {
    if (node.op == Op::kVariable) return std::nullopt;
  }
  return ExpressionProgram(*this, {}).evaluate(nullptr);
}

Expression Expression::substitute(const std::function<std::optional<Expression>(std::string_view)>& replacement) const {
  ExpressionTreeBuilder builder;
  const auto copy = [&builder](const ExpressionTree& tree, ExpressionNode node, const std::vector<int>& moved) {
    for (int& arg : node.args) {
      if (arg >= 0) arg = moved[arg];
    }
    if (node.text >= 0) node.text = builder.text(tree.texts[node.text]);
    return builder.add(node);
  };
  // Each name is asked for and copied in once, however often it is used: chains of substitutions grow by addition.
  constexpr int kUnasked = -1, kKept = -2;
  std::vector<int> replaced(tree_->texts.size(), kUnasked);
  std::vector<int> moved;
  moved.reserve(tree_->nodes.size());
  for (const ExpressionNode& node : tree_->nodes) {
    if (node.op == Op::kVariable && replaced[node.text] == kUnasked) {
      replaced[node.text] = kKept;
      if (const std::optional<Expression> formula = replacement(tree_->texts[node.text])) {
        std::vector<int> inner;
        for (const ExpressionNode& inner_node : formula->tree_->nodes) {
          inner.push_back(copy(*formula->tree_, inner_node, inner));
        }
        replaced[node.text] = inner.back();
      }
    }
    const bool replace = node.op == Op::kVariable && replaced[node.text] >= 0;
    moved.push_back(replace ? replaced[node.text] : copy(*tree_, node, moved));
  }
  return Expression(builder.finish(moved.back(), tree_->at));
}

SourceRange Expression::at() const { return tree_->at; }

}  // namespace ferrers
