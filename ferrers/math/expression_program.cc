#include <algorithm>
#include <stdexcept>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "ferrers/core/checks.h"
#include "ferrers/math/expression.h"
#include "ferrers/math/expression_code.h"
#include "ferrers/math/expression_graph.h"
#include "ferrers/math/expression_node.h"

namespace ferrers {
namespace {

/// The number of an input by its name. Few look-ups search, many are worth an index.
class InputNumbers {
 public:
  InputNumbers(std::span<const std::string> inputs, std::size_t look_ups) : inputs_(inputs) {
    constexpr std::size_t kFew = 8;
    if (look_ups <= kFew) return;
    for (std::size_t i = 0; i < inputs.size(); ++i) index_.try_emplace(inputs[i], static_cast<int>(i));
  }

  int operator()(const std::string& name) const {
    if (index_.empty()) {
      const auto found = std::find(inputs_.begin(), inputs_.end(), name);
      if (found != inputs_.end()) return static_cast<int>(found - inputs_.begin());
    } else if (const auto found = index_.find(name); found != index_.end()) {
      return found->second;
    }
    throw std::invalid_argument("ExpressionProgram: '" + name + "' is no input");
  }

 private:
  std::span<const std::string> inputs_;
  std::unordered_map<std::string_view, int> index_;
};

/// Calls `use` with the registers filled, which stand on the stack up to a bound.
template <class Use>
auto with_registers(const ExpressionCode& code, const double* inputs, Use use) {
  const auto executed = [&](double* registers) {
    code.execute(inputs, registers);
    return use(static_cast<const double*>(registers));
  };
  constexpr int kSmall = 256, kMiddle = 2048, kLarge = 16384;
  if (code.register_count <= kSmall) {
    double registers[kSmall];
    return executed(registers);
  }
  if (code.register_count <= kMiddle) {
    double registers[kMiddle];
    return executed(registers);
  }
  if (code.register_count <= kLarge) {
    double registers[kLarge];
    return executed(registers);
  }
  return executed(std::vector<double>(static_cast<std::size_t>(code.register_count)).data());
}

}  // namespace

struct ExpressionProgram::Code : ExpressionCode {};

ExpressionProgram::ExpressionProgram() : ExpressionProgram(Expression(), {}) {}

ExpressionProgram::ExpressionProgram(const Expression& expression, std::span<const std::string> inputs)
    : ExpressionProgram(std::span(&expression, 1), inputs) {}

ExpressionProgram::ExpressionProgram(std::span<const Expression> outputs, std::span<const std::string> inputs) {
  std::size_t look_ups = 0;
  for (const Expression& output : outputs) look_ups += output.tree_->texts.size();
  const InputNumbers number_of(inputs, look_ups);
  ExpressionGraph graph;
  std::vector<int> roots;
  for (const Expression& output : outputs) {
    const ExpressionTree& tree = *output.tree_;
    std::vector<int> input_of_text(tree.texts.size(), -1);
    for (const ExpressionNode& node : tree.nodes) {
      if (node.op != ExpressionOp::kVariable || input_of_text[node.text] >= 0) continue;
      input_of_text[node.text] = number_of(tree.texts[node.text]);
    }
    roots.push_back(graph.add(tree, input_of_text));
  }
  code_ = std::make_shared<const Code>(Code{compile_expressions(graph, roots)});
}

int ExpressionProgram::register_count() const { return code_->register_count; }
int ExpressionProgram::instruction_count() const { return code_->step_count; }
int ExpressionProgram::output_count() const { return static_cast<int>(code_->outputs.size()); }

double ExpressionProgram::evaluate(const double* inputs) const {
  require(code_->outputs.size() == 1, "ExpressionProgram::evaluate: the program has not one output");
  return with_registers(*code_, inputs, [&](const double* registers) { return registers[code_->outputs.front()]; });
}

void ExpressionProgram::evaluate(const double* inputs, double* outputs) const {
  with_registers(*code_, inputs, [&](const double* registers) {
    for (const int place : code_->outputs) *outputs++ = registers[place];
  });
}

}  // namespace ferrers
