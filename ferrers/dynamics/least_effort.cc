#include "ferrers/dynamics/least_effort.h"

#include <algorithm>

#include "ferrers/math/rank.h"

namespace ferrers {

LeastEffort::LeastEffort(Rows rows, std::vector<int> chosen) : rows_(std::move(rows)), chosen_(std::move(chosen)) {
  const auto r = rows_.G.rows(), k = rows_.E.rows();
  for (int i = 0; i < static_cast<int>(k); ++i) {
    if (std::find(chosen_.begin(), chosen_.end(), i) == chosen_.end()) others_.push_back(i);
  }
  idle_lambda_ = MatrixXd::Zero(r, 0);
  idle_efforts_ = MatrixXd::Zero(k, 0);
  if (r + static_cast<long>(chosen_.size()) == rows_.columns.size()) {
    find_idle();
  } else {
    find_idle_at_singular_pose();
  }
}

void LeastEffort::find_idle() {
  const auto n = rows_.columns.size(), r = rows_.G.rows();
  MatrixXd A(n, n);
  A << rows_.G, rows_.E(chosen_, Eigen::all);
  lu_.compute(A);
  if (others_.empty()) return;
  // One unit of another drive is balanced by −A⁻ᵀ of its row.
  const MatrixXd balance = lu_.transpose().solve(rows_.E(others_, Eigen::all).transpose());
  MatrixXd efforts = MatrixXd::Zero(rows_.E.rows(), balance.cols());
  for (std::size_t i = 0; i < chosen_.size(); ++i) efforts.row(chosen_[i]) = -balance.row(r + static_cast<long>(i));
  for (std::size_t i = 0; i < others_.size(); ++i) efforts(others_[i], static_cast<long>(i)) = 1;
  const Eigen::HouseholderQR<MatrixXd> qr(rows_.E_scale.cwiseInverse().asDiagonal() * efforts);
  const auto R = qr.matrixQR().topRows(efforts.cols()).triangularView<Eigen::Upper>();
  idle_efforts_ = R.solve<Eigen::OnTheRight>(efforts);
  idle_lambda_ = R.solve<Eigen::OnTheRight>(MatrixXd(-balance.topRows(r)));
  weighted_.compute(rows_.weights.asDiagonal() * idle_efforts_);
}

void LeastEffort::find_idle_at_singular_pose() {
  const auto n = rows_.columns.size(), r = rows_.G.rows(), k = rows_.E.rows();
  scaled_transposed_.resize(n, r + k);
  scaled_transposed_ << rows_.columns.asDiagonal() * rows_.G.transpose() * rows_.G_scale.asDiagonal(),
      rows_.columns.asDiagonal() * rows_.E.transpose() * rows_.E_scale.asDiagonal();
  const MatrixXd idle = analyze_rank(scaled_transposed_, 1.0).right_null;
  idle_lambda_ = rows_.G_scale.asDiagonal() * idle.topRows(r);
  idle_efforts_ = rows_.E_scale.asDiagonal() * idle.bottomRows(k);
}

bool LeastEffort::solve(const VectorXd& b, VectorXd& lambda, VectorXd& u) const {
  const auto r = rows_.G.rows(), k = rows_.E.rows();
  if (scaled_transposed_.size() == 0) {
    const VectorXd x = lu_.transpose().solve(b);
    lambda = x.head(r);
    u = VectorXd::Zero(k);
    for (std::size_t i = 0; i < chosen_.size(); ++i) u[chosen_[i]] = x[r + static_cast<long>(i)];
    if (idle_efforts_.cols() == 0) return true;
    const VectorXd share = weighted_.solve(-rows_.weights.cwiseProduct(u));
    lambda += idle_lambda_ * share;
    u += idle_efforts_ * share;
    return true;
  }
  const VectorXd scaled = rows_.columns.cwiseProduct(b);
  const LeastNormResult least = solve_least_norm(scaled_transposed_, scaled);
  if (!is_negligible(least.residual, std::max(scaled.norm(), 1e-300))) return false;
  lambda = rows_.G_scale.cwiseProduct(least.x.head(r));
  u = rows_.E_scale.cwiseProduct(least.x.tail(k));
  if (idle_efforts_.cols() == 0) return true;
  const VectorXd share = solve_least_norm(rows_.weights.asDiagonal() * idle_efforts_, -rows_.weights.cwiseProduct(u)).x;
  lambda += idle_lambda_ * share;
  u += idle_efforts_ * share;
  return true;
}

std::vector<bool> LeastEffort::shared() const {
  std::vector<bool> shared(static_cast<std::size_t>(rows_.E.rows()), false);
  for (std::size_t i = 0; i < shared.size() && idle_efforts_.cols() > 0; ++i) {
    const auto row = static_cast<long>(i);
    shared[i] = !is_negligible(idle_efforts_.row(row).norm() / rows_.E_scale[row], 1.0);
  }
  return shared;
}

}  // namespace ferrers
