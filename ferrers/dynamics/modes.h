#pragma once

#include <complex>
#include <string_view>
#include <vector>

#include "ferrers/dynamics/reduced_motion.h"

/// Problem: with what frequencies, and how damped, does a mechanism vibrate or drift away?
///
/// Given: ẋ = A x with x = [δs; δṡ], and the mass, stiffness and damping matrices behind it. Wanted: eigenvalues λ and
/// the shapes y of the motions s = y e^{λt}.
/// Without damping and gyroscopic forces, K and M symmetric: K y = ω² M y, by which frequencies keep all digits that K
/// has. Else (λ² M + λ C + K) y = 0, by the eigenvalues of A in coordinates in which M is the unit matrix and time has
/// the unit of the fastest motion. Motions that neither stiffness nor damping resists are split off before: their
/// double eigenvalue zero has one eigenvector only, and rounding would tear it into two of size 1e-8. How many zeros
/// there are is decided in math/rank. Cost: O(w³).
namespace ferrers {

enum class ModeKind {
  kOscillation,  ///< A pair λ, λ* with Im λ > 0; grows where Re λ > 0.
  kDecay,        ///< Real λ < 0.
  kGrowth,       ///< Real λ > 0.
  kNeutral,      ///< λ = 0: a motion without resistance.
};
std::string_view to_string(ModeKind kind);

struct Mode {
  ModeKind kind = ModeKind::kNeutral;
  std::complex<double> eigenvalue;  ///< 1/s; of a pair the one with Im λ > 0.
  int multiplicity = 1;             ///< Modes that share the eigenvalue to 1e-7: their shapes are one choice of many.
  Eigen::VectorXcd shape;           ///< w, independent coordinates; of any size.
  double frequency_rad_s() const { return std::abs(eigenvalue); }
  /// −Re λ / |λ|; 0 for neutral ones.
  double damping_ratio() const;
};

struct ModalAnalysis {
  std::vector<std::complex<double>> eigenvalues;  ///< 2w: of all modes, neutral ones twice where nothing damps them.
  std::vector<Mode> modes;                        ///< Neutral first, then by |λ|.
  bool undamped = false;                          ///< Taken as free of damping and gyroscopic forces.
};

/// At rest in equilibrium. `neutral`, `unstable`: how many principal stiffnesses are zero or negative
/// (dynamics/stability.h). M w × w positive definite; K, C w × w.
ModalAnalysis analyze_modes_at_rest(const MatrixXd& M, const EstimatedMatrix& K, const EstimatedMatrix& C, int neutral,
                                    int unstable);

/// At any other state: eigenvalues of A (2w × 2w) as it stands.
ModalAnalysis analyze_modes(const MatrixXd& M, const MatrixXd& A);

}  // namespace ferrers
