#pragma once

#include <memory>
#include <span>

#include "ferrers/math/expression_graph.h"
#include "ferrers/math/machine_memory.h"

namespace ferrers {

/// Native code for the values of a graph: what an `ExpressionProgram` runs instead of an `ExpressionCode`, with the
/// same bits as result. Private to math/.
struct ExpressionMachine {
  /// `scratch`: room for `scratch_size` doubles. `outputs` must not overlap `inputs`.
  using Function = void (*)(const double* inputs, double* outputs, double* scratch);

  Function function = nullptr;  ///< Null: none can be made here (another processor, or memory may not be executed).
  int scratch_size = 0;
  std::size_t code_bytes = 0;
  std::shared_ptr<const MachineMemory> memory;
};

/// Sums, products, quotients, roots and signs are instructions; other functions are calls, which come first as far as
/// their operands allow, since they leave no value in a register. Registers are given up for what is needed last
/// [belady1966]. Cost: O(size of the graph).
ExpressionMachine assemble_expressions(const ExpressionGraph& graph, std::span<const int> outputs);

}  // namespace ferrers
