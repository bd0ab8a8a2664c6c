#include <fmt/format.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <memory>

#include "analysis_text.h"
#include "exit_code.h"
#include "ferrers/io/json_report.h"
#include "ferrers/io/model_writer.h"
#include "ferrers/io/run_folder.h"
#include "model_input.h"
#include "terminal.h"
#include "verbs.h"

using namespace ferrers;  // NOLINT(google-build-using-namespace)

namespace {

void print_json(const LoadedModel& loaded, const MechanismAnalysis* analysis) {
  AnalysisDocument document;
  if (loaded.model) {
    document.model = loaded.model->name();
    document.bodies = &loaded.model->bodies();
  }
  document.analysis = analysis;
  document.geometry = loaded.geometry ? &*loaded.geometry : nullptr;
  document.diagnostics = &loaded.diagnostics;
  print(stdout, write_analysis_json(document));
}

struct AnalyzeOptions : ModelOptions {
  int apply_release = 0;  ///< 1 is the first suggestion; 0: not asked for.
};

/// Does `--apply-release`. Returns what went wrong, or an empty text.
std::string write_released_model(const AnalyzeOptions& options, const LoadedModel& loaded,
                                 const std::vector<Release>& releases) {
  const int count = static_cast<int>(releases.size());
  if (options.apply_release > count) {
    return count == 0 ? "there is no release to apply"
                      : fmt::format("there is no release {}: {} suggested", options.apply_release,
                                    count == 1 ? std::string("one is") : fmt::format("{} are", count));
  }
  const Release& release = releases[static_cast<std::size_t>(options.apply_release - 1)];
  const JointChangeResult changed = apply_release(edited_spec(options, loaded), release);
  if (!changed.spec) return changed.reason;
  if (std::string error = write_file_whole(options.write_model, write_model(*changed.spec)); !error.empty()) {
    return error;
  }
  print(stderr, fmt::format("ferrers: wrote '{}': {}\n", options.write_model, release.says));
  for (const std::string& note : changed.notes) print(stderr, fmt::format("ferrers: {}\n", note));
  return "";
}

int analyze(const AnalyzeOptions& options) {
  if (options.apply_release > 0 && options.write_model.empty()) {
    return command_line_error("'--apply-release' needs '--write-model FILE' to write the changed model to");
  }
  LoadedModel loaded = load_model_as_written(options);
  make_geometry_consistent(options, loaded);
  if (!loaded.model) {
    if (options.json) print_json(loaded, nullptr);
    return kExitModel;
  }
  if (options.apply_release == 0) {
    if (const std::string error = write_model_if_asked(options, loaded); !error.empty()) {
      return command_line_error(error);
    }
  }
  const MechanismAnalysis analysis = analyze_mechanism(*make_system(loaded.model));
  if (!analysis.is_assembled()) {
    report_open(loaded, analysis.assembly, analysis.closure);
    if (options.json) print_json(loaded, &analysis);
    return kExitNotAssembled;
  }
  if (options.apply_release > 0) {
    const std::string error = write_released_model(options, loaded, analysis.releases->releases);
    if (!error.empty()) return command_line_error(error);
  }
  if (analysis.rate_conflict) {
    report(loaded, "F503", {}, rate_conflict_message(*analysis.rate_conflict),
           "leave one of them out, or let them ask for the same velocities");
  }
  if (options.json) {
    print_json(loaded, &analysis);
  } else {
    print(stdout, analysis_text(*loaded.model, analysis, loaded.geometry ? &*loaded.geometry : nullptr, Style(stdout)));
  }
  return analysis.rate_conflict ? kExitNotAssembled : kExitDone;
}

}  // namespace

void add_analyze(CLI::App& command, Job& job) {
  auto options = std::make_shared<AnalyzeOptions>();
  CLI::App* verb =
      command.add_subcommand("analyze", "redundant constraints: how many, which joints, since when, what of it");
  add_model_options(*verb, *options);
  verb->add_option("--apply-release", options->apply_release,
                   "write the model with this suggestion's joint changes (1: the first) to --write-model")
      ->type_name("N")
      ->check(CLI::PositiveNumber);
  verb->footer(
      "Examples:\n"
      "  ferrers analyze examples/bricard-a04/model.yaml\n"
      "  ferrers analyze press.yaml -p length='120 mm' --json\n"
      "  ferrers analyze press.yaml --apply-release 1 --write-model press-released.yaml\n"
      "\nExit codes: 0 done; 3 the model has errors; 4 it cannot be assembled. A doubtful rank is said, and is 0.");
  verb->callback([options, &job] { job = [options] { return analyze(*options); }; });
}
