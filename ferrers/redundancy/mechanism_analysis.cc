#include "ferrers/redundancy/mechanism_analysis.h"

namespace ferrers {
namespace {

ConstraintKinematics constraints_at_rest(const System& system, State state) {
  state.v.setZero(system.nv);
  PositionKinematics pos = make_position_kinematics(system);
  VelocityKinematics vel = make_velocity_kinematics(system);
  compute_positions(system, state.q, pos);
  compute_velocities(system, pos, state.q, state.v, vel);
  ConstraintKinematics out = make_constraint_kinematics(system);
  compute_constraints(system, state, pos, vel, out);
  return out;
}

}  // namespace

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
  if (!system.velocity_rows.empty() || system.knows_time) {
    out.rate_conflict = find_rate_conflict(system, system.scaling, constraints_at_rest(system, state));
  }
  return out;
}

}  // namespace ferrers
