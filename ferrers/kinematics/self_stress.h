#pragma once

#include <utility>
#include <vector>

#include "ferrers/kinematics/joint_wrenches.h"

/// Problem: what multipliers that balance each other on the closure rows mean for every joint of their loops.
///
/// Given: multipliers of some closure rows with Gᵀ λ = 0. Wanted: the multipliers of all joints' rows that go with them
/// (G_all^T z = 0). Only the loops concerned are visited. Cost: O(length of those loops) per self-stress.
namespace ferrers {

using SparseRows = std::vector<std::pair<int, double>>;  ///< (row, value).

class SelfStressExtender {
 public:
  SelfStressExtender(const System& system, const Scaling& scaling, const AllRows& rows, const PositionKinematics& pos,
                     const JointWrenches& joints);

  /// From closure rows (of phi) to rows of `AllRows`.
  SparseRows extend(const SparseRows& closure_rows);

 private:
  void load(const SparseRows& closure_rows);
  void add_pair(const FramePair& frames, const Vector3d& p_M, const Wrench& w);
  void touch(int node);

  const System& system_;
  const Scaling& scaling_;
  const AllRows& rows_;
  const PositionKinematics& pos_;
  const JointWrenches& joints_;
  std::vector<int> closure_of_row_, first_all_row_;
  std::vector<Wrench> on_nodes_;  ///< Zero between calls.
  std::vector<Wrench> efforts_;   ///< Per node: wrench of the efforts in its joint, at p_M. Zero between calls.
  std::vector<bool> is_touched_;
  std::vector<int> touched_;
};

}  // namespace ferrers
