#include "ferrers/redundancy/reduced_closure.h"

#include <Eigen/QR>
#include <algorithm>

#include "ferrers/kinematics/assembly.h"
#include "ferrers/math/damped_step.h"

namespace ferrers {
namespace {

// Orthonormal complement of orthonormal columns.
MatrixXd complement(const MatrixXd& B) {
  if (B.cols() == 0) return MatrixXd::Identity(B.rows(), B.rows());
  const Eigen::HouseholderQR<MatrixXd> qr(B);
  const MatrixXd Q = qr.householderQ();
  return Q.rightCols(B.rows() - B.cols());
}

}  // namespace

ReducedClosure::ReducedClosure(const ClusterSystem& cluster, const LocalMotion& local)
    : cluster_(cluster),
      N_(local.N),
      Z_(local.Z),
      Y_(complement(local.N)),
      U_(complement(local.Z)),
      pos_(make_position_kinematics(cluster.system)),
      rest_(make_velocity_kinematics(cluster.system)),
      constraints_(make_constraint_kinematics(cluster.system)) {}

void ReducedClosure::evaluate(const State& state) {
  compute_positions(cluster_.system, state.q, pos_);
  compute_constraints(cluster_.system, state, pos_, rest_, constraints_);
  phi_ = constraints_.phi.cwiseProduct(cluster_.system.scaling.rows);
}

void ReducedClosure::factorize() {
  UG_ = (U_.transpose() * cluster_.system.scaling.rows.asDiagonal()) * constraints_.G;
  UG_ *= cluster_.system.scaling.columns.asDiagonal();
  lu_.compute(UG_ * Y_);
}

void ReducedClosure::move(const VectorXd& x, State& state) const {
  displace(cluster_.system, x.cwiseProduct(cluster_.system.scaling.columns), state.q);
}

// Newton along Y; the matrix is kept while it serves. `state` is evaluated afterwards.
bool ReducedClosure::restore(State& state) {
  constexpr int kIterations = 30;
  const double length = cluster_.system.scaling.length_m;
  evaluate(state);
  if (Y_.cols() == 0) return true;
  double last = INFINITY;
  bool is_fresh = false;
  for (int i = 0; i < kIterations; ++i) {
    const VectorXd residual = U_.transpose() * phi_;
    const double size = residual.norm();
    if (!std::isfinite(size) || size > length) return false;
    if (size <= 2e-16 * length) break;
    if (is_fresh && size > 0.5 * last) {  // as far as it goes
      if (size > closed_tolerance(cluster_.system.scaling)) return false;
      break;
    }
    is_fresh = i == 0 || size > 0.1 * last;
    if (is_fresh) factorize();
    last = size;
    const VectorXd step = -lu_.solve(residual);
    if (!(step.cwiseAbs().maxCoeff() < 0.5 * length)) return false;
    move(Y_ * step, state);
    evaluate(state);
  }
  accept_winding(cluster_.system, pos_, state);
  return (U_.transpose() * phi_).norm() <= closed_tolerance(cluster_.system.scaling);
}

// What remains, to first order, as N z goes with the share along Y that keeps Uᵀ phi.
void ReducedClosure::linearize() {
  along_ = N_;
  if (Y_.cols() > 0) {
    factorize();
    along_ -= Y_ * lu_.solve(UG_ * N_);
  }
  const MatrixXd ZG = (Z_.transpose() * cluster_.system.scaling.rows.asDiagonal()) * constraints_.G;
  J_ = ZG * cluster_.system.scaling.columns.asDiagonal() * along_;
  g_ = Z_.transpose() * phi_;
}

VectorXd ReducedClosure::correction(double damping) const {
  VectorXd z = compute_damped_step(J_, g_, std::max(damping * J_.norm(), 1e-14));
  const double limit = 0.1 * cluster_.system.scaling.length_m;
  const double size = z.cwiseAbs().maxCoeff();
  if (size > limit) z *= limit / size;
  return along_ * z;
}

bool ReducedClosure::improve(const VectorXd& step, double wanted, State& state) {
  State trial = state;
  move(step, trial);
  if (!restore(trial) || !(remainder() < wanted)) return false;
  state = trial;
  return true;
}

bool ReducedClosure::close(State& state) {
  constexpr int kIterations = 60;
  constexpr double kClosed = 1e-13;
  const double length = cluster_.system.scaling.length_m;
  if (!restore(state)) return false;
  double size = remainder(), ratio = 0, damping = 1e-6;
  for (int i = 0; i < kIterations && size > 3e-16 * length; ++i) {
    linearize();
    // Quarters of what remains tell a double zero, half a step short each time. The step is doubled once, while
    // rounding does not yet spoil it.
    if (size < 1e-9 * length && ratio > 0.2 && ratio < 0.3 && improve(2 * correction(damping), 0.1 * size, state)) {
      size = remainder();
      ratio = 0;
      if (size <= kClosed * length) break;
      linearize();
    }
    bool better = false;
    for (int k = 0; k < 6 && !better; ++k) {
      better = improve(correction(damping), 0.9 * size, state);
      damping = better ? std::max(0.01 * damping, 1e-12) : std::max(30 * damping, 1e-3);
    }
    evaluate(state);
    if (!better) break;
    ratio = remainder() / size;
    size = remainder();
  }
  evaluate(state);
  // Near a double zero a closed loop is far from closed: what remains must be down at rounding.
  const bool is_closed = phi_.cwiseAbs().maxCoeff() <= closed_tolerance(cluster_.system.scaling);
  return is_closed && remainder() <= kClosed * length && !is_any_flipped();
}

double ReducedClosure::remainder() const {
  return Z_.cols() > 0 && N_.cols() > 0 ? (Z_.transpose() * phi_).norm() : 0.0;
}

bool ReducedClosure::is_any_flipped() const {
  return std::any_of(cluster_.system.cuts.begin(), cluster_.system.cuts.end(), [&](const CutJoint& cut) {
    return is_flipped(*cut.type, compute_relative_motion(cut.frames, pos_, rest_));
  });
}

}  // namespace ferrers
