#include <fmt/format.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <system_error>
#include <thread>
#include <vector>

#include "exit_code.h"
#include "ferrers/io/run_folder.h"
#include "ferrers/study/sweep_folder.h"
#include "interrupts.h"
#include "method_options.h"
#include "output_folder.h"
#include "progress_bar.h"
#include "run_verb.h"
#include "sweep_text.h"
#include "verbs.h"

using namespace ferrers;  // NOLINT(google-build-using-namespace): the command speaks the library's language

namespace {

constexpr int kMostThreads = 1024;

struct Options {
  ModelOptions model;
  std::string folder, table;
  std::vector<std::string> ranges;
  SimulationOptions simulation;
  std::optional<double> every;
  int threads = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, kMostThreads);
  bool resume = false;
};

/// Every variant makes and forgets the same megabyte: it stays with the process instead of going to the system and
/// back, which would cost a tenth of the time.
void keep_memory() {
#ifdef __GLIBC__
  mallopt(M_TRIM_THRESHOLD, 1 << 28);
  mallopt(M_MMAP_THRESHOLD, 1 << 25);  // the most that it takes
#endif
}

std::string find_fault(const Options& options) {
  if (options.table.empty() == options.ranges.empty()) {
    return options.table.empty() ? "which parameters? give --table FILE, or --vary NAME=FROM:TO:COUNT"
                                 : "--table and --vary: take one of them";
  }
  return ::find_fault(options.simulation);
}

/// Sets of values for parameters that are not set by -p as well. Prints what is wrong.
ParameterTableResult read_table(const Options& options, const Model& model) {
  ParameterTableResult result =
      options.table.empty() ? make_parameter_grid(options.ranges, model) : read_parameter_table(options.table, model);
  if (result.table) {
    for (const std::string& text : options.model.parameters) {
      const std::string name = text.substr(0, text.find('='));
      const auto& names = result.table->names;
      if (std::find(names.begin(), names.end(), name) == names.end()) continue;
      result.diagnostics.error("F216", {}, fmt::format("the parameter '{}' is varied, but -p sets it", name),
                               "leave out one of them");
    }
  }
  if (result.diagnostics.has_errors()) result.table.reset();
  print_diagnostics(result.diagnostics, result.source);
  return result;
}

/// One sweep from its table to its summary.
class Sweep {
 public:
  Sweep(const Options& options, const LoadedModel& loaded, const ParameterTableResult& table,
        const DynamicsModel& dynamics)
      : options_(options),
        loaded_(loaded),
        table_(*table.table),
        columns_(run_columns(dynamics)),
        folder_(options.folder, "sweep", "sweep.csv", options.model, loaded),
        rows_(table_, columns_) {
    document_.model = loaded.model->name();
    document_.table = &table_;
    document_.simulation = options.simulation;
    document_.simulation.grid = options.every ? OutputGrid{options.simulation.grid.t_end, *options.every}
                                              : last_row_grid(options.simulation, options.simulation.grid);
    document_.threads = options.threads;
    document_.diagnostics = &loaded.diagnostics;
    document_.table_diagnostics = &table.diagnostics;
  }

  int run() {
    if (std::string error = folder_.refusal(); !error.empty()) return command_line_error(error);
    if (folder_.holds_model()) {
      return command_line_error(
          "the folder '" + folder_.path().string() +
          "' is that of the model file itself: nothing could tell later with which model its rows "
          "were made; take another -o");
    }
    if (std::string error = options_.resume ? "" : find_kept_sweep(folder_.path()); !error.empty()) {
      return command_line_error(error);
    }
    if (std::string error = options_.resume ? go_on() : rows_.begin(folder_.path()); !error.empty()) {
      return command_line_error(options_.resume ? "--resume: " + error : error);
    }
    document_.folder = folder_.path().string();
    std::string error = options_.resume ? "" : folder_.write_model();
    if (error.empty()) error = write_summary();
    if (!error.empty()) return command_line_error(error);
    catch_interrupts();
    keep_memory();
    simulate();
    error = rows_.close();
    document_.status = document_.tally.count() == table_.rows() ? SweepStatus::kFinished : SweepStatus::kInterrupted;
    if (error.empty()) error = write_summary();
    if (!error.empty()) return command_line_error(error);
    const std::string files = "sweep.csv, sweep.json, " + folder_.model_file();
    print(stdout, options_.model.json ? write_sweep_json(document_) : sweep_text(document_, files, Style(stdout)));
    if (document_.status == SweepStatus::kInterrupted) return kExitInterrupted;
    return document_.tally.failed() > 0 ? kExitVariants : kExitDone;
  }

 private:
  /// Behind the rows of an earlier call. Returns why not, or an empty text.
  std::string go_on() {
    std::error_code ignored;
    if (!std::filesystem::exists(folder_.path() / "sweep.csv", ignored)) {
      return fmt::format("there is no sweep in '{}'", folder_.path().string());
    }
    if (std::string error = folder_.find_other_model(); !error.empty()) return error;
    if (std::string error = find_other_options(folder_.path() / "sweep.json", document_); !error.empty()) return error;
    std::string error = rows_.go_on(folder_.path(), document_.tally);
    document_.resumed = document_.tally.count();
    return error;
  }

  std::string write_summary() const {
    return write_file_whole(folder_.path() / "sweep.json", write_sweep_json(document_));
  }

  void simulate() {
    const auto begin = std::chrono::steady_clock::now();
    ProgressBar progress;
    VariantsOptions variants;
    variants.simulation = document_.simulation;
    variants.threads = options_.threads;
    variants.first = document_.resumed;
    VariantsControl control;
    control.stop = &stop_asked;
    control.on_result = [&](const VariantResult& result) {
      rows_.add(result);
      document_.tally.add(result);
      if (!rows_.is_good()) stop_asked = true;
      if (!progress.is_due()) return;
      const double done = static_cast<double>(rows_.rows()), all = static_cast<double>(table_.rows());
      progress.draw(done / all,
                    fmt::format("{} of {} variants, {} failed", rows_.rows(), table_.rows(), document_.tally.failed()));
    };
    simulate_variants(*loaded_.model, table_, variants, control);
    document_.wall_time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }

  const Options& options_;
  const LoadedModel& loaded_;
  const ParameterTable& table_;
  std::vector<std::string> columns_;
  OutputFolder folder_;
  SweepFolder rows_;
  SweepDocument document_;
};

int not_begun(const Options& options, const LoadedModel& loaded, const Diagnostics* table) {
  if (!options.model.json) return kExitModel;
  SweepDocument document;
  if (loaded.model) document.model = loaded.model->name();
  document.diagnostics = &loaded.diagnostics;
  document.table_diagnostics = table;
  print(stdout, write_sweep_json(document));
  return kExitModel;
}

int run(const Options& options) {
  if (const std::string fault = find_fault(options); !fault.empty()) return command_line_error(fault);
  LoadedModel loaded = load_model(options.model);
  if (!loaded.model) return not_begun(options, loaded, nullptr);
  if (loaded.geometry && loaded.geometry->spec) {
    return command_line_error(
        "the joints had to move to where the geometry is exact, and would not follow the parameters; "
        "'ferrers convert --snap' writes it, or sweep with '--geometric-tolerance 0'");
  }
  const ParameterTableResult table = read_table(options, *loaded.model);
  if (!table.table) return not_begun(options, loaded, &table.diagnostics);
  if (const std::string error = write_model_if_asked(options.model, loaded); !error.empty()) {
    return command_line_error(error);
  }
  const auto dynamics = make_dynamics_model(make_system(loaded.model));
  if (!dynamics->massless_bodies.empty()) {
    report_masses(loaded, dynamics->massless_bodies);
    return not_begun(options, loaded, &table.diagnostics);
  }
  return Sweep(options, loaded, table, *dynamics).run();
}

void add_options(CLI::App& verb, Options& options) {
  add_model_options(verb, options.model);
  verb.add_option("--table", options.table, "CSV file: its first line names parameters, every other one sets them")
      ->type_name("FILE");
  verb.add_option("--vary", options.ranges,
                  "so many values of a parameter from one to another; repeatable: all combinations")
      ->type_name("NAME=FROM:TO:COUNT")
      ->allow_extra_args(false);
  verb.add_option("-o,--output", options.folder, "folder of the results [out/MODELNAME-sweep]")->type_name("FOLDER");
  verb.add_option("--end", options.simulation.grid.t_end, "last time, s [10]")
      ->type_name("T")
      ->check(number_from_zero());
  verb.add_option_function<double>(
          "--every", [&options](const double& value) { options.every = value; },
          "spacing of the rows that each run makes before its last one, s [none; 0.01 with steps of equal length]")
      ->type_name("DT")
      ->check(positive_number());
  add_method_options(verb, options.simulation);
  verb.add_option("--jobs", options.threads, "threads that share the variants [as many as there are processors]")
      ->type_name("N")
      ->check(CLI::Range(1, kMostThreads).description(""));
  verb.add_flag("--resume", options.resume, "go on behind the rows that are in the folder already");
}

}  // namespace

void add_sweep(CLI::App& command, Job& job) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = command.add_subcommand("sweep", "simulate for many sets of parameter values");
  add_options(*verb, *options);
  verb->footer(
      "Examples:\n"
      "  ferrers sweep examples/bricard-a04/model.yaml --vary 'c=50 mm:200 mm:100' --end 10 -o out/thickness\n"
      "  ferrers sweep door.yaml --vary 'width=0.6:1:20' --vary 'mass=10 kg:40 kg:20' --jobs 2 --json\n"
      "  ferrers sweep press.yaml --table variants.csv --driven -o out/press --resume\n"
      "\nWrites sweep.csv with a row per variant, sweep.json and the model file. Ctrl-C keeps what is done, --resume "
      "goes on.\n"
      "Exit codes: 0 done; 3 the model or the table has errors; 6 some variants failed; 130 interrupted.");
  verb->callback([options, &job] { job = [options] { return run(*options); }; });
}
