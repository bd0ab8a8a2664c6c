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
      "  ferrers inverse examples/two-motors/model.yaml --end 1\n"
      "\nThe drives' 'motion' laws prescribe the motion; laws given twice must agree. Drives without any law help, "
      "those\n"
      "with an 'effort' alone act by it. Where more drives act than the motion needs, the least weighted effort is "
      "taken\n"
      "and what depends on that choice is marked distributed. Writes result.csv, reactions.csv, summary.json and the\n"
      "model.\n"
      "Exit codes: 0 done; 3 the model has errors, or its laws leave a motion free or contradict each other at the\n"
      "start; 4 it cannot be assembled;\n"
      "5 the motion cannot be followed; 130 interrupted.");
  verb->callback([options, &job] { job = [options] { return inverse(*options); }; });
}
