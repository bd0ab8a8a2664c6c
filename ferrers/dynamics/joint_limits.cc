#include "ferrers/dynamics/joint_limits.h"

#include <fmt/format.h>

#include <cmath>

namespace ferrers {
namespace {

// The cubic with values and slopes (per unit of s) given at s = 0 and s = 1.
struct Cubic {
  double f0, d0, f1, d1;
  double value(double s) const {
    const double r = 1 - s;
    return r * r * ((1 + 2 * s) * f0 + s * d0) + s * s * ((1 + 2 * r) * f1 - r * d1);
  }
  double slope(double s) const {
    const double r = 1 - s;
    return 6 * r * s * (f1 - f0) + r * (1 - 3 * s) * d0 + s * (3 * s - 2) * d1;
  }
};

// Where `f` changes its sign between 0 and 1; `end`: f(1).
template <typename Function>
double zero_between(double end, const Function& f) {
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double s = 0.5 * (low + high);
    ((f(s) > 0) == (end > 0) ? high : low) = s;
  }
  return high;
}

}  // namespace

LimitWatch::LimitWatch(std::shared_ptr<const DynamicsModel> model)
    : model_(std::move(model)),
      pos_(make_position_kinematics(*model_->system)),
      vel_(make_velocity_kinematics(*model_->system)) {
  const auto& joints = model_->system->model->joints();
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (!joints[j].limits) continue;
    const auto [low, high] = *joints[j].limits;
    watched_.push_back({JointId(j), model_->system->access({JointId(j), 0}), {low, high}});
  }
}

// From one end to the other without a maximum between them.
void LimitWatch::pass(Watched& one, int side, const End& from, const End& to) {
  if (to.beyond > 0 && from.beyond <= 0 && one.count[side]++ == 0) {
    const double dt = to.t - from.t;
    const Cubic cubic = {from.beyond, dt * from.rate, to.beyond, dt * to.rate};
    one.t[side] = from.t + dt * zero_between(to.beyond, [&](double s) { return cubic.value(s); });
  }
  if (to.beyond > one.excess[side]) {
    one.excess[side] = to.beyond;
    one.excess_t[side] = to.t;
  }
}

void LimitWatch::follow(Watched& one, int side, double t, double value, double rate) {
  const double sign = side == 0 ? -1 : 1;
  // A coordinate that rests on its limit is not beyond it by rounding.
  const double limit = one.limits[side] + sign * 1e-12 * (1 + std::abs(one.limits[side]));
  const End to = {t, sign * (value - limit), sign * rate};
  if (!started_) return pass(one, side, {t, -1, 0}, to);
  End from = {t_, sign * (one.value - limit), sign * one.rate};
  if (t > t_ && from.rate > 0 && to.rate < 0) {  // it turned round on the way
    const double dt = t - t_;
    const Cubic cubic = {from.beyond, dt * from.rate, to.beyond, dt * to.rate};
    const double s = zero_between(to.rate, [&](double at) { return cubic.slope(at); });
    const End top = {t_ + s * dt, cubic.value(s), 0};
    pass(one, side, from, top);
    from = top;
  }
  pass(one, side, from, to);
}

void LimitWatch::observe(const State& state, const PositionKinematics& pos, const VelocityKinematics& vel) {
  for (Watched& one : watched_) {
    const Jet jet = measure_coordinate(*model_->system, one.access, state, pos, vel);
    for (const int side : {0, 1}) follow(one, side, state.t, jet.value, jet.rate);
    one.value = jet.value;
    one.rate = jet.rate;
  }
  started_ = true;
  t_ = state.t;
}

void LimitWatch::observe(const State& state) {
  compute_positions(*model_->system, state.q, pos_);
  compute_velocities(*model_->system, pos_, state.q, state.v, vel_);
  observe(state, pos_, vel_);
}

std::vector<LimitCrossing> LimitWatch::crossings() const {
  std::vector<LimitCrossing> all;
  for (const Watched& one : watched_) {
    for (const int side : {0, 1}) {
      if (one.count[side] == 0) continue;
      all.push_back({model_->system->model->joint(one.joint).name, side == 1, one.limits[side], one.t[side],
                     one.count[side], one.excess[side], one.excess_t[side]});
    }
  }
  return all;
}

std::string describe(const LimitCrossing& crossing) {
  const std::string again = crossing.times > 1 ? fmt::format(" for the first of {} times", crossing.times) : "";
  return fmt::format("joint '{}' crosses its {} limit {:.6g} at t = {:.6g} s{}, by at most {:.4g} (at t = {:.6g} s)",
                     crossing.joint, crossing.upper ? "upper" : "lower", crossing.limit, crossing.t, again,
                     crossing.excess, crossing.excess_t);
}

}  // namespace ferrers
