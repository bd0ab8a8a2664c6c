#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "ferrers/dynamics/forward.h"

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
        G_i_(r_, w_),
        gamma_(r_),
        N_(system.nv, w_),
        M_N_(system.nv, w_),
        reduced_(w_, w_),
        p_(VectorXd::Zero(system.nv)),
        residual_(system.nv),
        z_(w_),
        dependent_(r_),
        solved_(r_),
        lu_(r_),
        llt_(w_) {
    N_.setZero();
    for (int k = 0; k < w_; ++k) N_(s_.independent[k], k) = 1;
  }

  void solve(const Equations& eq, ForwardResult& out) override {
    gather(eq.constraints);
    if (r_ > 0) {
      lu_.compute(G_d_);
      G_i_ = lu_.solve(G_i_);
      solved_ = lu_.solve(gamma_);
    }
    for (int i = 0; i < r_; ++i) {
      N_.row(s_.dependent[i]) = -G_i_.row(i);
      p_[s_.dependent[i]] = solved_[i];
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
      if (llt_.info() != Eigen::Success) {
        out.status = ForwardStatus::kSingularMass;
        return;
      }
      llt_.solveInPlace(z_);
      out.vdot.noalias() += N_ * z_;
      residual_.noalias() -= M_N_ * z_;
    }
    // residual_ = force − M vdot, which the constraint forces balance.
    for (int i = 0; i < r_; ++i) dependent_[i] = -residual_[s_.dependent[i]];
    if (r_ > 0) solved_ = lu_.transpose().solve(dependent_);
    for (int i = 0; i < r_; ++i) out.lambda[s_.rows[i]] = solved_[i];
    if (!out.vdot.allFinite()) out.status = ForwardStatus::kWornSelection;
  }

  double smallest_pivot() const override {
    return r_ > 0 ? lu_.matrixLU().diagonal().cwiseAbs().minCoeff() : 1.0;
  }

 private:
  void gather(const ConstraintKinematics& c) {
    for (int i = 0; i < r_; ++i) {
      const auto row = c.G.row(s_.rows[i]);
      for (int k = 0; k < r_; ++k) G_d_(i, k) = row[s_.dependent[k]];
      for (int k = 0; k < w_; ++k) G_i_(i, k) = row[s_.independent[k]];
      gamma_[i] = c.gamma[s_.rows[i]];
    }
  }

  Selection s_;
  int r_, w_;
  MatrixXd G_d_, G_i_;
  VectorXd gamma_;
  MatrixXd N_, M_N_, reduced_;
  VectorXd p_, residual_, z_, dependent_, solved_;
  Eigen::PartialPivLU<MatrixXd> lu_;
  Eigen::LLT<MatrixXd> llt_;
};

}  // namespace

std::unique_ptr<ForwardSolver> make_null_space_solver(const System& system, const Selection& selection) {
  return std::make_unique<NullSpaceSolver>(system, selection);
}

}  // namespace ferrers
