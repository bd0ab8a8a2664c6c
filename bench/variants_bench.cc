// Sweeps: ten thousand variants of the Bricard mechanism on one thread and on two, and where the time of one goes.
// Items are variants.

#include <benchmark/benchmark.h>

#include <string>
#include <utility>

#include "ferrers/io/model_reader.h"
#include "ferrers/study/variants.h"

namespace {

using namespace ferrers;  // NOLINT(google-build-using-namespace): a program, not a header

Model bricard() { return std::move(*read_model_file(FERRERS_SOURCE_DIR "/examples/bricard-a04/model.yaml").model); }

ParameterTable thicknesses(std::size_t count) {
  ParameterTable table;
  table.names = {"c"};
  for (std::size_t i = 0; i < count; ++i) {
    table.values.push_back(0.05 + 0.2 * static_cast<double>(i) / static_cast<double>(count));
  }
  return table;
}

SimulationOptions last_row_only(double t_end) {
  SimulationOptions simulation;
  simulation.grid = last_row_grid(simulation, {t_end, 0.01});
  return simulation;
}

void measure_sweep(benchmark::State& run, std::size_t count, double t_end, int threads, Formulation formulation) {
  const Model model = bricard();
  const ParameterTable table = thicknesses(count);
  VariantsOptions options;
  options.simulation = last_row_only(t_end);
  options.simulation.formulation = formulation;
  options.threads = threads;
  double evaluations = 0;
  bool all_finished = true;
  VariantsControl control;
  control.on_result = [&](const VariantResult& result) {
    evaluations += static_cast<double>(result.evaluations);
    all_finished = all_finished && result.is_finished();
  };
  for (auto _ : run) benchmark::DoNotOptimize(simulate_variants(model, table, options, control));
  if (!all_finished) run.SkipWithError("a variant failed");
  const auto variants = static_cast<double>(run.iterations()) * static_cast<double>(count);
  run.SetItemsProcessed(static_cast<long>(variants));
  run.counters["evaluations"] = evaluations / variants;
}

// What comes before the first step: the model of other values, its layout, and a run that ends where it begins.
void measure_parts(benchmark::State& run, int parts) {
  const Model model = bricard();
  double c = 0.05;
  for (auto _ : run) {
    c = c < 0.25 ? c + 1e-6 : 0.05;
    ModelBuildResult built = model.with_parameters({{"c", c}});
    if (parts == 0) continue;
    auto dynamics = make_dynamics_model(make_system(std::move(*built.model)));
    if (parts == 1) continue;
    SimulationOptions simulation = last_row_only(0);
    simulation.with_reactions = false;
    benchmark::DoNotOptimize(simulate(std::move(dynamics), simulation, {}).steps);
  }
  run.SetItemsProcessed(run.iterations());
}

}  // namespace

int main(int argc, char** argv) {
  for (const Formulation formulation : {Formulation::kSparse, Formulation::kNullSpace}) {
    for (const int t_end : {10, 1}) {
      for (const int threads : {1, 2}) {
        const std::string name = "sweep_10000/" + std::string(to_string(formulation)) + "/" + std::to_string(t_end) +
                                 "_s/threads:" + std::to_string(threads);
        benchmark::RegisterBenchmark(name.c_str(), measure_sweep, std::size_t{10'000}, t_end, threads, formulation)
            ->Unit(benchmark::kMillisecond)
            ->Iterations(1)
            ->UseRealTime();
      }
    }
  }
  benchmark::RegisterBenchmark("model", measure_parts, 0)->Unit(benchmark::kMicrosecond);
  benchmark::RegisterBenchmark("model_and_layout", measure_parts, 1)->Unit(benchmark::kMicrosecond);
  benchmark::RegisterBenchmark("model_layout_and_start", measure_parts, 2)->Unit(benchmark::kMicrosecond);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
