// What derivatives made by the engine cost against those written by hand: phi, G, gamma, M and all forces of Andrews'
// squeezer in its seven angles, from the formulas of a model file and in hand-written C++, without the solution; then
// with it, and the same mechanism as bodies and spatial joints.

#include <benchmark/benchmark.h>

#include <algorithm>

#include "ferrers/io/model_reader.h"
#include "ferrers/redundancy/selection.h"
#include "ferrers/testing/andrews_formulas.h"
#include "ferrers/testing/engine_probe.h"

namespace {

using namespace ferrers;           // NOLINT(google-build-using-namespace): a program, not a header
using namespace ferrers::witness;  // NOLINT(google-build-using-namespace)

ModelSpec example(const char* name) {
  return read_model_file(std::string(FERRERS_SOURCE_DIR) + "/examples/" + name + "/model.yaml").spec;
}

State moving(const EngineProbe& engine) {
  State state = engine.start();
  for (int i = 0; i < state.v.size(); ++i) state.v[i] = 1 + 0.3 * i;
  return state;
}

void by_hand(benchmark::State& run) {
  const EngineProbe engine(example("andrews-angles"));
  const State state = moving(engine);
  double inputs[2 * kAndrewsCoordinates], outputs[kAndrewsOutputs];
  std::copy_n(state.q.data(), kAndrewsCoordinates, inputs);
  std::copy_n(state.v.data(), kAndrewsCoordinates, inputs + kAndrewsCoordinates);
  for (auto _ : run) {
    compute_andrews_by_hand(inputs, outputs);
    benchmark::DoNotOptimize(outputs);
  }
}

void by_engine(benchmark::State& run, const char* model) {
  EngineProbe engine(example(model));
  const State state = moving(engine);
  for (auto _ : run) {
    compute_equations(*engine.dynamics, state, engine.eq);
    benchmark::DoNotOptimize(engine.eq.force.data());
  }
}

void with_solution(benchmark::State& run, const char* model) {
  EngineProbe engine(example(model));
  const State state = engine.start();
  engine.evaluate(state);
  const auto solver = make_forward_solver(recommended_formulation(), *engine.system, engine.selection);
  ForwardResult result = make_forward_result(engine.eq);
  for (auto _ : run) {
    compute_equations(*engine.dynamics, state, engine.eq);
    solver->solve(engine.eq, result);
    benchmark::DoNotOptimize(result.vdot.data());
  }
}

}  // namespace

BENCHMARK(by_hand)->Name("andrews_equations/by_hand");
BENCHMARK_CAPTURE(by_engine, angles, "andrews-angles")->Name("andrews_equations/formulas");
BENCHMARK_CAPTURE(by_engine, bodies, "andrews-a03")->Name("andrews_equations/bodies");
BENCHMARK_CAPTURE(with_solution, angles, "andrews-angles")->Name("andrews_with_solution/formulas");
BENCHMARK_CAPTURE(with_solution, bodies, "andrews-a03")->Name("andrews_with_solution/bodies");

BENCHMARK_MAIN();
