#pragma once

#include <memory>
#include <vector>

#include "ferrers/simulate/evaluator.h"
#include "ferrers/simulate/explicit_rule.h"

namespace ferrers {

/// One step of an integrator from `state`, at which `evaluator` was evaluated last.
///
/// Post, when `finite`: `next` at t + h, on the constraints, and evaluated there. The explicit ones
/// allocate nothing in a step that crosses no singular pose. One integrator per file.
class Stepper {
 public:
  virtual ~Stepper() = default;
  struct Outcome {
    bool finite = true;  ///< False: the step failed (not finite, or no solution); `next` is not valid.
    double error = 0;    ///< Estimated local error, in rad and characteristic lengths; 0 without an estimate.
    Work work;           ///< Done during the step, J.
  };
  virtual Outcome step(Evaluator& evaluator, const State& state, double h, State& next) = 0;

  /// State and accelerations at `t` within the step taken last, from `from` to `to`. Evaluations may be needed, so that
  /// `evaluator` is somewhere else afterwards. False: there is no better way than the quintic through both ends.
  virtual bool interpolate(Evaluator& evaluator, const State& from, const State& to, double t, State& state,
                           VectorXd& vdot);

  /// Power of h of the error estimate; 0: there is none, steps are fixed.
  virtual int error_order() const { return 0; }
  /// Where in a step a singular pose does least harm (simulate/explicit_rule.h).
  virtual const std::vector<double>& gaps() const;
};

/// A rule and projection; the error estimate is the rule's.
std::unique_ptr<Stepper> make_explicit_stepper(const Evaluator& evaluator, const ExplicitRule& rule);

/// The classical rule of order four. Fixed steps: error O(h⁵) per step, no estimate. With `doubling`, two half steps
/// beside one whole step; their difference over 15 estimates the error and, added, makes the result of fifth order.
/// [hairer1993]
std::unique_ptr<Stepper> make_runge_kutta_4(const Evaluator& evaluator, bool doubling);

/// The paper's scheme: independent accelerations are held over the step, dependent coordinates and velocities follow
/// from the constraints. First order in velocity. [stepanyan, "inverse problem", step 4]
std::unique_ptr<Stepper> make_constant_acceleration(const Evaluator& evaluator);

/// The generalized-α method for index 3 on the coordinates' Lie group, order two, with adjustable damping of what is
/// too fast for the step (simulate/generalized_alpha.cc) [arnold2007, bruls2010].
/// With `doubling` order three and an error estimate.
std::unique_ptr<Stepper> make_generalized_alpha(const Evaluator& evaluator, bool doubling);

/// The stepper of an integrator, for steps of fixed length or with an error estimate where it has one.
std::unique_ptr<Stepper> make_stepper(Integrator integrator, const Evaluator& evaluator, bool fixed);

/// How errors of positions and velocities are measured: in rad and characteristic lengths, velocities over the fastest
/// rate seen.
class ErrorScale {
 public:
  ErrorScale(const System& system, const Scaling& scaling);
  /// Takes the rates at a state into account.
  void see(const VectorXd& v, const VectorXd& vdot);
  /// Largest scaled entry of an error in q (nq) and v (nv).
  double size(const VectorXd& q_error, const VectorXd& v_error) const;
  /// The same for a displacement given as a velocity for unit time (nv).
  double size_of_velocities(const VectorXd& dq, const VectorXd& v_error) const;
  double fastest() const { return fastest_; }  ///< 1/s.

 private:
  VectorXd q_, v_;  // inverse units
  double fastest_ = 0;
};

}  // namespace ferrers
