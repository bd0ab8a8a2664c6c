#include <algorithm>
#include <cmath>

#include "ferrers/simulate/stepper.h"

namespace ferrers {
namespace {

// y' = f(y) on y = (q, v), with q' = E(q) v; quaternions are integrated as four numbers and normalized at the end.
class RungeKutta {
 public:
  explicit RungeKutta(const System& system) : stage_(make_drawn_state(system)) {
    for (VectorXd* q : {&q_rate_, &q_sum_}) *q = VectorXd::Zero(system.nq);
    for (VectorXd* v : {&vdot_, &v_sum_}) *v = VectorXd::Zero(system.nv);
  }

  // One step without projection; `vdot` are the accelerations at `state`.
  bool advance(Evaluator& evaluator, const State& state, const VectorXd& vdot, double h, State& next) {
    static constexpr double kFraction[] = {0, 0.5, 0.5, 1}, kWeight[] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
    stage_.winding = state.winding;
    vdot_ = vdot;
    q_sum_.setZero();
    v_sum_.setZero();
    for (int i = 0; i < 4; ++i) {
      if (i == 0) {
        compute_position_rates(evaluator.system(), state.q, state.v, q_rate_);
      } else {
        stage_.t = state.t + kFraction[i] * h;
        stage_.q = state.q + kFraction[i] * h * q_rate_;
        stage_.v = state.v + kFraction[i] * h * vdot_;
        if (evaluator.evaluate(stage_) != ForwardStatus::kSolved) return false;
        vdot_ = evaluator.result().vdot;
        compute_position_rates(evaluator.system(), stage_.q, stage_.v, q_rate_);
      }
      q_sum_ += kWeight[i] * q_rate_;
      v_sum_ += kWeight[i] * vdot_;
    }
    next.t = state.t + h;
    next.q = state.q + h * q_sum_;
    next.v = state.v + h * v_sum_;
    next.winding = state.winding;
    return next.q.allFinite() && next.v.allFinite();
  }

 private:
  State stage_;
  VectorXd q_rate_, q_sum_, vdot_, v_sum_;
};

class RungeKutta4 final : public Stepper {
 public:
  explicit RungeKutta4(const System& system) : rule_(system) {}

  Outcome step(Evaluator& evaluator, const State& state, double h, State& next) override {
    vdot_ = evaluator.result().vdot;
    if (!rule_.advance(evaluator, state, vdot_, h, next)) return {false, 0};
    return {std::isfinite(evaluator.project(next)), 0};
  }

 private:
  RungeKutta rule_;
  VectorXd vdot_;
};

class RungeKuttaDoubling final : public Stepper {
 public:
  explicit RungeKuttaDoubling(const System& system)
      : rule_(system), whole_(make_drawn_state(system)), half_(make_drawn_state(system)) {}

  Outcome step(Evaluator& evaluator, const State& state, double h, State& next) override {
    vdot_ = evaluator.result().vdot;
    if (!rule_.advance(evaluator, state, vdot_, h, whole_)) return {false, 0};
    if (!rule_.advance(evaluator, state, vdot_, 0.5 * h, half_)) return {false, 0};
    if (evaluator.evaluate(half_) != ForwardStatus::kSolved) return {false, 0};
    half_vdot_ = evaluator.result().vdot;
    if (!rule_.advance(evaluator, half_, half_vdot_, 0.5 * h, next)) return {false, 0};
    double error = difference(evaluator, next, whole_) / 15;
    next.q += (next.q - whole_.q) / 15;
    next.v += (next.v - whole_.v) / 15;
    next.t = state.t + h;
    // What the projection has to correct is error too: a large correction would be a jump to another motion.
    whole_.q = next.q;
    whole_.v = next.v;
    if (!std::isfinite(evaluator.project(next))) return {false, 0};
    error = std::max(error, difference(evaluator, next, whole_) / 15);
    return {std::isfinite(error), error};
  }

 private:
  // Position error in rad or characteristic lengths; velocity error over the fastest rate seen.
  double difference(const Evaluator& evaluator, const State& next, const State& other) {
    const System& system = evaluator.system();
    const Scaling& scaling = evaluator.scaling();
    double error = 0, v_error = 0, rate = 0, curvature = 0;
    for (const Node& node : system.nodes) {
      for (int k = 0; k < node.nq; ++k) {
        const bool length = node.nq == node.nv && scaling.columns[node.v + k] == 1 && scaling.length_m != 1;
        const double size = length ? scaling.length_m : 1;
        error = std::max(error, std::abs(next.q[node.q + k] - other.q[node.q + k]) / size);
      }
      for (int k = node.v; k < node.v + node.nv; ++k) {
        const double unit = scaling.columns[k] * scaling.length_m;
        v_error = std::max(v_error, std::abs(next.v[k] - other.v[k]) / unit);
        rate = std::max(rate, std::abs(next.v[k]) / unit);
        curvature = std::max(curvature, std::abs(vdot_[k]) / unit);
      }
    }
    fastest_ = std::max({fastest_, rate, std::sqrt(curvature)});
    return std::max(error, fastest_ > 0 ? v_error / fastest_ : 0.0);
  }

  RungeKutta rule_;
  State whole_, half_;
  VectorXd vdot_, half_vdot_;
  double fastest_ = 0;
};

}  // namespace

std::unique_ptr<Stepper> make_runge_kutta_4(const Evaluator& evaluator) {
  return std::make_unique<RungeKutta4>(evaluator.system());
}

std::unique_ptr<Stepper> make_runge_kutta_doubling(const Evaluator& evaluator) {
  return std::make_unique<RungeKuttaDoubling>(evaluator.system());
}

}  // namespace ferrers
