#pragma once

#include <memory>

#include "ferrers/dynamics/joint_limits.h"
#include "ferrers/dynamics/momentum.h"
#include "ferrers/simulate/event_watch.h"
#include "ferrers/simulate/singular_poses.h"
#include "ferrers/simulate/step_control.h"

namespace ferrers {

constexpr double kDefaultTolerance = 1e-9;

/// One forward simulation: the loop "step, watch, output", with its bookkeeping. Everything that `simulate` does after
/// it has looked at the model.
class Run {
 public:
  /// `looser`: multiplies what steps may err by, rounding too, for a companion (simulate/error_estimate.h).
  Run(std::shared_ptr<const DynamicsModel> model, const SimulationOptions& options, const RunControl& control,
      double looser = 1);
  RunSummary go();

 private:
  void conclude();
  bool fail(RunStatus status, std::string message);
  bool start();
  void choose_method();
  bool put_on_laws();
  bool solved(ForwardStatus status);
  bool stuck();

  void march();
  bool take_step(const std::vector<double>& times, std::size_t due);
  bool accept();
  void judge_native_code(long evaluations);
  bool finish_step(const std::vector<double>& times, std::size_t& due);
  bool emit_until(double t, const std::vector<double>& times, std::size_t& due);
  void state_at(double t, State& state, VectorXd& vdot);
  bool act(const EventWatch::Hit& hit);
  bool land_on(double t);
  void watch_limits(double until);
  std::string switch_drive(DriveId drive);
  void use_switches();
  std::vector<std::string> drives_off() const;
  bool meets_laws(const Event& event);
  void note_singular_pose();

  bool emit_here();
  bool emit_between(double t);
  bool record(const State& state, const VectorXd& vdot, bool solved);
  void follow_momentum(bool first);

  const System& system() const { return *model_->system; }

  std::shared_ptr<const DynamicsModel> model_;
  const SimulationOptions& options_;
  const RunControl& control_;
  Formulation formulation_;
  Evaluator evaluator_;
  Recorder recorder_;
  EventWatch events_;
  LimitWatch limits_;
  std::unique_ptr<Stepper> stepper_;
  StepControl control_steps_;
  RunSummary summary_;
  State state_, next_;
  Hermite between_;  ///< The step taken last.
  State sample_state_;
  VectorXd sample_vdot_;
  Work work_, work_before_;  ///< Until the state, and until the step taken last.
  std::vector<int> driven_;
  std::vector<bool> off_;  ///< Per drive component.
  bool adaptive_ = false, crossing_ = false, moved_ = false, switched_ = false, unlocated_told_ = false;
  double begin_ = 0;                                     ///< s.
  double step_ = 0;                                      ///< Fixed steps, s.
  double energy_ = 0, elastic_ = 0, elastic_start_ = 0;  ///< J.
};

}  // namespace ferrers
