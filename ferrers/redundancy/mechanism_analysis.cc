#include "ferrers/redundancy/mechanism_analysis.h"

namespace ferrers {

MechanismAnalysis analyze_mechanism(const System& system) {
  MechanismAnalysis out;
  out.assembly = assemble(system);
  out.closure = analyze_contradiction(system, out.assembly);
  if (out.closure.verdict == ClosureVerdict::kNotFound) return out;
  const State& state = out.closure.state;
  out.redundancy = analyze_redundancy(system, state, {.blur = out.closure.blur});
  if (!out.is_assembled()) return out;
  const RedundancyReport& report = *out.redundancy;
  out.permanence = analyze_permanence(system, state, report);
  out.preload = analyze_preload(system, state, report, out.closure.misfit);
  out.resultants = find_unique_resultants(system, state, report);
  out.releases = analyze_releases(system, state, report, {.permanence = &*out.permanence});
  return out;
}

}  // namespace ferrers
