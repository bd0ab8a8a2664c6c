#pragma once

#include <vector>

#include "ferrers/redundancy/cluster_system.h"

/// Problem: the null space of G holds velocities; not every one of them belongs to a motion.
///
/// Given: first-order motions N (v = N z) and self-stresses Z at an assembled pose. A motion q(t) with v(0) = N z has
/// some acceleration with G vdot = gamma(q, N z) [stepanyan, eq. (8)], which exists when Zᵀ gamma(q, N z) = 0: one
/// quadratic form in z for each self-stress. Wanted: which z fulfil all of them (second-order flexes), or the proof
/// that only z = 0 does: then the mechanism is rigid at this pose although its rank leaves it a mobility
/// [connelly1996]. A second-order flex does not prove that it moves.
/// Proofs of rigidity: a combination of the forms is positive definite (prestress stability), found as the point
/// nearest to the origin in the convex hull of the forms' values on the unit sphere (Frank-Wolfe); else, for few
/// freedoms, a subdivision of the sphere with a bound on every part.
namespace ferrers {

/// Independent quadratic forms on R^w, of unit Frobenius norm and orthogonal.
struct QuadraticForms {
  int size = 0;             ///< w.
  std::vector<MatrixXd> A;  ///< Symmetric w × w.
  bool confident = true;    ///< How many are independent was clear.

  VectorXd evaluate(const VectorXd& z) const;
  MatrixXd gradient(const VectorXd& z) const;         ///< Row k: 2 zᵀ A_k.
  MatrixXd combine(const VectorXd& y) const;          ///< Σ y_k A_k.
  std::vector<MatrixXd> on(const MatrixXd& B) const;  ///< Bᵀ A_k B.
};

/// Where a branch of motion is singular all along, its equations have double zeros, and a pose on it is known to the
/// root of rounding only: the `blur` (math/rank.h) to decide with at poses that were reached by closing loops.
constexpr double kDoubleZeroBlur = 1e-7;

/// Keeps what is independent. `blur`: error of the matrices.
QuadraticForms make_quadratic_forms(const std::vector<MatrixXd>& forms, int size, double blur = 0);

/// The forms of the pose that the probe is at, made dimensionless with the characteristic length.
/// Cost: w (w + 1)/2 evaluations of the constraints.
QuadraticForms compute_second_order_forms(PoseProbe& probe, const LocalMotion& motion, double blur = 0);

/// The common zeros of the forms: a cone.
struct FlexCone {
  bool is_rigid = false;         ///< Proven: only 0.
  bool confident = true;         ///< The proof does not hang on a doubtful zero.
  std::vector<VectorXd> flexes;  ///< Zeros of unit norm, found from random starts; no two parallel.
  MatrixXd span;                 ///< w × d, orthonormal: the subspace that they span.
  bool is_linear = true;         ///< All of `span` are zeros, so that the cone is this subspace.
};

/// Seeded: always the same answer. `starts`: how many searches.
FlexCone find_second_order_flexes(const QuadraticForms& forms, int starts = 24, unsigned seed = 1);

/// Where all forms and their gradients vanish: the null space that all A_k share.
struct CommonKernel {
  MatrixXd basis;  ///< w × d, orthonormal.
  bool confident = true;
};
CommonKernel find_common_kernel(const QuadraticForms& forms);

}  // namespace ferrers
