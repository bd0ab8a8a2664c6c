#include "ferrers/math/straight_code.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "ferrers/core/checks.h"

namespace ferrers {
namespace {

using Op = ExpressionOp;
using Base = X86Assembler::Base;
using Operand = X86Assembler::Operand;
using Arithmetic = X86Assembler::Arithmetic;
using Fused = X86Assembler::Fused;

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

Fused fused_instruction(StraightCode::Op op) {
  switch (op) {
    case StraightCode::kMultiplyAdd:
      return Fused::kMultiplyAdd;
    case StraightCode::kMultiplySubtract:
      return Fused::kMultiplySubtract;
    default:
      return Fused::kSubtractProduct;
  }
}

double all_but_sign() { return std::bit_cast<double>(~(std::uint64_t{1} << 63)); }

// ---- registers and code --------------------------------------------------------------------------------------------

class Writer {
 public:
  Writer(const StraightCode& code, X86Assembler& out)
      : code_(code), values_(code.values), home_(code.values.size()), out_(out) {
    held_.fill(-1);
    find_uses();
    for (int i = static_cast<int>(code_.stores.size()) - 1; i >= 0; --i) home_[code_.stores[i].value].store = i;
    for (std::size_t i = 0; i < values_.size(); ++i) {
      if (values_[i].op == static_cast<StraightCode::Op>(Op::kVariable)) home_[i].memory = values_[i].place;
    }
  }

  int run() {
    out_.use_lanes(code_.lanes);
    if (code_.repeat > 1) out_.count(code_.repeat);
    const std::size_t begin = out_.here();
    for (now_ = 0; now_ < static_cast<int>(values_.size()); ++now_) {
      if (values_[now_].is_operation()) compute(now_);
      locked_ = 0;
    }
    for (int i = 0; i < static_cast<int>(code_.stores.size()); ++i) {
      const int index = code_.stores[i].value;
      if (home_[index].store == i && values_[index].is_operation()) continue;  // stored when it was computed
      out_.store(code_.stores[i].to, in_register(index));
    }
    if (code_.repeat > 1) {
      out_.address(Base::kRbx, Base::kRbx, code_.lanes);
      out_.repeat_from(begin);
      out_.address(Base::kRbx, Base::kRbx, -code_.lanes * code_.repeat);
    }
    return slots_ * code_.lanes;
  }

 private:
  struct Home {
    int xmm = -1;               ///< The register that holds the value, or -1.
    Operand memory;             ///< Where it is in memory, unless `in_register`: nowhere.
    int slot = -1;              ///< That is this place of the scratch, or -1.
    int store = -1;             ///< The first store of it, or -1.
    const int* uses = nullptr;  ///< At which steps from now on; as many as `uses_left`.
    int uses_left = 0;
    int next_use() const { return uses_left == 0 ? kNever : *uses; }
    bool is_used_after(int step) const { return uses_left > 0 && uses[uses_left - 1] > step; }
    bool is_in_memory() const { return !memory.in_register; }
  };

  // Steps that read each value, in order, those of one value side by side.
  void find_uses() {
    std::vector<int> begin(values_.size() + 1, 0);
    const auto for_each = [this](const auto& take) {
      for (int step = 0; step < static_cast<int>(values_.size()); ++step) {
        if (!values_[step].is_operation()) continue;
        const auto& [a, b, c] = values_[step].args;
        if (a >= 0) take(a, step);
        if (b >= 0 && b != a) take(b, step);
        if (c >= 0 && c != a && c != b) take(c, step);
      }
    };
    for_each([&](int value, int) { ++begin[static_cast<std::size_t>(value) + 1]; });
    for (std::size_t i = 0; i < values_.size(); ++i) begin[i + 1] += begin[i];
    uses_.resize(static_cast<std::size_t>(begin.back()));
    for (std::size_t i = 0; i < values_.size(); ++i) home_[i].uses = uses_.data() + begin[i];
    for_each([&](int value, int step) {
      Home& home = home_[value];
      uses_[static_cast<std::size_t>(begin[value] + home.uses_left++)] = step;
    });
  }

  // ---- one step ------------------------------------------------------------------------------------------------

  void compute(int index) {
    const StraightCode::Op op = values_[index].op;
    if (op > static_cast<StraightCode::Op>(Op::kIf)) return compute_fused(index);
    switch (static_cast<Op>(op)) {
      case Op::kNegate:
      case Op::kAbs:
      case Op::kSqrt:
      case Op::kFloor:
        return compute_of_one(index);
      case Op::kAdd:
      case Op::kSubtract:
      case Op::kMultiply:
      case Op::kDivide:
        return compute_of_two(index);
      default:
        require(code_.lanes == 1, "StraightCode: calls are made one lane at a time");
        call(index);
    }
  }

  void compute_of_one(int index) {
    const auto op = static_cast<Op>(values_[index].op);
    const int a = values_[index].args[0];
    const bool bits = op == Op::kNegate || op == Op::kAbs;
    const Operand from = bits ? locked(in_register(a)) : locked(operand(a));
    pass(a);
    const int to = destination(from);
    if (op == Op::kNegate) {
      out_.exclusive_or(to, from.xmm, Operand::at(Base::kConstant, out_.constant_pair(-0.0)));
    } else if (op == Op::kAbs) {
      out_.conjunction(to, from.xmm, Operand::at(Base::kConstant, out_.constant_pair(all_but_sign())));
    } else if (op == Op::kFloor) {
      out_.round_down(to, from);
    } else {
      out_.compute(Arithmetic::kSqrt, to, from.in_register ? from.xmm : to, from);
    }
    settle(index, to);
  }

  void compute_of_two(int index) {
    const auto op = static_cast<Op>(values_[index].op);
    auto [a, b, unused] = values_[index].args;
    const bool commutes = op == Op::kAdd || op == Op::kMultiply;
    if (commutes && home_[a].xmm < 0 && home_[b].xmm >= 0) std::swap(a, b);
    lock(home_[b].xmm);
    const Operand first = locked(in_register(a));
    const Operand second = locked(operand(b));
    pass(a);
    pass(b);
    const int to = destination(first, second);
    out_.compute(instruction(op), to, first.xmm, second);
    settle(index, to);
  }

  // Which operand's register takes the result decides the form of the instruction.
  void compute_fused(int index) {
    auto [a, b, c] = values_[index].args;
    const Fused op = fused_instruction(values_[index].op);
    for (const int one : {a, b, c}) lock(home_[one].xmm);
    if (home_[a].xmm < 0 && home_[b].xmm >= 0) std::swap(a, b);
    if (c != a && c != b && dies(c)) {
      const int sum = home_[c].xmm;
      const Operand first = locked(in_register(a)), second = locked(operand(b));
      pass_all(index);
      out_.multiply_into_sum(op, sum, first.xmm, second);
      return settle(index, sum);
    }
    if (!(a != b && a != c && dies(a)) && b != a && b != c && dies(b)) std::swap(a, b);
    if (a != b && a != c && dies(a)) {
      const int factor = home_[a].xmm;
      if (home_[b].xmm < 0 && home_[c].xmm >= 0) {
        const Operand other = locked(operand(b));
        if (!other.in_register) {
          const int sum = home_[c].xmm;
          pass_all(index);
          out_.multiply_by_memory(op, factor, sum, other);
          return settle(index, factor);
        }
      }
      const Operand other = locked(in_register(b)), sum = locked(operand(c));
      pass_all(index);
      out_.multiply_into_factor(op, factor, other.xmm, sum);
      return settle(index, factor);
    }
    const Operand from = locked(operand(c));
    const int sum = free_register();
    lock(sum);
    out_.load(sum, from);
    const Operand first = locked(in_register(a)), second = locked(operand(b));
    pass_all(index);
    out_.multiply_into_sum(op, sum, first.xmm, second);
    settle(index, sum);
  }

  // Registers survive no call: what is still wanted goes to memory.
  void call(int index) {
    const StraightCode::Value& value = values_[index];
    const auto op = static_cast<Op>(value.op);
    const int pair = op == Op::kSin || op == Op::kCos ? other_of(index) : -1;
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
      if (!(from.in_register && from.xmm == i)) out_.load(i, from);
    }
    pass_all(index);
    for (int xmm = 0; xmm < kRegisters; ++xmm) release(xmm);
    if (pair >= 0) return call_pair(index, pair);
    out_.call(reinterpret_cast<const void*>(kCalled[value.op]));
    settle(index, 0);
  }

  void call_pair(int index, int pair) {
    const bool is_sine = values_[index].op == static_cast<StraightCode::Op>(Op::kSin);
    const int sine = is_sine ? index : pair, cosine = is_sine ? pair : index;
    const int slot = slots_;  // two neighbours
    slots_ += 2;
    out_.address(Base::kRdi, Base::kR12, slot);
    out_.call(reinterpret_cast<const void*>(&call_sine_cosine));
    for (const int one : {sine, cosine}) {
      home_[one].memory = Operand::at(Base::kR12, one == sine ? slot : slot + 1);
      if (home_[one].store < 0) continue;
      out_.load(0, home_[one].memory);
      out_.store(code_.stores[home_[one].store].to, 0);
    }
  }

  // The cosine of a sine's angle and the reverse, where both are wanted.
  int other_of(int index) {
    if (partner_.empty()) {
      partner_.assign(values_.size(), -1);
      std::vector<int> sine(values_.size(), -1), cosine(values_.size(), -1);
      for (int one = 0; one < static_cast<int>(values_.size()); ++one) {
        const auto op = static_cast<Op>(values_[one].op);
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

  /// Registers of this step's operands are not given to others.
  void lock(int xmm) {
    if (xmm >= 0) locked_ |= 1U << static_cast<unsigned>(xmm);
  }
  Operand locked(int xmm) { return locked(Operand::of(xmm)); }
  Operand locked(const Operand& operand) {
    if (operand.in_register) lock(operand.xmm);
    return operand;
  }
  bool is_locked(int xmm) const { return (locked_ >> static_cast<unsigned>(xmm) & 1U) != 0; }

  /// In a register, and this step is the last to read it.
  bool dies(int index) const { return home_[index].xmm >= 0 && !home_[index].is_used_after(now_); }

  Operand operand(int index) {
    Home& home = home_[index];
    if (home.xmm >= 0) return Operand::of(home.xmm);
    if (values_[index].same_in_all_lanes && code_.lanes > 1) return Operand::of(in_register(index));
    if (!home.is_in_memory()) home.memory = Operand::at(Base::kConstant, out_.constant(values_[index].constant));
    return home.memory;
  }

  int in_register(int index) {
    Home& home = home_[index];
    if (home.xmm >= 0) return home.xmm;
    const int xmm = free_register();
    if (values_[index].same_in_all_lanes) {
      out_.load_everywhere(xmm, home.memory);
    } else {
      out_.load(xmm, operand(index));
    }
    held_[xmm] = index;
    home.xmm = xmm;
    return xmm;
  }

  // This step has read the value.
  void pass(int index) {
    Home& home = home_[index];
    if (home.uses_left > 0 && *home.uses <= now_) {
      ++home.uses;
      --home.uses_left;
    }
    if (home.uses_left > 0) return;
    if (home.xmm >= 0) release(home.xmm);
    if (home.slot >= 0) {
      passed_slots_.push_back(home.slot);  // free after this step, which still reads it
      home.slot = -1;
    }
  }

  void pass_all(int index) {
    for (const int arg : values_[index].args) {
      if (arg >= 0) pass(arg);
    }
  }

  void release(int xmm) {
    if (held_[xmm] >= 0) home_[held_[xmm]].xmm = -1;
    held_[xmm] = -1;
  }

  // For a result: an operand's register that nobody wants any more, or another.
  int destination(const Operand& a, const Operand& b = Operand::at(Base::kRbx, 0)) {
    if (a.in_register && held_[a.xmm] < 0) return a.xmm;
    if (b.in_register && held_[b.xmm] < 0) return b.xmm;
    return free_register();
  }

  int free_register() {
    for (int xmm = 0; xmm < kRegisters; ++xmm) {
      if (held_[xmm] < 0 && !is_locked(xmm)) return xmm;
    }
    int last = -1;
    for (int xmm = 0; xmm < kRegisters; ++xmm) {
      if (is_locked(xmm)) continue;
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
    home.memory = Operand::at(Base::kR12, home.slot * code_.lanes);
    out_.store(home.memory, home.xmm);
  }

  // The value of this step is in the register.
  void settle(int index, int xmm) {
    Home& home = home_[index];
    free_slots_.insert(free_slots_.end(), passed_slots_.begin(), passed_slots_.end());
    passed_slots_.clear();
    if (home.store >= 0) {
      home.memory = code_.stores[home.store].to;
      out_.store(home.memory, xmm);
    }
    if (home.uses_left == 0) return;
    home.xmm = xmm;
    held_[xmm] = index;
  }

  const StraightCode& code_;
  const std::vector<StraightCode::Value>& values_;
  std::vector<Home> home_;
  std::vector<int> uses_;
  X86Assembler& out_;
  std::array<int, kRegisters> held_{};  ///< Which value each register holds, or -1.
  std::vector<int> free_slots_, passed_slots_, partner_;
  unsigned locked_ = 0;
  int slots_ = 0, now_ = 0;
};

}  // namespace

bool is_instruction(ExpressionOp op) {
  switch (op) {
    case Op::kNegate:
    case Op::kAdd:
    case Op::kSubtract:
    case Op::kMultiply:
    case Op::kDivide:
    case Op::kSqrt:
    case Op::kAbs:
    case Op::kFloor:
      return true;
    default:
      return false;
  }
}

int write_straight_code(const StraightCode& code, X86Assembler& out) { return Writer(code, out).run(); }

}  // namespace ferrers
