#include <fmt/format.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include "equations_text.h"
#include "exit_code.h"
#include "ferrers/io/run_folder.h"
#include "ferrers/io/run_restart.h"
#include "rest_input.h"
#include "run_verb.h"
#include "verbs.h"

using namespace ferrers;  // NOLINT(google-build-using-namespace)

namespace {

struct Options {
  ModelOptions model;
  bool inverse = false;
  std::optional<double> t;
  std::string run;    ///< Folder of a run whose state is taken.
  std::string latex;  ///< "document", "fragment", or empty: not asked for.
  std::string file;   ///< Empty: stdout.
};

/// Prints or writes the result. Returns what went wrong, or an empty text.
std::string tell(const Options& options, const RestStart& start, const EquationsReport* report) {
  EquationsDocument document;
  if (start.loaded.model) document.model = start.loaded.model->name();
  document.dynamics = start.dynamics.get();
  document.report = report;
  document.diagnostics = &start.loaded.diagnostics;
  std::string text;
  if (options.model.json) {
    text = write_equations_json(document);
  } else if (report == nullptr || !report->has_equations) {
    return "";
  } else if (!options.latex.empty()) {
    text = write_equations_latex(document, options.latex == "document");
  } else {
    text = equations_text(document, options.file.empty() ? Style(stdout) : Style::plain());
  }
  if (!options.file.empty()) return write_file_whole(options.file, text);
  print(stdout, text);
  return "";
}

/// Takes the state from the run's folder. False: it cannot be; reported.
bool take_stored_state(const Options& options, RestStart& start) {
  const System& system = *start.dynamics->system;
  const RestartResult stored =
      options.t ? read_stored_state(system, options.run, *options.t) : read_restart(system, options.run);
  if (!stored.state) {
    report(start.loaded, "F509", {}, "--state: " + stored.error, "give the folder of a run of this model");
    return false;
  }
  start.state = *stored.state;
  return true;
}

int conclude(const EquationsReport& found, LoadedModel& loaded) {
  switch (found.status) {
    case EquationsStatus::kSolved:
      return kExitDone;
    case EquationsStatus::kBadMotion:
      report(loaded, "F508", {}, found.message, "without --inverse the efforts are taken by their laws");
      return kExitModel;
    case EquationsStatus::kSingularMass:
      report(loaded, "F505", {}, found.message, "give what moves there a mass");
      return kExitSolve;
    case EquationsStatus::kUndeterminedFriction:
      report(loaded, "F509", {}, found.message, "give the joints a 'stiffness', or leave their friction out");
      return kExitModel;
    default:
      report(loaded, "F506", {}, found.message, "take a state beside it");
      return kExitSolve;
  }
}

int run(const Options& options) {
  if (!options.latex.empty() && options.latex != "document" && options.latex != "fragment") {
    return command_line_error(fmt::format("--latex={}: it is --latex or --latex=fragment", options.latex));
  }
  if (!options.latex.empty() && options.model.json) return command_line_error("--latex and --json: take one of them");
  RestStart start = load_at_rest(options.model, options.run.empty() ? options.t.value_or(0) : 0);
  if (start.exit_code == kExitDone && !options.run.empty() && !take_stored_state(options, start)) {
    start.exit_code = kExitModel;
  }
  if (start.exit_code != kExitDone) {
    tell(options, start, nullptr);
    return start.exit_code;
  }
  if (const std::string error = write_model_if_asked(options.model, start.loaded); !error.empty()) {
    return command_line_error(error);
  }
  EquationsReport found = analyze_equations(start.dynamics, start.state,
                                            options.inverse ? EquationsProblem::kInverse : EquationsProblem::kForward);
  if (!options.run.empty() && !start.dynamics->events.empty()) {
    found.notices.emplace_back("drives act as if no event of the run had switched them");
  }
  const int exit_code = conclude(found, start.loaded);
  if (const std::string error = tell(options, start, &found); !error.empty()) return command_line_error(error);
  return exit_code;
}

}  // namespace

void add_equations(CLI::App& command, Job& job) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = command.add_subcommand("equations", "the equations (6)-(9) at a state, with their solution");
  add_model_options(*verb, options->model);
  verb->add_flag("--inverse", options->inverse,
                 "motions by the drives' laws, efforts and multipliers wanted (else efforts by their laws)");
  verb->add_option("--at", options->t, "time at which laws are taken, s [0]; with --state, of the row")
      ->type_name("T")
      ->check(number_from_zero());
  verb->add_option("--state", options->run,
                   "take the state from the run in this folder, the stored row nearest to --at [the last]")
      ->type_name("FOLDER");
  verb->add_flag("--latex{document}", options->latex, "a LaTeX document; --latex=fragment: only its body");
  verb->add_option("-o", options->file, "write to this file instead of stdout")->type_name("FILE");
  verb->footer(
      "Examples:\n"
      "  ferrers equations examples/three-cranks/model.yaml\n"
      "  ferrers equations examples/four-bar-driven/model.yaml --inverse --at 0.5\n"
      "  ferrers equations press.yaml --state out/press-simulate --at 1.25 --json\n"
      "\nThe state is the initial one, assembled. A multiplier that rigid bodies do not determine is '?', null in "
      "JSON.\n"
      "Exit codes: 0 done; 3 the model has errors, or lacks motions; 4 it cannot be assembled; 5 no solution.");
  verb->callback([options, &job] { job = [options] { return run(*options); }; });
}
