#include "ferrers/dynamics/paper_steps.h"

#include <Eigen/LU>
#include <cmath>

#include "ferrers/core/checks.h"

namespace ferrers {
namespace {

void require_selection(const Selection& s, long n, long m) {
  require_size(static_cast<long>(s.dependent.size()), static_cast<long>(s.rows.size()),
               "paper step: dependent coordinates, as many as rows");
  require_size(static_cast<long>(s.dependent.size() + s.independent.size()), n, "paper step: coordinates chosen");
  require(s.rows.empty() || s.rows.back() < m, "paper step: the selection has a row that the system does not have");
}

/// The constraints at one state, and the factors of G_d.
struct Instant {
  PositionKinematics pos;
  VelocityKinematics vel;
  ConstraintKinematics constraints;
  Eigen::PartialPivLU<MatrixXd> lu;

  explicit Instant(const System& system)
      : pos(make_position_kinematics(system)),
        vel(make_velocity_kinematics(system)),
        constraints(make_constraint_kinematics(system)) {}

  void go_to(const System& system, const Selection& s, const State& state) {
    compute_positions(system, state.q, pos);
    compute_velocities(system, pos, state.q, state.v, vel);
    compute_constraints(system, state, pos, vel, constraints);
    if (!s.rows.empty()) lu.compute(MatrixXd(constraints.G(s.rows, s.dependent)));
  }
};

}  // namespace

PositionSolution solve_dependent_positions(const DynamicsModel& model, const Selection& s, State& state,
                                           int max_iterations) {
  const System& system = *model.system;
  require_selection(s, system.nv, system.m);
  const Scaling& scaling = system.scaling;
  const double enough = closed_tolerance(scaling);
  PositionSolution out;
  Instant at(system);
  for (int i = 0; i <= max_iterations; ++i) {
    at.go_to(system, s, state);
    const VectorXd phi = at.constraints.phi(s.rows);
    const double size = s.rows.empty() ? 0 : phi.cwiseProduct(scaling.rows(s.rows)).cwiseAbs().maxCoeff();
    const bool stalls = !out.residuals.empty() && size > 0.1 * out.residuals.back();
    out.residuals.push_back(size);
    out.closed = size <= enough;
    if (!std::isfinite(size) || size == 0 || (out.closed && stalls) || i == max_iterations) break;
    VectorXd step = VectorXd::Zero(system.nv);
    const VectorXd dependent = at.lu.solve(-phi);
    step(s.dependent) = dependent;
    displace(system, step, state.q);
  }
  accept_winding(system, at.pos, state);
  return out;
}

void solve_dependent_velocities(const DynamicsModel& model, const Selection& s, State& state) {
  const System& system = *model.system;
  require_selection(s, system.nv, system.m);
  if (s.rows.empty()) return;
  Instant at(system);
  at.go_to(system, s, state);
  const ConstraintKinematics& c = at.constraints;
  const VectorXd wanted = c.nu(s.rows) - c.G(s.rows, s.independent) * state.v(s.independent);
  const VectorXd dependent = at.lu.solve(wanted);
  state.v(s.dependent) = dependent;
}

VectorXd solve_dependent_accelerations(const Equations& eq, const Selection& s, const VectorXd& independent) {
  const ConstraintKinematics& c = eq.constraints;
  require_selection(s, c.G.cols(), c.G.rows());
  require_size(independent.size(), static_cast<long>(s.independent.size()), "solve_dependent_accelerations");
  VectorXd vdot = VectorXd::Zero(c.G.cols());
  vdot(s.independent) = independent;
  if (s.rows.empty()) return vdot;
  const VectorXd wanted = c.gamma(s.rows) - c.G(s.rows, s.independent) * independent;
  const VectorXd dependent = MatrixXd(c.G(s.rows, s.dependent)).partialPivLu().solve(wanted);
  vdot(s.dependent) = dependent;
  return vdot;
}

MotionForces solve_multipliers_and_efforts(const Equations& eq, const Selection& s, const VectorXd& vdot) {
  const long n = eq.M.rows(), r = static_cast<long>(s.rows.size()), nu = eq.B_transposed.rows();
  require_selection(s, n, eq.constraints.G.rows());
  require_size(vdot.size(), n, "solve_multipliers_and_efforts: vdot");
  require_size(nu, n - r, "solve_multipliers_and_efforts: drives, as many as motions");
  MatrixXd unknowns(n, n);
  unknowns.leftCols(r) = eq.constraints.G.dense_rows(s.rows).transpose();
  unknowns.rightCols(nu) = eq.B_transposed.transpose();
  const VectorXd found = unknowns.partialPivLu().solve(eq.M * vdot + eq.h - eq.tau);
  MotionForces out{VectorXd::Zero(eq.constraints.G.rows()), found.tail(nu)};
  out.lambda(s.rows) = found.head(r);
  return out;
}

State hold_accelerations(const System& system, const Selection& s, const State& state, const VectorXd& vdot,
                         double dt_s) {
  require_selection(s, system.nv, system.m);
  require_size(vdot.size(), system.nv, "hold_accelerations: vdot");
  State next = state;
  next.t = state.t + dt_s;
  VectorXd step = VectorXd::Zero(system.nv);
  for (const int i : s.independent) {
    step[i] = state.v[i] * dt_s + 0.5 * vdot[i] * dt_s * dt_s;
    next.v[i] = state.v[i] + vdot[i] * dt_s;
  }
  displace(system, step, next.q);
  return next;
}

}  // namespace ferrers
