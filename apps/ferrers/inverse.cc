#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>

#include "run_verb.h"
#include "verbs.h"

using namespace ferrers;  // NOLINT(google-build-using-namespace)

namespace {

int inverse(const RunOptions& options) {
  RunTask task;
  task.verb = "inverse";
  task.run = [&](auto model, const RunControl& control) {
    PrescribedOptions prescribed;
    prescribed.grid = options.grid;
    prescribed.axes = options.axes;
    prescribed.distribution = options.distribution;
    return run_prescribed(std::move(model), prescribed, control);
  };
  return execute(task, options);
}

}  // namespace

void add_inverse(CLI::App& command, Job& job) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* verb = command.add_subcommand("inverse", "prescribed motion in, drive forces and joint reactions out");
  add_run_options(*verb, *options, true);
  verb->footer(
      "Examples:\n"
      "  ferrers inverse examples/four-bar-driven/model.yaml -o out/four-bar\n"
      "  ferrers inverse lift.yaml --end 1 --every 0.001 --reactions joint\n"
      "  ferrers inverse door.yaml --distribute equal --stiffness-range 0.5:2\n"
      "\nThe drives' 'motion' laws prescribe the motion. Writes result.csv, reactions.csv, summary.json and the "
      "model.\n"
      "Exit codes: 0 done; 3 the model has errors, or prescribes too little or too much; 4 it cannot be assembled;\n"
      "5 the motion cannot be followed; 130 interrupted.");
  verb->callback([options, &job] { job = [options] { return inverse(*options); }; });
}
