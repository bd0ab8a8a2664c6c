#include <fmt/format.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>
#include <vector>

#include "run_verb.h"
#include "verbs.h"

using namespace ferrers;  // NOLINT(google-build-using-namespace)

namespace {

struct Options {
  RunOptions run;
  SimulationOptions simulation;
};

std::vector<std::string> integrator_names() {
  std::vector<std::string> names;
  for (const Integrator one : {Integrator::kRungeKutta4, Integrator::kConstantAcceleration}) {
    names.emplace_back(to_string(one));
  }
  return names;
}

std::vector<std::string> formulation_names() {
  return {std::string(to_string(Formulation::kNullSpace)), std::string(to_string(Formulation::kElimination))};
}

void add_method_options(CLI::App& verb, Options& options) {
  verb.add_option_function<std::string>(
          "--integrator",
          [&options](const std::string& name) {
            if (const auto found = find_integrator(name)) options.simulation.integrator = *found;
          },
          fmt::format("{} [runge-kutta-4]", fmt::join(integrator_names(), " or ")))
      ->type_name("NAME")
      ->check(one_of(integrator_names()));
  verb.add_option_function<double>(
          "--step", [&options](const double& value) { options.simulation.step = value; }, "fixed step, s")
      ->type_name("DT")
      ->check(positive_number());
  verb.add_option_function<double>(
          "--tolerance", [&options](const double& value) { options.simulation.tolerance = value; },
          "local error per second, of steps that adapt [1e-10]; not with --step")
      ->type_name("TOL")
      ->check(positive_number());
  verb.add_option_function<std::string>(
          "--formulation",
          [&options](const std::string& name) {
            const bool elimination = name == to_string(Formulation::kElimination);
            options.simulation.formulation = elimination ? Formulation::kElimination : Formulation::kNullSpace;
          },
          "null-space, or elimination as in the paper [null-space]")
      ->type_name("NAME")
      ->check(one_of(formulation_names()));
}

int simulate_model(const Options& options) {
  if (options.simulation.step && options.simulation.tolerance) {
    return command_line_error("--step fixes the step, --tolerance adapts it: take one of them");
  }
  RunTask task;
  task.verb = "simulate";
  task.run = [&](auto model, const RunControl& control) {
    SimulationOptions simulation = options.simulation;
    simulation.grid = options.run.grid;
    simulation.axes = options.run.axes;
    simulation.distribution = options.run.distribution;
    return simulate(std::move(model), simulation, control);
  };
  return execute(task, options.run);
}

}  // namespace

void add_simulate(CLI::App& command, Job& job) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = command.add_subcommand("simulate", "forces in, motion and joint reactions out");
  add_run_options(*verb, options->run, true);
  add_method_options(*verb, *options);
  verb->footer(
      "Examples:\n"
      "  ferrers simulate examples/bricard-a04/model.yaml --end 10 -o out/a04\n"
      "  ferrers simulate door.yaml -p width='0.9 m' --every 0.001 --json\n"
      "  ferrers simulate door.yaml --distribute equal --stiffness-range 0.5:2\n"
      "  ferrers simulate door.yaml --integrator constant-acceleration --step 0.0005\n"
      "\nWrites result.csv, reactions.csv, summary.json and the model file as run. Ctrl-C keeps what is done.\n"
      "Exit codes: 0 done; 3 the model has errors; 4 it cannot be assembled; 5 the integration failed; 130 "
      "interrupted.");
  verb->callback([options, &job] { job = [options] { return simulate_model(*options); }; });
}
