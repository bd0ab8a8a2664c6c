#include <fmt/format.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <memory>
#include <optional>

#include "exit_code.h"
#include "ferrers/dynamics/initial_pose.h"
#include "ferrers/io/model_writer.h"
#include "ferrers/io/run_folder.h"
#include "rest_input.h"
#include "rest_text.h"
#include "run_verb.h"
#include "verbs.h"

using namespace ferrers;  // NOLINT(google-build-using-namespace)

namespace {

struct Options {
  ModelOptions model;
  bool hold = false;
  double t = 0;
  ReactionAxes axes = ReactionAxes::kWorld;
  DistributionOptions distribution;
};

/// Everything that was found, until it is told.
struct Rest {
  std::optional<EquilibriumResult> equilibrium;
  std::optional<HoldingResult> holding;
  std::optional<std::vector<JointReaction>> reactions;
};

void tell(const Options& options, const RestStart& start, const Rest& rest, bool done) {
  RestDocument document;
  if (start.loaded.model) document.model = start.loaded.model->name();
  document.dynamics = start.dynamics.get();
  if (rest.equilibrium) document.equilibrium = &*rest.equilibrium;
  if (rest.holding) document.holding = &*rest.holding;
  if (rest.reactions) document.reactions = &*rest.reactions;
  document.diagnostics = &start.loaded.diagnostics;
  if (options.model.json) {
    print(stdout, write_rest_json(document));
  } else if (done) {
    print(stdout, rest_text(document, Style(stdout)));
  }
}

/// Does `--write-model`: the model with the pose that was found as its initial one.
std::string write_pose(const Options& options, const RestStart& start, const State& state) {
  const ModelSpec spec = with_initial_pose(edited_spec(options.model, start.loaded), *start.dynamics->system, state);
  return write_file_whole(options.model.write_model, write_model(spec));
}

int find(const Options& options, RestStart& start) {
  Rest rest;
  EquilibriumOptions search;
  search.t = options.t;
  rest.equilibrium = solve_equilibrium(*start.dynamics, start.state, search);
  const bool found = rest.equilibrium->status == EquilibriumStatus::kFound;
  if (found) {
    rest.reactions = compute_rest_reactions(start.dynamics, *rest.equilibrium, options.axes, options.distribution);
    if (!options.model.write_model.empty()) {
      if (const std::string error = write_pose(options, start, rest.equilibrium->state); !error.empty()) {
        return command_line_error(error);
      }
    }
  } else {
    const bool unsupported = rest.equilibrium->status == EquilibriumStatus::kUnsupported;
    report(start.loaded, unsupported ? "F509" : "F512", {}, rest.equilibrium->message,
           unsupported
               ? ""
               : "what nothing holds needs a spring, a stop or a drive; or start elsewhere with 'initial' positions");
  }
  tell(options, start, rest, found);
  return found ? kExitDone : kExitSolve;
}

int hold(const Options& options, RestStart& start) {
  if (const std::string error = write_model_if_asked(options.model, start.loaded); !error.empty()) {
    return command_line_error(error);
  }
  Rest rest;
  rest.holding = solve_holding_efforts(*start.dynamics, start.state, options.t);
  const bool held = rest.holding->status == HoldingStatus::kHeld;
  if (held) {
    rest.reactions = compute_rest_reactions(start.dynamics, *rest.holding, options.axes, options.distribution);
  } else {
    report(start.loaded, "F513", {}, rest.holding->message, "give a drive to what moves");
  }
  tell(options, start, rest, held);
  return held ? kExitDone : kExitSolve;
}

int run(const Options& options) {
  RestStart start = load_at_rest(options.model, options.t);
  if (start.exit_code != kExitDone) {
    tell(options, start, {}, false);
    return start.exit_code;
  }
  return options.hold ? hold(options, start) : find(options, start);
}

}  // namespace

void add_equilibrium(CLI::App& command, Job& job) {
  auto options = std::make_shared<Options>();
  CLI::App* verb =
      command.add_subcommand("equilibrium", "where it comes to rest under its loads; efforts that hold it");
  add_model_options(*verb, options->model);
  verb->add_flag("--hold", options->hold, "keep the initial pose, and tell the efforts of the drives that hold it");
  verb->add_option("--time", options->t, "time at which loads and effort laws are taken, s [0]")
      ->type_name("T")
      ->check(number_from_zero());
  add_reaction_options(*verb, options->axes, options->distribution);
  verb->footer(
      "Examples:\n"
      "  ferrers equilibrium examples/pendulum-a01/model.yaml\n"
      "  ferrers equilibrium lift.yaml --write-model lift-at-rest.yaml\n"
      "  ferrers equilibrium examples/scissor-lift/model.yaml --hold --json\n"
      "\nThe search starts at the initial pose and goes downhill. --write-model writes the model with the pose found.\n"
      "With --hold all drives hold but those that have an effort law and no motion; if that leaves none, all.\n"
      "Exit codes: 0 done; 3 the model has errors; 4 it cannot be assembled; 5 no equilibrium, or not held.");
  verb->callback([options, &job] { job = [options] { return run(*options); }; });
}
