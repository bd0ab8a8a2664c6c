#include "ferrers/simulate/event_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace ferrers {
namespace {

int sign(double value) { return value > 0 ? 1 : (value < 0 ? -1 : 0); }

}  // namespace

EventWatch::EventWatch(std::shared_ptr<const DynamicsModel> model)
    : model_(std::move(model)),
      pos_(make_position_kinematics(*model_->system)),
      vel_(make_velocity_kinematics(*model_->system)),
      probe_(make_drawn_state(*model_->system)) {
  sides_.assign(model_->events.size(), 0);
}

double EventWatch::value(std::size_t event, const State& state) {
  compute_positions(*model_->system, state.q, pos_);
  compute_velocities(*model_->system, pos_, state.q, state.v, vel_);
  const double value = model_->events[event].evaluate(*model_->system, state, pos_, vel_);
  if (!std::isfinite(value) && broken_.empty()) {
    broken_ = fmt::format("the formula of event '{}' is not a number at t = {:g} s",
                          model_->system->model->events()[event].name, state.t);
  }
  return value;
}

void EventWatch::start(const State& state) {
  for (std::size_t e = 0; e < sides_.size(); ++e) sides_[e] = sign(value(e, state));
}

double EventWatch::refine(std::size_t event, double a, double at_a, double b, double at_b,
                          const std::function<void(double, State&)>& state_at) {
  int stayed = 0;  // which end stayed in the iteration before: −1, 1
  for (int i = 0; i < 60 && b - a > 4e-16 * std::max(std::abs(b), 1e-300); ++i) {
    double t = b - at_b * (b - a) / (at_b - at_a);
    if (!(t > a && t < b)) t = 0.5 * (a + b);
    state_at(t, probe_);
    const double there = value(event, probe_);
    if (there == 0) return t;
    if ((there > 0) == (at_b > 0)) {
      b = t;
      at_b = there;
      if (stayed == -1) at_a *= 0.5;  // Illinois: an end that stays twice counts half
      stayed = -1;
    } else {
      a = t;
      at_a = there;
      if (stayed == 1) at_b *= 0.5;
      stayed = 1;
    }
  }
  return b;
}

std::optional<EventWatch::Hit> EventWatch::find(double from, double to,
                                                const std::function<void(double, State&)>& state_at) {
  constexpr int kPieces = 8;
  double t = from;
  std::vector<double> before(sides_.size(), 0);
  for (int i = 1; i <= kPieces; ++i) {
    const double next = i == kPieces ? to : from + (to - from) * i / kPieces;
    std::optional<Hit> first;
    for (std::size_t e = 0; e < sides_.size(); ++e) {
      state_at(next, probe_);
      const double there = value(e, probe_);
      if (!broken_.empty()) return std::nullopt;
      const int side = sign(there);
      if (sides_[e] != 0 && side != sides_[e]) {
        // `before` is not known in the first piece.
        double at_a = before[e];
        if (i == 1) {
          state_at(t, probe_);
          at_a = value(e, probe_);
        }
        const double zero =
            side == 0 ? next : (sign(at_a) == side || at_a == 0 ? t : refine(e, t, at_a, next, there, state_at));
        if (!first || zero < first->t) first = Hit{zero, static_cast<int>(e)};
      } else if (side != 0) {
        sides_[e] = side;
      }
      before[e] = there;
    }
    if (first) {
      sides_[static_cast<std::size_t>(first->event)] = 0;
      return first;
    }
    t = next;
  }
  return std::nullopt;
}

}  // namespace ferrers
