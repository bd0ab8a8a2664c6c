#pragma once

#include <Eigen/Cholesky>
#include <Eigen/QR>

#include "ferrers/kinematics/constraints.h"
#include "ferrers/kinematics/scaling.h"

namespace ferrers {

/// Brings a state back to the constraints after an integration step: the nearest positions and velocities in a metric,
///   min |Δq|_W with phi_r(q ⊕ Δq) = 0,   min |Δv|_W with G_r (v + Δv) = 0,
/// for independent rows r. The metric W (the mass matrix, say) is given by its Cholesky factor W = L Lᵀ; with the QR
/// factors of X = L⁻¹ G_rᵀ the corrections are −L⁻ᵀ Q R⁻ᵀ residual. A residual at the level of rounding is left alone:
/// near a singular pose its correction would be noise.
/// Allocates nothing. Cost: O(n² r) per iteration.
class Projector {
 public:
  Projector(const System& system, const Scaling& scaling, std::vector<int> rows);

  /// Projects `state`; `pos`, `vel`, `constraints` are work space and end up at the projected positions (not
  /// velocities). Returns the largest scaled residual of the rows left, m; infinity where it failed.
  double project(const Eigen::LLT<MatrixXd>& metric, State& state, PositionKinematics& pos, VelocityKinematics& vel,
                 ConstraintKinematics& constraints);

 private:
  void correct(const Eigen::LLT<MatrixXd>& metric, const RowMatrixXd& G, const VectorXd& residual);
  double size(const VectorXd& residual) const;
  struct Rounding {
    double position, velocity;  ///< m, m/s: what rounding alone leaves in phi and G v.
  };
  Rounding rounding(const PositionKinematics& pos, const VelocityKinematics& vel) const;

  const System& system_;
  std::vector<int> rows_;
  double length_m_;
  VectorXd row_scale_;
  MatrixXd X_;
  VectorXd rhs_, correction_, work_;
  Eigen::HouseholderQR<MatrixXd> qr_;
};

}  // namespace ferrers
