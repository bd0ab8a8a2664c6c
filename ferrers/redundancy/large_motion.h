#pragma once

#include "ferrers/redundancy/branches.h"

/// Problem: a cluster of thousands of coordinates is too large for null spaces as dense matrices and for second order.
///
/// Given: a system at an assembled pose and one of its clusters. Wanted: whether it moves, and the rank at generic
/// poses. Method: steps along random vectors of the null space, by the sparse elimination (math/rank_sparse.h), the
/// loops closed by sparse steps; the rank is decided anew where they lead. Where it is the rank at the pose, the motion
/// is smooth and its dimension is told by the rank; where it is larger, the pose is singular, and branches are not told
/// apart (`all_branches` and `second_order_done` are false). Seeded. Cost: a few eliminations and sparse closings.
namespace ferrers {

ClusterMotion analyze_large_motion(const System& system, const Scaling& scaling, const State& state, int cluster,
                                   const BranchOptions& options = {});

}  // namespace ferrers
