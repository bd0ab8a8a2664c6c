#pragma once

#include <map>
#include <string>
#include <vector>

#include "ferrers/simulate/simulation.h"
#include "ferrers/testing/engine_probe.h"

/// Whole runs for tests: every row kept, values found by the names of their columns.
namespace ferrers::witness {

struct ProbedRun {
  RunSummary summary;
  std::vector<RunSample> samples;
  std::map<std::string, std::size_t> columns;

  /// Value of a column in the row at time t (to 1e-9); throws `std::out_of_range` when there is none.
  double at(double t, const std::string& column) const {
    for (const RunSample& sample : samples) {
      if (std::abs(sample.t - t) < 1e-9) return sample.values.at(columns.at(column));
    }
    throw std::out_of_range("ProbedRun: no row at that time");
  }
  double last(const std::string& column) const { return samples.back().values.at(columns.at(column)); }
  Vector3d point(double t, const std::string& name) const {
    return {at(t, name + ".x"), at(t, name + ".y"), at(t, name + ".z")};
  }
  double energy_drift() const {
    return std::max(summary.energy_max - summary.energy_start, summary.energy_start - summary.energy_min);
  }
};

inline RunControl keep_rows(const DynamicsModel& model, ProbedRun& run) {
  const std::vector<std::string> names = run_columns(model);
  for (std::size_t i = 0; i < names.size(); ++i) run.columns[names[i]] = i;
  RunControl control;
  control.on_sample = [&run](const RunSample& sample) { run.samples.push_back(sample); };
  return control;
}

inline ProbedRun probe_run(const ModelSpec& spec, const SimulationOptions& options) {
  const EngineProbe engine(spec);
  ProbedRun run;
  const RunControl control = keep_rows(*engine.dynamics, run);
  run.summary = simulate(engine.dynamics, options, control);
  return run;
}

/// Options of a plain run: rows `every` seconds up to `t_end`, no reactions; native code, however short the run.
inline SimulationOptions plain_run(double t_end, double every) {
  SimulationOptions options;
  options.grid = {t_end, every};
  options.with_reactions = false;
  options.native_code = NativeCode::kAlways;
  return options;
}

}  // namespace ferrers::witness
