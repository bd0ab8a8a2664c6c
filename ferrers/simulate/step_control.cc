#include "ferrers/simulate/step_control.h"

#include <algorithm>
#include <cmath>

namespace ferrers {
namespace {

constexpr double kRounding = 2e-16;        // see crossing_length
constexpr double kLargestLoss = 1e-10;     // in a step, that may pass for rounding
constexpr double kLargestRounding = 1e-6;  // of the motion in a step: more than that is no rounding

}  // namespace

double StepControl::fastest_rate(const Evaluator& evaluator, const State& state) const {
  double rate = 0, curvature = 0;
  const VectorXd& vdot = evaluator.result().vdot;
  for (int k = 0; k < evaluator.system().nv; ++k) {
    const double unit = evaluator.scaling().columns[k] * evaluator.scaling().length_m;
    rate = std::max(rate, std::abs(state.v[k]) / unit);
    curvature = std::max(curvature, std::abs(vdot[k]) / unit);
  }
  return std::max({rate, std::sqrt(curvature), 1e-3 / longest_});
}

// Not less than what rounding leaves of the closures.
double StepControl::allowed_error(const Evaluator& evaluator, double h, double fastest) const {
  return looser_ * std::max(tolerance_ * std::clamp(h * fastest, 1e-3, 1.0), rounding(evaluator));
}

double StepControl::rounding(const Evaluator& evaluator) {
  // Places are made of many operations, an angle is one number.
  const double rounding = std::max(40 * evaluator.rounding_of_places(), 4 * evaluator.rounding_of_positions());
  return rounding / evaluator.scaling().length_m;
}

// What rounding alone does with pivots down to `ratio` of healthy ones.
double StepControl::rounding_error(const Evaluator& evaluator, double h, double fastest) const {
  const double ratio = std::max(evaluator.smallest_pivot_ratio(), 1e-9);
  if (crossing_) return std::min(30 * kRounding / (ratio * ratio), kLargestRounding);
  const double residual = evaluator.residual_at_step() / evaluator.scaling().length_m + 1e-16;
  const double amplified = 1e-15 * evaluator.system().nv / ratio + residual / (ratio * ratio);
  return std::min(h * fastest, 1.0) * std::min(amplified, kLargestRounding);
}

// Time until the smallest pivot vanishes if it goes on as at the end of the last step; infinity if it does not shrink.
double StepControl::predicted_distance(Evaluator& evaluator, const State& state) {
  const double pivot = evaluator.pivot();
  const auto [t, before] = evaluator.a_little_before();
  last_pivot_ = pivot;
  const bool shrinking = t > begin_ && state.t > t && pivot < before && pivot < 0.9 * evaluator.best_pivot();
  if (!shrinking) return INFINITY;
  const double distance = pivot * (state.t - t) / (before - pivot);
  return distance < 3 * next_ ? refined_distance(evaluator, state, distance) : distance;
}

// The same with pivots looked up ahead, on the parabola that the motion starts along. `state` is evaluated afterwards.
double StepControl::refined_distance(Evaluator& evaluator, const State& state, double distance) {
  double t = 0, pivot = evaluator.pivot();
  const VectorXd vdot = evaluator.result().vdot;  // probing overwrites it
  for (const double fraction : {0.6, 0.85}) {
    const double ahead = fraction * distance;
    if (ahead <= t) break;
    probe_ = state;
    probe_.t = state.t + ahead;
    displacement_ = ahead * state.v + 0.5 * ahead * ahead * vdot;
    displace(evaluator.system(), displacement_, probe_.q);
    if (evaluator.evaluate(probe_) != ForwardStatus::kSolved) break;
    const double there = evaluator.pivot();
    if (!(there < pivot)) break;
    distance = t + (ahead - t) * pivot / (pivot - there);
    t = ahead;
    pivot = there;
  }
  evaluator.evaluate(state);
  return distance;
}

// Across a singular pose rounding costs about kRounding / ρ², ρ the smallest pivot met over the best one, and less with
// longer steps, which keep away from the pose; truncation costs more. The best compromise, at least `h`.
double StepControl::crossing_length(const Evaluator& evaluator, const Stepper& stepper, double h, double allowed,
                                    double distance) const {
  constexpr double kHalfGap = 0.13;
  const double nearest = kHalfGap * h * last_pivot_ / (distance * evaluator.best_pivot());
  const double ratio = kRounding / (nearest * nearest * allowed);
  return ratio > 1 ? h * std::pow(ratio, 1.0 / (stepper.error_order() + 2)) : h;
}

// Lays the step so that the crossing is in the middle of a gap between stages, with the longest such step; before that,
// a shorter one so that this will be possible.
double StepControl::fit_to_crossing(const Evaluator& evaluator, const Stepper& stepper, double h, double allowed,
                                    double distance) {
  const std::vector<double>& gaps = stepper.gaps();
  const double best = gaps.front();
  if (distance > (1 + 2 * best) * h) return h;
  const double across = crossing_length(evaluator, stepper, h, allowed, distance);
  if (distance > h + best * across) return h;
  if (distance > 1.1 * best * across) return std::clamp(distance - best * across, 0.1 * h, h);
  crossing_ = true;
  for (const double fraction : gaps) {
    if (distance / fraction <= 1.1 * across) return distance / fraction;
  }
  return distance / gaps.back();
}

// A run that creeps towards a point which it cannot pass would go on for ever.
bool StepControl::is_hopeless(double t) {
  constexpr int kSteps = 1000;
  constexpr double kProgress = 1e-10;  // of the run, in so many steps
  if (pace_steps_++ % kSteps != 0) return false;
  const bool creeps = pace_steps_ > 1 && t - pace_t_ < kProgress * longest_;
  pace_t_ = t;
  return creeps;
}

void StepControl::restart(double t) {
  next_ = trusted_ = 0;
  last_pivot_ = -1;
  begin_ = pace_t_ = t;
  pace_steps_ = 0;
  crossing_ = near_crossing_ = false;
}

bool StepControl::step(Evaluator& evaluator, Stepper& stepper, const State& state, double t_limit, RunSummary& summary,
                       State& next) {
  const double fastest = fastest_rate(evaluator, state);
  const double shortest = 1e-12 * std::min(longest_, 1 / fastest);
  const double power = 1.0 / (stepper.error_order() - 1);
  if (next_ <= 0) next_ = std::min(longest_, 0.01 / fastest);
  const double distance = predicted_distance(evaluator, state);
  near_crossing_ = distance < 3 * next_;
  evaluator.note_residual();
  if (is_hopeless(state.t)) return false;
  const double proposed_first = next_, followed = evaluator.longest_followed_turn();
  double refused_h = 0, refused_error = 0;
  while (true) {
    crossing_ = false;
    double h = fit_to_crossing(evaluator, stepper, next_, allowed_error(evaluator, next_, fastest), distance);
    const double left = t_limit - state.t;
    if (!crossing_) h = std::min(h, followed);
    if (!crossing_) h = h >= left ? left : (2 * h > left ? 0.5 * left : h);
    if ((h < shortest && h < left) || !(state.t + h > state.t)) return false;  // no way on
    evaluator.reset_watch();
    evaluator.settle_stages(crossing_);
    const Stepper::Outcome outcome = stepper.step(evaluator, state, h, next);
    work_ = outcome.work;
    if (outcome.finite && h > 1.5 * evaluator.longest_followed_turn()) {  // it went on faster than it began
      ++summary.rejected_steps;
      next_ = 0.5 * h;
      if (evaluator.evaluate(state) != ForwardStatus::kSolved) return false;
      continue;
    }
    const double allowed = allowed_error(evaluator, h, fastest);
    const double change = outcome.error > 0 ? 0.9 * std::pow(allowed / outcome.error, power) : 4.0;
    if (outcome.finite && outcome.error <= allowed) {
      // Estimates are small by accident now and then: what they promise is believed by half, unless it is very much.
      const bool by_half = change > 1 && change < 3 && allowed > 10 * looser_ * rounding(evaluator);
      const double growth = by_half ? std::sqrt(change) : std::clamp(change, 0.2, 4.0);
      const double proposed = h * growth;
      if (h >= 0.999 * next_ || change < 1) next_ = std::min(proposed, longest_);
      if (crossing_) evaluator.restore_energy(state, work_, next);
      trusted_ = h < 0.999 * next_ ? std::max(h, trusted_) : h;  // a step cut short tells nothing against longer ones
      return true;
    }
    // A step no longer than the last good one, whose error is not more than rounding.
    const bool not_longer = crossing_ || h <= 1.5 * trusted_;
    if (outcome.finite && not_longer && outcome.error <= rounding_error(evaluator, h, fastest)) {
      lost_ = std::max(lost_, outcome.error);
      if (crossing_) evaluator.restore_energy(state, work_, next);
      return true;
    }
    // Shorter steps do not err less: that is rounding, and this step is as good as any.
    const bool no_better = h < 0.75 * refused_h && outcome.error > 0.5 * refused_error;
    if (outcome.finite && no_better && outcome.error <= kLargestLoss) {
      lost_ = std::max(lost_, outcome.error);
      next_ = proposed_first;
      return true;
    }
    refused_h = h;
    refused_error = outcome.error;
    ++summary.rejected_steps;
    next_ = h * (outcome.finite ? std::clamp(change, 0.1, 0.7) : 0.25);
    if (next_ < shortest || evaluator.evaluate(state) != ForwardStatus::kSolved) return false;
  }
}

void Hermite::evaluate(const System& system, double t, State& state, VectorXd& vdot) const {
  const double h = to.t - from.t, s = (t - from.t) / h;
  // p(s) with p, p', p'' given at 0 and 1, and its first two derivatives.
  const auto blend = [&](double p0, double v0, double a0, double p1, double v1, double a1, double* out) {
    const double c0 = p0, c1 = v0 * h, c2 = 0.5 * a0 * h * h;
    const double d = p1 - c0 - c1 - c2, e = v1 * h - c1 - 2 * c2, f = a1 * h * h - 2 * c2;
    const double c3 = 10 * d - 4 * e + 0.5 * f, c4 = -15 * d + 7 * e - f, c5 = 6 * d - 3 * e + 0.5 * f;
    out[0] = c0 + s * (c1 + s * (c2 + s * (c3 + s * (c4 + s * c5))));
    out[1] = (c1 + s * (2 * c2 + s * (3 * c3 + s * (4 * c4 + s * 5 * c5)))) / h;
    out[2] = (2 * c2 + s * (6 * c3 + s * (12 * c4 + s * 20 * c5))) / (h * h);
  };
  state.t = t;
  state.winding = from.winding;
  VectorXd rate_0(system.nq), rate_1(system.nq);
  compute_position_rates(system, from.q, from.v, rate_0);
  compute_position_rates(system, to.q, to.v, rate_1);
  double out[3];
  for (const Node& node : system.nodes) {
    if (node.nv == 0) continue;
    const bool scalar = node.type->quaternion_at < 0;
    for (int k = 0; k < node.nv; ++k) {
      const int v = node.v + k;
      if (scalar) {
        const int q = node.q + k;
        blend(from.q[q], from.v[v], from_vdot[v], to.q[q], to.v[v], to_vdot[v], out);
        state.q[q] = out[0];
        state.v[v] = out[1];
        vdot[v] = out[2];
        continue;
      }
      // Velocities and accelerations of a rotation: a cubic through v and vdot.
      const double c2 = 3 * (to.v[v] - from.v[v]) - h * (2 * from_vdot[v] + to_vdot[v]);
      const double c3 = -2 * (to.v[v] - from.v[v]) + h * (from_vdot[v] + to_vdot[v]);
      state.v[v] = from.v[v] + s * (h * from_vdot[v] + s * (c2 + s * c3));
      vdot[v] = from_vdot[v] + s * (2 * c2 + 3 * s * c3) / h;
    }
    for (int q = node.q; !scalar && q < node.q + node.nq; ++q) {
      // Positions: a cubic through q and its rates, then normalized below.
      const double c2 = 3 * (to.q[q] - from.q[q]) - h * (2 * rate_0[q] + rate_1[q]);
      const double c3 = -2 * (to.q[q] - from.q[q]) + h * (rate_0[q] + rate_1[q]);
      state.q[q] = from.q[q] + s * (h * rate_0[q] + s * (c2 + s * c3));
    }
  }
  normalize_quaternions(system, state.q);
}

}  // namespace ferrers
