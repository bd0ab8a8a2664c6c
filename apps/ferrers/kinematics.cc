#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>

#include "run_verb.h"
#include "verbs.h"

using namespace ferrers;  // NOLINT(google-build-using-namespace)

namespace {

int kinematics(const RunOptions& options) {
  RunTask task;
  task.verb = "kinematics";
  task.needs_masses = false;
  task.with_reactions = false;
  task.run = [&](auto model, const RunControl& control) {
    PrescribedOptions prescribed;
    prescribed.grid = options.grid;
    prescribed.with_efforts = false;
    return run_prescribed(std::move(model), prescribed, control);
  };
  return execute(task, options);
}

}  // namespace

void add_kinematics(CLI::App& command, Job& job) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* verb = command.add_subcommand("kinematics", "prescribed motion in, positions to accelerations out");
  add_run_options(*verb, *options, false);
  verb->footer(
      "Examples:\n"
      "  ferrers kinematics examples/four-bar-driven/model.yaml -o out/four-bar\n"
      "\nThe drives' 'motion' laws prescribe the motion; masses are not needed. Writes result.csv, summary.json and "
      "the\n"
      "model. Exit codes: as of 'inverse'.");
  verb->callback([options, &job] { job = [options] { return kinematics(*options); }; });
}
