#pragma once

#include <array>
#include <string>
#include <vector>

#include "ferrers/redundancy/analysis.h"
#include "ferrers/redundancy/distribution.h"

/// Problem: a redundant mechanism whose joints are out of line is under stress before any load acts on it.
///
/// Given: an assembled state, its redundancy report, the joints' stiffness and misalignment, and where the geometry
/// does not close what is left of phi. Wanted: the reactions that this alone gives rise to: the distribution of no
/// load, lambda_p = 0 (redundancy/distribution.h). No mass is read. With the residual of a loop that cannot close it
/// tells how compliant joints close it elastically. To first order in misalignment and residual. Cost: that of one
/// distribution, dense: O(rows · k²) for k self-stresses; nothing where all is in line.
namespace ferrers {

enum class PreloadStatus {
  kNone,           ///< No joint is out of line and everything closes: no preload.
  kSolved,         ///< Values are valid where their status is not kUndetermined.
  kContradictory,  ///< Rigid joints (`contradictory`) cannot be assembled with this misalignment: no values
                   ///< for them and what is tied to them by self-stresses.
  kTooLarge,       ///< Not computed: more than `kMostPreloadStresses` self-stresses.
};

inline constexpr int kMostPreloadStresses = 500;

struct JointPreload {
  std::string joint;
  /// force_x … moment_z along the joint's frame, on the second body at the joint's point; N and N·m.
  std::array<double, 6> value{};
  std::array<ReactionStatus, 6> status{};
};

struct PreloadReport {
  PreloadStatus status = PreloadStatus::kNone;
  bool confident = true;                   ///< Which self-stresses springs fix was a clear decision.
  std::vector<JointPreload> joints;        ///< In the order of the file.
  std::vector<std::string> contradictory;  ///< Joints and couplings.
};

/// `closure_residual`: m numbers, SI, added to the misalignment on the closure rows; empty, or below what counts as
/// closed: nothing to close elastically.
PreloadReport analyze_preload(const System& system, const State& state, const RedundancyReport& report,
                              const VectorXd& closure_residual = {});

}  // namespace ferrers
