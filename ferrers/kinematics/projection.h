#pragma once

#include <Eigen/Cholesky>

#include "ferrers/kinematics/constraints.h"
#include "ferrers/kinematics/scaling.h"

namespace ferrers {

/// Brings a state back to the constraints after an integration step: the nearest positions and velocities in a metric,
///   min |Δq|_W with phi_r(q ⊕ Δq) = 0,   min |Δv|_W with G_r (v + Δv) = 0,
/// for independent rows r. The metric W (the mass matrix, say) is given by its Cholesky factor.
/// Allocates nothing. Cost: O(n² r + r³) per iteration.
class Projector {
 public:
  Projector(const System& system, const Scaling& scaling, std::vector<int> rows);

  /// Projects `state`; `pos`, `vel`, `constraints` are work space and end up at the projected positions (not velocities).
  /// Returns the largest scaled residual of the rows left, m; infinity where it failed.
  double project(const Eigen::LLT<MatrixXd>& metric, State& state, PositionKinematics& pos, VelocityKinematics& vel,
                 ConstraintKinematics& constraints);

 private:
  void correct(const Eigen::LLT<MatrixXd>& metric, const RowMatrixXd& G, const VectorXd& residual);
  double size(const VectorXd& residual) const;

  const System& system_;
  std::vector<int> rows_;
  double length_m_;
  VectorXd row_scale_;
  MatrixXd G_transposed_, X_, A_;
  VectorXd rhs_, correction_;
  Eigen::LLT<MatrixXd> llt_;
};

}  // namespace ferrers
