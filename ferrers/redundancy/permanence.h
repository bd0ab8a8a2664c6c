#pragma once

#include <optional>
#include <string_view>

#include "ferrers/redundancy/analysis.h"

/// Problem: is a redundancy a property of the mechanism, or met only at this pose?
///
/// Given: an assembled state and its report. Wanted: rank at generic configurations of the same branch of assembly.
/// Method: walks from the state along random directions of the null space of G, closing the loops after each step; the
/// rank is decided anew at every configuration reached, and the largest rank counts as generic. Seeded, so that the
/// answer is always the same. Where no walk gets away from the pose (a structure, or a mechanism that only seems to
/// move), `finite_mobility` is not claimed. Cost: `configurations` assemblies and rank decisions.
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
  int configurations = 8;
  unsigned seed = 1;
};

struct PermanenceReport {
  Permanence kind = Permanence::kUnknown;
  std::optional<int> generic_mobility, generic_redundant;
  int configurations = 0;              ///< Reached and judged, the given one not counted.
  std::optional<int> finite_mobility;  ///< Dimension of the motion through the pose; empty where not established.
  bool confident = true;               ///< Every rank decision on the way was confident.
};

PermanenceReport analyze_permanence(const System& system, const State& state, const RedundancyReport& report,
                                    const PermanenceOptions& options = {});

}  // namespace ferrers
