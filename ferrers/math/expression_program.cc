#include <algorithm>
#include <stdexcept>
#include <utility>

#include "ferrers/math/expression.h"
#include "ferrers/math/expression_node.h"

namespace ferrers {

using Op = ExpressionOp;

/// One step: `result = op(a, b, c)`, all registers; a constant; or the input number `a`.
struct ExpressionProgram::Instruction {
  Op op = Op::kLiteral;
  int result = 0, a = 0, b = 0, c = 0;
  double value = 0;
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

template <class Instructions>
double run(const Instructions& code, const double* values, double* registers) {
  for (const auto& step : code) {
    double& result = registers[step.result];
    switch (step.op) {
      case Op::kLiteral:
        result = step.value;
        break;
      case Op::kVariable:
        result = values[step.a];
        break;
      default:
        result = apply_expression_op(step.op, registers[step.a], registers[step.b], registers[step.c]);
    }
  }
  return registers[code.back().result];
}

int input_index(const std::string& name, std::span<const std::string> inputs) {
  const auto found = std::find(inputs.begin(), inputs.end(), name);
  if (found == inputs.end()) throw std::invalid_argument("ExpressionProgram: '" + name + "' is no input");
  return static_cast<int>(found - inputs.begin());
}

}  // namespace

ExpressionProgram::ExpressionProgram() : ExpressionProgram(Expression(), {}) {}

ExpressionProgram::ExpressionProgram(const Expression& expression, std::span<const std::string> inputs) {
  const ExpressionTree& tree = *expression.tree_;
  std::vector<int> last_use(tree.nodes.size(), -1);
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    for (const int arg : tree.nodes[i].args) {
      if (arg >= 0) last_use[arg] = static_cast<int>(i);
    }
  }
  std::vector<int> input_of_text(tree.texts.size(), -1);
  std::vector<int> place(tree.nodes.size(), -1);
  std::vector<Instruction> code;
  code.reserve(tree.nodes.size());
  Registers registers;
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const ExpressionNode& node = tree.nodes[i];
    Instruction step;
    step.op = node.op == Op::kPi ? Op::kLiteral : node.op;
    step.value = node.value;
    int* const operands[] = {&step.a, &step.b, &step.c};
    for (int k = 0; k < 3; ++k) {
      // An absent operand reads a register that is surely written: the first operand.
      if (node.args[0] >= 0) *operands[k] = place[node.args[node.args[k] >= 0 ? k : 0]];
    }
    if (node.op == Op::kVariable) {
      int& input = input_of_text[node.text];
      if (input < 0) input = input_index(tree.texts[node.text], inputs);
      step.a = input;
    }
    for (const int arg : node.args) {
      if (arg < 0 || last_use[arg] != static_cast<int>(i)) continue;
      registers.give_back(place[arg]);
      last_use[arg] = -1;  // the same operand twice (x*x) is freed once
    }
    step.result = place[i] = registers.take();
    code.push_back(step);
  }
  register_count_ = registers.count();
  code_ = std::make_shared<const std::vector<Instruction>>(std::move(code));
}

int ExpressionProgram::instruction_count() const { return static_cast<int>(code_->size()); }

double ExpressionProgram::evaluate(const double* values) const {
  constexpr int kSmall = 64, kLarge = 4096;
  if (register_count_ <= kSmall) {
    double registers[kSmall];
    return run(*code_, values, registers);
  }
  if (register_count_ <= kLarge) {
    double registers[kLarge];
    return run(*code_, values, registers);
  }
  return run(*code_, values, std::vector<double>(static_cast<std::size_t>(register_count_)).data());
}

}  // namespace ferrers
