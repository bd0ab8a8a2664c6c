#pragma once

#include "ferrers/simulate/stepper.h"

namespace ferrers {

/// Chooses the lengths of adaptive steps: by the error, and so that singular poses are stepped across, not into.
///
/// A step may err by the tolerance times how far things move in it. Near a singular pose the chosen pivots go to zero
/// like δ, the distance to the pose, and rounding in the constraints reaches the accelerations multiplied by 1/δ³,
/// although the motion itself is smooth there. So the time of the crossing is predicted from the pivots, and the step
/// that contains it is laid so that no evaluation of the step-doubling rule (at quarters of the step) comes nearer than
/// an eighth of it.
class StepControl {
 public:
  StepControl(double tolerance, double longest) : tolerance_(tolerance), longest_(longest) {}

  /// Takes one step from `state` (evaluated) to `next`, not beyond `t_limit` unless a singular pose is crossed there.
  /// False: no step keeps the error. `crossing` tells whether the step went across a predicted singular pose.
  bool step(Evaluator& evaluator, Stepper& stepper, const State& state, double t_limit, RunSummary& summary,
            State& next);

  bool crossing() const { return crossing_; }

 private:
  double fastest_rate(const Evaluator& evaluator, const State& state) const;
  double predicted_distance(const Evaluator& evaluator, const State& state);
  double fit_to_crossing(double h, double distance);
  double allowed_error(double h, double fastest) const;
  double rounding_error(const Evaluator& evaluator, double h, double fastest) const;

  double tolerance_, longest_;
  double next_ = 0;                      ///< Length proposed for the next step, s; 0: not known.
  double trusted_ = 0;                   ///< The last length whose error was allowed.
  double last_t_ = 0, last_pivot_ = -1;  ///< At the previous accepted step.
  bool crossing_ = false;
};

/// State at time `t` between two accepted states with their accelerations: the quintic through positions, velocities
/// and accelerations of both (error of sixth order). Quaternions are interpolated as numbers and normalized.
struct Hermite {
  State from, to;
  VectorXd from_vdot, to_vdot;
  void evaluate(const System& system, double t, State& state, VectorXd& vdot) const;
};

}  // namespace ferrers
