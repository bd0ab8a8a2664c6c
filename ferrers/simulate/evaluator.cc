#include "ferrers/simulate/evaluator.h"

namespace ferrers {

Evaluator::Evaluator(std::shared_ptr<const DynamicsModel> model, Formulation formulation)
    : model_(std::move(model)),
      formulation_(formulation),
      scaling_(make_scaling(*model_->system)),
      eq_(make_equations(*model_)),
      result_(make_forward_result(*model_->system)),
      metric_(model_->system->nv),
      projected_(make_constraint_kinematics(*model_->system)),
      projected_pos_(make_position_kinematics(*model_->system)),
      projected_vel_(make_velocity_kinematics(*model_->system)) {}

void Evaluator::use(Selection selection) {
  selection_ = std::move(selection);
  solver_ = make_forward_solver(formulation_, system(), selection_);
  projector_ = std::make_unique<Projector>(system(), scaling_, selection_.rows);
  result_.lambda.setZero();
  pivot_known_ = false;
}

void Evaluator::record(double t, const std::string& reason, RunSummary& summary) const {
  DecisionRecord record;
  record.t = t;
  record.rank = static_cast<int>(selection_.rows.size());
  record.mobility = static_cast<int>(selection_.independent.size());
  record.reason = reason;
  for (const int row : selection_.excluded_rows(system().m)) record.excluded_rows.push_back(system().row_names[row]);
  for (const int v : selection_.independent) record.independent_coordinates.push_back(system().coordinate_names[v]);
  summary.decisions.push_back(std::move(record));
}

void Evaluator::decide(const State& state, const std::string& reason, RunSummary& summary) {
  compute_kinematics(*model_, state, eq_);
  RankDecision decision;
  use(select_independent(system(), scaling_, eq_.constraints, &decision));
  if (!decision.confident) {
    summary.notices.push_back("the rank at t = " + std::to_string(state.t) + " s is in doubt: " +
                              std::to_string(decision.rank) + " or " + std::to_string(decision.other_rank));
  }
  record(state.t, reason, summary);
}

ForwardStatus Evaluator::choose_again(const State& state, RunSummary& summary) {
  const Selection previous = selection_;
  const double healthy = healthy_pivot_;
  use(reselect(system(), scaling_, eq_.constraints, previous));
  ForwardStatus status = evaluate(state);
  if (status == ForwardStatus::kSolved && !is_worn_pivot(solver_->smallest_pivot(), best_pivot_)) {
    record(state.t, "the coordinates chosen before became ill-conditioned", summary);
    return status;
  }
  use(previous);  // all choices are bad here: the pose is nearly singular
  status = evaluate(state);
  healthy_pivot_ = healthy;
  return status;
}

ForwardStatus Evaluator::evaluate(const State& state) {
  ++evaluations_;
  compute_equations(*model_, state, eq_);
  solver_->solve(eq_, result_);
  if (result_.status != ForwardStatus::kSolved) return result_.status;
  const double pivot = solver_->smallest_pivot();
  if (!pivot_known_) healthy_pivot_ = pivot;
  pivot_known_ = true;
  best_pivot_ = std::max(best_pivot_, pivot);
  smallest_pivot_ = std::min(smallest_pivot_, pivot);
  return result_.status;
}

double Evaluator::project(State& state) {
  metric_.compute(eq_.M);
  if (metric_.info() != Eigen::Success) {  // massless bodies: any regular metric will do
    const VectorXd unit = scaling_.columns.cwiseInverse().cwiseAbs2();
    metric_.compute(eq_.M + 1e-6 * eq_.M.diagonal().maxCoeff() * MatrixXd(unit.asDiagonal()));
  }
  return projector_->project(metric_, state, projected_pos_, projected_vel_, projected_);
}

bool Evaluator::is_worn() const { return pivot_known_ && is_worn_pivot(solver_->smallest_pivot(), healthy_pivot_); }

double Evaluator::left_out_residual() const {
  return system().m > 0 ? eq_.constraints.phi.cwiseProduct(scaling_.rows).cwiseAbs().maxCoeff() : 0.0;
}

}  // namespace ferrers
