// Accelerations at thousands of states: one after another, four in lanes, and shared by threads. Items are states.

#include <benchmark/benchmark.h>

#include <string>

#include "ferrers/dynamics/forward_batch.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/zoo.h"

namespace {

using namespace ferrers;           // NOLINT(google-build-using-namespace): a program, not a header
using namespace ferrers::witness;  // NOLINT(google-build-using-namespace)

constexpr long kStates = 16384;

struct Subject {
  EngineProbe engine;
  std::vector<State> some;
  ForwardBatch::States states;

  explicit Subject(const ModelSpec& spec) : engine(spec) {
    for (int i = 0; i < 16; ++i) some.push_back(engine.wandered(i, 0.1));
    states.q.resize(kStates, engine.system->nq);
    states.v.resize(kStates, engine.system->nv);
    for (long i = 0; i < kStates; ++i) {
      states.q.row(i) = some[static_cast<std::size_t>(i % 16)].q;
      states.v.row(i) = some[static_cast<std::size_t>(i % 16)].v;
    }
  }
};

void measure_one_by_one(benchmark::State& run, const ModelSpec& spec) {
  const Subject subject(spec);
  ForwardDynamics dynamics(subject.engine.dynamics, subject.some.front());
  std::size_t i = 0;
  for (auto _ : run) {
    dynamics.evaluate(subject.some[i++ % 16]);
    benchmark::DoNotOptimize(dynamics.result().vdot.data());
  }
  run.SetItemsProcessed(run.iterations());
}

void measure_batch(benchmark::State& run, const ModelSpec& spec, int threads) {
  const Subject subject(spec);
  ForwardBatch batch(subject.engine.dynamics, subject.some.front(), threads);
  ForwardBatch::Results results;
  for (auto _ : run) {
    batch.evaluate(subject.states, results);
    benchmark::DoNotOptimize(results.vdot.data());
  }
  run.SetItemsProcessed(run.iterations() * kStates);
  run.counters["lanes"] = batch.is_in_lanes() ? 4 : 1;
}

void add(const std::string& name, const ModelSpec& spec) {
  benchmark::RegisterBenchmark(("one/" + name).c_str(), measure_one_by_one, spec);
  benchmark::RegisterBenchmark(("batch/" + name).c_str(), measure_batch, spec, 1)->UseRealTime();
  benchmark::RegisterBenchmark(("batch_2_threads/" + name).c_str(), measure_batch, spec, 2)->UseRealTime();
}

}  // namespace

int main(int argc, char** argv) {
  add("bricard_a04", make_bricard(BricardRods::kBricks));
  add("four_bar", make_four_bar(FourBarJoints::kRevolute));
  add("three_cranks", make_parallel_cranks());
  add("andrews_a03", make_andrews());
  add("n_four_bar_a02/10", make_n_four_bar(10, 0.3));
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
