#include "ferrers/math/expression_machine.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "ferrers/math/straight_code.h"

namespace ferrers {
namespace {

using Value = ExpressionGraph::Value;
using Base = X86Assembler::Base;
using Operand = X86Assembler::Operand;

// The operations that the outputs need, operands first; calls and what they need before all others.
class Order {
 public:
  Order(const std::vector<Value>& values, std::span<const int> outputs) : values_(values), done_(values.size(), false) {
    const std::vector<int> all = reach(outputs);
    std::fill(done_.begin(), done_.end(), false);
    std::vector<int> calls;
    for (const int index : all) {
      if (!is_instruction(values_[index].op)) calls.push_back(index);
    }
    order_ = reach(calls);
    const std::vector<int> rest = reach(outputs);
    order_.insert(order_.end(), rest.begin(), rest.end());
  }

  std::vector<int> take() { return std::move(order_); }

 private:
  std::vector<int> reach(std::span<const int> from) {
    std::vector<int> found, stack;
    for (const int root : from) {
      stack.push_back(root);
      while (!stack.empty()) {
        const int index = stack.back();
        if (done_[index] || !values_[index].is_operation()) {
          stack.pop_back();
          continue;
        }
        const std::size_t height = stack.size();
        for (int i = 2; i >= 0; --i) {
          const int arg = values_[index].args[i];
          if (arg >= 0 && values_[arg].is_operation() && !done_[arg]) stack.push_back(arg);
        }
        if (stack.size() > height) continue;
        stack.pop_back();
        done_[index] = true;
        found.push_back(index);
      }
    }
    return found;
  }

  const std::vector<Value>& values_;
  std::vector<bool> done_;
  std::vector<int> order_;
};

// Inputs from rbx on, outputs from rbp on.
StraightCode straight_code(const ExpressionGraph& graph, std::span<const int> outputs) {
  const std::vector<Value>& values = graph.values();
  StraightCode code;
  std::vector<int> number(values.size(), -1);
  const auto add = [&](int index) {
    const Value& value = values[index];
    StraightCode::Value out;
    out.op = static_cast<StraightCode::Op>(value.op);
    out.constant = value.constant;
    if (value.op == ExpressionOp::kVariable) {
      out.place = Operand::at(Base::kRbx, value.args[0]);
    } else if (value.is_operation()) {
      for (std::size_t i = 0; i < 3; ++i) out.args[i] = value.args[i] < 0 ? -1 : number[value.args[i]];
    }
    number[index] = code.add(out);
  };
  const auto add_leaf = [&](int index) {
    if (index >= 0 && number[index] < 0 && !values[index].is_operation()) add(index);
  };
  for (const int index : Order(values, outputs).take()) {
    for (const int arg : values[index].args) add_leaf(arg);
    add(index);
  }
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    add_leaf(outputs[i]);
    code.stores.push_back({number[outputs[i]], Operand::at(Base::kRbp, static_cast<int>(i))});
  }
  return code;
}

}  // namespace

ExpressionMachine assemble_expressions(const ExpressionGraph& graph, std::span<const int> outputs) {
  if (!has_machine_code()) return {};
  ExpressionMachine machine;
  X86Assembler assembler;
  assembler.push(Base::kRbx);
  assembler.push(Base::kRbp);
  assembler.push(Base::kR12);  // and with the return address the stack is aligned for calls
  assembler.move(Base::kRbx, Base::kRdi);
  assembler.move(Base::kRbp, Base::kRsi);
  assembler.move(Base::kR12, Base::kRdx);
  machine.scratch_size = write_straight_code(straight_code(graph, outputs), assembler);
  assembler.pop(Base::kR12);
  assembler.pop(Base::kRbp);
  assembler.pop(Base::kRbx);
  assembler.finish();
  const std::vector<std::uint8_t> code = assembler.take();
  machine.memory = MachineMemory::make(code);
  if (machine.memory == nullptr) return {};
  machine.function = reinterpret_cast<ExpressionMachine::Function>(const_cast<void*>(machine.memory->begin()));
  machine.code_bytes = code.size();
  return machine;
}

}  // namespace ferrers
