#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ferrers/dynamics/reactions.h"

/// What the joints carry at rest.
namespace ferrers {

/// A pose at rest with what balances it: found (dynamics/equilibrium.h) or held (dynamics/holding.h).
struct RestPoint {
  State state;          ///< At rest.
  Selection selection;  ///< There.
  VectorXd lambda;      ///< m, zero at rows left out.
  VectorXd u;           ///< nu: drive efforts.
  /// Efforts (nu × k) that the constraints balance with multipliers (m × k): what the pose does not tell of u. Empty
  /// where all of it is told.
  MatrixXd idle_efforts, idle_lambda;
  std::vector<std::string> notices;
};

/// Reactions of all joints at rest; those that change with the sharing of the efforts are marked distributed.
std::vector<JointReaction> compute_rest_reactions(const std::shared_ptr<const DynamicsModel>& model,
                                                  const RestPoint& rest, ReactionAxes axes,
                                                  const DistributionOptions& distribution,
                                                  DistributionOutcome* outcome = nullptr);

}  // namespace ferrers
