#include <fmt/format.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <filesystem>
#include <memory>

#include "ferrers/io/run_restart.h"
#include "method_options.h"
#include "run_verb.h"
#include "verbs.h"

using namespace ferrers;  // NOLINT(google-build-using-namespace)

namespace {

struct Options {
  RunOptions run;
  SimulationOptions simulation;
  std::string restart;
  bool quick = false;
};

int simulate_model(const Options& options) {
  if (const std::string fault = find_fault(options.simulation); !fault.empty()) return command_line_error(fault);
  if (!options.restart.empty()) {
    std::error_code ignored;
    if (std::filesystem::equivalent(options.restart, options.run.folder, ignored)) {
      return command_line_error("--restart and -o name the same folder: take another -o");
    }
  }
  RunTask task;
  task.verb = "simulate";
  task.run = [&](auto model, const RunControl& control) {
    SimulationOptions simulation = options.simulation;
    simulation.grid = options.run.grid;
    simulation.axes = options.run.axes;
    simulation.distribution = options.run.distribution;
    simulation.estimate_error = !options.quick;
    if (!options.restart.empty()) {
      RestartResult restart = read_restart(*model->system, options.restart);
      if (!restart.state) {
        RunSummary summary;
        summary.status = RunStatus::kUnsupported;
        summary.message = "--restart: " + restart.error;
        return summary;
      }
      simulation.start = std::move(restart.state);
      simulation.drives_off = std::move(restart.drives_off);
      simulation.events_acted = std::move(restart.events_acted);
    }
    return simulate(std::move(model), simulation, control);
  };
  return execute(task, options.run);
}

}  // namespace

void add_simulate(CLI::App& command, Job& job) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = command.add_subcommand("simulate", "forces in, motion and joint reactions out");
  add_run_options(*verb, options->run, true);
  add_method_options(*verb, options->simulation);
  verb->add_option("--restart", options->restart, "go on from where the run in this folder ended")->type_name("FOLDER");
  verb->add_flag("--quick", options->quick, "without the second run that estimates the error");
  verb->footer(
      "Examples:\n"
      "  ferrers simulate examples/bricard-a04/model.yaml --end 10 -o out/a04\n"
      "  ferrers simulate door.yaml -p width='0.9 m' --every 0.001 --json\n"
      "  ferrers simulate door.yaml --distribute equal --stiffness-range 0.5:2\n"
      "  ferrers simulate press.yaml --driven --end 5 -o out/a; ferrers simulate press.yaml --driven --restart out/a\n"
      "  ferrers simulate door.yaml --integrator constant-acceleration --step 0.0005\n"
      "\nWrites result.csv, reactions.csv, summary.json and the model file as run. Ctrl-C keeps what is done.\n"
      "Exit codes: 0 done; 3 the model has errors; 4 it cannot be assembled; 5 the integration failed; 130 "
      "interrupted.");
  verb->callback([options, &job] { job = [options] { return simulate_model(*options); }; });
}
