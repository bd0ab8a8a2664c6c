#pragma once

#include <memory>

#include "ferrers/simulate/evaluator.h"

namespace ferrers {

/// One step of an integrator from `state`, whose accelerations `evaluator` has just evaluated.
///
/// Post: `next` at t + h, on the constraints, with `state`'s windings carried on by the caller. Steppers allocate
/// nothing per step. One integrator per file.
class Stepper {
 public:
  virtual ~Stepper() = default;
  struct Outcome {
    bool finite = true;  ///< False: the step failed (not finite, or no solution); `next` is not valid.
    double error = 0;    ///< Estimated local error, in rad and characteristic lengths; 0 without an estimate.
  };
  virtual Outcome step(Evaluator& evaluator, const State& state, double h, State& next) = 0;
};

/// Classical Runge-Kutta of order four, then projection. Error: O(h⁵) per step, no estimate. [hairer1993]
std::unique_ptr<Stepper> make_runge_kutta_4(const Evaluator& evaluator);

/// Two half steps beside one whole step of the same; their difference over 15 estimates the error and, added, makes the
/// result of fifth order. `rate_scale()` in 1/s converts velocity errors. [hairer1993]
std::unique_ptr<Stepper> make_runge_kutta_doubling(const Evaluator& evaluator);

/// The paper's scheme: independent accelerations are held over the step, dependent coordinates and velocities follow
/// from the constraints. First order in velocity. [stepanyan, "inverse problem", step 4]
std::unique_ptr<Stepper> make_constant_acceleration(const Evaluator& evaluator);

}  // namespace ferrers
