#include "ferrers/dynamics/rest_reactions.h"

namespace ferrers {

std::vector<JointReaction> compute_rest_reactions(const std::shared_ptr<const DynamicsModel>& model,
                                                  const RestPoint& rest, ReactionAxes axes,
                                                  const DistributionOptions& distribution,
                                                  DistributionOutcome* outcome) {
  Equations eq = make_equations(*model);
  compute_equations(*model, rest.state, eq);
  eq.idle_efforts = rest.idle_efforts;
  eq.idle_lambda = rest.idle_lambda;
  const VectorXd still = VectorXd::Zero(model->system->nv);
  return ReactionSolver(model, distribution)
      .solve(rest.state, eq, rest.selection, still, rest.lambda, rest.u, axes, outcome);
}

}  // namespace ferrers
