#pragma once

#include <optional>

#include "ferrers/redundancy/contradiction.h"
#include "ferrers/redundancy/permanence.h"
#include "ferrers/redundancy/preload.h"
#include "ferrers/redundancy/rate_conflict.h"
#include "ferrers/redundancy/releases.h"
#include "ferrers/redundancy/resultants.h"

/// Problem: a designer's five questions about a mechanism, before any simulation.
///
/// Given: a system. Wanted: assembly, and then (1) mobility and redundancy with what certainty, (2) which joints share
/// it, (3) permanent or at this pose only, (4) which reactions are exact and how the others divide, (5) which joint
/// change removes it. Where the loops contradict themselves without stiffness to take it up, the first two are answered
/// at the best fit, with the blur that the misclosure brings, and nothing else. Cost: that of the parts.
namespace ferrers {

struct MechanismAnalysis {
  AssemblyResult assembly;
  ContradictionReport closure;
  std::optional<RedundancyReport> redundancy;  ///< Empty: no pose to speak of was found.
  std::optional<PermanenceReport> permanence;
  std::optional<PreloadReport> preload;
  std::vector<UniqueResultant> resultants;
  std::optional<ReleaseReport> releases;
  std::optional<RateConflict> rate_conflict;  ///< At t = 0.

  bool is_assembled() const {
    return closure.verdict == ClosureVerdict::kCloses || closure.verdict == ClosureVerdict::kElastic;
  }
};

MechanismAnalysis analyze_mechanism(const System& system);

}  // namespace ferrers
