#include "ferrers/kinematics/projection.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ferrers {

Projector::Projector(const System& system, const Scaling& scaling, std::vector<int> rows)
    : system_(system),
      rows_(std::move(rows)),
      length_m_(scaling.length_m),
      row_scale_(static_cast<long>(rows_.size())),
      X_(system.nv, static_cast<long>(rows_.size())),
      rhs_(static_cast<long>(rows_.size())),
      correction_(system.nv),
      work_(1),
      qr_(system.nv, static_cast<long>(rows_.size())) {
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

void Projector::correct(const Eigen::LLT<MatrixXd>& metric, const RowMatrixXd& G, const VectorXd& residual) {
  const long r = static_cast<long>(rows_.size());
  for (long i = 0; i < r; ++i) {
    X_.col(i) = G.row(rows_[static_cast<std::size_t>(i)]).transpose();
    rhs_[i] = -residual[rows_[static_cast<std::size_t>(i)]];
  }
  metric.matrixL().solveInPlace(X_);
  qr_.compute(X_);
  qr_.matrixQR().topLeftCorner(r, r).triangularView<Eigen::Upper>().transpose().solveInPlace(rhs_);
  correction_.setZero();
  correction_.head(r) = rhs_;
  qr_.householderQ().applyThisOnTheLeft(correction_, work_);
  metric.matrixU().solveInPlace(correction_);
}

Projector::Rounding Projector::rounding(const PositionKinematics& pos, const VelocityKinematics& vel) const {
  constexpr double kUnits = 2 * std::numeric_limits<double>::epsilon();
  double place = 0, speed = 0, turn = 0;
  for (std::size_t i = 1; i < pos.nodes.size(); ++i) {
    place = std::max(place, pos.nodes[i].p.squaredNorm());
    speed = std::max(speed, vel.nodes[i].v.squaredNorm());
    turn = std::max(turn, vel.nodes[i].w.squaredNorm());
  }
  return {kUnits * std::max(length_m_, std::sqrt(place)), kUnits * (std::sqrt(speed) + length_m_ * std::sqrt(turn))};
}

double Projector::project(const Eigen::LLT<MatrixXd>& metric, State& state, PositionKinematics& pos,
                          VelocityKinematics& vel, ConstraintKinematics& constraints) {
  normalize_quaternions(system_, state.q);
  if (rows_.empty()) return 0;
  double before = INFINITY, now = 0;
  Rounding enough{};
  for (int i = 0; i < 8; ++i) {
    compute_positions(system_, state.q, pos);
    compute_velocities(system_, pos, state.q, state.v, vel);
    compute_constraints(system_, state, pos, vel, constraints);
    now = size(constraints.phi);
    if (!std::isfinite(now)) return INFINITY;
    enough = rounding(pos, vel);
    if (now <= enough.position || (i > 1 && now > 0.5 * before)) break;
    before = now;
    correct(metric, constraints.G, constraints.phi);
    displace(system_, correction_, state.q);
  }
  if (size(constraints.rate) <= enough.velocity) return now;
  correct(metric, constraints.G, constraints.rate);
  state.v += correction_;
  return now;
}

}  // namespace ferrers
