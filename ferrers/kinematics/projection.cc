#include "ferrers/kinematics/projection.h"

#include <cmath>

namespace ferrers {

Projector::Projector(const System& system, const Scaling& scaling, std::vector<int> rows)
    : system_(system),
      rows_(std::move(rows)),
      length_m_(scaling.length_m),
      row_scale_(static_cast<long>(rows_.size())),
      G_transposed_(system.nv, static_cast<long>(rows_.size())),
      X_(system.nv, static_cast<long>(rows_.size())),
      A_(static_cast<long>(rows_.size()), static_cast<long>(rows_.size())),
      rhs_(static_cast<long>(rows_.size())),
      correction_(system.nv),
      llt_(static_cast<long>(rows_.size())) {
  for (std::size_t i = 0; i < rows_.size(); ++i) row_scale_[static_cast<long>(i)] = scaling.rows[rows_[i]];
}

double Projector::size(const VectorXd& residual) const {
  double largest = 0;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const double value = std::abs(residual[rows_[i]] * row_scale_[static_cast<long>(i)]);
    if (!(value <= largest)) largest = value;  // keeps a NaN
  }
  return largest;
}

// correction = −W⁻¹ Gᵀ (G W⁻¹ Gᵀ)⁻¹ residual, with X = L⁻¹ Gᵀ.
void Projector::correct(const Eigen::LLT<MatrixXd>& metric, const RowMatrixXd& G, const VectorXd& residual) {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    X_.col(static_cast<long>(i)) = G.row(rows_[i]).transpose();
    rhs_[static_cast<long>(i)] = -residual[rows_[i]];
  }
  metric.matrixL().solveInPlace(X_);
  A_.noalias() = X_.transpose() * X_;
  llt_.compute(A_);
  llt_.solveInPlace(rhs_);
  correction_.noalias() = X_ * rhs_;
  metric.matrixU().solveInPlace(correction_);
}

double Projector::project(const Eigen::LLT<MatrixXd>& metric, State& state, PositionKinematics& pos,
                          VelocityKinematics& vel, ConstraintKinematics& constraints) {
  normalize_quaternions(system_, state.q);
  const double enough = 1e-15 * length_m_;
  double before = INFINITY, now = 0;
  for (int i = 0; i < 8; ++i) {
    compute_positions(system_, state.q, pos);
    compute_velocities(system_, pos, state.q, state.v, vel);
    compute_constraints(system_, state, pos, vel, constraints);
    now = size(constraints.phi);
    if (!std::isfinite(now)) return INFINITY;
    if (now <= enough || (i > 0 && now < 1e-12 * length_m_) || (now < 1e-13 * length_m_ && now > 0.5 * before)) break;
    before = now;
    correct(metric, constraints.G, constraints.phi);
    displace(system_, correction_, state.q);
  }
  if (rows_.empty()) return 0;
  correct(metric, constraints.G, constraints.rate);
  state.v += correction_;
  return now;
}

}  // namespace ferrers
