#include "run_verb.h"

#include <fmt/format.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "exit_code.h"
#include "ferrers/core/closest_name.h"
#include "ferrers/io/run_folder.h"
#include "interrupts.h"
#include "output_folder.h"
#include "progress_bar.h"
#include "run_text.h"
#include "terminal.h"

using namespace ferrers;  // NOLINT(google-build-using-namespace)

namespace {

constexpr double kMostRows = 1e8;

/// Everything that a run writes into its folder, made when the first row is known.
class Output {
 public:
  Output(const RunTask& task, const RunOptions& options, const LoadedModel& loaded)
      : task_(task),
        options_(options),
        loaded_(loaded),
        folder_(options.folder, task.verb, "result.csv", options.model, loaded) {}

  const std::string& error() const { return error_; }
  const OutputFolder& folder() const { return folder_; }
  bool begun() const { return begun_; }
  long rows() const { return rows_; }
  std::string files() const {
    return fmt::format("result.csv, {}summary.json, {}", task_.with_reactions ? "reactions.csv, " : "",
                       folder_.model_file());
  }

  void add(const DynamicsModel& dynamics, const RunSample& sample) {
    if (!begun_) begin(dynamics);
    if (!error_.empty()) return;
    if (task_.with_reactions) {
      drives_.add(sample);
      rows_file_.add(sample);
    } else {
      rows_file_.add(without_forces(dynamics, sample));
    }
    ++rows_;
  }
  const std::vector<DrivePeak>& drives() const { return drives_.peaks(); }
  void flush_if_due() { rows_file_.flush_if_due(); }
  void close() { keep(rows_file_.close()); }
  void write_summary(const std::string& text) {
    if (begun_ && error_.empty()) keep(write_file_whole(folder_.path() / "summary.json", text));
  }

 private:
  void keep(std::string error) {
    if (error_.empty() && !error.empty()) {
      error_ = std::move(error);
      stop_asked = true;
    }
  }

  /// Kinematics knows no efforts, and no energy where a mass is missing: these cells stay empty.
  const RunSample& without_forces(const DynamicsModel& dynamics, const RunSample& sample) {
    constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    partial_ = sample;
    for (const std::size_t column : drives_.columns()) partial_.values[column] = kUnknown;
    if (!dynamics.massless_bodies.empty()) partial_.values.back() = kUnknown;
    return partial_;
  }

  void begin(const DynamicsModel& dynamics) {
    begun_ = true;
    drives_ = DrivePeaks(dynamics);
    const ReactionNames reactions = task_.with_reactions ? name_reactions(*loaded_.model) : ReactionNames();
    keep(rows_file_.open(folder_.path(), run_columns(dynamics), reactions, options_.distribution.range.has_value()));
    if (error_.empty()) keep(folder_.write_model());
  }

  const RunTask& task_;
  const RunOptions& options_;
  const LoadedModel& loaded_;
  OutputFolder folder_;
  std::string error_;
  RunFolder rows_file_;
  DrivePeaks drives_;
  RunSample partial_;
  bool begun_ = false;
  long rows_ = 0;
};

/// The exit code that a run's status means; reports it when it is none of the good ones.
int conclude(const RunSummary& summary, long rows, LoadedModel& loaded) {
  const auto fail = [&](std::string_view code, int exit_code, std::string hint = {}) {
    const std::string kept =
        rows > 0 ? fmt::format(" (at t = {} s; rows up to there are kept)", number(summary.t_reached)) : "";
    report(loaded, code, {}, summary.message + kept, std::move(hint));
    return exit_code;
  };
  switch (summary.status) {
    case RunStatus::kFinished:
      return kExitDone;
    case RunStatus::kStoppedByEvent:
      return kExitDone;
    case RunStatus::kStopped:
      return stop_asked ? kExitInterrupted : kExitDone;
    case RunStatus::kNotAssembled:
      return fail("F501", kExitNotAssembled);
    case RunStatus::kInconsistentVelocities:
      return fail("F503", kExitNotAssembled);
    case RunStatus::kSingularMass:
      return fail("F505", kExitSolve);
    case RunStatus::kStepTooSmall:
      return fail("F506", kExitSolve);
    case RunStatus::kRedundancyEnded:
      return fail("F507", kExitSolve);
    case RunStatus::kBadMotion:  // too much or too little prescribed shows before the first row
      return fail("F508", rows > 0 ? kExitSolve : kExitModel);
    case RunStatus::kUnsupported:
      return fail("F509", kExitModel);
  }
  return kExitOurBug;
}

void print_not_run(const RunTask& task, const RunOptions& options, const LoadedModel& loaded) {
  if (!options.model.json) return;
  RunDocument document;
  document.verb = task.verb;
  if (loaded.model) document.model = loaded.model->name();
  document.diagnostics = &loaded.diagnostics;
  print(stdout, write_summary_json(document));
}

int run(const RunTask& task, const RunOptions& options, LoadedModel& loaded,
        const std::shared_ptr<const DynamicsModel>& dynamics) {
  Output output(task, options, loaded);
  if (const std::string refusal = output.folder().refusal(); !refusal.empty()) return command_line_error(refusal);
  RunSummary summary;
  catch_interrupts();
  {
    ProgressBar progress;
    const double t_end = options.grid.t_end;
    RunControl control;
    control.stop = &stop_asked;
    control.on_sample = [&](const RunSample& sample) { output.add(*dynamics, sample); };
    control.on_progress = [&](double t) {
      if (progress.is_due()) {
        progress.draw(t_end > 0 ? t / t_end : 1, fmt::format("t = {:.4g} of {:.4g} s", t, t_end));
      }
      output.flush_if_due();
    };
    summary = task.run(dynamics, control);
  }
  output.close();
  if (!output.error().empty()) return command_line_error(output.error());

  const int exit_code = conclude(summary, output.rows(), loaded);
  RunDocument document;
  document.verb = task.verb;
  document.model = loaded.model->name();
  document.summary = &summary;
  document.interrupted = exit_code == kExitInterrupted;
  document.with_reactions = task.with_reactions;
  document.joints = name_reactions(*loaded.model).joints;
  document.drives = output.drives();
  if (output.begun()) document.folder = output.folder().path().string();
  document.diagnostics = &loaded.diagnostics;
  const std::string json = write_summary_json(document);
  output.write_summary(json);
  if (!output.error().empty()) return command_line_error(output.error());
  if (options.model.json) {
    print(stdout, json);
  } else if (output.begun()) {
    print(stdout, run_text(document, output.rows(), output.files(), Style(stdout)));
  }
  return exit_code;
}

}  // namespace

CLI::Validator positive_number() {
  return CLI::Validator(
      [](std::string& text) {
        double value = 0;
        const bool good = CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0;
        return good ? std::string() : fmt::format("'{}' is not a number above zero", text);
      },
      "");
}

CLI::Validator number_from_zero() {
  return CLI::Validator(
      [](std::string& text) {
        double value = 0;
        const bool good = CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value >= 0;
        return good ? std::string() : fmt::format("'{}' is not a number from zero on", text);
      },
      "");
}

namespace {

/// LOW:HIGH, two numbers above zero in order.
std::optional<StiffnessRange> read_range(const std::string& text) {
  const std::size_t colon = text.find(':');
  StiffnessRange range;
  if (colon == std::string::npos || !CLI::detail::lexical_cast(text.substr(0, colon), range.low) ||
      !CLI::detail::lexical_cast(text.substr(colon + 1), range.high)) {
    return std::nullopt;
  }
  const bool good = range.low > 0 && range.high >= range.low && std::isfinite(range.high);
  return good ? std::optional(range) : std::nullopt;
}

CLI::Validator stiffness_range() {
  return CLI::Validator(
      [](std::string& text) {
        return read_range(text) ? std::string() : fmt::format("'{}' is not a range like 0.5:2", text);
      },
      "");
}

void add_range_option(CLI::App& verb, DistributionOptions& distribution) {
  verb.add_option_function<std::string>(
          "--stiffness-range", [&distribution](const std::string& text) { distribution.range = read_range(text); },
          "also the ranges of divided reactions when every stiffness entry is multiplied by a factor of its own")
      ->type_name("LOW:HIGH")
      ->check(stiffness_range());
}

}  // namespace

CLI::Validator one_of(std::vector<std::string> names) {
  return CLI::Validator(
      [names = std::move(names)](std::string& text) {
        if (std::find(names.begin(), names.end(), text) != names.end()) return std::string();
        const std::string hint = did_you_mean(text, names);
        return fmt::format("'{}' is none of {}{}{}", text, fmt::join(names, ", "), hint.empty() ? "" : "; ", hint);
      },
      "");
}

void add_reaction_options(CLI::App& verb, ReactionAxes& axes, DistributionOptions& distribution) {
  verb.add_option_function<std::string>(
          "--reactions",
          [&axes](const std::string& name) { axes = name == "joint" ? ReactionAxes::kJoint : ReactionAxes::kWorld; },
          "axes of reaction components: world or joint [world]")
      ->type_name("AXES")
      ->check(one_of({"world", "joint"}));
  verb.add_option_function<std::string>(
          "--distribute",
          [&distribution](const std::string& name) {
            if (const auto by = find_distribution(name)) distribution.by = *by;
          },
          "what divides reactions that rigid bodies leave open: the joints' stiffness; equal: the same stiffness for "
          "every joint; none [stiffness]")
      ->type_name("WAY")
      ->check(one_of({"stiffness", "equal", "none"}));
}

void add_run_options(CLI::App& verb, RunOptions& options, bool with_reactions) {
  add_model_options(verb, options.model);
  verb.add_option("-o,--output", options.folder, "folder of the results [out/MODELNAME-VERB]")->type_name("FOLDER");
  verb.add_option("--end", options.grid.t_end, "last time, s [10]")->type_name("T")->check(number_from_zero());
  verb.add_option("--every", options.grid.every, "spacing of the rows, s [0.01]")
      ->type_name("DT")
      ->check(positive_number());
  if (with_reactions) {
    add_reaction_options(verb, options.axes, options.distribution);
    add_range_option(verb, options.distribution);
  }
}

int execute(const RunTask& task, const RunOptions& options) {
  if (options.grid.t_end / options.grid.every > kMostRows) {
    return command_line_error(fmt::format("--end {} with --every {} is more than {:.0e} rows", options.grid.t_end,
                                          options.grid.every, kMostRows));
  }
  LoadedModel loaded = load_model(options.model);
  if (!loaded.model) {
    print_not_run(task, options, loaded);
    return kExitModel;
  }
  if (const std::string error = write_model_if_asked(options.model, loaded); !error.empty()) {
    return command_line_error(error);
  }
  const auto dynamics = make_dynamics_model(make_system(loaded.model));
  if (task.needs_masses && !dynamics->massless_bodies.empty()) {
    report_masses(loaded, dynamics->massless_bodies);
    print_not_run(task, options, loaded);
    return kExitModel;
  }
  return run(task, options, loaded, dynamics);
}
