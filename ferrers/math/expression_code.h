#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "ferrers/math/expression_graph.h"

namespace ferrers {

/// What an `ExpressionProgram` executes. Private to expression*.cc.
///
/// The register file holds the inputs that are used, the constants, and then what the steps compute. Steps of one
/// operation stand together in runs, as far as their operands allow: which operation comes next is then decided once
/// per run and not once per step, which would cost more than most of the operations themselves.
struct ExpressionCode {
  using StepOp = std::uint8_t;  ///< An `ExpressionOp`, or one of the following, which only programs have.
  enum : StepOp {
    kSinCos = static_cast<StepOp>(ExpressionOp::kIf) + 1,  ///< two results, sin(a) and cos(a)
    kMultiplyAdd,                                          ///< a*b + c, rounded twice
    kMultiplySubtract,                                     ///< a*b - c
    kSubtractProduct,                                      ///< c - a*b
    kStepOpCount
  };

  struct Run {
    StepOp op;
    std::int32_t count;
  };

  std::vector<std::int32_t> inputs;   ///< Which inputs stand at the start of the register file.
  std::vector<double> constants;      ///< What stands after them.
  std::vector<Run> runs;              ///< In this order.
  std::vector<std::int32_t> places;   ///< Per step the registers of its results, then of its operands.
  std::vector<std::int32_t> outputs;  ///< The registers that hold the outputs at the end.
  int register_count = 0;
  int step_count = 0;

  /// Fills the registers.
  void execute(const double* values, double* registers) const;
};

/// Compiles what the values `outputs` of the graph need. Cost: O(size of the graph).
ExpressionCode compile_expressions(const ExpressionGraph& graph, std::span<const int> outputs);

}  // namespace ferrers
