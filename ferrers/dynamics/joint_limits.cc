#include "ferrers/dynamics/joint_limits.h"

#include <fmt/format.h>

#include <cmath>

namespace ferrers {
namespace {

// Where the cubic with values and slopes (per unit of s) at s = 0 and s = 1 passes zero; its ends differ in sign.
double zero_of_cubic(double f0, double d0, double f1, double d1) {
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double s = 0.5 * (low + high), r = 1 - s;
    const double value = r * r * ((1 + 2 * s) * f0 + s * d0) + s * s * ((1 + 2 * r) * f1 - r * d1);
    ((value > 0) == (f1 > 0) ? high : low) = s;
  }
  return high;
}

}  // namespace

LimitWatch::LimitWatch(std::shared_ptr<const DynamicsModel> model) : model_(std::move(model)) {
  const auto& joints = model_->system->model->joints();
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (!joints[j].limits) continue;
    const auto [low, high] = *joints[j].limits;
    watched_.push_back({JointId(j), model_->system->access({JointId(j), 0}), {low, high}});
  }
}

void LimitWatch::follow(Watched& one, int side, double t, double value, double rate) {
  const double sign = side == 0 ? -1 : 1;
  // A coordinate that rests on its limit is not beyond it by rounding.
  const double limit = one.limits[side] + sign * 1e-12 * (1 + std::abs(one.limits[side]));
  const double beyond = sign * (value - limit);
  const double before = started_ ? sign * (one.value - limit) : -1;
  if (beyond > 0 && before <= 0 && one.count[side]++ == 0) {
    const double dt = t - t_;
    one.t[side] =
        started_ && dt > 0 ? t_ + dt * zero_of_cubic(before, sign * dt * one.rate, beyond, sign * dt * rate) : t;
  }
  if (beyond > one.excess[side]) {
    one.excess[side] = beyond;
    one.excess_t[side] = t;
  }
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
