#pragma once

#include <vector>

#include "ferrers/simulate/simulation.h"

/// Problem: step control knows local errors; the user wants to know how far the motion is off at the end.
///
/// Given: a run that was made with a tolerance. Wanted: how far its positions may be off. A companion with ten times
/// the tolerance is run afterwards; the largest difference of any joint coordinate at up to a thousand rows, in rad and
/// characteristic lengths, is the error of the companion, and more than that of the run. Rounding shows in it too.
/// Cost: that of the companion, about three quarters of the run's steps with an integrator of order eight.
namespace ferrers {

class ErrorEstimate {
 public:
  ErrorEstimate(std::shared_ptr<const DynamicsModel> model, const SimulationOptions& options);
  /// A row of the run.
  void keep(const RunSample& sample);
  /// Runs the companion and compares. Empty: it did not finish, or was stopped.
  std::optional<double> compute(double t_reached, const RunControl& control);

 private:
  void compare(const RunSample& sample);

  std::shared_ptr<const DynamicsModel> model_;
  SimulationOptions looser_;
  std::vector<double> scales_;  ///< Per column: what a position counts; 0: no position.
  std::vector<RunSample> rows_;
  std::size_t next_ = 0;
  double largest_ = 0;
};

}  // namespace ferrers
