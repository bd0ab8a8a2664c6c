#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "ferrers/dynamics/forward.h"
#include "ferrers/redundancy/reaction_bounds.h"

namespace ferrers {

/// The constraint's wrench on a joint's second body at the joint's point: force_x … force_z, moment_x … moment_z, in N
/// and N·m, world axes or the joint's frame F. Drive efforts, springs and damping in the joint are not in it, so the
/// component along a freedom is 0 and unique. The first body gets the opposite wrench at the same point.
///
/// A coupling or constraint has one component instead, its multiplier: the work that it does per unit of its phi.
struct JointReaction {
  int components = 6;             ///< Of the arrays below; 1: a multiplier.
  std::array<double, 6> value{};  ///< Valid where status is not kUndetermined.
  std::array<ReactionStatus, 6> status{};
  /// Where a range of stiffness was asked for: the range of the value, valid like it.
  std::array<double, 6> low{}, high{};
};

/// Names of what has reactions, in their order: the joints, then couplings and constraints.
struct ReactionNames {
  std::vector<std::string> joints, couplings;
};
ReactionNames name_reactions(const Model& model);

enum class ReactionAxes { kWorld, kJoint };

/// What makes reactions definite that rigid bodies leave open.
struct DistributionOptions {
  /// By stiffness, joints that have none are rigid: without any stiffness or misalignment nothing is distributed.
  DistributionBy by = DistributionBy::kJointStiffness;
  std::optional<StiffnessRange> range;  ///< Also compute how reactions range with the stiffness.
};

/// How the distribution went at one state.
struct DistributionOutcome {
  bool used = false;                       ///< There was stiffness to distribute by.
  int too_many = 0;                        ///< Self-stresses, where there are more than can be distributed.
  bool confident = true;                   ///< Which self-stresses it fixes was a clear decision.
  std::vector<std::string> contradictory;  ///< Rigid joints that cannot be assembled with the misalignment: no values
  ///< for them and what self-stresses tie to them.
  BoundsMethod bounds = BoundsMethod::kExact;
};

/// Computes reactions of all joints at a state whose accelerations are known.
///
/// Each tree joint balances its outboard side; a component is unique when its projection on the joint's constraint
/// wrenches is orthogonal to every self-stress at this pose [wojtyra2005]. The others are distributed by joint
/// stiffness (redundancy/distribution.h) as far as it goes, of up to `kMostDistributed` self-stresses: they are taken
/// as one dense system. Cost: O(rows · redundant), and that of the distribution if there is one; without stiffness, of
/// large mechanisms, that of a rank decision.
class ReactionSolver {
 public:
  static constexpr int kMostDistributed = 1500;

  /// More closure rows than `largest_dense`, and self-stresses are kept with their zeros left out, unless stiffness
  /// divides by them.
  explicit ReactionSolver(std::shared_ptr<const DynamicsModel> model, const DistributionOptions& options = {},
                          int largest_dense = 256);

  /// `eq` filled at `state`; `vdot`, `lambda` solve it with the drive efforts `u` (nu).
  std::vector<JointReaction> solve(const State& state, const Equations& eq, const Selection& selection,
                                   const VectorXd& vdot, const VectorXd& lambda, const VectorXd& u,
                                   ReactionAxes axes = ReactionAxes::kWorld,
                                   DistributionOutcome* outcome = nullptr) const;

  bool distributes() const { return springs_.any; }

 private:
  struct Instant;
  struct Distributed;
  int redundant_rows(const Selection& selection) const;
  Distributed distribute(const Instant& at, VectorXd lambda, DistributionOutcome& outcome) const;
  std::vector<JointReaction> make_reactions(const Instant& at, const Distributed& solution, ReactionAxes axes) const;
  void add_ranges(const Instant& at, const Distributed& solution, ReactionAxes axes,
                  std::vector<JointReaction>& reactions, DistributionOutcome& outcome) const;

  std::shared_ptr<const DynamicsModel> model_;
  DistributionOptions options_;
  int largest_dense_;
  Scaling scaling_;
  AllRows rows_;
  JointSprings springs_;
};

}  // namespace ferrers
