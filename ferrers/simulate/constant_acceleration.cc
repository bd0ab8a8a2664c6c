#include <Eigen/LU>
#include <cmath>

#include "ferrers/simulate/stepper.h"

namespace ferrers {
namespace {

class ConstantAcceleration final : public Stepper {
 public:
  explicit ConstantAcceleration(const System& system)
      : pos_(make_position_kinematics(system)),
        vel_(make_velocity_kinematics(system)),
        constraints_(make_constraint_kinematics(system)) {}

  Outcome step(Evaluator& evaluator, const State& state, double h, State& next) override {
    const System& system = evaluator.system();
    const Selection& s = evaluator.selection();
    const VectorXd& vdot = evaluator.result().vdot;
    // Independent coordinates: q' = q + v h + vdot h²/2; the dependent ones start from the same and are then corrected.
    next.q = state.q;
    next.winding = state.winding;
    next.t = state.t + h;
    step_ = h * state.v + 0.5 * h * h * vdot;
    displace(system, step_, next.q);
    if (!solve_dependent_positions(evaluator, next)) return {false, 0};
    // v_d = −G_d⁻¹ G_i v_i.
    next.v = state.v + h * vdot;
    for (const int d : s.dependent) next.v[d] = 0;
    gather(system, s, next);
    next.v(s.dependent) = -lu_.solve(rows(constraints_.G, s) * next.v);
    return {next.v.allFinite(), 0};
  }

 private:
  static MatrixXd rows(const RowMatrixXd& G, const Selection& s) { return G(s.rows, Eigen::all); }

  void gather(const System& system, const Selection& s, const State& state) {
    compute_positions(system, state.q, pos_);
    compute_constraints(system, state, pos_, vel_, constraints_);
    lu_.compute(MatrixXd(constraints_.G(s.rows, s.dependent)));
  }

  bool solve_dependent_positions(const Evaluator& evaluator, State& next) {
    const System& system = evaluator.system();
    const Selection& s = evaluator.selection();
    if (s.rows.empty()) return true;
    double before = INFINITY;
    for (int i = 0; i < 25; ++i) {
      gather(system, s, next);
      const VectorXd phi = constraints_.phi(s.rows);
      const double size = phi.cwiseProduct(evaluator.scaling().rows(s.rows)).cwiseAbs().maxCoeff();
      if (!std::isfinite(size)) return false;
      if (size <= closed_tolerance(evaluator.scaling()) && size > 0.1 * before) return true;
      if (size == 0) return true;
      before = size;
      step_.setZero();
      step_(s.dependent) = -lu_.solve(phi);
      displace(system, step_, next.q);
    }
    return before <= closed_tolerance(evaluator.scaling());
  }

  PositionKinematics pos_;
  VelocityKinematics vel_;
  ConstraintKinematics constraints_;
  VectorXd step_;
  Eigen::PartialPivLU<MatrixXd> lu_;
};

}  // namespace

std::unique_ptr<Stepper> make_constant_acceleration(const Evaluator& evaluator) {
  return std::make_unique<ConstantAcceleration>(evaluator.system());
}

}  // namespace ferrers
