#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ferrers/dynamics/rest_reactions.h"
#include "ferrers/dynamics/stability.h"

/// Problem: where does a mechanism come to rest under its loads, and does it stay there?
///
/// Given: a model and an assembled state near which to look. Wanted: q with
///
///   phi(q) = 0,   f_r(q) = Nᵀ (tau + B u − h) = 0   at v = 0, t given,
///
/// where drives act by their effort laws; then the multipliers (h − tau − B u = Gᵀ lambda), the stability and the
/// energy. Redundant rows take no part: forces count on admissible motions only.
/// Method: Newton's steps in independent coordinates, each resisted direction by its own stiffness. Directions of
/// negative stiffness are gone along, not back, so that the search goes downhill like a mechanism let go in honey;
/// steps are bounded by how far a body moves, and are shortened until the forces do not turn against them, which needs
/// no potential. A pose that is at rest already stays, stable or not. Independent coordinates are chosen anew after
/// every step; at a singular pose the step follows the forces and the loops are closed with all rows.
/// Accuracy: forces to about 64 roundings of all that act. Cost: some 12 evaluations of O(n³) per coordinate and step.
namespace ferrers {

enum class EquilibriumStatus {
  kFound,
  kNotFound,     ///< None was reached: `message` says what still accelerates. The state is the last one.
  kUnsupported,  ///< The model asks what cannot be done: `message`. Nothing was computed.
};

struct EquilibriumOptions {
  double t = 0;              ///< Time at which loads are evaluated, s.
  int max_iterations = 300;  ///< Steps.
};

/// `u`: efforts by the laws. `notices`: a rank in doubt, joint limits that are passed.
struct EquilibriumResult : RestPoint {
  EquilibriumStatus status = EquilibriumStatus::kFound;
  Energy energy;
  StabilityVerdict stability;
  EstimatedMatrix stiffness;  ///< K in the independent coordinates; empty at a singular pose.
  double residual_N = 0;      ///< Largest force left, over unit displacements of the bodies, N.
  double force_scale_N = 0;   ///< Sum of all forces that act.
  int steps = 0;
  std::string message;
};

EquilibriumResult solve_equilibrium(const DynamicsModel& model, const State& start,
                                    const EquilibriumOptions& options = {});

/// Joints whose coordinate is outside of their limits at this state, in words.
std::vector<std::string> passed_limits(const System& system, const State& state);

}  // namespace ferrers
