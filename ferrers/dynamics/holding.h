#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "ferrers/dynamics/rest_reactions.h"

/// Problem: which efforts of the drives keep a mechanism at rest in a given pose?
///
/// Given: an assembled pose and the drives that hold. Wanted: u with
///
///   Nᵀ (tau + B_g u_g + B_h u − h) = 0   at v = 0,
///
/// u_g the efforts of the other drives, by their laws. With fewer drives than mobility some motions are held by nobody:
/// which, and whether they start. With more, the u of least Σ (weight_k u_k)², as in inverse dynamics; an effort is
/// unique where no null vector of Nᵀ B_h touches it. Redundant rows take no part; rank by math/rank, in the measure
/// of the bodies' displacement. Cost: O(n³).
namespace ferrers {

enum class HoldingStatus {
  kHeld,         ///< Nothing starts to move.
  kNotHeld,      ///< Some motion starts: `message` says which. Efforts are those that leave the least force.
  kUnsupported,  ///< The model asks what cannot be done: `message`. Nothing was computed.
};

/// `state`: the pose, at rest. `notices`: a rank in doubt.
struct HoldingResult : RestPoint {
  HoldingStatus status = HoldingStatus::kHeld;
  std::vector<bool> holds;   ///< nu: the drive was free to choose its effort.
  std::vector<bool> unique;  ///< nu: no other effort of this drive would do (true where it does not hold).
  int free_motions = 0;      ///< Motions that no drive resists, started or not.
  std::vector<std::string> free_motion_names;  ///< The coordinates that take part in each of them.
  bool confident = true;  ///< Clear decisions: the rank of the constraints, and how many motions the drives resist.
  double residual_N = 0;  ///< Force that nobody holds, over unit displacements of the bodies, N.
  Energy energy;
  std::string message;
};

/// Which drives hold: all but those that have an effort law and no motion law, which act by it; all if that leaves
/// none.
std::vector<bool> holding_drives(const DynamicsModel& model);

/// "N·m" of drives on angles, else "N".
std::string_view effort_unit(const DriveComponent& drive);

/// Efforts that hold `pose` at time t.
HoldingResult solve_holding_efforts(const DynamicsModel& model, const State& pose, double t = 0);

}  // namespace ferrers
