#include <algorithm>
#include <stdexcept>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "ferrers/core/checks.h"
#include "ferrers/math/expression.h"
#include "ferrers/math/expression_graph.h"
#include "ferrers/math/expression_node.h"

namespace ferrers {

using Op = ExpressionOp;

/// The register file is: the inputs that are used, the constants, then what the steps compute.
struct ExpressionProgram::Code {
  /// `result = op(a, b, c)`, all registers.
  struct Step {
    Op op = Op::kLiteral;
    int result = 0, a = 0, b = 0, c = 0;
  };

  std::vector<int> inputs;        ///< Which inputs stand at the start of the register file.
  std::vector<double> constants;  ///< What stands after them.
  std::vector<Step> steps;
  std::vector<int> outputs;  ///< The registers that hold the outputs at the end.
  int register_count = 0;

  const double* run(const double* values, double* registers) const;
};

namespace {

/// Hands out register numbers, the most recently freed first, so that few are used and those stay in cache.
class Registers {
 public:
  int take() {
    if (free_.empty()) return count_++;
    const int index = free_.back();
    free_.pop_back();
    return index;
  }
  void give_back(int index) { free_.push_back(index); }
  int count() const { return count_; }

 private:
  std::vector<int> free_;
  int count_ = 0;
};

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

/// The values that the outputs need, operands first, in the order a recursive evaluation would reach them.
std::vector<int> needed(const ExpressionGraph& graph, std::span<const int> outputs) {
  const auto& values = graph.values();
  enum class Mark : std::uint8_t { kNew, kOpen, kDone };
  std::vector<Mark> marks(values.size(), Mark::kNew);
  std::vector<int> order, stack;
  for (const int output : outputs) {
    stack.push_back(output);
    while (!stack.empty()) {
      const int index = stack.back();
      if (marks[index] == Mark::kNew) {
        marks[index] = Mark::kOpen;
        if (!values[index].is_operation()) continue;
        for (int i = 2; i >= 0; --i) {
          const int arg = values[index].args[i];
          if (arg >= 0 && marks[arg] == Mark::kNew) stack.push_back(arg);
        }
        continue;
      }
      stack.pop_back();
      if (marks[index] == Mark::kOpen) order.push_back(index);
      marks[index] = Mark::kDone;
    }
  }
  return order;
}

}  // namespace

const double* ExpressionProgram::Code::run(const double* values, double* registers) const {
  double* next = registers;
  for (const int input : inputs) *next++ = values[input];
  for (const double constant : constants) *next++ = constant;
  for (const Step& step : steps) {
    registers[step.result] = apply_expression_op(step.op, registers[step.a], registers[step.b], registers[step.c]);
  }
  return registers;
}

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
      if (node.op != Op::kVariable || input_of_text[node.text] >= 0) continue;
      input_of_text[node.text] = number_of(tree.texts[node.text]);
    }
    roots.push_back(graph.add(tree, input_of_text));
  }

  auto code = std::make_shared<Code>();
  const auto& values = graph.values();
  const std::vector<int> order = needed(graph, roots);
  std::vector<int> last_use(values.size(), -1), place(values.size(), -1);
  for (const int index : order) {
    if (!values[index].is_operation()) continue;
    for (const int arg : values[index].args) {
      if (arg >= 0) last_use[arg] = index;
    }
  }
  for (const int root : roots) last_use[root] = -1;  // kept to the end
  Registers registers;
  for (const int index : order) {
    if (values[index].op != Op::kVariable) continue;
    place[index] = registers.take();
    code->inputs.push_back(values[index].args[0]);
  }
  for (const int index : order) {
    if (!values[index].is_constant()) continue;
    place[index] = registers.take();
    code->constants.push_back(values[index].constant);
  }
  for (const int index : order) {
    if (!values[index].is_operation()) continue;
    const auto& args = values[index].args;
    // An absent operand reads a register that is surely written: the first operand.
    const auto operand = [&](int k) { return place[args[args[k] >= 0 ? k : 0]]; };
    Code::Step step{values[index].op, 0, operand(0), operand(1), operand(2)};
    for (const int arg : args) {
      if (arg < 0 || last_use[arg] != index || !values[arg].is_operation()) continue;
      registers.give_back(place[arg]);
      last_use[arg] = -1;  // the same operand twice (x*x) is freed once
    }
    step.result = place[index] = registers.take();
    code->steps.push_back(step);
  }
  for (const int root : roots) code->outputs.push_back(place[root]);
  code->register_count = registers.count();
  code_ = std::move(code);
}

int ExpressionProgram::register_count() const { return code_->register_count; }
int ExpressionProgram::instruction_count() const { return static_cast<int>(code_->steps.size()); }
int ExpressionProgram::output_count() const { return static_cast<int>(code_->outputs.size()); }

namespace {

/// Calls `use` with room for so many registers, which stand on the stack up to a bound.
template <class Use>
auto with_registers(int count, Use use) {
  constexpr int kSmall = 64, kLarge = 4096;
  if (count <= kSmall) {
    double registers[kSmall];
    return use(registers);
  }
  if (count <= kLarge) {
    double registers[kLarge];
    return use(registers);
  }
  return use(std::vector<double>(static_cast<std::size_t>(count)).data());
}

}  // namespace

double ExpressionProgram::evaluate(const double* inputs) const {
  require(code_->outputs.size() == 1, "ExpressionProgram::evaluate: the program has not one output");
  return with_registers(code_->register_count,
                        [&](double* registers) { return code_->run(inputs, registers)[code_->outputs.front()]; });
}

void ExpressionProgram::evaluate(const double* inputs, double* outputs) const {
  with_registers(code_->register_count, [&](double* registers) {
    const double* const results = code_->run(inputs, registers);
    for (const int place : code_->outputs) *outputs++ = results[place];
  });
}

}  // namespace ferrers
