#pragma once

#include <vector>

#include "ferrers/kinematics/constraints.h"

/// Problem: every closure touches the coordinates of its own loop only. In a mechanism of thousands of loops the whole
/// of G, mostly zeros, would neither fit nor be worth a look.
///
/// Given: a system at one state. Wanted: phi and the rows of G closure by closure, each on the coordinates that it can
/// touch. Cost and memory: O(Σ rows × coordinates of their loops).
namespace ferrers {

/// The rows of one closure.
struct ConstraintBlock {
  int row = 0;               ///< First row in phi and G.
  std::vector<int> columns;  ///< Velocity coordinates, ascending.
  MatrixXd G;                ///< rows × columns.
};

struct ConstraintBlocks {
  VectorXd phi;                         ///< m.
  std::vector<ConstraintBlock> blocks;  ///< One per closure, in the order of `Topology::closures`.
};

ConstraintBlocks make_constraint_blocks(const System& system);

/// Fills phi and G. Shapes: as made by `make_constraint_blocks`.
void compute_constraint_blocks(const System& system, const State& state, const PositionKinematics& pos,
                               ConstraintBlocks& out);
/// The same from the state alone.
ConstraintBlocks compute_constraint_blocks(const System& system, const State& state);

/// Cut out of constraints that are known already.
ConstraintBlocks cut_into_blocks(const System& system, const ConstraintKinematics& constraints);

}  // namespace ferrers
