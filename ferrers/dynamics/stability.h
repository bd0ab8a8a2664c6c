#pragma once

#include <string_view>

#include "ferrers/dynamics/reduced_motion.h"

/// Problem: does a mechanism at rest stay there when it is disturbed?
///
/// Given: K = −∂f_r/∂s in independent coordinates at a pose of rest, and D = XᵀX, the measure of the bodies'
/// displacement. Wanted: the principal stiffnesses κ with K φ = κ D φ and their signs. With a potential, K is symmetric
/// and the pose is stable where all κ > 0 (Dirichlet). Which of them are zero is decided in math/rank, on a scale that
/// the forces give: a stiffness that holds less than 1e-12 of them against a displacement of the mechanism's own size
/// is none. Without a potential (K not symmetric beyond its error) the eigenvalues of M_r⁻¹ K count: one with a
/// negative real part diverges, a complex one flutters. Damping and gyroscopic forces are not looked at:
/// dynamics/linearization.h does. Cost: O(w³).
namespace ferrers {

enum class Stability {
  kStable,    ///< Every motion is resisted.
  kUnstable,  ///< Some motion runs away.
  kNeutral,   ///< None runs away, some meet no resistance.
  kUnknown,   ///< A singular pose: there is no stiffness matrix.
};
std::string_view to_string(Stability stability);

struct StabilityVerdict {
  Stability stability = Stability::kUnknown;
  bool confident = true;                      ///< Which directions are neutral was a clear decision.
  bool conservative = true;                   ///< K is symmetric.
  int stable = 0, unstable = 0, neutral = 0;  ///< Directions.
  VectorXd stiffness;                         ///< w, ascending: principal stiffnesses, N/m.
  MatrixXd directions;  ///< w × w: column k belongs to `stiffness[k]`; independent coordinates, of unit displacement.
};

/// `K` with its error estimates, `X`: body displacements, `M`: w × w mass matrix (used where K is not symmetric, if it
/// is regular), `force_N`: ReducedMotion::force_scale.
StabilityVerdict judge_stability(const EstimatedMatrix& K, const MatrixXd& X, const MatrixXd& M, double force_N,
                                 double length_m);

/// Whether K is symmetric to its error estimates.
bool is_symmetric(const EstimatedMatrix& K);

}  // namespace ferrers
