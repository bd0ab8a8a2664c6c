// Native code of graphs against the arithmetic that it stands for, one value at a time.

#include "ferrers/math/kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "ferrers/math/traced.h"
#include "ferrers/testing/needs_machine_code.h"

namespace ferrers {
namespace {

using Op = ExpressionOp;

double value_of(const ExpressionGraph& graph, int index, const std::vector<double>& inputs,
                std::vector<double>& known) {
  for (int i = 0; i <= index; ++i) {
    const ExpressionGraph::Value& value = graph.values()[i];
    const auto arg = [&](std::size_t k) { return value.args[k] < 0 ? 0.0 : known[value.args[k]]; };
    known.push_back(value.is_constant()         ? value.constant
                    : value.op == Op::kVariable ? inputs[value.args[0]]
                                                : apply_expression_op(value.op, arg(0), arg(1), arg(2)));
  }
  return known[index];
}

// As many evaluations at once, each with inputs of its own.
void expect_values_in_lanes(const ExpressionGraph& graph, const std::vector<int>& outputs,
                            const std::vector<double>& inputs, double tolerance, const std::string& what) {
  constexpr int kCount = 12;
  const Kernel kernel = Kernel::in_lanes(graph, outputs, kCount);
  ASSERT_TRUE(kernel.is_native()) << what;
  Kernel::Board board = kernel.make_board();
  const auto input_of = [&](std::size_t i, int lane) { return inputs[i] * (1 + 0.03125 * lane); };
  for (std::size_t i = 0; i < kernel.inputs().size(); ++i) {
    for (int lane = 0; lane < kCount && kernel.inputs()[i] >= 0; ++lane) {
      board[static_cast<std::size_t>(kernel.inputs()[i] * kCount + lane)] = input_of(i, lane);
    }
  }
  kernel.run(board);
  for (int lane = 0; lane < kCount; ++lane) {
    std::vector<double> own, known;
    for (std::size_t i = 0; i < inputs.size(); ++i) own.push_back(input_of(i, lane));
    value_of(graph, static_cast<int>(graph.values().size()) - 1, own, known);
    for (std::size_t k = 0; k < outputs.size(); ++k) {
      const double found = board[static_cast<std::size_t>(kernel.outputs()[k] * kCount + lane)];
      EXPECT_NEAR(found, known[outputs[k]], tolerance * (1 + std::abs(known[outputs[k]]))) << what << ", lane " << lane;
    }
  }
}

void expect_values(const ExpressionGraph& graph, const std::vector<int>& outputs, const KernelTags& tags,
                   const std::vector<double>& inputs, double tolerance, const std::string& what) {
  const Kernel kernel(graph, outputs, tags);
  ASSERT_TRUE(kernel.is_native());
  Kernel::Board board = kernel.make_board();
  std::vector<double> known;
  value_of(graph, static_cast<int>(graph.values().size()) - 1, inputs, known);
  for (int pass = 0; pass < 2; ++pass) {  // nothing is left of the first
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      if (kernel.inputs()[i] >= 0) board[static_cast<std::size_t>(kernel.inputs()[i])] = inputs[i];
    }
    kernel.run(board);
    for (std::size_t k = 0; k < outputs.size(); ++k) {
      const double expected = known[outputs[k]], found = board[static_cast<std::size_t>(kernel.outputs()[k])];
      EXPECT_NEAR(found, expected, tolerance * (1 + std::abs(expected))) << what << ", output " << k;
    }
  }
}

// Random sums and products of few or many values: more than there are registers, operands that die or stay.
TEST(KernelTest, ComputesRandomGraphs) {
  NEEDS_MACHINE_CODE();
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 random(seed);
    const auto below = [&](int bound) { return static_cast<int>(random() % static_cast<unsigned>(bound)); };
    ExpressionGraph graph;
    std::vector<int> values;
    std::vector<double> inputs;
    KernelTags tags;
    for (int i = 0; i < 6; ++i) {
      values.push_back(graph.input(i));
      inputs.push_back(0.5 + 0.25 * below(8));
      tags.inputs.push_back(below(3));
    }
    for (int i = 0; i < 3; ++i) values.push_back(graph.constant(0.5 + below(4)));
    const int count = 20 + below(200), reach = 5 + below(60);
    for (int i = 0; i < count; ++i) {
      const auto pick = [&] {
        const int size = static_cast<int>(values.size());
        return values[static_cast<std::size_t>(size - 1 - below(std::min(size, reach)))];
      };
      const int a = pick(), b = pick();
      switch (below(9)) {
        case 0:
          values.push_back(graph.operation(Op::kSqrt, graph.operation(Op::kAbs, a, -1, -1), -1, -1));
          break;
        case 1:
          values.push_back(graph.operation(Op::kNegate, a, -1, -1));
          break;
        case 2: {  // no division by almost nothing
          const int divisor = graph.operation(Op::kAdd, graph.operation(Op::kAbs, b, -1, -1), graph.constant(1), -1);
          values.push_back(graph.operation(Op::kDivide, a, divisor, -1));
          break;
        }
        case 3:
        case 4: {
          const int small = graph.operation(Op::kMultiply, b, graph.constant(0.125), -1);
          const int product = graph.operation(Op::kMultiply, a, small, -1);
          const int bounded = graph.operation(
              Op::kDivide, product,
              graph.operation(Op::kAdd, graph.operation(Op::kAbs, product, -1, -1), graph.constant(1), -1), -1);
          values.push_back(bounded);
          break;
        }
        case 5:
          values.push_back(
              graph.operation(Op::kSubtract, a, graph.operation(Op::kMultiply, b, graph.constant(0.25), -1), -1));
          break;
        case 6:
          values.push_back(
              graph.operation(Op::kSubtract, graph.operation(Op::kMultiply, a, graph.constant(0.25), -1), b, -1));
          break;
        case 7:
          values.push_back(
              graph.operation(Op::kAdd, a, graph.operation(Op::kMultiply, b, graph.constant(0.25), -1), -1));
          break;
        default:
          values.push_back(graph.operation(Op::kAdd, graph.operation(Op::kMultiply, a, graph.constant(0.3), -1),
                                           graph.operation(Op::kMultiply, b, graph.constant(0.4), -1), -1));
      }
    }
    std::vector<int> outputs;
    for (int i = 0; i < 12; ++i)
      outputs.push_back(values[static_cast<std::size_t>(below(static_cast<int>(values.size())))]);
    for (int i = 0; i < 12; ++i) tags.outputs.push_back(i / 3);
    expect_values(graph, outputs, tags, inputs, 1e-10, "seed " + std::to_string(seed));
    expect_values_in_lanes(graph, outputs, inputs, 1e-10, "seed " + std::to_string(seed));
  }
}

// Places that all do the same, with more values than there are registers; each reads another one, in any order: its
// neighbour, around a ring, or whichever. Some places are odd, some read what all read, some call functions; and
// something runs along them.
TEST(KernelTest, DoesEqualPartsAtOnceHoweverTheyReadEachOther) {
  NEEDS_MACHINE_CODE();
  for (unsigned seed = 0; seed < 400; ++seed) {
    std::mt19937 random(seed);
    const auto below = [&](int bound) { return static_cast<int>(random() % static_cast<unsigned>(bound)); };
    Trace trace;
    KernelTags tags;
    std::vector<double> inputs;
    const auto input = [&](int tag) {
      tags.inputs.push_back(tag);
      inputs.push_back(0.25 + 0.125 * below(12));
      return trace.input(static_cast<int>(inputs.size()) - 1);
    };
    const int count = 3 + below(14), shift = below(3) == 0 ? 0 : 1 + below(2);
    std::vector<int> other(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) other[static_cast<std::size_t>(i)] = (i + shift) % count;
    if (shift == 0) std::shuffle(other.begin(), other.end(), random);
    const int odd = below(3) == 0 ? below(count) : -1, length = 6 + below(30),
              calls = below(4) == 0 ? below(length) : -1;
    const Traced all = input(1000);
    std::vector<Traced> own, outputs;
    for (int i = 0; i < count; ++i) {  // first what each place does alone
      const Traced x = input(i), y = input(i);
      const Traced size = sqrt(x * x + y * y + 1.0), plain = size * y + 0.5 * x / (size + 1.0) + y * 0.25;
      own.push_back(i != odd ? plain : seed % 2 == 0 ? plain + x * 0.125 : input(i));
      outputs.push_back(size);
      tags.outputs.push_back(i);
    }
    Traced along = 0.5;
    for (int i = 0; i < count; ++i) {  // then what it does with another's
      const auto from = static_cast<std::size_t>(other[static_cast<std::size_t>(i)]);
      std::vector<Traced> values = {own[static_cast<std::size_t>(i)], own[from], input(i), 0.5 + 0.25 * (i % 3)};
      if (seed % 3 == 0) values.push_back(all);
      std::mt19937 same(seed);  // the same operations at every place
      const auto pick = [&] { return values[same() % values.size()]; };
      for (int k = 0; k < length; ++k) {
        const Traced a = pick(), b = pick();
        const auto kind = same() % 4;
        if (k == calls) {
          values.push_back(atan2(a, b * b + 1.0));
        } else if (kind == 0) {
          values.push_back(a * 0.5 - b * 0.25);
        } else if (kind == 1) {
          values.push_back(a / (b * b + 1.0));
        } else {
          values.push_back(0.25 * a * b / (1.0 + a * a * 0.0625 + b * b * 0.0625) + a * 0.125);
        }
      }
      Traced sum = 0.0;  // of all, the latest first: they must wait
      for (std::size_t k = values.size(); k-- > 0;) sum = sum * 0.5 + values[k];
      along = along * 0.5 + sum * 0.125;
      outputs.push_back(sum);
      outputs.push_back(along);
      tags.outputs.insert(tags.outputs.end(), {i, i});
    }
    std::vector<int> values;
    for (const Traced& output : outputs) values.push_back(trace.value_of(output));
    expect_values(trace.graph(), values, tags, inputs, 1e-11, "seed " + std::to_string(seed));
  }
}

// A chain of equal links, each of which sees its neighbour: what each does alone is done four at a time, whatever the
// length, and the sum along the chain one after another.
TEST(KernelTest, DoesEqualPartsOfAChainAtOnce) {
  NEEDS_MACHINE_CODE();
  for (int count = 2; count <= 40; ++count) {
    Trace trace;
    KernelTags tags;
    std::vector<Traced> angle, rate, outputs;
    std::vector<double> inputs;
    for (auto* vector : {&angle, &rate}) {
      for (int i = 0; i < count; ++i) {
        tags.inputs.push_back(i);
        inputs.push_back(std::sin(static_cast<double>(inputs.size())));
        vector->push_back(trace.input(static_cast<int>(inputs.size()) - 1));
      }
    }
    Traced along = 0.25;
    for (int i = 0; i + 1 < count; ++i) {
      const Traced x = cos(angle[i]) + 0.5 * cos(angle[i + 1]), y = sin(angle[i]) + 0.5 * sin(angle[i + 1]);
      const Traced length = sqrt(x * x + y * y + 0.125 * (i % 3));  // a constant that differs
      const Traced share = (x * rate[i] - y * rate[i + 1]) / length;
      along = along * 0.5 + share;
      outputs.push_back(length);
      outputs.push_back(along);
      tags.outputs.insert(tags.outputs.end(), {i, i});
    }
    std::vector<int> values;
    for (const Traced& output : outputs) values.push_back(trace.value_of(output));
    expect_values(trace.graph(), values, tags, inputs, 1e-14, std::to_string(count) + " links");
    const Kernel kernel(trace.graph(), values, tags);
    EXPECT_GT(kernel.shared_part(), count < 8 ? -1 : 0.7) << count;
  }
}

TEST(KernelTest, CodeOfEqualPartsDoesNotGrowWithTheirNumber) {
  NEEDS_MACHINE_CODE();
  const auto bytes = [](int count) {
    Trace trace;
    KernelTags tags;
    std::vector<int> outputs;
    for (int i = 0; i < count; ++i) {
      tags.inputs.push_back(i);
      outputs.push_back(trace.value_of(sin(trace.input(i))));
      tags.outputs.push_back(i);
    }
    return Kernel(trace.graph(), outputs, tags).code_bytes();
  };
  EXPECT_EQ(bytes(40), bytes(400));
}

}  // namespace
}  // namespace ferrers
