#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "ferrers/dynamics/forward.h"
#include "ferrers/math/rank_pivot.h"

namespace ferrers {
namespace {

// With columns split into dependent (d) and independent (i) coordinates, G_d regular:
//   vdot_d = G_d⁻¹ (gamma − G_i z),   N = [−G_d⁻¹ G_i; 1],   p = [G_d⁻¹ gamma; 0],   vdot = N z + p,
//   Nᵀ M N z = Nᵀ (force − M p),   G_dᵀ lambda = (M vdot − force)_d.
class NullSpaceSolver final : public ForwardSolver {
 public:
  NullSpaceSolver(const System& system, const Selection& selection)
      : s_(selection),
        r_(static_cast<int>(selection.rows.size())),
        w_(static_cast<int>(selection.independent.size())),
        G_d_(r_, r_),
        X_(r_, w_ + 1),
        N_(system.nv, w_),
        M_N_(system.nv, w_),
        reduced_(w_, w_),
        p_(VectorXd::Zero(system.nv)),
        residual_(system.nv),
        z_(w_),
        lambda_(r_),
        lu_(r_),
        llt_(w_),
        place_(static_cast<std::size_t>(system.nv)) {
    for (int k = 0; k < r_; ++k) place_[s_.dependent[k]] = k;
    for (int k = 0; k < w_; ++k) place_[s_.independent[k]] = r_ + k;
    N_.setZero();
    for (int k = 0; k < w_; ++k) N_(s_.independent[k], k) = 1;
  }

  void solve(const Equations& eq, ForwardResult& out) override {
    M_ = &eq.M;
    if (r_ > 0) solve_dependent(eq.constraints);
    for (int i = 0; i < r_; ++i) {
      for (int k = 0; k < w_; ++k) N_(s_.dependent[i], k) = -X_(i, k);
      p_[s_.dependent[i]] = X_(i, w_);
    }
    out.status = ForwardStatus::kSolved;
    residual_ = eq.force;
    residual_.noalias() -= eq.M * p_;
    out.vdot = p_;
    if (w_ > 0) {
      M_N_.noalias() = eq.M * N_;
      reduced_.noalias() = N_.transpose() * M_N_;
      z_.noalias() = N_.transpose() * residual_;
      llt_.compute(reduced_);
      if (llt_.info() != Eigen::Success || has_lost_pivot()) {
        out.status = ForwardStatus::kSingularMass;
        return;
      }
      llt_.solveInPlace(z_);
      out.vdot.noalias() += N_ * z_;
      residual_.noalias() -= M_N_ * z_;
    }
    // residual_ = force − M vdot, which the constraint forces balance.
    if (r_ > 0) solve_multipliers(out.lambda);
    if (!out.vdot.allFinite()) out.status = ForwardStatus::kWornSelection;
  }

  void resolve(const VectorXd& force, const VectorXd& gamma, ForwardResult& out) override {
    if (r_ > 0) {
      const auto& place = lu_.permutationP().indices();
      for (int i = 0; i < r_; ++i) lambda_[place[i]] = gamma[s_.rows[i]];
      lu_.matrixLU().triangularView<Eigen::UnitLower>().solveInPlace(lambda_);
      lu_.matrixLU().triangularView<Eigen::Upper>().solveInPlace(lambda_);
    }
    for (int i = 0; i < r_; ++i) p_[s_.dependent[i]] = lambda_[i];
    out.status = ForwardStatus::kSolved;
    out.vdot = p_;
    residual_ = force;
    residual_.noalias() -= *M_ * p_;
    if (w_ > 0) {
      z_.noalias() = N_.transpose() * residual_;
      llt_.solveInPlace(z_);
      out.vdot.noalias() += N_ * z_;
      residual_.noalias() -= M_N_ * z_;
    }
    if (r_ > 0) solve_multipliers(out.lambda);
  }

  double smallest_pivot() const override { return r_ > 0 ? lu_.matrixLU().diagonal().cwiseAbs().minCoeff() : 1.0; }

 private:
  // X = G_d⁻¹ [G_i, gamma], with P G_d = L U; rows are permuted as they are gathered.
  void solve_dependent(const ConstraintKinematics& c) {
    G_d_.setZero();
    for_each_entry(c.G, [&](int i, int k, double value) {
      if (k < r_) G_d_(i, k) = value;
    });
    lu_.compute(G_d_);
    const auto& place = lu_.permutationP().indices();
    X_.setZero();
    for_each_entry(c.G, [&](int i, int k, double value) {
      if (k >= r_) X_(place[i], k - r_) = value;
    });
    for (int i = 0; i < r_; ++i) X_(place[i], w_) = c.gamma[s_.rows[i]];
    lu_.matrixLU().triangularView<Eigen::UnitLower>().solveInPlace(X_);
    lu_.matrixLU().triangularView<Eigen::Upper>().solveInPlace(X_);
  }

  // Of the chosen rows: `visit(row, coordinate, value)` with the coordinates' places, the dependent ones first.
  template <class Visit>
  void for_each_entry(const PatternMatrix& G, Visit visit) const {
    for (int i = 0; i < r_; ++i) {
      for (PatternMatrix::InnerIterator it(G, s_.rows[i]); it; ++it) visit(i, place_[it.col()], it.value());
    }
  }

  // Whether some motion has no mass: what is left is rounding of its own mass, or of that with what follows it.
  bool has_lost_pivot() const {
    for (int k = 0; k < w_; ++k) {
      const double root = llt_.matrixLLT()(k, k), own = (*M_)(s_.independent[k], s_.independent[k]);
      if (is_lost_pivot(root * root, own + reduced_(k, k))) return true;
    }
    return false;
  }

  // G_dᵀ lambda = −residual_d, with G_dᵀ = Uᵀ Lᵀ P.
  void solve_multipliers(VectorXd& lambda) {
    for (int i = 0; i < r_; ++i) lambda_[i] = -residual_[s_.dependent[i]];
    lu_.matrixLU().triangularView<Eigen::Upper>().transpose().solveInPlace(lambda_);
    lu_.matrixLU().triangularView<Eigen::UnitLower>().transpose().solveInPlace(lambda_);
    const auto& place = lu_.permutationP().indices();
    for (int i = 0; i < r_; ++i) lambda[s_.rows[i]] = lambda_[place[i]];
  }

  Selection s_;
  const PatternMatrix* M_ = nullptr;  // of the equations solved last
  int r_, w_;
  MatrixXd G_d_, X_;
  MatrixXd N_, M_N_, reduced_;
  VectorXd p_, residual_, z_, lambda_;
  Eigen::PartialPivLU<MatrixXd> lu_;
  Eigen::LLT<MatrixXd> llt_;
  std::vector<int> place_;  // of each coordinate in the selection, the dependent ones first
};

}  // namespace

std::unique_ptr<ForwardSolver> make_null_space_solver(const System& system, const Selection& selection) {
  return std::make_unique<NullSpaceSolver>(system, selection);
}

}  // namespace ferrers
