#include "ferrers/math/expression_code.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace ferrers {
namespace {

using Op = ExpressionOp;
using Code = ExpressionCode;
using StepOp = ExpressionCode::StepOp;
using Place = std::int32_t;

// ---- execution -----------------------------------------------------------------------------------------------------

constexpr int results_of(StepOp op) { return op == Code::kSinCos ? 2 : 1; }

constexpr int operands_of(StepOp op) {
  switch (op) {
    case Code::kSinCos:
      return 1;
    case Code::kMultiplyAdd:
    case Code::kMultiplySubtract:
    case Code::kSubtractProduct:
      return 3;
    default:
      break;
  }
  switch (static_cast<Op>(op)) {
    case Op::kIf:
      return 3;
    case Op::kAdd:
    case Op::kSubtract:
    case Op::kMultiply:
    case Op::kDivide:
    case Op::kPower:
    case Op::kAtan2:
    case Op::kHypot:
    case Op::kMod:
    case Op::kMin:
    case Op::kMax:
    case Op::kLess:
    case Op::kLessEqual:
    case Op::kGreater:
    case Op::kGreaterEqual:
      return 2;
    default:
      return 1;
  }
}

constexpr int stride_of(StepOp op) { return results_of(op) + operands_of(op); }

template <StepOp kOp>
double value_of_step(double a, double b, double c) {
  switch (kOp) {
    case Code::kMultiplyAdd:
      return a * b + c;
    case Code::kMultiplySubtract:
      return a * b - c;
    case Code::kSubtractProduct:
      return c - a * b;
    default:
      return apply_expression_op(static_cast<Op>(kOp), a, b, c);
  }
}

template <StepOp kOp>
void execute_run(int count, const Place* places, double* registers) {
  for (const Place* const end = places + count * stride_of(kOp); places != end; places += stride_of(kOp)) {
    if constexpr (kOp == Code::kSinCos) {
      const double angle = registers[places[2]];
      const double sine = std::sin(angle), cosine = std::cos(angle);  // one call of the C library, as optimized
      registers[places[0]] = sine;
      registers[places[1]] = cosine;
    } else {
      constexpr int kOperands = operands_of(kOp);
      registers[places[0]] = value_of_step<kOp>(registers[places[1]], kOperands > 1 ? registers[places[2]] : 0.0,
                                                kOperands > 2 ? registers[places[3]] : 0.0);
    }
  }
}

using ExecuteRun = void (*)(int, const Place*, double*);

template <std::size_t... kOps>
constexpr std::array<ExecuteRun, sizeof...(kOps)> all_runs(std::index_sequence<kOps...>) {
  return {execute_run<static_cast<StepOp>(kOps)>...};
}

constexpr auto kExecuteRun = all_runs(std::make_index_sequence<Code::kStepOpCount>());

// ---- compilation ---------------------------------------------------------------------------------------------------

/// The values that the outputs need, operands first, in the order a recursive evaluation would reach them.
std::vector<int> needed_values(const ExpressionGraph& graph, std::span<const int> outputs) {
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

/// A step over values of the graph.
struct Step {
  StepOp op = 0;
  std::array<int, 2> results{-1, -1};
  std::array<int, 3> args{-1, -1, -1};
};

/// Chooses the steps: a product that only one sum needs is computed with it, the sine and the cosine of one angle are
/// computed together.
class StepSelection {
 public:
  StepSelection(const ExpressionGraph& graph, std::span<const int> order, std::span<const int> outputs)
      : values_(graph.values()), uses_(values_.size(), 0), other_(values_.size(), -1) {
    for (const int index : order) {
      if (!values_[index].is_operation()) continue;
      for (const int arg : values_[index].args) {
        if (arg >= 0) ++uses_[arg];
      }
    }
    for (const int output : outputs) uses_[output] += 2;
    pair_sines(order);
    std::vector<bool> done(values_.size(), false);
    for (const int index : order) {
      if (values_[index].is_operation()) fuse(index, done);
    }
    for (const int index : order) {
      if (values_[index].is_operation() && !done[index]) select(index, done);
    }
  }

  std::vector<Step> take() { return std::move(steps_); }

 private:
  /// other_[sine] = cosine of the same angle and the reverse.
  void pair_sines(std::span<const int> order) {
    std::vector<int> sine_of(values_.size(), -1), cosine_of(values_.size(), -1);
    for (const int index : order) {
      const Op op = values_[index].op;
      if (op != Op::kSin && op != Op::kCos) continue;
      const int angle = values_[index].args[0];
      (op == Op::kSin ? sine_of : cosine_of)[angle] = index;
      if (sine_of[angle] < 0 || cosine_of[angle] < 0) continue;
      other_[sine_of[angle]] = cosine_of[angle];
      other_[cosine_of[angle]] = sine_of[angle];
    }
  }

  bool is_own_product(int index) const { return values_[index].op == Op::kMultiply && uses_[index] == 1; }

  /// Notes in `other_` of a sum the product that is computed with it; that product is no step of its own.
  void fuse(int index, std::vector<bool>& done) {
    const auto& value = values_[index];
    if (value.op != Op::kAdd && value.op != Op::kSubtract) return;
    const int product = is_own_product(value.args[1]) ? value.args[1] : value.args[0];
    if (!is_own_product(product)) return;
    other_[index] = product;
    done[product] = true;
  }

  void select(int index, std::vector<bool>& done) {
    const auto& value = values_[index];
    Step step;
    step.op = static_cast<StepOp>(value.op);
    step.results[0] = index;
    step.args = value.args;
    const int other = other_[index];
    if (other >= 0 && (value.op == Op::kSin || value.op == Op::kCos)) {
      step.op = Code::kSinCos;
      step.results = value.op == Op::kSin ? std::array{index, other} : std::array{other, index};
      done[other] = true;
    } else if (other >= 0) {
      const bool second = value.args[1] == other;
      step.op = value.op == Op::kAdd ? Code::kMultiplyAdd : second ? Code::kSubtractProduct : Code::kMultiplySubtract;
      step.args = {values_[other].args[0], values_[other].args[1], value.args[second ? 0 : 1]};
    }
    steps_.push_back(step);
  }

  const std::vector<ExpressionGraph::Value>& values_;
  std::vector<int> uses_, other_;
  std::vector<Step> steps_;
};

/// Orders steps so that those of one operation follow each other: among the operations that could go on, the one with
/// the most steps ready goes on until it has none. Only steps near the first one left are considered, so that long
/// programs keep few values waiting.
class Schedule {
 public:
  Schedule(std::vector<Step> steps, std::size_t value_count)
      : steps_(std::move(steps)), missing_(steps_.size(), 0), consumers_(steps_.size()), done_(steps_.size(), false) {
    std::vector<int> producer(value_count, -1);
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      for (const int result : steps_[i].results) {
        if (result >= 0) producer[result] = static_cast<int>(i);
      }
    }
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      for (const int arg : steps_[i].args) {
        if (arg < 0 || producer[arg] < 0) continue;
        consumers_[producer[arg]].push_back(static_cast<int>(i));
        ++missing_[i];
      }
    }
    open_window();
  }

  /// Calls `emit(step)` in order.
  template <class Emit>
  void for_each(Emit emit) {
    while (first_ < steps_.size()) {
      const auto most = std::max_element(ready_.begin(), ready_.end(),
                                         [](const auto& a, const auto& b) { return a.size() < b.size(); });
      for (std::size_t k = 0; k < most->size(); ++k) {
        const int index = (*most)[k];
        emit(steps_[index]);
        finish(index);
      }
      most->clear();
    }
  }

 private:
  static constexpr std::size_t kWindow = 1024;

  void make_ready(int index) { ready_[steps_[index].op].push_back(index); }

  void finish(int index) {
    done_[index] = true;
    for (const int consumer : consumers_[index]) {
      if (--missing_[consumer] == 0 && static_cast<std::size_t>(consumer) < end_) make_ready(consumer);
    }
    while (first_ < steps_.size() && done_[first_]) ++first_;
    open_window();
  }

  void open_window() {
    for (; end_ < std::min(first_ + kWindow, steps_.size()); ++end_) {
      if (missing_[end_] == 0) make_ready(static_cast<int>(end_));
    }
  }

  std::vector<Step> steps_;
  std::vector<int> missing_;  ///< Operands that are not computed yet.
  std::vector<std::vector<int>> consumers_;
  std::vector<bool> done_;
  std::array<std::vector<int>, Code::kStepOpCount> ready_;
  std::size_t first_ = 0, end_ = 0;  ///< The first step left, and the end of the window from there.
};

/// Hands out register numbers, the most recently freed first, so that few are used and those stay in cache.
class Registers {
 public:
  Place take() {
    if (free_.empty()) return count_++;
    const Place place = free_.back();
    free_.pop_back();
    return place;
  }
  void give_back(Place place) { free_.push_back(place); }
  int count() const { return count_; }

 private:
  std::vector<Place> free_;
  Place count_ = 0;
};

}  // namespace

void ExpressionCode::execute(const double* values, double* registers) const {
  double* next = registers;
  for (const Place input : inputs) *next++ = values[input];
  std::copy(constants.begin(), constants.end(), next);
  const Place* steps = places.data();
  for (const Run& run : runs) {
    kExecuteRun[run.op](run.count, steps, registers);
    steps += run.count * stride_of(run.op);
  }
}

ExpressionCode compile_expressions(const ExpressionGraph& graph, std::span<const int> outputs) {
  const auto& values = graph.values();
  const std::vector<int> order = needed_values(graph, outputs);
  std::vector<Step> steps;
  Schedule schedule(StepSelection(graph, order, outputs).take(), values.size());
  schedule.for_each([&steps](const Step& step) { steps.push_back(step); });

  Code code;
  Registers registers;
  std::vector<Place> place(values.size(), -1);
  for (const int index : order) {
    if (values[index].op != Op::kVariable) continue;
    place[index] = registers.take();
    code.inputs.push_back(values[index].args[0]);
  }
  for (const int index : order) {
    if (!values[index].is_constant()) continue;
    place[index] = registers.take();
    code.constants.push_back(values[index].constant);
  }
  std::vector<int> last_use(values.size(), -1);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    for (const int arg : steps[i].args) {
      if (arg >= 0 && values[arg].is_operation()) last_use[arg] = static_cast<int>(i);
    }
  }
  for (const int output : outputs) last_use[output] = -1;  // kept to the end
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Step& step = steps[i];
    if (code.runs.empty() || code.runs.back().op != step.op) code.runs.push_back({step.op, 0});
    ++code.runs.back().count;
    for (const int arg : step.args) {
      if (arg < 0 || last_use[arg] != static_cast<int>(i)) continue;
      registers.give_back(place[arg]);
      last_use[arg] = -1;  // the same operand twice (x*x) is freed once
    }
    for (int k = 0; k < results_of(step.op); ++k) {
      code.places.push_back(place[step.results[k]] = registers.take());
    }
    for (int k = 0; k < operands_of(step.op); ++k) code.places.push_back(place[step.args[k]]);
  }
  for (const int output : outputs) code.outputs.push_back(place[output]);
  code.register_count = registers.count();
  code.step_count = static_cast<int>(steps.size());
  return code;
}

}  // namespace ferrers
