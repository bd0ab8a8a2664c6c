#pragma once

#include <array>
#include <span>
#include <vector>

#include "ferrers/math/expression_graph.h"

/// Problem: a large mechanism does the same at many places, and a processor does four equal things at once.
///
/// Given: the graph of all that an evaluation computes. Wanted: which of its parts are equal and do not wait for each
/// other. Values that depend on the same few coordinates are a cell (what one loop computes from its own joints); so
/// are values on which the same few outputs depend. Cells with the same operations in the same places are a group.
/// Private to math/.
namespace ferrers {

/// What is around a value, by whatever numbers tell parts of the mechanism apart.
struct KernelTags {
  std::vector<int> inputs;   ///< Per input.
  std::vector<int> outputs;  ///< Per output.
};

struct KernelCell {
  std::vector<int> values;     ///< Operations, ascending.
  std::vector<int> externals;  ///< Values from elsewhere and inputs, in the order of their first use.
  std::vector<double> constants;
};

/// Equal cells: the k-th values of all are the same operation on their k-th operands.
struct KernelGroup {
  std::vector<KernelCell> cells;
};

/// One after another: what a level needs was computed by those before.
struct KernelLevel {
  std::vector<KernelGroup> groups;
  std::vector<int> rest;  ///< Operations that are in no group, ascending. They come after the groups.
};

/// Operands in the order that cells are compared by: what is constant second where the order does not matter.
std::array<int, 3> kernel_operands(const ExpressionGraph& graph, int value);

/// What `outputs` need. Cost: O(size of the graph).
std::vector<KernelLevel> find_kernel_levels(const ExpressionGraph& graph, std::span<const int> outputs,
                                            const KernelTags& tags);

}  // namespace ferrers
