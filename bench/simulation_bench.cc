// One evaluation of forward dynamics with multipliers, whole simulations with their error, and decisions, on the
// mechanism zoo. Counters show what the time bought: error against converged figures and drift of energy.

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cmath>
#include <string>

#include "ferrers/testing/run_probe.h"
#include "ferrers/testing/zoo.h"

namespace {

using namespace ferrers;           // NOLINT(google-build-using-namespace): a program, not a header
using namespace ferrers::witness;  // NOLINT(google-build-using-namespace)

void measure_evaluation(benchmark::State& run, const ModelSpec& spec, Formulation formulation) {
  EngineProbe engine(spec);
  const State state = engine.wandered(1, 0.1);
  const auto solver = make_forward_solver(formulation, *engine.system, engine.selection);
  ForwardResult result = make_forward_result(*engine.system);
  for (auto _ : run) {
    compute_equations(*engine.dynamics, state, engine.eq);
    solver->solve(engine.eq, result);
    benchmark::DoNotOptimize(result.lambda.data());
    benchmark::DoNotOptimize(result.vdot.data());
  }
  run.counters["coordinates"] = engine.system->nv;
  run.counters["rows"] = engine.system->m;
}

void measure_analysis(benchmark::State& run, const ModelSpec& spec) {
  const EngineProbe engine(spec);
  const State state = make_drawn_state(*engine.system);
  for (auto _ : run) benchmark::DoNotOptimize(analyze_redundancy(*engine.system, state).rank);
}

struct Reference {
  double t = 0;
  std::string column_stem;  ///< Of a recorded point, or of an angle.
  Vector3d point = Vector3d::Zero();
};

void measure_run(benchmark::State& run, const ModelSpec& spec, double t_end, double every, double tolerance,
                 const Reference& reference, bool find_singular_poses) {
  const EngineProbe engine(spec);
  SimulationOptions options = plain_run(t_end, every);
  options.tolerance = tolerance;
  options.find_singular_poses = find_singular_poses;
  ProbedRun last;
  for (auto _ : run) {
    last = ProbedRun();
    const RunControl control = keep_rows(*engine.dynamics, last);
    last.summary = simulate(engine.dynamics, options, control);
  }
  if (last.summary.status != RunStatus::kFinished) run.SkipWithError(last.summary.message.c_str());
  run.counters["steps"] = static_cast<double>(last.summary.steps);
  run.counters["evaluations"] = static_cast<double>(last.summary.evaluations);
  run.counters["energy_drift_J"] = last.energy_drift();
  const bool is_angle = last.columns.contains(reference.column_stem);
  run.counters["error"] = is_angle ? std::abs(last.at(reference.t, reference.column_stem) - reference.point.x())
                                   : (last.point(reference.t, reference.column_stem) - reference.point).norm();
}

void add(const std::string& name, const ModelSpec& spec) {
  for (const Formulation formulation : kFormulations) {
    benchmark::RegisterBenchmark(("evaluation/" + std::string(to_string(formulation)) + "/" + name).c_str(),
                                 measure_evaluation, spec, formulation)
        ->Unit(benchmark::kMicrosecond);
  }
  benchmark::RegisterBenchmark(("analysis/" + name).c_str(), measure_analysis, spec)->Unit(benchmark::kMicrosecond);
}

}  // namespace

int main(int argc, char** argv) {
  add("bricard_a04", make_bricard(BricardRods::kBricks));
  add("four_bar", make_four_bar(FourBarJoints::kRevolute));
  add("three_cranks", make_parallel_cranks());
  add("andrews_a03", make_andrews());
  for (const int n : {1, 2, 10, 40, 100}) add("n_four_bar_a02/" + std::to_string(n), make_n_four_bar(n, 0.3));
  const auto add_run = [](const std::string& name, const ModelSpec& spec, double t_end, double every,
                          const Reference& r) {
    for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
      const std::string title = fmt::format("run/{}/tolerance_{:g}", name, tolerance);
      benchmark::RegisterBenchmark(title.c_str(), measure_run, spec, t_end, every, tolerance, r, true)
          ->Unit(benchmark::kMillisecond);
      // The same motion, without the times and ranks of the singular poses on its way.
      benchmark::RegisterBenchmark((title + "/motion_only").c_str(), measure_run, spec, t_end, every, tolerance, r,
                                   false)
          ->Unit(benchmark::kMillisecond);
    }
  };
  add_run("bricard_a04_10s", make_bricard(BricardRods::kBricks), 10, 1,
          {10, "P3", {0.999730987305, -0.999999963826, -0.000268976511}});
  add_run("n_four_bar_a02_2_10s", make_n_four_bar(2, 0, 1), 10, 1,
          {10, "B0", {0.3284581115408154, 0.9445185381786010, 0}});
  add_run("n_four_bar_a02_40_20s", make_n_four_bar(40, 0, 1), 20, 1,
          {10, "B0", {0.1805122266867284, 0.9835727405823116, 0}});
  add_run("andrews_a03_0.03s", make_andrews(), 0.03, 0.01,
          {0.03, "O.angle", {15.810771195154 + 0.0617138900142764496, 0, 0}});
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
