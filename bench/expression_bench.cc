// What formulas cost beside the same numbers written out by hand: mass matrix, forces, constraints, Jacobian and gamma
// of Andrews' squeezer in its seven angles. The figures in math/expression.h are these.

#include <benchmark/benchmark.h>

#include "ferrers/testing/andrews_formulas.h"

namespace {

using namespace ferrers;           // NOLINT(google-build-using-namespace): a program, not a header
using namespace ferrers::witness;  // NOLINT(google-build-using-namespace)

constexpr double kState[] = {-0.06, 0.1, 0.45, 0.22, 0.48, -0.22, 1.23, 3.0, -2.0, 1.5, 0.7, -0.4, 2.2, -1.1};

void measure_by_hand(benchmark::State& run) {
  double inputs[14], outputs[kAndrewsOutputs];
  std::copy(std::begin(kState), std::end(kState), inputs);
  for (auto _ : run) {
    benchmark::DoNotOptimize(inputs);
    compute_andrews_by_hand(inputs, outputs);
    benchmark::DoNotOptimize(outputs);
  }
}

void measure_program(benchmark::State& run, AndrewsEnergy energy) {
  const ExpressionProgram program(andrews_formulas(energy), andrews_inputs());
  double inputs[14], outputs[kAndrewsOutputs];
  std::copy(std::begin(kState), std::end(kState), inputs);
  for (auto _ : run) {
    benchmark::DoNotOptimize(inputs);
    program.evaluate(inputs, outputs);
    benchmark::DoNotOptimize(outputs);
  }
  run.counters["instructions"] = program.instruction_count();
  run.counters["registers"] = program.register_count();
}

// One program per number, as long as a program had one output.
void measure_single_programs(benchmark::State& run, AndrewsEnergy energy) {
  std::vector<ExpressionProgram> programs;
  const std::vector<std::string> names = andrews_inputs();
  for (const Expression& output : andrews_formulas(energy)) programs.emplace_back(output, names);
  double inputs[14], outputs[kAndrewsOutputs];
  std::copy(std::begin(kState), std::end(kState), inputs);
  for (auto _ : run) {
    benchmark::DoNotOptimize(inputs);
    for (std::size_t i = 0; i < programs.size(); ++i) outputs[i] = programs[i].evaluate(inputs);
    benchmark::DoNotOptimize(outputs);
  }
}

void measure_making(benchmark::State& run, AndrewsEnergy energy) {
  for (auto _ : run) benchmark::DoNotOptimize(ExpressionProgram(andrews_formulas(energy), andrews_inputs()));
}

}  // namespace

BENCHMARK(measure_by_hand);
BENCHMARK_CAPTURE(measure_program, angles, AndrewsEnergy::kAngles);
BENCHMARK_CAPTURE(measure_program, centres, AndrewsEnergy::kCentres);
BENCHMARK_CAPTURE(measure_single_programs, angles, AndrewsEnergy::kAngles);
BENCHMARK_CAPTURE(measure_single_programs, centres, AndrewsEnergy::kCentres);
BENCHMARK_CAPTURE(measure_making, angles, AndrewsEnergy::kAngles)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(measure_making, centres, AndrewsEnergy::kCentres)->Unit(benchmark::kMillisecond);
BENCHMARK_MAIN();
