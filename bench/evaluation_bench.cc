// What one evaluation and one decision cost, on mechanisms of examples/. Evaluation must grow with the size of the
// mechanism, not with its square: compare the N-four-bar with 2 and with 40 cells.

#include <benchmark/benchmark.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "ferrers/dynamics/dynamics_model.h"
#include "ferrers/dynamics/equations.h"
#include "ferrers/dynamics/forward.h"
#include "ferrers/io/model_reader.h"
#include "ferrers/kinematics/assembly.h"
#include "ferrers/redundancy/analysis.h"

namespace {

using namespace ferrers;  // NOLINT(google-build-using-namespace): a program, not a header

const char* const kModels[] = {"bricard-a04/model.yaml", "four-bar/model.yaml", "n-four-bar-a02/model.yaml",
                               "n-four-bar-a02/model-n40.yaml"};

struct Assembled {
  std::shared_ptr<const System> system;
  State state;
};

Assembled load(const std::string& name) {
  ModelReadResult read = read_model_file(std::string(FERRERS_SOURCE_DIR) + "/examples/" + name);
  if (!read.model) throw std::runtime_error(name + ": not a valid model");
  Assembled out{.system = make_system(std::move(*read.model)), .state = {}};
  AssemblyResult assembly = assemble(*out.system);
  if (assembly.status != AssemblyStatus::kAssembled) throw std::runtime_error(name + ": " + assembly.message);
  out.state = std::move(assembly.state);
  return out;
}

void measure_equations(benchmark::State& run, const std::string& name) {
  const Assembled mechanism = load(name);
  const auto model = make_dynamics_model(mechanism.system);
  Equations equations = make_equations(*model);
  for (auto _ : run) {
    compute_equations(*model, mechanism.state, equations);
    benchmark::DoNotOptimize(equations.force.data());
  }
}

void measure_forward(benchmark::State& run, const std::string& name, Formulation formulation) {
  const Assembled mechanism = load(name);
  const auto model = make_dynamics_model(mechanism.system);
  Equations equations = make_equations(*model);
  compute_equations(*model, mechanism.state, equations);
  const Selection selection =
      select_independent(*mechanism.system, make_scaling(*mechanism.system), equations.constraints);
  const auto solver = make_forward_solver(formulation, *mechanism.system, selection);
  ForwardResult result = make_forward_result(*mechanism.system);
  for (auto _ : run) {
    solver->solve(equations, result);
    benchmark::DoNotOptimize(result.vdot.data());
  }
}

void measure_decision(benchmark::State& run, const std::string& name) {
  const Assembled mechanism = load(name);
  for (auto _ : run) {
    const RedundancyReport report = analyze_redundancy(*mechanism.system, mechanism.state);
    benchmark::DoNotOptimize(report.rank);
  }
}

}  // namespace

int main(int argc, char** argv) {
  for (const std::string name : kModels) {
    benchmark::RegisterBenchmark(("equations/" + name).c_str(), measure_equations, name);
    for (const Formulation formulation : {Formulation::kNullSpace, Formulation::kElimination}) {
      const std::string title = "forward/" + std::string(to_string(formulation)) + "/" + name;
      benchmark::RegisterBenchmark(title.c_str(), measure_forward, name, formulation);
    }
    benchmark::RegisterBenchmark(("decision/" + name).c_str(), measure_decision, name);
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
