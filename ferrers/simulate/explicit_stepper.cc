#include <algorithm>
#include <cmath>

#include "ferrers/simulate/stepper.h"

namespace ferrers {
namespace {

const ExplicitRule& classical_rule() {
  static const ExplicitRule rule = {
      .name = "runge-kutta-4",
      .order = 4,
      .c = {0, 0.5, 0.5, 1},
      .a = {{{0, 0.5}}, {{1, 0.5}}, {{2, 1.0}}},
      .b = {{0, 1.0 / 6}, {1, 1.0 / 3}, {2, 1.0 / 3}, {3, 1.0 / 6}},
      .error = {},
      .error_3 = {},
      .dense_c = {},
      .dense_a = {},
      .dense = {},
      .gaps = {0.25, 0.75},
  };
  return rule;
}

// y' = f(t, y) on y = (q, v, work of drives, work of other forces), with q' = E(q) v; quaternions are integrated as
// four numbers and normalized at the end.
class Stages {
 public:
  Stages(const System& system, const ExplicitRule& rule)
      : rule_(rule),
        nq_(system.nq),
        nv_(system.nv),
        K_(nq_ + nv_ + 2, rule.all_stages()),
        stage_(make_drawn_state(system)) {
    sum_ = VectorXd::Zero(K_.rows());
    q_rate_ = VectorXd::Zero(nq_);
    K_.setZero();
  }

  /// Takes the rates at `state`, the last evaluation, as stage i.
  void take(const Evaluator& evaluator, const State& state, int i) {
    compute_position_rates(evaluator.system(), state.q, state.v, q_rate_);
    K_.col(i).head(nq_) = q_rate_;
    K_.col(i).segment(nq_, nv_) = evaluator.result().vdot;
    const Work power = evaluator.power(state);
    K_(nq_ + nv_, i) = power.drives;
    K_(nq_ + nv_ + 1, i) = power.others;
  }

  /// All stages from `state`, whose rates are stage 0 already, and the result, not yet projected.
  bool advance(Evaluator& evaluator, const State& state, double h, State& next) {
    h_ = h;
    for (int i = 1; i < rule_.stages(); ++i) {
      if (!evaluate(evaluator, state, rule_.c[i], rule_.a[i - 1], i)) return false;
    }
    add(rule_.b);
    place(state, 1, next);
    work_ = {h * sum_[nq_ + nv_], h * sum_[nq_ + nv_ + 1]};
    return next.q.allFinite() && next.v.allFinite();
  }

  /// The further stages of the dense output.
  bool extend(Evaluator& evaluator, const State& state) {
    for (std::size_t i = 0; i < rule_.dense_a.size(); ++i) {
      const int at = rule_.stages() + 1 + static_cast<int>(i);
      if (!evaluate(evaluator, state, rule_.dense_c[i], rule_.dense_a[i], at)) return false;
    }
    return true;
  }

  /// h Σ w_i k_i in q and v.
  void combine(const Weights& weights, VectorXd& q, VectorXd& v) {
    add(weights);
    q = h_ * sum_.head(nq_);
    v = h_ * sum_.segment(nq_, nv_);
  }

  const Work& work() const { return work_; }
  double h() const { return h_; }
  auto rates(int i) const { return K_.col(i).head(nq_ + nv_); }

 private:
  void add(const Weights& weights) {
    sum_.setZero();
    double* const sum = sum_.data();
    for (const Weight& w : weights) {
      const double* const k = K_.data() + w.stage * K_.rows();
      for (long i = 0; i < K_.rows(); ++i) sum[i] += w.value * k[i];
    }
  }

  void place(const State& state, double c, State& out) const {
    out.t = state.t + c * h_;
    out.q = state.q + h_ * sum_.head(nq_);
    out.v = state.v + h_ * sum_.segment(nq_, nv_);
    out.winding = state.winding;
  }

  bool evaluate(Evaluator& evaluator, const State& state, double c, const Weights& a, int i) {
    add(a);
    place(state, c, stage_);
    if (!stage_.q.allFinite() || !evaluator.evaluate_stage(stage_)) return false;
    take(evaluator, stage_, i);
    return true;
  }

  const ExplicitRule& rule_;
  int nq_, nv_;
  MatrixXd K_;
  State stage_;
  VectorXd sum_, q_rate_;
  Work work_;
  double h_ = 0;
};

class ExplicitStepper final : public Stepper {
 public:
  ExplicitStepper(const Evaluator& evaluator, const ExplicitRule& rule)
      : rule_(rule), stages_(evaluator.system(), rule), scale_(evaluator.system(), evaluator.scaling()) {
    raw_q_ = q_ = VectorXd::Zero(evaluator.system().nq);
    raw_v_ = v_ = VectorXd::Zero(evaluator.system().nv);
    terms_.resize(q_.size() + v_.size(), 3 + static_cast<long>(rule.dense.size()));
  }

  Outcome step(Evaluator& evaluator, const State& state, double h, State& next) override {
    dense_known_ = false;
    scale_.see(state.v, evaluator.result().vdot);
    stages_.take(evaluator, state, 0);
    if (!stages_.advance(evaluator, state, h, next)) return {.finite = false, .error = 0, .work = {}};
    raw_q_ = next.q;
    raw_v_ = next.v;
    if (!std::isfinite(evaluator.settle(next))) return {.finite = false, .error = 0, .work = {}};
    stages_.take(evaluator, next, rule_.stages());
    const double error = evaluator.settles_stages() ? estimate_across(evaluator, next) : estimate(next);
    return {.finite = std::isfinite(error), .error = error, .work = stages_.work()};
  }

  bool interpolate(Evaluator& evaluator, const State& from, const State& to, double t, State& state,
                   VectorXd& vdot) override {
    if (rule_.dense.empty()) return false;
    if (!dense_known_ && !stages_.extend(evaluator, from)) return false;
    if (!dense_known_) prepare(from, to);
    dense_known_ = true;
    evaluate_terms(evaluator.system(), from, t, state, vdot);
    return true;
  }

  int error_order() const override { return rule_.error.empty() ? 0 : rule_.order; }
  const std::vector<double>& gaps() const override { return rule_.gaps; }

 private:
  // What the projection has to correct is error too: a large correction would be a jump to another motion.
  double estimate(const State& next) {
    if (rule_.error.empty()) return 0;
    raw_q_ -= next.q;
    raw_v_ -= next.v;
    const double corrected = scale_.size(raw_q_, raw_v_);
    stages_.combine(rule_.error, q_, v_);
    double error = scale_.size(q_, v_);
    if (!rule_.error_3.empty() && error > 0) {
      stages_.combine(rule_.error_3, q_, v_);
      error *= error / std::hypot(error, 0.1 * scale_.size(q_, v_));
    }
    return std::max(error, corrected);
  }

  // Across a singular pose: rounding amplified off the constraints was taken back by the projection; what counts is
  // what is left along the admissible motions. The projection's size still tells a jump to another branch.
  double estimate_across(Evaluator& evaluator, const State& next) {
    constexpr double kJump = 1e-4;
    raw_q_ -= next.q;
    raw_v_ -= next.v;
    if (scale_.size(raw_q_, raw_v_) > kJump) return scale_.size(raw_q_, raw_v_);
    double errors[2] = {0, 0};
    const Weights* weights[2] = {&rule_.error, &rule_.error_3};
    for (int i = 0; i < 2; ++i) {
      stages_.combine(*weights[i], q_, v_);
      to_velocities(evaluator.system(), next.q);
      evaluator.keep_admissible(dv_);
      evaluator.keep_admissible(v_);
      errors[i] = scale_.size_of_velocities(dv_, v_);
    }
    return rule_.error_3.empty() || errors[0] == 0 ? errors[0]
                                                   : errors[0] * errors[0] / std::hypot(errors[0], 0.1 * errors[1]);
  }

  // dv_ with E(q) dv_ = q_, nearest; the columns of E are orthogonal.
  void to_velocities(const System& system, const VectorXd& q) {
    dv_.resize(system.nv);
    VectorXd one = VectorXd::Zero(system.nv), rate = VectorXd::Zero(system.nq);
    for (int k = 0; k < system.nv; ++k) {
      one[k] = 1;
      compute_position_rates(system, q, one, rate);
      dv_[k] = rate.dot(q_) / rate.squaredNorm();
      one[k] = 0;
    }
  }

  // The interpolant's terms: y(θ) = y_0 + θ (F_0 + (1−θ)(F_1 + θ (F_2 + (1−θ)(F_3 + …)))).
  void prepare(const State& from, const State& to) {
    const double h = stages_.h();
    VectorXd delta(q_.size() + v_.size());
    delta << to.q - from.q, to.v - from.v;
    terms_.col(0) = delta;
    terms_.col(1) = h * stages_.rates(0) - delta;
    terms_.col(2) = 2 * delta - h * (stages_.rates(0) + stages_.rates(rule_.stages()));
    for (std::size_t i = 0; i < rule_.dense.size(); ++i) {
      stages_.combine(rule_.dense[i], q_, v_);
      terms_.col(3 + static_cast<long>(i)) << q_, v_;
    }
    value_ = rate_ = VectorXd::Zero(delta.size());
  }

  void evaluate_terms(const System& system, const State& from, double t, State& state, VectorXd& vdot) {
    const double theta = (t - from.t) / stages_.h();
    value_.setZero();
    rate_.setZero();  // d/dθ
    for (long i = terms_.cols() - 1; i >= 0; --i) {
      value_ += terms_.col(i);
      const double factor = i % 2 == 0 ? theta : 1 - theta, slope = i % 2 == 0 ? 1 : -1;
      rate_ = factor * rate_ + slope * value_;
      value_ *= factor;
    }
    state.t = t;
    state.winding = from.winding;
    state.q = from.q + value_.head(q_.size());
    state.v = from.v + value_.tail(v_.size());
    vdot = rate_.tail(v_.size()) / stages_.h();
    normalize_quaternions(system, state.q);
  }

  const ExplicitRule& rule_;
  Stages stages_;
  ErrorScale scale_;
  VectorXd raw_q_, raw_v_, q_, v_, dv_;
  MatrixXd terms_;
  VectorXd value_, rate_;
  bool dense_known_ = false;
};

class DoublingStepper final : public Stepper {
 public:
  explicit DoublingStepper(const Evaluator& evaluator)
      : first_(evaluator.system(), classical_rule()),
        second_(first_),
        long_(first_),
        scale_(evaluator.system(), evaluator.scaling()),
        whole_(make_drawn_state(evaluator.system())),
        half_(whole_) {}

  Outcome step(Evaluator& evaluator, const State& state, double h, State& next) override {
    const Outcome failed = {.finite = false, .error = 0, .work = {}};
    scale_.see(state.v, evaluator.result().vdot);
    long_.take(evaluator, state, 0);
    first_.take(evaluator, state, 0);
    if (!long_.advance(evaluator, state, h, whole_)) return failed;
    if (!first_.advance(evaluator, state, 0.5 * h, half_)) return failed;
    if (!evaluator.evaluate_stage(half_)) return failed;
    second_.take(evaluator, half_, 0);
    if (!second_.advance(evaluator, half_, 0.5 * h, next)) return failed;
    double error = difference(next) / 15;  // whole_ is not projected: across a singular pose this is pessimistic
    next.q += (next.q - whole_.q) / 15;
    next.v += (next.v - whole_.v) / 15;
    next.t = state.t + h;
    // What the projection has to correct is error too: a large correction would be a jump to another motion.
    whole_.q = next.q;
    whole_.v = next.v;
    if (!std::isfinite(evaluator.settle(next))) return failed;
    error = std::max(error, difference(next) / 15);
    const auto extrapolated = [](double halves, double whole) { return halves + (halves - whole) / 15; };
    const Work &a = first_.work(), &b = second_.work(), &c = long_.work();
    return {.finite = std::isfinite(error),
            .error = error,
            .work = {extrapolated(a.drives + b.drives, c.drives), extrapolated(a.others + b.others, c.others)}};
  }

  int error_order() const override { return 5; }
  const std::vector<double>& gaps() const override {
    static const std::vector<double> between_quarters = {0.125, 0.375, 0.625, 0.875};
    return between_quarters;
  }

 private:
  double difference(const State& next) { return scale_.size(next.q - whole_.q, next.v - whole_.v); }

  Stages first_, second_, long_;
  ErrorScale scale_;
  State whole_, half_;
};

}  // namespace

std::unique_ptr<Stepper> make_explicit_stepper(const Evaluator& evaluator, const ExplicitRule& rule) {
  return std::make_unique<ExplicitStepper>(evaluator, rule);
}

std::unique_ptr<Stepper> make_runge_kutta_4(const Evaluator& evaluator, bool doubling) {
  if (doubling) return std::make_unique<DoublingStepper>(evaluator);
  return std::make_unique<ExplicitStepper>(evaluator, classical_rule());
}

}  // namespace ferrers
