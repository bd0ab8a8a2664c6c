// What the redundancy analysis costs as mechanisms grow: about linear for local loops, in time and memory, and bearable
// for a tangle without any structure. `whole` is everything that `ferrers analyze` answers.

#include <benchmark/benchmark.h>

#include <memory>
#include <string>
#include <utility>

#include "ferrers/redundancy/mechanism_analysis.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_large.h"

namespace {

using namespace ferrers;  // NOLINT(google-build-using-namespace): a program, not a header

std::shared_ptr<const System> built(const ModelSpec& spec) { return make_system(std::move(*build_model(spec).model)); }

void measure_analysis(benchmark::State& run, const ModelSpec& spec) {
  const auto system = built(spec);
  const State state = make_drawn_state(*system);
  int redundant = 0;
  for (auto _ : run) redundant = analyze_redundancy(*system, state).redundant;
  run.counters["bodies"] = system->topology->moving_bodies;
  run.counters["redundant"] = redundant;
  run.counters["us_per_body"] =
      benchmark::Counter(system->topology->moving_bodies * 1e-6,
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void measure_whole(benchmark::State& run, const ModelSpec& spec) {
  const auto system = built(spec);
  for (auto _ : run) benchmark::DoNotOptimize(analyze_mechanism(*system).redundancy->redundant);
  run.counters["bodies"] = system->topology->moving_bodies;
}

}  // namespace

int main(int argc, char** argv) {
  const auto add = [](const std::string& name, const ModelSpec& spec, bool whole) {
    benchmark::RegisterBenchmark(("redundancy/" + name).c_str(), measure_analysis, spec)->Unit(benchmark::kMillisecond);
    if (!whole) return;
    benchmark::RegisterBenchmark(("whole/" + name).c_str(), measure_whole, spec)->Unit(benchmark::kMillisecond);
  };
  add("bricard", witness::make_bricard(witness::BricardRods::kBricks), true);
  for (const int n : {2, 40, 100, 1000, 10000}) {
    add("n_four_bar/" + std::to_string(n), witness::make_n_four_bar(n, 0.3), n <= 1000);
  }
  add("lazy_tongs/1000", witness::make_lazy_tongs(1000), true);
  add("ball_tangle/100_loops", witness::make_ball_tangle(60, 100), true);
  add("spherical_tangle/100_loops", witness::make_spherical_tangle(60, 100), true);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
