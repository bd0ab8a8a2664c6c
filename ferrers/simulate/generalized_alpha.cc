#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "ferrers/simulate/stepper.h"

// The generalized-α method for constrained systems of index 3 on the coordinates' Lie group [arnold2007, bruls2010].
//
//   M vdot' + h = tau + B u + G_rᵀ lambda',   phi_r(q') = 0                                  (at t + h)
//   q' = q ⊕ (h v + h² (½ − β) a + h² β a'),   v' = v + h (1 − γ) a + h γ a'
//   (1 − α_m) a' + α_m a = (1 − α_f) vdot' + α_f vdot
//
// with α_m = (2ρ − 1)/(ρ + 1), α_f = ρ/(ρ + 1), γ = ½ + α_f − α_m, β = ¼ (γ + ½)²; ρ damps what is too fast for the
// step. Order 2; with doubling, two half steps beside a whole one give an error estimate and, by local extrapolation,
// order 3. Newton's matrix [M + γ' h C + β' h² K, −G_rᵀ; G_r, 0] has K and C by differences, kept while they serve.
// Positions and velocities are put on the constraints afterwards. Cost per step: some evaluations, factors of O((n +
// r)³), and 2 n evaluations when K and C are renewed.
namespace ferrers {
namespace {

constexpr double kRho = 0.6;  // extrapolation keeps damping what is fast: (4 ρ² + ρ)/3 < 1
constexpr double kAlphaM = (2 * kRho - 1) / (kRho + 1), kAlphaF = kRho / (kRho + 1);
constexpr double kGamma = 0.5 + kAlphaF - kAlphaM, kBeta = 0.25 * (kGamma + 0.5) * (kGamma + 0.5);
constexpr double kPerVdot = (1 - kAlphaF) / (1 - kAlphaM);
constexpr double kSettled = 1e-13;  // of Newton's corrections, in rad and characteristic lengths
constexpr double kEnough = 1e-9;    // where rounding does not allow that
constexpr int kMostIterations = 15, kSlow = 6;

// A state of the method: with what it calls accelerations (a lags behind vdot, in proportion to the step).
struct Point {
  State state;
  VectorXd vdot, a, lambda;
};

class GeneralizedAlpha final : public Stepper {
 public:
  GeneralizedAlpha(const Evaluator& evaluator, bool doubling)
      : doubling_(doubling), scale_(evaluator.system(), evaluator.scaling()) {
    const int nv = evaluator.system().nv;
    K_ = C_ = MatrixXd::Zero(nv, nv);
    start_.state = make_drawn_state(evaluator.system());
    start_.vdot = start_.a = VectorXd::Zero(nv);
    start_.lambda = VectorXd::Zero(evaluator.row_scale().size());
    whole_ = half_ = end_ = start_;
  }

  Outcome step(Evaluator& evaluator, const State& state, double h, State& next) override {
    const Outcome failed = {.finite = false, .error = 0, .work = {}};
    const Work before = evaluator.power(state);
    scale_.see(state.v, evaluator.result().vdot);
    begin(evaluator, state, h);
    double error = 0;
    Work middle = before;
    if (doubling_) {
      const VectorXd lag = start_.a - start_.vdot;
      if (!advance(evaluator, start_, h, whole_)) return failed;
      start_.a = start_.vdot + 0.5 * lag;
      if (!advance(evaluator, start_, 0.5 * h, half_)) return failed;
      middle = evaluator.power(half_.state);
      if (!advance(evaluator, half_, 0.5 * h, end_)) return failed;
      error = extrapolate();
    } else if (!advance(evaluator, start_, h, end_)) {
      return failed;
    }
    const State raw = end_.state;
    next = end_.state;
    next.t = state.t + h;
    next.winding = state.winding;
    if (!std::isfinite(evaluator.settle(next))) return failed;
    if (doubling_) error = std::max(error, scale_.size(next.q - raw.q, next.v - raw.v) / 3);
    a_step_ = doubling_ ? 0.5 * h : h;
    last_ = next;
    known_ = true;
    const Work after = evaluator.power(next);
    const auto simpson = [&](double a, double b, double c) {
      return doubling_ ? h * (a + 4 * b + c) / 6 : 0.5 * h * (a + c);
    };
    return {.finite = std::isfinite(error),
            .error = error,
            .work = {simpson(before.drives, middle.drives, after.drives),
                     simpson(before.others, middle.others, after.others)}};
  }

  int error_order() const override { return doubling_ ? 3 : 0; }
  const std::vector<double>& gaps() const override {
    static const std::vector<double> between_halves = {0.25, 0.75};
    return between_halves;
  }

 private:
  // Where the step before ended, or a fresh start.
  void begin(const Evaluator& evaluator, const State& state, double h) {
    const bool goes_on = known_ && state.t == last_.t && state.q == last_.q && state.v == last_.v &&
                         end_.lambda.size() == evaluator.row_scale().size();
    if (goes_on) {
      start_.vdot = end_.vdot;
      start_.a = end_.vdot + (h / a_step_) * (end_.a - end_.vdot);
      start_.lambda = end_.lambda;
    } else {
      start_.vdot = start_.a = evaluator.result().vdot;
      start_.lambda = evaluator.result().lambda;
      has_tangents_ = false;
    }
    start_.state = state;
  }

  // Third order from two halves and a whole; the difference tells the error of the halves.
  double extrapolate() {
    const double error = scale_.size(end_.state.q - whole_.state.q, end_.state.v - whole_.state.v) / 3;
    end_.state.q += (end_.state.q - whole_.state.q) / 3;
    end_.state.v += (end_.state.v - whole_.state.v) / 3;
    return error;
  }

  bool advance(Evaluator& evaluator, const Point& from, double h, Point& to) {
    if (!has_tangents_) find_tangents(evaluator, from);
    bool fresh = tangents_are_new_;
    while (true) {
      const int iterations = iterate(evaluator, from, h, to);
      if (iterations > 0) {
        if (iterations > kSlow) has_tangents_ = false;
        tangents_are_new_ = false;
        return true;
      }
      if (fresh) return false;
      find_tangents(evaluator, from);
      fresh = true;
    }
  }

  // Newton's method; returns the number of iterations, 0 where it did not converge.
  int iterate(Evaluator& evaluator, const Point& from, double h, Point& to) {
    const System& system = evaluator.system();
    const std::vector<int>& rows = evaluator.selection().rows;
    const int nv = system.nv, r = static_cast<int>(rows.size());
    to.vdot = from.vdot;
    to.lambda = from.lambda;
    to.state.winding = from.state.winding;
    to.state.t = from.state.t + h;
    const double to_v = h * kGamma * kPerVdot, to_q = h * h * kBeta * kPerVdot;
    double before = INFINITY;
    for (int i = 1; i <= kMostIterations; ++i) {
      to.a = kPerVdot * to.vdot + (kAlphaF * from.vdot - kAlphaM * from.a) / (1 - kAlphaM);
      to.state.q = from.state.q;
      step_ = h * from.state.v + h * h * ((0.5 - kBeta) * from.a + kBeta * to.a);
      displace(system, step_, to.state.q);
      to.state.v = from.state.v + h * ((1 - kGamma) * from.a + kGamma * to.a);
      if (!to.state.q.allFinite()) return 0;
      if (evaluator.evaluate(to.state) == ForwardStatus::kSingularMass) return 0;
      const Equations& eq = evaluator.equations();
      rhs_.resize(nv + r);
      rhs_.head(nv) = eq.force - eq.M * to.vdot;
      for (int k = 0; k < r; ++k) {
        rhs_.head(nv) += to.lambda[rows[k]] * eq.constraints.G.row(rows[k]).transpose();
        rhs_[nv + k] = -eq.constraints.phi[rows[k]] / to_q;
      }
      if (i == 1) factor(eq, rows, to_v, to_q);
      change_ = lu_.solve(rhs_);
      if (!change_.allFinite()) return 0;
      to.vdot += change_.head(nv);
      for (int k = 0; k < r; ++k) to.lambda[rows[k]] += change_[nv + k];
      step_ = to_q * change_.head(nv);
      const double size = std::max(scaled(evaluator, step_), scale_.size(VectorXd(), to_v * change_.head(nv)));
      if (size <= kSettled || (size > 0.5 * before && size <= kEnough)) {
        to.state.v += to_v * change_.head(nv);
        displace(system, step_, to.state.q);
        to.a += kPerVdot * change_.head(nv);
        return i;
      }
      if (i > 2 && size > 2 * before) return 0;
      before = size;
    }
    return 0;
  }

  void factor(const Equations& eq, const std::vector<int>& rows, double to_v, double to_q) {
    const long nv = eq.M.rows(), r = static_cast<long>(rows.size());
    matrix_ = MatrixXd::Zero(nv + r, nv + r);
    matrix_.topLeftCorner(nv, nv) = to_v * C_ + to_q * K_;
    matrix_.topLeftCorner(nv, nv) += eq.M;
    for (long k = 0; k < r; ++k) {
      matrix_.row(nv + k).head(nv) = eq.constraints.G.row(rows[static_cast<std::size_t>(k)]);
      matrix_.col(nv + k).head(nv) = -eq.constraints.G.row(rows[static_cast<std::size_t>(k)]).transpose();
    }
    lu_.compute(matrix_);
  }

  // K = ∂w/∂q, C = ∂w/∂v of w = M vdot − force − Gᵀ lambda, vdot and lambda held.
  void find_tangents(Evaluator& evaluator, const Point& at) {
    constexpr double kDifference = 1e-7;
    const System& system = evaluator.system();
    State probe = at.state;
    const VectorXd here = imbalance(evaluator, probe, at);
    for (int k = 0; k < system.nv; ++k) {
      const double unit = kDifference * evaluator.scaling().columns[k] * evaluator.scaling().length_m;
      probe = at.state;
      step_ = VectorXd::Zero(system.nv);
      step_[k] = unit;
      displace(system, step_, probe.q);
      K_.col(k) = (imbalance(evaluator, probe, at) - here) / unit;
      probe = at.state;
      const double rate = unit * std::max(1.0, scale_.fastest());
      probe.v[k] += rate;
      C_.col(k) = (imbalance(evaluator, probe, at) - here) / rate;
    }
    has_tangents_ = tangents_are_new_ = true;
  }

  static VectorXd imbalance(Evaluator& evaluator, const State& state, const Point& at) {
    evaluator.evaluate(state);
    const Equations& eq = evaluator.equations();
    return eq.M * at.vdot - eq.force - eq.constraints.G.transpose() * at.lambda;
  }

  static double scaled(const Evaluator& evaluator, const VectorXd& dv) {
    return dv.cwiseQuotient(evaluator.scaling().columns).lpNorm<Eigen::Infinity>() / evaluator.scaling().length_m;
  }

  bool doubling_;
  ErrorScale scale_;
  Point start_, whole_, half_, end_;
  State last_;
  bool known_ = false, has_tangents_ = false, tangents_are_new_ = false;
  double a_step_ = 1;
  MatrixXd K_, C_, matrix_;
  VectorXd rhs_, change_, step_;
  Eigen::PartialPivLU<MatrixXd> lu_;
};

}  // namespace

std::unique_ptr<Stepper> make_generalized_alpha(const Evaluator& evaluator, bool doubling) {
  return std::make_unique<GeneralizedAlpha>(evaluator, doubling);
}

}  // namespace ferrers
