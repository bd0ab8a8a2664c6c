#include <algorithm>
#include <chrono>

#include "ferrers/core/checks.h"
#include "ferrers/dynamics/inverse.h"
#include "ferrers/simulate/simulation.h"

namespace ferrers {
namespace {

void note_energy(RunSummary& summary, const RunSample& sample, bool first) {
  summary.energy_end = sample.energy;
  if (first) summary.energy_start = summary.energy_min = summary.energy_max = sample.energy;
  summary.energy_min = std::min(summary.energy_min, sample.energy);
  summary.energy_max = std::max(summary.energy_max, sample.energy);
  summary.max_constraint_residual = std::max(summary.max_constraint_residual, sample.constraint_residual);
}

DecisionRecord describe(const System& system, const Selection& selection) {
  DecisionRecord record;
  record.rank = static_cast<int>(selection.rows.size());
  record.mobility = static_cast<int>(selection.independent.size());
  record.reason = "start";
  for (const int row : selection.excluded_rows(system.m)) record.excluded_rows.push_back(system.row_names[row]);
  for (const int v : selection.independent) record.independent_coordinates.push_back(system.coordinate_names[v]);
  return record;
}

RunStatus run_status(PrescribedStatus status) {
  switch (status) {
    case PrescribedStatus::kSolved:
      return RunStatus::kFinished;
    case PrescribedStatus::kUndriven:
    case PrescribedStatus::kOverdriven:
      return RunStatus::kBadMotion;
    case PrescribedStatus::kNotReached:
    case PrescribedStatus::kSingular:
      break;
  }
  return RunStatus::kStepTooSmall;
}

}  // namespace

RunSummary run_prescribed(std::shared_ptr<const DynamicsModel> model, const PrescribedOptions& options,
                          const RunControl& control) {
  require(model != nullptr, "run_prescribed: no model");
  const auto begin = std::chrono::steady_clock::now();
  RunSummary summary;
  summary.method = options.with_efforts ? "prescribed motion, inverse dynamics" : "prescribed motion, kinematics";
  if (options.with_efforts && !model->unsupported.empty()) {
    summary.status = RunStatus::kUnsupported;
    summary.message = "efforts cannot be computed: the model has " + model->unsupported.front();
    return summary;
  }
  const AssemblyResult assembly = assemble(*model->system);
  if (assembly.status != AssemblyStatus::kAssembled) {
    summary.status = RunStatus::kNotAssembled;
    summary.message = assembly.message;
    return summary;
  }
  PrescribedMotion motion(model, assembly.state);
  Recorder recorder(model, options.axes, options.distribution);
  PrescribedResult result = motion.check();
  summary.decisions.push_back(describe(*model->system, motion.selection()));
  bool first = true;
  for (const double t : options.grid.times()) {
    if (result.status != PrescribedStatus::kSolved) break;
    result = motion.solve(t, options.with_efforts);
    if (result.status != PrescribedStatus::kSolved) break;
    ++summary.steps;
    const RunSample& sample = recorder.record(result.state, motion.equations(), motion.selection(), result.vdot,
                                              result.lambda, result.u, options.with_efforts);
    if (const std::string reason = refused_range(recorder.distribution()); !reason.empty()) {
      summary.status = RunStatus::kUnsupported;
      summary.message = reason;
      break;
    }
    note_energy(summary, sample, first);
    first = false;
    summary.t_reached = t;
    if (control.on_sample) control.on_sample(sample);
    if (control.on_progress) control.on_progress(t);
    if (control.stop && control.stop->load(std::memory_order_relaxed)) {
      summary.status = RunStatus::kStopped;
      summary.message = "interrupted";
      break;
    }
  }
  if (summary.status == RunStatus::kFinished) summary.status = run_status(result.status);
  if (summary.message.empty()) summary.message = result.message;
  summary.peaks = recorder.peaks();
  summary.distribution = recorder.distribution();
  summary.wall_time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return summary;
}

}  // namespace ferrers
