#include <Eigen/LU>
#include <cmath>

#include "ferrers/simulate/stepper.h"

namespace ferrers {
namespace {

class ConstantAcceleration final : public Stepper {
 public:
  explicit ConstantAcceleration(const Evaluator& evaluator)
      : pos_(make_position_kinematics(evaluator.system())),
        vel_(make_velocity_kinematics(evaluator.system())),
        constraints_(
            make_constraint_kinematics(evaluator.system(), columns_of_drives(evaluator.model(), evaluator.driven()))),
        drive_work_(make_drive_evaluation(evaluator.model())) {}

  Outcome step(Evaluator& evaluator, const State& state, double h, State& next) override {
    const Outcome failed = {.finite = false, .error = 0, .work = {}};
    const System& system = evaluator.system();
    const Selection& s = evaluator.selection();
    const VectorXd& vdot = evaluator.result().vdot;
    const Work before = evaluator.power(state);
    // Independent coordinates: q' = q + v h + vdot h²/2; the dependent ones start from the same and are then corrected.
    next.q = state.q;
    next.winding = state.winding;
    next.t = state.t + h;
    step_ = h * state.v + 0.5 * h * h * vdot;
    displace(system, step_, next.q);
    if (!solve_dependent_positions(evaluator, next)) return failed;
    // v_d = G_d⁻¹ (nu − G_i v_i).
    next.v = state.v + h * vdot;
    for (const int d : s.dependent) next.v[d] = 0;
    gather(evaluator, next);
    step_ = VectorXd(constraints_.nu - constraints_.G * next.v)(s.rows);
    const VectorXd dependent = lu_.solve(step_);
    next.v(s.dependent) = dependent;
    if (!next.v.allFinite() || evaluator.evaluate(next) != ForwardStatus::kSolved) return failed;
    const Work after = evaluator.power(next);
    return {.finite = true,
            .error = 0,
            .work = {0.5 * h * (before.drives + after.drives), 0.5 * h * (before.others + after.others)}};
  }

 private:
  void gather(const Evaluator& evaluator, const State& state) {
    const Selection& s = evaluator.selection();
    compute_positions(evaluator.system(), state.q, pos_);
    compute_constraints(evaluator.system(), state, pos_, vel_, constraints_);
    compute_driven_rows(evaluator.model(), state, evaluator.driven(), pos_, vel_, drive_work_, constraints_);
    lu_.compute(MatrixXd(constraints_.G(s.rows, s.dependent)));
  }

  bool solve_dependent_positions(const Evaluator& evaluator, State& next) {
    const Selection& s = evaluator.selection();
    if (s.rows.empty()) return true;
    const double enough = closed_tolerance(evaluator.scaling());
    double before = INFINITY;
    for (int i = 0; i < 25; ++i) {
      gather(evaluator, next);
      const VectorXd phi = constraints_.phi(s.rows);
      const double size = phi.cwiseProduct(evaluator.row_scale()(s.rows)).cwiseAbs().maxCoeff();
      if (!std::isfinite(size)) return false;
      if (size == 0 || (size <= enough && size > 0.1 * before)) return true;
      before = size;
      const VectorXd change = -lu_.solve(phi);
      step_.setZero(evaluator.system().nv);
      step_(s.dependent) = change;
      displace(evaluator.system(), step_, next.q);
    }
    return before <= enough;
  }

  PositionKinematics pos_;
  VelocityKinematics vel_;
  ConstraintKinematics constraints_;
  FormulaEvaluation drive_work_;
  VectorXd step_;
  Eigen::PartialPivLU<MatrixXd> lu_;
};

}  // namespace

std::unique_ptr<Stepper> make_constant_acceleration(const Evaluator& evaluator) {
  return std::make_unique<ConstantAcceleration>(evaluator);
}

}  // namespace ferrers
