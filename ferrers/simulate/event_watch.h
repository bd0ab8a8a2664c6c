#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "ferrers/dynamics/dynamics_model.h"

/// Problem: when, within a step, does the formula of an event pass through zero?
///
/// Given: the step as dense output. Wanted: the earliest zero after the step's start. Signs are compared at eighths of
/// the step, so that two zeros nearer to each other than that may be missed; then regula falsi (Illinois) to rounding.
/// A formula that is zero at the start, or that has just acted, must leave zero before it acts again. One that is not a
/// number anywhere ends the run.
namespace ferrers {

class EventWatch {
 public:
  explicit EventWatch(std::shared_ptr<const DynamicsModel> model);
  bool any() const { return !model_->events.empty(); }

  /// Remembers on which side of zero the formulas are at `state`.
  void start(const State& state);

  struct Hit {
    double t = 0;
    int event = 0;  ///< Index into `Model::events()`.
  };
  /// `state_at(t, state)` gives the state within (from, to]. Nothing where `broken()` is set.
  std::optional<Hit> find(double from, double to, const std::function<void(double, State&)>& state_at);

  /// The event whose formula turned out to be no number, and when; empty: none.
  const std::string& broken() const { return broken_; }

  /// The event acted at `state`: its side of zero is taken anew from what follows.
  void acted(int event) { sides_[static_cast<std::size_t>(event)] = 0; }

 private:
  double value(std::size_t event, const State& state);
  double refine(std::size_t event, double a, double at_a, double b, double at_b,
                const std::function<void(double, State&)>& state_at);

  std::shared_ptr<const DynamicsModel> model_;
  std::vector<int> sides_;  ///< −1, 1; 0: not known.
  PositionKinematics pos_;
  VelocityKinematics vel_;
  State probe_;
  std::string broken_;
};

}  // namespace ferrers
