#include "ferrers/math/kernel_section.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "ferrers/math/machine_memory.h"

namespace ferrers {

using Op = StraightCode::Op;

namespace {

constexpr Op op_of(ExpressionOp op) { return static_cast<Op>(op); }

// About how long a result lets wait for itself.
int cycles(Op op) {
  if (op == op_of(ExpressionOp::kDivide) || op == op_of(ExpressionOp::kSqrt)) return 14;
  if (op <= op_of(ExpressionOp::kVariable)) return 5;
  return op == op_of(ExpressionOp::kNegate) ? 1 : 4;
}

}  // namespace

int KernelSection::constant(double value) {
  StraightCode::Value out;
  out.constant = value;
  values_.push_back(out);
  return static_cast<int>(values_.size()) - 1;
}

int KernelSection::memory(const X86Assembler::Operand& place) {
  StraightCode::Value out;
  out.op = op_of(ExpressionOp::kVariable);
  out.place = place;
  values_.push_back(out);
  return static_cast<int>(values_.size()) - 1;
}

int KernelSection::same_memory(const X86Assembler::Operand& place) {
  const int index = memory(place);
  values_[index].same_in_all_lanes = true;
  return index;
}

int KernelSection::operation(ExpressionOp op, const std::array<int, 3>& args) {
  StraightCode::Value out;
  out.op = op_of(op);
  out.args = args;
  values_.push_back(out);
  return static_cast<int>(values_.size()) - 1;
}

void KernelSection::fuse() {
  std::vector<int> uses(values_.size(), 0);
  for (const StraightCode::Value& value : values_) {
    for (const int arg : value.args) {
      if (arg >= 0) ++uses[arg];
    }
  }
  for (const StraightCode::Store& store : stores_) ++uses[store.value];
  const auto is_product = [&](int index) {
    return values_[index].op == op_of(ExpressionOp::kMultiply) && uses[index] == 1;
  };
  for (StraightCode::Value& value : values_) {
    const auto [a, b, unused] = value.args;
    const auto become = [&value, this](Op op, int product, int other) {
      value.op = op;
      value.args = {values_[product].args[0], values_[product].args[1], other};
    };
    if (value.op == op_of(ExpressionOp::kAdd)) {
      if (is_product(b)) {
        become(StraightCode::kMultiplyAdd, b, a);
      } else if (is_product(a)) {
        become(StraightCode::kMultiplyAdd, a, b);
      }
    } else if (value.op == op_of(ExpressionOp::kSubtract)) {
      if (is_product(b)) {
        become(StraightCode::kSubtractProduct, b, a);
      } else if (is_product(a)) {
        become(StraightCode::kMultiplySubtract, a, b);
      }
    }
  }
}

std::vector<int> KernelSection::depth_first() const {
  std::vector<int> order, stack;
  std::vector<bool> done(values_.size(), false);
  for (const StraightCode::Store& store : stores_) {
    stack.push_back(store.value);
    while (!stack.empty()) {
      const int index = stack.back();
      if (done[index]) {
        stack.pop_back();
        continue;
      }
      const std::size_t height = stack.size();
      for (std::size_t i = 3; i-- > 0;) {
        const int arg = values_[index].args[i];
        if (arg >= 0 && !done[arg]) stack.push_back(arg);
      }
      if (stack.size() > height) continue;
      stack.pop_back();
      done[index] = true;
      order.push_back(index);
    }
  }
  return order;
}

std::vector<int> KernelSection::just_in_time() const {
  std::vector<int> order = depth_first();
  std::vector<int> time(values_.size(), 0), wanted(values_.size(), std::numeric_limits<int>::max());
  for (const int index : order) {
    for (const int arg : values_[index].args) {
      if (arg >= 0) time[index] = std::max(time[index], time[arg] + cycles(values_[arg].op));
    }
  }
  for (std::size_t i = order.size(); i-- > 0;) {
    const int index = order[i];
    if (wanted[index] != std::numeric_limits<int>::max()) time[index] = wanted[index] - cycles(values_[index].op);
    for (const int arg : values_[index].args) {
      if (arg >= 0) wanted[arg] = std::min(wanted[arg], time[index]);
    }
  }
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return time[a] < time[b]; });
  return order;
}

StraightCode KernelSection::take(int lanes, int repeat, Order order) {
  if (has_fused_instructions()) fuse();
  StraightCode code;
  code.lanes = lanes;
  code.repeat = repeat;
  std::vector<int> number(values_.size(), -1);
  code.values.reserve(values_.size());
  code.stores.reserve(stores_.size());
  for (const int index : order == Order::kJustInTime ? just_in_time() : depth_first()) {
    StraightCode::Value value = values_[index];
    for (int& arg : value.args) arg = arg < 0 ? -1 : number[arg];
    number[index] = code.add(value);
  }
  for (const StraightCode::Store& store : stores_) code.stores.push_back({number[store.value], store.to});
  return code;
}

}  // namespace ferrers
