#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ferrers/redundancy/analysis.h"
#include "ferrers/redundancy/branches.h"

/// Problem: is a redundancy a property of the mechanism, or met only at this pose? And does the mechanism move at all?
///
/// Given: an assembled state and its report. Wanted: rank at generic configurations of the same assembly, the branches
/// of motion through the pose, and the largest dimension among them.
/// Method: each cluster of loops by itself (redundancy/branches.h); branches of the whole are combinations of theirs.
/// Where the pose is proven isolated (a structure, or a mechanism that only seems to move) it is the only configuration
/// of its assembly, and generic figures are those of the pose; `is_shaky` then says that the geometry is special.
/// Cost: see branches.h, for each cluster with redundant rows.
namespace ferrers {

enum class Permanence {
  kNone,           ///< No redundancy at this pose.
  kPermanent,      ///< The same redundancy at generic configurations.
  kConfiguration,  ///< Redundant here, not at generic configurations.
  kMixed,          ///< Redundant at generic configurations, and more so here.
  kUnknown,        ///< The geometry is known at the drawn pose only, or no generic configuration was reached.
};
std::string_view to_string(Permanence kind);

struct PermanenceOptions {
  BranchOptions branches;
  int largest_cluster = 200;  ///< Clusters of more coordinates are moved by sparse steps (large_motion.h).
};

/// A smooth branch of the motion of the whole mechanism through the pose.
struct BranchReport {
  int dimension = 0;
  int mobility = 0;  ///< By rank, at generic poses of the branch; larger than `dimension` where every pose is singular.
  int redundant = 0;  ///< At generic poses of the branch.
  double share = 1;   ///< Of the walks that were tried.
  /// A velocity along the branch at the pose: coordinates that move, by name; rad/s and m/s, the largest one (angles
  /// times the characteristic length) being one characteristic length per second.
  std::vector<std::pair<std::string, double>> direction;
};

struct PermanenceReport {
  Permanence kind = Permanence::kUnknown;
  /// At configurations of largest rank. Where branches differ in rank, `branches` tells of each.
  std::optional<int> generic_mobility, generic_redundant;
  int configurations = 0;              ///< Reached and judged, the given one not counted.
  std::optional<int> finite_mobility;  ///< Largest dimension of a motion through the pose; empty: not established.
  FiniteMobilityBasis basis = FiniteMobilityBasis::kNotEstablished;
  bool is_shaky = false;               ///< Some loops are proven rigid although the rank leaves them a mobility.
  std::vector<BranchReport> branches;  ///< Largest dimension first; empty where nothing moves or nothing is known.
  bool all_branches = true;            ///< False: more than are listed.
  bool second_order_done = true;       ///< False: some loops have too many freedoms for the second-order test.
  bool confident = true;               ///< Every rank decision on the way was confident.
};

PermanenceReport analyze_permanence(const System& system, const State& state, const RedundancyReport& report,
                                    const PermanenceOptions& options = {});

}  // namespace ferrers
