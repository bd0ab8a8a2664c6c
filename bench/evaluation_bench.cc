// What one evaluation of forward dynamics with multipliers costs, formulation by formulation, as mechanisms grow: the
// equations must grow with the size of the mechanism, not with its square, and so must the sparse form. The figures in
// dynamics/forward.h are these.

#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "ferrers/dynamics/forward_dynamics.h"
#include "ferrers/redundancy/selection.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/zoo.h"

namespace {

using namespace ferrers;           // NOLINT(google-build-using-namespace): a program, not a header
using namespace ferrers::witness;  // NOLINT(google-build-using-namespace)

constexpr int kLargestDense = 100;  // coordinates up to which a selection is pivoted as a whole

struct Subject {
  EngineProbe engine;
  State state;

  explicit Subject(const ModelSpec& spec) : engine(spec) {
    if (engine.system->nv <= kLargestDense) {
      state = engine.wandered(1, 0.1);
      return;
    }
    state = engine.start();
    const ConstraintBlocks blocks = compute_constraint_blocks(*engine.system, state);
    engine.selection =
        select_rows_and_coordinates(*engine.system, decide_clusters(*engine.system, engine.scaling, blocks));
    compute_equations(*engine.dynamics, state, engine.eq);
  }
};

void measure_equations(benchmark::State& run, const ModelSpec& spec) {
  Subject subject(spec);
  for (auto _ : run) {
    compute_equations(*subject.engine.dynamics, subject.state, subject.engine.eq);
    benchmark::DoNotOptimize(subject.engine.eq.force.data());
  }
  run.counters["coordinates"] = subject.engine.system->nv;
  run.counters["rows"] = subject.engine.system->m;
}

// In the order that suits the last equations.
SparseKkt chosen_order(const EngineProbe& engine) {
  KktStructure structure = make_kkt_structure(*engine.system, engine.selection.rows);
  take_values(engine.selection.rows, engine.eq.constraints.G, structure);
  return {structure, engine.selection.rows, engine.scaling.columns};
}

// Equations and solution as one piece of native code.
void measure_program(benchmark::State& run, const ModelSpec& spec) {
  Subject subject(spec);
  EngineProbe& engine = subject.engine;
  const SparseKkt kkt = chosen_order(engine);
  const ForwardProgram program(*engine.dynamics, kkt, ForwardProgram::Extent::kAccelerations);
  if (!program.is_native()) return run.SkipWithError("no native code on this processor");
  Kernel::Board board = program.make_board();
  ForwardResult result = make_forward_result(engine.eq);
  const VectorXd applied = VectorXd::Zero(engine.system->nv);
  ForwardProgram::Watched watched;
  ForwardStatus status = ForwardStatus::kSolved;
  for (auto _ : run) {
    status = program.evaluate(subject.state, applied, board, result, watched);
    benchmark::DoNotOptimize(result.lambda.data());
    benchmark::DoNotOptimize(result.vdot.data());
  }
  if (status != ForwardStatus::kSolved) run.SkipWithError("not solved");
  run.counters["bytes"] = static_cast<double>(program.code_bytes());
  run.counters["shared"] = program.shared_part();
}

// What writing such a program costs.
void measure_compilation(benchmark::State& run, const ModelSpec& spec) {
  Subject subject(spec);
  EngineProbe& engine = subject.engine;
  const SparseKkt kkt = chosen_order(engine);
  for (auto _ : run) {
    const ForwardProgram program(*engine.dynamics, kkt, ForwardProgram::Extent::kAccelerations);
    benchmark::DoNotOptimize(program.code_bytes());
  }
}

// `whole`: the equations too.
void measure_solution(benchmark::State& run, const ModelSpec& spec, Formulation formulation, bool whole) {
  Subject subject(spec);
  EngineProbe& engine = subject.engine;
  const auto solver = make_forward_solver(formulation, *engine.system, engine.selection);
  ForwardResult result = make_forward_result(engine.eq);
  for (auto _ : run) {
    if (whole) compute_equations(*engine.dynamics, subject.state, engine.eq);
    solver->solve(engine.eq, result);
    benchmark::DoNotOptimize(result.lambda.data());
    benchmark::DoNotOptimize(result.vdot.data());
  }
  if (result.status != ForwardStatus::kSolved) run.SkipWithError("not solved");
}

void measure_resolution(benchmark::State& run, const ModelSpec& spec, Formulation formulation) {
  Subject subject(spec);
  EngineProbe& engine = subject.engine;
  const auto solver = make_forward_solver(formulation, *engine.system, engine.selection);
  ForwardResult result = make_forward_result(engine.eq);
  solver->solve(engine.eq, result);
  for (auto _ : run) {
    solver->resolve(engine.eq.force, engine.eq.constraints.gamma, result);
    benchmark::DoNotOptimize(result.vdot.data());
  }
}

// As it is used: for states that come one by one.
void measure_growth(benchmark::State& run, const ModelSpec& spec) {
  const EngineProbe engine(spec);
  const State state = engine.start();
  ForwardDynamics dynamics(engine.dynamics, state);
  for (auto _ : run) {
    dynamics.evaluate(state);
    benchmark::DoNotOptimize(dynamics.result().vdot.data());
  }
  if (dynamics.result().status != ForwardStatus::kSolved) run.SkipWithError("not solved");
  run.counters["coordinates"] = engine.system->nv;
}

// Those that suit: dense ones take minutes where there are a thousand coordinates.
std::vector<Formulation> all_formulations() { return {kFormulations.begin(), kFormulations.end()}; }

void add(const std::string& name, const ModelSpec& spec,
         const std::vector<Formulation>& formulations = all_formulations()) {
  const auto in_microseconds = [](auto* registered) { registered->Unit(benchmark::kMicrosecond); };
  in_microseconds(benchmark::RegisterBenchmark(("equations/" + name).c_str(), measure_equations, spec));
  in_microseconds(benchmark::RegisterBenchmark(("program/" + name).c_str(), measure_program, spec));
  in_microseconds(benchmark::RegisterBenchmark(("compile/" + name).c_str(), measure_compilation, spec));
  for (const Formulation f : formulations) {
    const std::string title = std::string(to_string(f)) + "/" + name;
    in_microseconds(benchmark::RegisterBenchmark(("solve/" + title).c_str(), measure_solution, spec, f, false));
    in_microseconds(benchmark::RegisterBenchmark(("resolve/" + title).c_str(), measure_resolution, spec, f));
    in_microseconds(benchmark::RegisterBenchmark(("whole/" + title).c_str(), measure_solution, spec, f, true));
  }
}

}  // namespace

int main(int argc, char** argv) {
  add("bricard_a04", make_bricard(BricardRods::kBricks));
  add("four_bar", make_four_bar(FourBarJoints::kRevolute));
  add("three_cranks", make_parallel_cranks());
  add("andrews_a03", make_andrews());
  for (const int n : {1, 2, 10, 40, 100, 300}) add("n_four_bar_a02/" + std::to_string(n), make_n_four_bar(n, 0.3));
  add("n_four_bar_a02/1000", make_n_four_bar(1000, 0.3), {Formulation::kSparse});
  for (const int n : {100, 1000, 10000}) {
    const std::string name = "forward_dynamics/n_four_bar_a02/" + std::to_string(n);
    benchmark::RegisterBenchmark(name.c_str(), measure_growth, make_n_four_bar(n, 0.3))->Unit(benchmark::kMicrosecond);
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
