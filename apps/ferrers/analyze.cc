#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <memory>

#include "analysis_text.h"
#include "exit_code.h"
#include "ferrers/io/json_report.h"
#include "model_input.h"
#include "terminal.h"
#include "verbs.h"

using namespace ferrers;  // NOLINT(google-build-using-namespace)

namespace {

void print_json(const LoadedModel& loaded, const RedundancyReport* result,
                const PermanenceReport* permanence = nullptr) {
  AnalysisDocument document;
  if (loaded.model) document.model = loaded.model->name();
  document.report = result;
  document.permanence = permanence;
  document.diagnostics = &loaded.diagnostics;
  print(stdout, write_analysis_json(document));
}

int analyze(const ModelOptions& options) {
  LoadedModel loaded = load_model(options);
  if (!loaded.model) {
    if (options.json) print_json(loaded, nullptr);
    return kExitModel;
  }
  if (const std::string error = write_model_if_asked(options, loaded); !error.empty()) return command_line_error(error);
  const auto system = make_system(loaded.model);
  const AssemblyResult assembly = assemble(*system);
  if (assembly.status != AssemblyStatus::kAssembled) {
    report_open(loaded, assembly);
    if (options.json) print_json(loaded, nullptr);
    return kExitNotAssembled;
  }
  const RedundancyReport result = analyze_redundancy(*system, assembly.state);
  const PermanenceReport permanence = analyze_permanence(*system, assembly.state, result);
  if (options.json) {
    print_json(loaded, &result, &permanence);
  } else {
    print(stdout, analysis_text(*loaded.model, result, permanence, Style(stdout)));
  }
  return kExitDone;
}

}  // namespace

void add_analyze(CLI::App& command, Job& job) {
  auto options = std::make_shared<ModelOptions>();
  CLI::App* verb = command.add_subcommand("analyze", "mobility, redundant constraints, reactions that are unique");
  add_model_options(*verb, *options);
  verb->footer(
      "Examples:\n"
      "  ferrers analyze examples/bricard-a04/model.yaml\n"
      "  ferrers analyze press.yaml -p length='120 mm' --json\n"
      "\nExit codes: 0 done; 3 the model has errors; 4 it cannot be assembled. A doubtful rank is said, and is 0.");
  verb->callback([options, &job] { job = [options] { return analyze(*options); }; });
}
