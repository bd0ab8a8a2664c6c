#pragma once

#include <array>
#include <string>
#include <vector>

#include "ferrers/dynamics/forward.h"

namespace ferrers {

enum class ReactionStatus {
  kUnique,        ///< Every solution of the equations of motion shares the value.
  kDistributed,   ///< Fixed by added physics (joint stiffness), named with the result.
  kUndetermined,  ///< Not determined by rigid-body dynamics: no value is given.
};
std::string_view to_string(ReactionStatus status);

/// The constraint's wrench on a joint's second body at the joint's point: force_x … force_z, moment_x … moment_z, in N
/// and N·m, world axes or the joint's frame F. Drive efforts, springs and damping in the joint are not in it, so the
/// component along a freedom is 0 and unique. The first body gets the opposite wrench at the same point.
struct JointReaction {
  std::array<double, 6> value{};  ///< Valid where status is not kUndetermined.
  std::array<ReactionStatus, 6> status{};
};

enum class ReactionAxes { kWorld, kJoint };

/// Computes reactions of all joints at a state whose accelerations are known.
///
/// Each tree joint balances its outboard side; a component is unique when its projection on the joint's constraint
/// wrenches is orthogonal to every self-stress at this pose [wojtyra2005]. Cost: O(rows · redundant).
class ReactionSolver {
 public:
  explicit ReactionSolver(std::shared_ptr<const DynamicsModel> model);

  /// `eq` filled at `state`; `vdot`, `lambda` solve it with the drive efforts `u` (nu).
  std::vector<JointReaction> solve(const State& state, const Equations& eq, const Selection& selection,
                                   const VectorXd& vdot, const VectorXd& lambda, const VectorXd& u,
                                   ReactionAxes axes = ReactionAxes::kWorld) const;

 private:
  std::shared_ptr<const DynamicsModel> model_;
  Scaling scaling_;
  AllRows rows_;
};

}  // namespace ferrers
