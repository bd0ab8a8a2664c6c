#include <Eigen/Cholesky>

#include "ferrers/dynamics/forward.h"
#include "ferrers/math/rank_pivot.h"

namespace ferrers {
namespace {

// The paper's elimination: dependent rows are left out, then with M = L Lᵀ, X = L⁻¹ G_rᵀ and y = L⁻¹ force
//   Xᵀ X lambda = gamma − Xᵀ y,   Lᵀ vdot = y + X lambda.
class EliminationSolver final : public ForwardSolver {
 public:
  EliminationSolver(const System& system, const Selection& selection)
      : s_(selection),
        r_(static_cast<int>(selection.rows.size())),
        X_(system.nv, r_),
        A_(r_, r_),
        y_(system.nv),
        lambda_(r_),
        mass_(system.nv),
        llt_(r_) {}

  void solve(const Equations& eq, ForwardResult& out) override {
    out.status = ForwardStatus::kSolved;
    mass_.compute(eq.M);
    if (mass_.info() != Eigen::Success || has_lost_pivot(eq.M)) {
      out.status = ForwardStatus::kSingularMass;
      return;
    }
    for (int i = 0; i < r_; ++i) X_.col(i) = eq.constraints.G.row(s_.rows[i]).transpose();
    if (r_ > 0) {
      mass_.matrixL().solveInPlace(X_);
      A_.noalias() = X_.transpose() * X_;
      llt_.compute(A_);
      if (llt_.info() != Eigen::Success) {
        out.status = ForwardStatus::kWornSelection;
        return;
      }
    }
    resolve(eq.force, eq.constraints.gamma, out);
    if (!out.vdot.allFinite()) out.status = ForwardStatus::kWornSelection;
  }

  void resolve(const VectorXd& force, const VectorXd& gamma, ForwardResult& out) override {
    out.status = ForwardStatus::kSolved;
    y_ = force;
    mass_.matrixL().solveInPlace(y_);
    if (r_ > 0) {
      for (int i = 0; i < r_; ++i) lambda_[i] = gamma[s_.rows[i]];
      lambda_.noalias() -= X_.transpose() * y_;
      llt_.solveInPlace(lambda_);
      y_.noalias() += X_ * lambda_;
      for (int i = 0; i < r_; ++i) out.lambda[s_.rows[i]] = lambda_[i];
    }
    mass_.matrixU().solveInPlace(y_);
    out.vdot = y_;
  }

  double smallest_pivot() const override { return r_ > 0 ? llt_.matrixLLT().diagonal().cwiseAbs().minCoeff() : 1.0; }

 private:
  bool has_lost_pivot(const PatternMatrix& M) const {
    for (long k = 0; k < M.rows(); ++k) {
      const double root = mass_.matrixLLT()(k, k);
      if (is_lost_pivot(root * root, M(k, k))) return true;
    }
    return false;
  }

  Selection s_;
  int r_;
  MatrixXd X_, A_;
  VectorXd y_, lambda_;
  Eigen::LLT<MatrixXd> mass_, llt_;
};

}  // namespace

std::unique_ptr<ForwardSolver> make_elimination_solver(const System& system, const Selection& selection) {
  return std::make_unique<EliminationSolver>(system, selection);
}

}  // namespace ferrers
