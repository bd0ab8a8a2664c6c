#include "ferrers/math/expression_node.h"

#include <utility>

namespace ferrers {
namespace {

using Op = ExpressionOp;

constexpr ExpressionFunction kFunctions[] = {
    {"sin", Op::kSin, 1, 1},
    {"cos", Op::kCos, 1, 1},
    {"tan", Op::kTan, 1, 1},
    {"asin", Op::kAsin, 1, 1},
    {"acos", Op::kAcos, 1, 1},
    {"atan", Op::kAtan, 1, 1},
    {"atan2", Op::kAtan2, 2, 2},
    {"sinh", Op::kSinh, 1, 1},
    {"cosh", Op::kCosh, 1, 1},
    {"tanh", Op::kTanh, 1, 1},
    {"exp", Op::kExp, 1, 1},
    {"log", Op::kLog, 1, 1},
    {"log10", Op::kLog10, 1, 1},
    {"sqrt", Op::kSqrt, 1, 1},
    {"abs", Op::kAbs, 1, 1},
    {"sign", Op::kSign, 1, 1},
    {"floor", Op::kFloor, 1, 1},
    {"smoothstep", Op::kSmoothstep, 1, 1},
    {"smootherstep", Op::kSmootherstep, 1, 1},
    {"min", Op::kMin, 2, kManyArguments},
    {"max", Op::kMax, 2, kManyArguments},
    {"mod", Op::kMod, 2, 2},
    {"pow", Op::kPower, 2, 2},
    {"hypot", Op::kHypot, 2, 2},
    {"if", Op::kIf, 3, 3},
};

}  // namespace

std::span<const ExpressionFunction> expression_functions() { return kFunctions; }

const ExpressionFunction* find_expression_function(std::string_view name) {
  for (const ExpressionFunction& function : kFunctions) {
    if (function.name == name) return &function;
  }
  return nullptr;
}

std::string_view expression_op_name(ExpressionOp op) {
  static constexpr std::pair<Op, std::string_view> kSigns[] = {
      {Op::kNegate, "-"},  {Op::kAdd, "+"},           {Op::kSubtract, "-"}, {Op::kMultiply, "*"},
      {Op::kDivide, "/"},  {Op::kPower, "^"},         {Op::kLess, "<"},     {Op::kLessEqual, "<="},
      {Op::kGreater, ">"}, {Op::kGreaterEqual, ">="}, {Op::kPi, "pi"},
  };
  for (const auto& [sign_op, sign] : kSigns) {
    if (sign_op == op) return sign;
  }
  for (const ExpressionFunction& function : kFunctions) {
    if (function.op == op) return function.name;
  }
  return {};
}

int ExpressionTreeBuilder::add(ExpressionNode node) {
  tree_.nodes.push_back(node);
  return static_cast<int>(tree_.nodes.size()) - 1;
}

int ExpressionTreeBuilder::literal(double value) {
  ExpressionNode node;
  node.value = value;
  return add(node);
}

int ExpressionTreeBuilder::variable(std::string_view name, SourceRange at) {
  ExpressionNode node;
  node.op = Op::kVariable;
  node.text = text(name);
  node.at = at;
  return add(node);
}

int ExpressionTreeBuilder::text(std::string_view text) {
  const auto [place, inserted] = text_index_.try_emplace(std::string(text), static_cast<int>(tree_.texts.size()));
  if (inserted) tree_.texts.emplace_back(text);
  return place->second;
}

std::vector<int> evaluation_order(const std::vector<ExpressionNode>& nodes, int root) {
  enum class Mark : std::uint8_t { kNew, kOpen, kDone };
  std::vector<Mark> marks(nodes.size(), Mark::kNew);
  std::vector<int> order, stack{root};
  while (!stack.empty()) {
    const int index = stack.back();
    if (marks[index] == Mark::kNew) {
      marks[index] = Mark::kOpen;
      for (int i = 2; i >= 0; --i) {
        const int arg = nodes[index].args[i];
        if (arg >= 0 && marks[arg] == Mark::kNew) stack.push_back(arg);
      }
      continue;
    }
    stack.pop_back();
    if (marks[index] == Mark::kOpen) order.push_back(index);
    marks[index] = Mark::kDone;
  }
  return order;
}

std::shared_ptr<const ExpressionTree> ExpressionTreeBuilder::finish(int root, SourceRange at) {
  auto result = std::make_shared<ExpressionTree>();
  result->at = at;
  std::vector<int> moved(tree_.nodes.size(), -1);
  std::vector<int> moved_text(tree_.texts.size(), -1);
  for (const int index : evaluation_order(tree_.nodes, root)) {
    ExpressionNode node = tree_.nodes[index];
    for (int& arg : node.args) {
      if (arg >= 0) arg = moved[arg];
    }
    if (node.text >= 0) {
      int& text = moved_text[node.text];
      if (text < 0) {
        text = static_cast<int>(result->texts.size());
        result->texts.push_back(tree_.texts[node.text]);
      }
      node.text = text;
    }
    moved[index] = static_cast<int>(result->nodes.size());
    result->nodes.push_back(node);
  }
  return result;
}

}  // namespace ferrers
