#include "ferrers/math/expression_machine.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "ferrers/math/x86_assembler.h"

namespace ferrers {
namespace {

using Op = ExpressionOp;
using Base = X86Assembler::Base;
using Operand = X86Assembler::Operand;
using Arithmetic = X86Assembler::Arithmetic;

constexpr int kRegisters = 16;
constexpr int kNever = std::numeric_limits<int>::max();

// ---- what is called ------------------------------------------------------------------------------------------------

template <Op kOp>
double called(double a, double b, double c) {
  return apply_expression_op(kOp, a, b, c);
}

using Called = double (*)(double, double, double);

template <std::size_t... kOps>
constexpr std::array<Called, sizeof...(kOps)> all_called(std::index_sequence<kOps...>) {
  return {called<static_cast<Op>(kOps)>...};
}

constexpr auto kCalled = all_called(std::make_index_sequence<static_cast<std::size_t>(Op::kIf) + 1>());

// Both at once, to neighbours in memory.
void call_sine_cosine(double angle, double* out) {
  const double sine = std::sin(angle), cosine = std::cos(angle);
  out[0] = sine;
  out[1] = cosine;
}

bool is_instruction(Op op) {
  switch (op) {
    case Op::kNegate:
    case Op::kAdd:
    case Op::kSubtract:
    case Op::kMultiply:
    case Op::kDivide:
    case Op::kSqrt:
    case Op::kAbs:
      return true;
    default:
      return false;
  }
}

Arithmetic instruction(Op op) {
  switch (op) {
    case Op::kAdd:
      return Arithmetic::kAdd;
    case Op::kSubtract:
      return Arithmetic::kSubtract;
    case Op::kMultiply:
      return Arithmetic::kMultiply;
    case Op::kDivide:
      return Arithmetic::kDivide;
    default:
      return Arithmetic::kSqrt;
  }
}

// ---- order ---------------------------------------------------------------------------------------------------------

using Value = ExpressionGraph::Value;

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

// ---- registers and code --------------------------------------------------------------------------------------------

class Emitter {
 public:
  Emitter(const ExpressionGraph& graph, std::span<const int> outputs)
      : values_(graph.values()), outputs_(outputs), order_(Order(values_, outputs).take()), home_(values_.size()) {
    held_.fill(-1);
    for (std::size_t i = 0; i < values_.size(); ++i) {
      if (values_[i].op == Op::kVariable) home_[i].memory = Operand::at(Base::kRbx, values_[i].args[0]);
    }
    count_uses();
  }

  ExpressionMachine run() {
    begin();
    for (now_ = 0; now_ < static_cast<int>(order_.size()); ++now_) {
      const int index = order_[now_];
      if (is_instruction(values_[index].op)) {
        compute(index);
      } else {
        call(index);
      }
    }
    end();
    ExpressionMachine machine;
    const std::vector<std::uint8_t> code = assembler_.take();
    machine.memory = MachineMemory::make(code);
    if (machine.memory == nullptr) return {};
    machine.function = reinterpret_cast<ExpressionMachine::Function>(const_cast<void*>(machine.memory->begin()));
    machine.scratch_size = slots_;
    machine.code_bytes = code.size();
    return machine;
  }

 private:
  struct Home {
    int xmm = -1;           ///< The register that holds the value, or -1.
    Operand memory;         ///< Where it is in memory, unless `in_register`: nowhere.
    int slot = -1;          ///< That is this place of the scratch, or -1.
    int output = -1;        ///< The first output that it is, or -1.
    std::vector<int> uses;  ///< At which steps, the next one last.
    int next_use() const { return uses.empty() ? kNever : uses.back(); }
    bool is_used_after(int step) const { return !uses.empty() && uses.front() > step; }
    bool is_in_memory() const { return !memory.in_register; }
  };

  void count_uses() {
    for (int step = static_cast<int>(order_.size()) - 1; step >= 0; --step) {
      for (const int arg : values_[order_[step]].args) {
        if (arg < 0) continue;
        if (home_[arg].uses.empty() || home_[arg].uses.back() != step) home_[arg].uses.push_back(step);
      }
    }
    for (int i = static_cast<int>(outputs_.size()) - 1; i >= 0; --i) home_[outputs_[i]].output = i;
  }

  void begin() {
    assembler_.push(Base::kRbx);
    assembler_.push(Base::kRbp);
    assembler_.push(Base::kR12);  // and with the return address the stack is aligned for calls
    assembler_.move(Base::kRbx, Base::kRdi);
    assembler_.move(Base::kRbp, Base::kRsi);
    assembler_.move(Base::kR12, Base::kRdx);
  }

  void end() {
    for (int i = 0; i < static_cast<int>(outputs_.size()); ++i) {
      const int index = outputs_[i];
      if (home_[index].output == i && values_[index].is_operation()) continue;  // stored when it was computed
      assembler_.store(Operand::at(Base::kRbp, i), in_register(index, -1));
    }
    assembler_.pop(Base::kR12);
    assembler_.pop(Base::kRbp);
    assembler_.pop(Base::kRbx);
    assembler_.finish();
  }

  // ---- one step ------------------------------------------------------------------------------------------------

  void compute(int index) {
    const Op op = values_[index].op;
    auto [a, b, unused] = values_[index].args;
    if (op == Op::kNegate || op == Op::kAbs) {
      const int from = in_register(a, -1);
      pass(a);
      const int to = free_register(from);
      if (op == Op::kNegate) {
        assembler_.exclusive_or(to, from, sign_mask());
      } else {
        assembler_.conjunction(to, from, magnitude_mask());
      }
      return settle(index, to);
    }
    if (op == Op::kSqrt) {
      const Operand from = operand(a);
      pass(a);
      const int to = free_register(from.in_register ? from.xmm : -1);
      assembler_.compute(Arithmetic::kSqrt, to, from.in_register ? from.xmm : to, from);
      return settle(index, to);
    }
    const bool commutes = op == Op::kAdd || op == Op::kMultiply;
    if (commutes && home_[a].xmm < 0 && home_[b].xmm >= 0) std::swap(a, b);
    const int first = in_register(a, home_[b].xmm);
    const Operand second = operand(b);
    pass(a);
    pass(b);
    const int to = free_register(first, second.in_register ? second.xmm : -1);
    assembler_.compute(instruction(op), to, first, second);
    settle(index, to);
  }

  // Registers survive no call: what is still wanted goes to memory.
  void call(int index) {
    const Value& value = values_[index];
    const int pair = value.op == Op::kSin || value.op == Op::kCos ? other_of(index) : -1;
    if (pair >= 0 && home_[index].is_in_memory()) return pass(value.args[0]);  // with its other half
    for (int xmm = 0; xmm < kRegisters; ++xmm) {
      if (held_[xmm] >= 0 && home_[held_[xmm]].is_used_after(now_)) keep(held_[xmm]);
    }
    for (int i = 0; i < 3; ++i) {
      const int arg = value.args[i];
      if (arg < 0) continue;
      if (home_[arg].xmm >= 0 && home_[arg].xmm != i) keep(arg);  // it may be overwritten by another argument
    }
    for (int i = 0; i < 3; ++i) {
      const int arg = value.args[i];
      if (arg < 0) continue;
      const Operand from = home_[arg].is_in_memory() ? home_[arg].memory : operand(arg);
      if (!(from.in_register && from.xmm == i)) assembler_.load(i, from);
    }
    for (int i = 0; i < 3; ++i) {
      if (value.args[i] >= 0) pass(value.args[i]);
    }
    for (int xmm = 0; xmm < kRegisters; ++xmm) release(xmm);
    if (pair >= 0) return call_pair(index, pair);
    assembler_.call(reinterpret_cast<const void*>(kCalled[static_cast<std::size_t>(value.op)]));
    settle(index, 0);
  }

  void call_pair(int index, int pair) {
    const int sine = values_[index].op == Op::kSin ? index : pair, cosine = sine == index ? pair : index;
    const int slot = slots_;  // two neighbours
    slots_ += 2;
    assembler_.address(Base::kRdi, Base::kR12, slot);
    assembler_.call(reinterpret_cast<const void*>(&call_sine_cosine));
    for (const int one : {sine, cosine}) {
      home_[one].memory = Operand::at(Base::kR12, one == sine ? slot : slot + 1);
      if (home_[one].output < 0) continue;
      assembler_.load(0, home_[one].memory);
      assembler_.store(Operand::at(Base::kRbp, home_[one].output), 0);
    }
  }

  // The cosine of a sine's angle and the reverse, where both are wanted.
  int other_of(int index) {
    if (partner_.empty()) {
      partner_.assign(values_.size(), -1);
      std::vector<int> sine(values_.size(), -1), cosine(values_.size(), -1);
      for (const int one : order_) {
        const Op op = values_[one].op;
        if (op != Op::kSin && op != Op::kCos) continue;
        const int angle = values_[one].args[0];
        (op == Op::kSin ? sine : cosine)[angle] = one;
        if (sine[angle] < 0 || cosine[angle] < 0) continue;
        partner_[sine[angle]] = cosine[angle];
        partner_[cosine[angle]] = sine[angle];
      }
    }
    return partner_[index];
  }

  // ---- where values are ----------------------------------------------------------------------------------------

  Operand operand(int index) {
    Home& home = home_[index];
    if (home.xmm >= 0) return Operand::of(home.xmm);
    if (!home.is_in_memory()) home.memory = Operand::at(Base::kConstant, assembler_.constant(values_[index].constant));
    return home.memory;
  }

  int in_register(int index, int keep_register) {
    Home& home = home_[index];
    if (home.xmm >= 0) return home.xmm;
    const Operand from = operand(index);
    const int xmm = free_register(keep_register, -1, true);
    assembler_.load(xmm, from);
    held_[xmm] = index;
    home.xmm = xmm;
    return xmm;
  }

  // This step has read the value.
  void pass(int index) {
    Home& home = home_[index];
    if (!home.uses.empty() && home.uses.back() <= now_) home.uses.pop_back();
    if (!home.uses.empty()) return;
    if (home.xmm >= 0) release(home.xmm);
    if (home.slot >= 0) {
      passed_slots_.push_back(home.slot);  // free after this step, which still reads it
      home.slot = -1;
    }
  }

  void release(int xmm) {
    if (held_[xmm] >= 0) home_[held_[xmm]].xmm = -1;
    held_[xmm] = -1;
  }

  // A register for a result or (`may_not_share`) for an operand beside others. Operands that stay are not given up.
  int free_register(int first, int second = -1, bool may_not_share = false) {
    if (!may_not_share && first >= 0 && held_[first] < 0) return first;
    for (int xmm = 0; xmm < kRegisters; ++xmm) {
      if (held_[xmm] < 0 && !(may_not_share && (xmm == first || xmm == second))) return xmm;
    }
    int last = -1;
    for (int xmm = 0; xmm < kRegisters; ++xmm) {
      if (xmm == first || xmm == second) continue;
      if (last < 0 || home_[held_[xmm]].next_use() > home_[held_[last]].next_use()) last = xmm;
    }
    keep(held_[last]);
    release(last);
    return last;
  }

  // Copies a value to memory, where it is not there yet.
  void keep(int index) {
    Home& home = home_[index];
    if (home.is_in_memory() || !values_[index].is_operation()) return;
    if (free_slots_.empty()) {
      home.slot = slots_++;
    } else {
      home.slot = free_slots_.back();
      free_slots_.pop_back();
    }
    home.memory = Operand::at(Base::kR12, home.slot);
    assembler_.store(home.memory, home.xmm);
  }

  // The value of this step is in the register.
  void settle(int index, int xmm) {
    Home& home = home_[index];
    free_slots_.insert(free_slots_.end(), passed_slots_.begin(), passed_slots_.end());
    passed_slots_.clear();
    if (home.output >= 0) {
      home.memory = Operand::at(Base::kRbp, home.output);
      assembler_.store(home.memory, xmm);
    }
    if (home.uses.empty()) return;
    home.xmm = xmm;
    held_[xmm] = index;
  }

  Operand sign_mask() {
    if (sign_mask_ < 0) sign_mask_ = assembler_.constant_pair(-0.0, -0.0);
    return Operand::at(Base::kConstant, sign_mask_);
  }
  Operand magnitude_mask() {
    if (magnitude_mask_ < 0) {
      magnitude_mask_ = assembler_.constant_pair(all_but_sign(), all_but_sign());
    }
    return Operand::at(Base::kConstant, magnitude_mask_);
  }
  static double all_but_sign() { return std::bit_cast<double>(~(std::uint64_t{1} << 63)); }

  const std::vector<Value>& values_;
  std::span<const int> outputs_;
  std::vector<int> order_;
  std::vector<Home> home_;
  std::array<int, kRegisters> held_{};  ///< Which value each register holds, or -1.
  std::vector<int> free_slots_, passed_slots_, partner_;
  int slots_ = 0, now_ = 0, sign_mask_ = -1, magnitude_mask_ = -1;
  X86Assembler assembler_;
};

}  // namespace

ExpressionMachine assemble_expressions(const ExpressionGraph& graph, std::span<const int> outputs) {
  if (!has_machine_code()) return {};
  return Emitter(graph, outputs).run();
}

}  // namespace ferrers
