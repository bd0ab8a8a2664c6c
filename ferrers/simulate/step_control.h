#pragma once

#include "ferrers/simulate/stepper.h"

namespace ferrers {

/// Chooses the lengths of adaptive steps: by the error, and so that singular poses are stepped across, not into.
///
/// A step may err by the tolerance times how far things move in it. Near a singular pose the chosen pivots go to zero
/// like δ, the distance to the pose, and rounding in the constraints reaches the accelerations multiplied by 1/δ³,
/// although the motion itself is smooth there. So the time of the crossing is predicted from the pivots, and the step
/// that contains it is laid so that the pose falls into the middle of a wide gap between the integrator's stages.
class StepControl {
 public:
  StepControl(double tolerance, double longest, double looser = 1)
      : tolerance_(tolerance), longest_(longest), looser_(looser) {}

  /// Takes one step from `state` (evaluated) to `next` (then evaluated), not beyond `t_limit` unless a singular pose is
  /// crossed there. False: no step keeps the error. `crossing` tells whether a predicted singular pose lies in the
  /// step.
  bool step(Evaluator& evaluator, Stepper& stepper, const State& state, double t_limit, RunSummary& summary,
            State& next);

  bool crossing() const { return crossing_; }
  /// A singular pose is expected within about two steps: choosing coordinates anew would not help.
  bool near_crossing() const { return near_crossing_; }
  /// Largest local error that was taken although the tolerance does not allow it, because rounding does not allow less.
  double lost() const { return lost_; }
  /// What rounding leaves in one step, in rad and characteristic lengths: no tolerance of a step is taken below that.
  static double rounding(const Evaluator& evaluator);
  const Work& work() const { return work_; }  ///< Of the step taken last.
  /// Forgets lengths and pivots: the motion goes on at `t` from another state or under other forces.
  void restart(double t);

 private:
  double fastest_rate(const Evaluator& evaluator, const State& state) const;
  bool is_hopeless(double t);
  double predicted_distance(Evaluator& evaluator, const State& state);
  double refined_distance(Evaluator& evaluator, const State& state, double distance);
  double crossing_length(const Evaluator& evaluator, const Stepper& stepper, double h, double allowed,
                         double distance) const;
  double fit_to_crossing(const Evaluator& evaluator, const Stepper& stepper, double h, double allowed, double distance);
  double allowed_error(const Evaluator& evaluator, double h, double fastest) const;
  double rounding_error(const Evaluator& evaluator, double h, double fastest) const;

  double tolerance_, longest_, looser_;
  double next_ = 0;                                          ///< Length proposed for the next step, s; 0: not known.
  double trusted_ = 0;                                       ///< The last length whose error was allowed.
  double last_pivot_ = -1;                                   ///< Where the step begins.
  double begin_ = -std::numeric_limits<double>::infinity();  ///< What was before is forgotten.
  double lost_ = 0;
  double pace_t_ = 0;  ///< When the steps were counted last.
  long pace_steps_ = 0;
  bool crossing_ = false, near_crossing_ = false;
  Work work_;
  State probe_;
  VectorXd displacement_;
};

/// State at time `t` between two accepted states with their accelerations: the quintic through positions, velocities
/// and accelerations of both (error of sixth order); joints with quaternions by cubics (fourth order), normalized.
struct Hermite {
  State from, to;
  VectorXd from_vdot, to_vdot;
  void evaluate(const System& system, double t, State& state, VectorXd& vdot) const;
};

}  // namespace ferrers
