#pragma once

#include <string>
#include <vector>

#include "ferrers/dynamics/modes.h"
#include "ferrers/dynamics/named_coordinates.h"
#include "ferrers/dynamics/stability.h"

/// Problem: control design and vibration want a linear system; a mechanism with redundant constraints has one in its
/// independent coordinates only.
///
/// Given: a model and a state on the constraints. Wanted, with x = [δs; δṡ] of the w independent coordinates and u the
/// drive efforts beyond their laws,
///
///   ẋ = A x + B u + c,   A = [P 1; ∂s̈/∂s ∂s̈/∂ṡ],   B = [0; M_r⁻¹ Nᵀ B],
///
/// c = [ṡ; s̈] the motion itself, zero in equilibrium. P is zero but for rotations of spherical and free joints that
/// turn meanwhile: δs is then a turn in first-body axes and P = ω×. Effort laws are part of A. Dependent coordinates
/// and redundant rows follow by N, so that no choice of rows bears on A; frequencies depend on no choice of coordinates
/// either.
/// Method: extrapolated differences of the accelerations on the constraints; B exactly. Dry friction is left out: at
/// rest it has no derivative worth the name. Accuracy: `relative_error`, an estimate, 1e-11 where nothing is stiff or
/// nearly singular. Cost: some 24 evaluations of O(n³) per independent coordinate.
namespace ferrers {

enum class LinearizationStatus {
  kDone,
  kSingularPose,  ///< Motions through this pose have no coordinates: `message`.
  kSingularMass,  ///< M_r is singular: some motion has no inertia.
  kUnsupported,   ///< The model asks what cannot be done: `message`.
};

/// One motion of all joints.
struct ModeShape {
  std::vector<std::complex<double>> value;  ///< As `Linearization::joint_coordinates`; the largest part is 1.
  int largest = 0;                          ///< Index of it, lengths and angles compared by the characteristic length.
};

struct Linearization {
  LinearizationStatus status = LinearizationStatus::kDone;
  State state;
  Selection selection;
  std::vector<NamedCoordinate> coordinates;    ///< The w independent ones, with their values' units; value ṡ.
  std::vector<std::string> inputs;             ///< nu drive components.
  MatrixXd A, B;                               ///< 2w × 2w, 2w × nu.
  VectorXd drift;                              ///< c, 2w.
  MatrixXd M, N;                               ///< w × w, nv × w.
  EstimatedMatrix K, C;                        ///< −∂f_r/∂s, −∂f_r/∂ṡ.
  double relative_error = 0;                   ///< Estimate for A, in coordinates in which M is the unit matrix.
  bool at_rest = true, is_equilibrium = true;  ///< v = 0; and nothing accelerates.
  StabilityVerdict stability;                  ///< At an equilibrium.
  ModalAnalysis modal;
  std::vector<NamedCoordinate> joint_coordinates;  ///< Of all joints, for the shapes.
  std::vector<ModeShape> shapes;                   ///< Per mode.
  std::string message;
  std::vector<std::string> notices;
};

Linearization linearize(const DynamicsModel& model, const State& state);

}  // namespace ferrers
