#include <algorithm>
#include <functional>
#include <stdexcept>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "ferrers/core/checks.h"
#include "ferrers/math/expression.h"
#include "ferrers/math/expression_code.h"
#include "ferrers/math/expression_graph.h"
#include "ferrers/math/expression_machine.h"
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

/// Calls `use` with room for `size` doubles, on the stack up to a bound.
template <class Use>
auto with_room(int size, Use use) {
  constexpr int kSmall = 256, kMiddle = 2048, kLarge = 16384;
  if (size <= kSmall) {
    double room[kSmall];
    return use(room);
  }
  if (size <= kMiddle) {
    double room[kMiddle];
    return use(room);
  }
  if (size <= kLarge) {
    double room[kLarge];
    return use(room);
  }
  return use(std::vector<double>(static_cast<std::size_t>(size)).data());
}

constexpr int kWorthMachineCode = 12;  // steps, from which on it pays to make native code

}  // namespace

struct ExpressionProgram::Code : ExpressionCode {
  /// Native code writes an output as soon as it has it: it cannot do so over inputs that it still needs.
  bool overlap(const double* from, const double* to) const {
    const std::less<const double*> before;
    return before(from, to + outputs.size()) && before(to, from + inputs_end);
  }

  ExpressionMachine machine;  // where there is one
  int inputs_end = 0;         // after the last input that is read
};

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
  Code code{compile_expressions(graph, roots), {}};
  for (const int input : code.inputs) code.inputs_end = std::max(code.inputs_end, input + 1);
  if (code.step_count >= kWorthMachineCode) code.machine = assemble_expressions(graph, roots);
  code_ = std::make_shared<const Code>(std::move(code));
}

bool ExpressionProgram::is_native() const { return code_->machine.function != nullptr; }

ExpressionProgram ExpressionProgram::interpreted() const {
  ExpressionProgram out;
  Code code = *code_;
  code.machine = {};
  out.code_ = std::make_shared<const Code>(std::move(code));
  return out;
}

int ExpressionProgram::register_count() const { return code_->register_count; }
int ExpressionProgram::instruction_count() const { return code_->step_count; }
int ExpressionProgram::output_count() const { return static_cast<int>(code_->outputs.size()); }

double ExpressionProgram::evaluate(const double* inputs) const {
  require(code_->outputs.size() == 1, "ExpressionProgram::evaluate: the program has not one output");
  double output;
  evaluate(inputs, &output);
  return output;
}

void ExpressionProgram::evaluate(const double* inputs, double* outputs) const {
  if (is_native() && !code_->overlap(inputs, outputs)) {
    with_room(code_->machine.scratch_size, [&](double* scratch) { code_->machine.function(inputs, outputs, scratch); });
    return;
  }
  with_room(code_->register_count, [&](double* registers) {
    code_->execute(inputs, registers);
    for (const int place : code_->outputs) *outputs++ = registers[place];
  });
}

}  // namespace ferrers
