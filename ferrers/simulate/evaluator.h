#pragma once

#include <limits>
#include <memory>
#include <string>

#include "ferrers/dynamics/forward_program.h"
#include "ferrers/dynamics/friction.h"
#include "ferrers/simulate/simulation.h"

namespace ferrers {

/// Evaluates accelerations with the decision in force, and watches that it stays true.
///
/// *Decide*: `decide` takes the rank and the selection at an assembled state. *Evaluate*: `evaluate` runs straight-line
/// algebra with it. *Watch*: `is_worn` compares the pivots with those at the decision; `left_out_residual` is how far
/// the rows left out are from holding.
class Evaluator {
 public:
  /// `driven`: drive components whose motion is prescribed (dynamics/equations.h).
  Evaluator(std::shared_ptr<const DynamicsModel> model, Formulation formulation, std::vector<int> driven = {},
            const DistributionOptions& distribution = {});

  /// From which evaluation on native code may be made and used; never: less than 0.
  void use_native_code_from(long evaluation) { native_from_ = evaluation; }
  /// Drives from now on: which are prescribed, and which do not act at all. `decide` must follow.
  void set_drives(std::vector<int> driven, std::vector<bool> off);
  /// Decides at `state` and records it.
  void decide(const State& state, const std::string& reason, RunSummary& summary);
  /// Chooses rows and coordinates anew with the rank kept, where that gives healthy pivots again; records it then.
  /// The accelerations at `state` are evaluated afterwards either way.
  ForwardStatus choose_again(const State& state, RunSummary& summary);

  ForwardStatus evaluate(const State& state);
  /// Brings positions and velocities onto the constraints, the nearest ones in the mass metric, and evaluates there:
  ///   min |Δq|_M with phi_r(q ⊕ Δq) = 0,   min |Δv|_M with G_r (v + Δv) = nu_r,
  /// by the forward solver's factors with other right sides. A residual at the level of rounding is left alone: near a
  /// singular pose its correction would be noise. Returns the largest scaled residual left, m; infinity where it
  /// failed. `offset`: go to phi = offset instead.
  double settle(State& state, const VectorXd* offset = nullptr);
  /// A residual of this length, m, is settled, and velocities in proportion: for runs that are asked for less than
  /// rounding allows. Not across singular poses.
  void close_to(double length) { close_enough_ = length; }
  /// Whether states within a step are put on the constraints before they are evaluated: near a singular pose what the
  /// closures lack reaches the accelerations multiplied by 1/δ³.
  void settle_stages(bool settle) { settles_stages_ = settle; }
  /// A state within a step: evaluates there, after settling it if that is wanted. Where the model's own native code can
  /// do it (dynamics/forward_program.h), only `result()`, `power` and the pivots are known at once.
  bool evaluate_stage(State& state);
  double rounding_of_positions() const;  ///< What rounding alone leaves in phi, m.
  double rounding_of_places() const;     ///< Of this what is not that of angles after many turns.
  bool settles_stages() const { return settles_stages_; }
  /// Takes from a displacement or velocity (nv) what the constraints at the last evaluation do not allow.
  void keep_admissible(VectorXd& dv);
  /// Across a singular pose rounding enters the motion along its admissible direction, where energy sees it: scales the
  /// velocities of `to` so that kinetic and potential energy changed by `work` since `from`, and evaluates there.
  /// Leaves alone what is no rounding (more than 1e-6 of the kinetic energy), and motions that are prescribed.
  void restore_energy(const State& from, const Work& work, State& to);
  /// Power of the applied forces at the last evaluation, which was at `state`.
  Work power(const State& state) const;
  /// Length of a step in which no joint that closes a loop turns so far that its turns are lost count of, s, as things
  /// move at the last evaluation; infinity where nothing turns.
  double longest_followed_turn();
  bool is_worn() const;
  /// Smallest pivot of the evaluations since `reset_watch`, over the best one known: how much rounding is amplified.
  double smallest_pivot_ratio() const { return best_pivot_ > 0 ? smallest_pivot_ / best_pivot_ : 1; }
  /// Remembers the residual of the last evaluation as that of the step about to be taken.
  void note_residual() { residual_ = left_out_residual(); }
  double residual_at_step() const { return residual_; }
  double pivot() const { return pivot_; }  ///< At the last evaluation.
  double best_pivot() const { return best_pivot_; }
  void reset_watch();
  /// An evaluation since `reset_watch` a little before the latest in time: how the pivot goes.
  struct Watched {
    double t = -std::numeric_limits<double>::infinity();
    double pivot = 0;
  };
  const Watched& a_little_before() const { return before_latest_; }
  double left_out_residual() const;  ///< Largest scaled residual of all rows at the last evaluation, m.
  /// Why dry friction let the last evaluation fail; empty: it did not.
  const std::string& friction_problem() const { return friction_problem_; }
  /// What is wrong with a prescribed motion where the last evaluation failed, or ahead of it: a law without a finite
  /// value, or against the constraints; empty: nothing.
  const std::string& motion_problem() const { return motion_problem_; }
  /// What keeps the prescribed motions from determining their coordinates; empty: nothing. Known after `decide`.
  const std::string& driven_conflict() const { return driven_conflict_; }

  const System& system() const { return *model_->system; }
  const DynamicsModel& model() const { return *model_; }
  const Scaling& scaling() const { return scaling_; }
  const VectorXd& row_scale() const { return row_scale_; }  ///< Of all rows, driven ones too.
  /// Prescribed drives whose motion the constraints imply by themselves (out of the plane of a planar mechanism, say):
  /// watched, and without effort.
  const std::vector<int>& implied_drives() const { return implied_drives_; }
  const Selection& selection() const { return selection_; }              ///< Of all rows, driven ones too.
  const Selection& joint_selection() const { return joint_selection_; }  ///< Of the system's own rows.
  /// Efforts of all drives, nu: laws, and what the prescribed ones turned out to need. Brings what `equations()` tells
  /// about idle efforts up to date.
  const VectorXd& efforts();
  /// At the last evaluation. Computes what native code left out.
  const Equations& equations();
  const std::vector<int>& driven() const { return eq_.driven; }
  /// The parts of these that are wanted most.
  const PositionKinematics& positions();
  const VelocityKinematics& velocities();
  const ForwardResult& result() const { return result_; }
  long evaluations() const { return evaluations_; }

 private:
  void use(Selection joints);
  bool finds_programs();
  bool evaluate_natively(const State& state, const ForwardProgram& program, Kernel::Board& board,
                         ForwardProgram::Closure* closure);
  const VectorXd& resolve(const VectorXd& right);
  void switch_off(VectorXd& force);
  void note_sizes(double place, double speed, double turn);
  void note_pivot(double t, double pivot);
  double rounding_of_velocities() const;
  void note_motion_problem(double t, std::string problem);
  bool laws_agree(double t);
  void record(double t, const std::string& reason, RunSummary& summary) const;
  void watch(double t, double pivot);

  std::shared_ptr<const DynamicsModel> model_;
  Formulation formulation_;
  Scaling scaling_;
  Equations eq_;
  ForwardResult result_;
  Selection selection_, joint_selection_;
  std::unique_ptr<ForwardSolver> solver_;
  PositionKinematics energy_pos_;
  VelocityKinematics energy_vel_;
  VectorXd row_scale_;                              ///< Of all rows.
  std::vector<int> implied_drives_, implied_rows_;  ///< The same drives; their places in `eq_.driven`.
  std::vector<bool> off_;                           ///< Per drive component; empty: all act.
  VectorXd no_force_, residual_rhs_, efforts_, applied_;
  // Native code for the selection, once the order of elimination is known; null: there is none, or not yet.
  std::shared_ptr<const ForwardProgram> stage_program_, closure_program_;
  Kernel::Board stage_board_, closure_board_;
  ForwardProgram::Closure closure_;
  bool programs_sought_ = false;
  long native_from_ = 0;
  State last_;                    ///< Of the last native evaluation.
  bool has_factors_ = false;      ///< Those of the last evaluation by parts.
  bool poses_stale_ = false;      ///< `eq_.pos` and `eq_.vel` are not those of the last evaluation.
  bool equations_stale_ = false;  ///< `eq_` and the factors are not those of the last evaluation.
  ForwardResult correction_;
  std::string driven_conflict_, friction_problem_, motion_problem_;
  double motion_problem_t_ = 0;
  FrictionSolver friction_;
  double pivot_ = 1;
  double other_power_ = 0;                     ///< Of forces that native code knows by itself, W.
  double healthy_pivot_ = 0, best_pivot_ = 0;  ///< When rows and coordinates were chosen; the largest of those.
  double smallest_pivot_ = std::numeric_limits<double>::infinity();
  double watch_start_ = 0;
  Watched latest_, before_latest_;
  bool pivot_known_ = false, settles_stages_ = false;
  double close_enough_ = 0;
  double residual_ = 0;
  double place_ = 0, speed_ = 0, turn_ = 0;            ///< The largest of the bodies' nodes: m, m/s, rad/s.
  double angle_ = 0;                                   ///< The largest of the tree's, where it was last settled, rad.
  double coordinate_size_ = 0, coordinate_speed_ = 0;  ///< Largest of the generalized coordinates, scaled: m, m/s.
  long evaluations_ = 0;
};

}  // namespace ferrers
