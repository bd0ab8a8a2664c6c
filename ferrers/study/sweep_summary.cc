#include "ferrers/study/sweep_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "ferrers/io/json_values.h"
#include "ferrers/io/run_folder.h"

namespace ferrers {
namespace {

constexpr std::string_view kModelError = "model_error";

template <class T>
OrderedJson value_or_null(const std::optional<T>& value) {
  return value ? OrderedJson(*value) : OrderedJson();
}

std::string_view status_name(SweepStatus status) {
  switch (status) {
    case SweepStatus::kFinished:
      return "finished";
    case SweepStatus::kInterrupted:
      return "interrupted";
    case SweepStatus::kRunning:
      break;
  }
  return "running";
}

OrderedJson options_value(const SimulationOptions& options) {
  OrderedJson value;
  value["end"] = options.grid.t_end;
  value["every"] = options.grid.every;
  value["integrator"] = to_string(integrator_of(options));
  value["step"] = value_or_null(options.step);
  value["tolerance"] = value_or_null(options.tolerance);
  value["formulation"] = to_string(options.formulation.value_or(recommended_formulation()));
  value["driven"] = options.driven;
  return value;
}

OrderedJson parameter_values(const ParameterTable& table) {
  OrderedJson all = OrderedJson::array();
  const std::size_t n = table.names.size();
  for (std::size_t column = 0; column < n; ++column) {
    double low = table.values[column], high = low;
    for (std::size_t row = 1; row < table.rows(); ++row) {
      low = std::min(low, table.values[row * n + column]);
      high = std::max(high, table.values[row * n + column]);
    }
    all.push_back({{"parameter", table.names[column]}, {"smallest", low}, {"largest", high}});
  }
  return all;
}

void add_sweep(const SweepDocument& document, OrderedJson& out) {
  const SweepTally& tally = document.tally;
  const std::size_t computed = tally.count() - document.resumed;
  out["status"] = status_name(document.status);
  out["variants"] = document.table->rows();
  out["done"] = tally.count();
  out["resumed"] = document.resumed;
  out["failed"] = tally.failed();
  out["statuses"] = OrderedJson::array();
  for (const auto& [status, count] : tally.statuses()) {
    out["statuses"].push_back({{"status", status}, {"variants", count}});
  }
  out["parameters"] = parameter_values(*document.table);
  out["options"] = options_value(document.simulation);
  out["threads"] = document.threads;
  out["wall_time_s"] = document.wall_time_s;
  const bool has_rate = computed > 0 && document.wall_time_s > 0;
  out["variants_per_second"] =
      has_rate ? OrderedJson(static_cast<double>(computed) / document.wall_time_s) : OrderedJson();
  out["failures"] = OrderedJson::array();
  for (const SweepTally::Failure& one : tally.failures()) {
    out["failures"].push_back({{"index", one.index}, {"status", one.status}, {"message", one.message}});
  }
  out["notices"] = OrderedJson::array();
  for (const SweepTally::Notice& one : tally.notices()) {
    out["notices"].push_back({{"notice", one.text}, {"variants", one.variants}, {"first", one.first}});
  }
}

}  // namespace

std::string_view variant_status_name(const VariantResult& result) {
  return result.run ? run_status_name(*result.run, false) : kModelError;
}

void SweepTally::add(const VariantResult& result) {
  add(result.index, variant_status_name(result), result.message);
  for (const std::string& text : result.notices) {
    const auto known =
        std::find_if(notices_.begin(), notices_.end(), [&](const Notice& one) { return one.text == text; });
    if (known != notices_.end()) {
      ++known->variants;
    } else if (notices_.size() < kMostNotices) {
      notices_.push_back({text, 1, result.index});
    }
  }
}

void SweepTally::add(std::size_t index, std::string_view status, std::string_view message) {
  ++count_;
  const auto known =
      std::find_if(statuses_.begin(), statuses_.end(), [&](const auto& one) { return one.first == status; });
  if (known != statuses_.end()) {
    ++known->second;
  } else {
    statuses_.emplace_back(status, 1);
  }
  const bool good = status == run_status_name(RunStatus::kFinished, false) ||
                    status == run_status_name(RunStatus::kStoppedByEvent, false);
  if (good) return;
  ++failed_;
  if (failures_.size() < kMostFailures) failures_.push_back({index, std::string(status), std::string(message)});
}

std::string write_sweep_json(const SweepDocument& document) {
  const auto has_errors = [](const Diagnostics* one) { return one != nullptr && one->has_errors(); };
  const bool errors = has_errors(document.diagnostics) || has_errors(document.table_diagnostics);
  OrderedJson out;
  out["schema"] = "ferrers.sweep/1";
  out["model"] = document.model.empty() ? OrderedJson() : OrderedJson(document.model);
  out["ok"] =
      document.table != nullptr && document.status == SweepStatus::kFinished && document.tally.failed() == 0 && !errors;
  if (document.table != nullptr) {
    add_sweep(document, out);
  } else {
    for (const char* key : {"status", "variants", "done", "resumed", "failed", "statuses", "parameters", "options",
                            "threads", "wall_time_s", "variants_per_second", "failures", "notices"}) {
      out[key] = nullptr;
    }
  }
  out["folder"] = value_or_null(document.folder);
  const auto told = [](const Diagnostics* one) {
    return one != nullptr ? diagnostics_value(*one) : OrderedJson::array();
  };
  out["diagnostics"] = told(document.diagnostics);
  out["table_diagnostics"] = told(document.table_diagnostics);
  return json_text(out);
}

std::string find_other_options(const std::filesystem::path& file, const SweepDocument& document) {
  std::ifstream in(file);
  const OrderedJson before = OrderedJson::parse(in, nullptr, /*allow_exceptions=*/false);
  if (!before.is_object() || before.value("schema", OrderedJson()) != "ferrers.sweep/1" ||
      !before.value("options", OrderedJson()).is_object()) {
    return fmt::format("'{}' does not tell with which options it was made", file.string());
  }
  const OrderedJson& old = before.at("options");
  const OrderedJson now = options_value(document.simulation);
  for (const auto& [key, value] : now.items()) {
    const OrderedJson other = old.value(key, OrderedJson());
    if (other != value) {
      return fmt::format("it was made with '{}' {} instead of {}", key, other.dump(), value.dump());
    }
  }
  return "";
}

std::string find_kept_sweep(const std::filesystem::path& folder) {
  std::error_code ignored;
  if (!std::filesystem::exists(folder / "sweep.csv", ignored)) return "";
  std::ifstream in(folder / "sweep.json");
  const OrderedJson before = OrderedJson::parse(in, nullptr, /*allow_exceptions=*/false);
  if (!before.is_object() || before.value("schema", OrderedJson()) != "ferrers.sweep/1") {
    return fmt::format("'{}' is no sweep's: nothing is replaced there; take another -o",
                       (folder / "sweep.csv").string());
  }
  if (before.value("status", OrderedJson()) == "finished") return "";
  return fmt::format(
      "the folder '{}' holds a sweep that has not come to its end: go on with --resume, or take another -o",
      folder.string());
}

}  // namespace ferrers
