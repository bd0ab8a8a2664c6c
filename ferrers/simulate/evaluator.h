#pragma once

#include <limits>
#include <memory>
#include <string>

#include "ferrers/dynamics/forward.h"
#include "ferrers/kinematics/projection.h"
#include "ferrers/simulate/simulation.h"

namespace ferrers {

/// Evaluates accelerations with the decision in force, and watches that it stays true.
///
/// *Decide*: `decide` takes the rank and the selection at an assembled state. *Evaluate*: `evaluate` runs straight-line
/// algebra with it. *Watch*: `is_worn` compares the pivots with those at the decision; `left_out_residual` is how far
/// the rows left out are from holding.
class Evaluator {
 public:
  Evaluator(std::shared_ptr<const DynamicsModel> model, Formulation formulation);

  /// Decides at `state` and records it.
  void decide(const State& state, const std::string& reason, RunSummary& summary);
  /// Chooses rows and coordinates anew with the rank kept, where that gives healthy pivots again; records it then.
  /// The accelerations at `state` are evaluated afterwards either way.
  ForwardStatus choose_again(const State& state, RunSummary& summary);

  ForwardStatus evaluate(const State& state);
  /// Projects onto the constraints in the mass metric of the last evaluation. Returns the residual left, m.
  double project(State& state);
  bool is_worn() const;
  /// Smallest pivot of the evaluations since `reset_watch`, over the best one known: how much rounding is amplified.
  double smallest_pivot_ratio() const { return best_pivot_ > 0 ? smallest_pivot_ / best_pivot_ : 1; }
  /// Remembers the residual of the last evaluation as that of the step about to be taken.
  void note_residual() { residual_ = left_out_residual(); }
  double residual_at_step() const { return residual_; }
  double pivot() const { return solver_->smallest_pivot(); }  ///< At the last evaluation.
  double best_pivot() const { return best_pivot_; }
  void reset_watch() { smallest_pivot_ = std::numeric_limits<double>::infinity(); }
  double left_out_residual() const;  ///< Largest scaled residual of all rows at the last evaluation, m.

  const System& system() const { return *model_->system; }
  const DynamicsModel& model() const { return *model_; }
  const Scaling& scaling() const { return scaling_; }
  const Selection& selection() const { return selection_; }
  const Equations& equations() const { return eq_; }
  const ForwardResult& result() const { return result_; }
  long evaluations() const { return evaluations_; }

 private:
  void use(Selection selection);
  void record(double t, const std::string& reason, RunSummary& summary) const;

  std::shared_ptr<const DynamicsModel> model_;
  Formulation formulation_;
  Scaling scaling_;
  Equations eq_;
  ForwardResult result_;
  Selection selection_;
  std::unique_ptr<ForwardSolver> solver_;
  std::unique_ptr<Projector> projector_;
  Eigen::LLT<MatrixXd> metric_;
  ConstraintKinematics projected_;
  PositionKinematics projected_pos_;
  VelocityKinematics projected_vel_;
  double healthy_pivot_ = 0, best_pivot_ = 0;  ///< When rows and coordinates were chosen; the largest of those.
  double smallest_pivot_ = std::numeric_limits<double>::infinity();
  bool pivot_known_ = false;
  double residual_ = 0;
  long evaluations_ = 0;
};

}  // namespace ferrers
