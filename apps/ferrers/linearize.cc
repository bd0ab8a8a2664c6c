#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <memory>

#include "exit_code.h"
#include "ferrers/dynamics/equilibrium.h"
#include "rest_input.h"
#include "rest_text.h"
#include "verbs.h"

using namespace ferrers;  // NOLINT(google-build-using-namespace)

namespace {

struct Options {
  ModelOptions model;
  bool at_equilibrium = false;
};

void tell(const Options& options, const RestStart& start, const Linearization* linear) {
  LinearizationDocument document;
  if (start.loaded.model) document.model = start.loaded.model->name();
  document.at_equilibrium = options.at_equilibrium;
  document.dynamics = start.dynamics.get();
  document.linear = linear;
  document.diagnostics = &start.loaded.diagnostics;
  if (options.model.json) {
    print(stdout, write_linearization_json(document));
  } else if (linear != nullptr && linear->status == LinearizationStatus::kDone) {
    print(stdout, linearization_text(document, Style(stdout)));
  }
}

int run(const Options& options) {
  RestStart start = load_at_rest(options.model);
  if (start.exit_code != kExitDone) {
    tell(options, start, nullptr);
    return start.exit_code;
  }
  if (const std::string error = write_model_if_asked(options.model, start.loaded); !error.empty()) {
    return command_line_error(error);
  }
  if (options.at_equilibrium) {
    const EquilibriumResult rest = solve_equilibrium(*start.dynamics, start.state);
    if (rest.status != EquilibriumStatus::kFound) {
      report(start.loaded, "F512", {}, rest.message, "without --at-equilibrium the initial state is taken");
      tell(options, start, nullptr);
      return kExitSolve;
    }
    start.state = rest.state;
  }
  const Linearization linear = linearize(*start.dynamics, start.state);
  if (linear.status != LinearizationStatus::kDone) {
    const bool unsupported = linear.status == LinearizationStatus::kUnsupported;
    const bool massless = linear.status == LinearizationStatus::kSingularMass;
    report(start.loaded,
           unsupported ? "F509"
           : massless  ? "F505"
                       : "F514",
           {}, linear.message,
           unsupported ? ""
           : massless  ? "give what moves there a mass"
                       : "take a pose beside it in 'initial'");
  }
  tell(options, start, &linear);
  return linear.status == LinearizationStatus::kDone ? kExitDone : kExitSolve;
}

}  // namespace

void add_linearize(CLI::App& command, Job& job) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = command.add_subcommand("linearize", "linear system, natural frequencies, damping and modes");
  add_model_options(*verb, options->model);
  verb->add_flag("--at-equilibrium", options->at_equilibrium,
                 "about the equilibrium that is found from the initial pose, not about the initial state");
  verb->footer(
      "Examples:\n"
      "  ferrers linearize examples/pendulum-a01/model.yaml --at-equilibrium\n"
      "  ferrers linearize lift.yaml -p stiffness='20 kN/m' --json\n"
      "\nStates are the independent coordinates and their velocities, inputs the efforts of the drives.\n"
      "Exit codes: 0 done; 3 the model has errors; 4 it cannot be assembled; 5 no equilibrium, or a singular pose.");
  verb->callback([options, &job] { job = [options] { return run(*options); }; });
}
