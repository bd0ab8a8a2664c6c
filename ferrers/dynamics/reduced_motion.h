#pragma once

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "ferrers/dynamics/equations.h"
#include "ferrers/redundancy/analysis.h"

/// Problem: rest, stability and small vibrations are questions about the motions that the joints leave; neither
/// redundant rows nor dependent coordinates may bear on them.
///
/// Given: a state on the constraints and a selection of independent rows (r) and coordinates (d dependent, i
/// independent). Wanted: the equations of motion in the w independent coordinates s, and motion along them,
///
///   v = N ṡ + p₀,  N = [−G_d⁻¹ G_i; 1],   M_r s̈ = f_r,   M_r = Nᵀ M N,   f_r = Nᵀ (tau + B u − h − M p),
///
/// with p the accelerations that gamma alone asks for [stepanyan, eq. (7)-(9)]. Rows left out never enter: they hold
/// by themselves as long as the redundancy does, which `move` checks. Nothing here decides a rank.
/// Cost: O(n³) per evaluation.
namespace ferrers {

class ReducedMotion {
 public:
  /// `base`: the state about which motions are counted.
  /// Evaluated there.
  ReducedMotion(const DynamicsModel& model, const Scaling& scaling, State base, Selection selection);

  /// Everything at a state; `state.v` must be admissible.
  void evaluate(const State& state);
  const Equations& equations() const { return eq_; }
  const Selection& selection() const { return selection_; }
  const State& base() const { return base_; }
  int w() const { return static_cast<int>(selection_.independent.size()); }

  const MatrixXd& N() const { return N_; }                                      ///< nv × w.
  const MatrixXd& M() const { return M_r_; }                                    ///< w × w.
  const VectorXd& force() const { return f_r_; }                                ///< w.
  MatrixXd B() const { return N_.transpose() * eq_.B_transposed.transpose(); }  ///< w × nu.
  /// z = M_r⁻¹ f_r; false where M_r is not positive definite but for rounding.
  bool accelerations(VectorXd& z) const;

  /// The state at which the independent coordinates lie `ds` (w) from the base, dependent ones following by Newton's
  /// method, and with the independent velocities those of the base plus `dv`. To first order it is q ⊕ N ds. False
  /// where the loops do not follow, or rows left out open: the redundancy, or this very pose, is singular.
  bool move(const VectorXd& ds, const VectorXd& dv, State& out);

  /// The last `move` failed for rows left out: those chosen closed.
  bool left_rows_open() const { return left_open_; }

  /// Displacements of all bodies per unit of each independent coordinate, at the state last evaluated: per body the
  /// turn times the characteristic length, then the displacement of the mass centre, m; 6·bodies × w. Called X,
  /// XᵀX measures motions without any choice of coordinates.
  MatrixXd body_displacements() const;

  /// Sum of the sizes of all forces that act at the state last evaluated, N (moments over the characteristic length):
  /// what the reduced forces are to be compared with.
  double force_scale(const State& state) const;

  /// Multipliers with which the joints hold `force` (nv) at the state last evaluated, zero at rows left out:
  /// G_dᵀ lambda = −force on the dependent coordinates. Shape: m.
  VectorXd rest_multipliers(const VectorXd& force) const;

 private:
  void factor();
  double residual(bool all) const;

  const DynamicsModel& model_;
  const System& system_;
  Scaling scaling_;
  State base_;
  Selection selection_;
  Equations eq_;
  MatrixXd base_N_;
  double base_residual_ = 0;
  bool left_open_ = false;
  Eigen::PartialPivLU<MatrixXd> lu_;
  VectorXd q_;  ///< Last evaluated.
  MatrixXd N_, M_r_;
  VectorXd f_r_;
};

/// Of body displacements (6·bodies): the largest of a body's turn times the characteristic length and its shift, m.
double largest_displacement(const VectorXd& bodies);

/// A derivative with the error estimates of its entries.
struct EstimatedMatrix {
  MatrixXd value, error;
};

/// Derivatives of reduced forces and accelerations at the base by extrapolated differences
/// (math/extrapolated_difference.h): every evaluation lies on the constraints. Each w × w.
struct ReducedDerivatives {
  bool valid = false;              ///< False: the base is a singular pose, where motions have no coordinates.
  EstimatedMatrix force_s;         ///< ∂f_r/∂s, which is −K.
  EstimatedMatrix force_v;         ///< ∂f_r/∂ṡ, which is −C.
  EstimatedMatrix acceleration_s;  ///< ∂s̈/∂s.
  EstimatedMatrix acceleration_v;  ///< ∂s̈/∂ṡ.
};

/// Of forces by positions alone; a mass matrix is not needed. Cost: some 12 evaluations per independent coordinate.
ReducedDerivatives compute_reduced_stiffness(ReducedMotion& motion, double length_m);
/// All of them; not valid where M_r is singular. Twice the cost. The motion is left evaluated at its base.
ReducedDerivatives compute_reduced_derivatives(ReducedMotion& motion, double length_m);

}  // namespace ferrers
