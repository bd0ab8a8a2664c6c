#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ferrers/core/diagnostics.h"
#include "ferrers/study/variants.h"

/// What a sweep came to: how many variants ended how, and what there is to know about them.
namespace ferrers {

/// "finished", "not_assembled" and so on as of a run; "model_error" where the values make no model.
std::string_view variant_status_name(const VariantResult& result);

/// Counts variants by how they ended, and keeps the first of what must be told.
class SweepTally {
 public:
  static constexpr std::size_t kMostFailures = 100, kMostNotices = 100;

  struct Failure {
    std::size_t index = 0;
    std::string status, message;
  };
  struct Notice {
    std::string text;
    std::size_t variants = 0, first = 0;  ///< How many say it; the first of them.
  };

  void add(const VariantResult& result);
  /// A variant of which a file tells this much.
  void add(std::size_t index, std::string_view status, std::string_view message);

  std::size_t count() const { return count_; }
  std::size_t failed() const { return failed_; }
  /// How many ended with each status, in the order in which they were met.
  const std::vector<std::pair<std::string, std::size_t>>& statuses() const { return statuses_; }
  const std::vector<Failure>& failures() const { return failures_; }  ///< The first ones.
  const std::vector<Notice>& notices() const { return notices_; }     ///< The first ones, each text once.

 private:
  std::size_t count_ = 0, failed_ = 0;
  std::vector<std::pair<std::string, std::size_t>> statuses_;
  std::vector<Failure> failures_;
  std::vector<Notice> notices_;
};

enum class SweepStatus { kRunning, kFinished, kInterrupted };

/// One sweep as `sweep.json` tells it. Without a table it did not begin.
struct SweepDocument {
  std::string model;  ///< Empty: not known.
  const ParameterTable* table = nullptr;
  SimulationOptions simulation;
  SweepStatus status = SweepStatus::kRunning;
  SweepTally tally;
  std::size_t resumed = 0;  ///< How many of them an earlier call computed.
  int threads = 1;
  double wall_time_s = 0;  ///< Of this call.
  std::optional<std::string> folder;
  const Diagnostics* diagnostics = nullptr;        ///< Of the model.
  const Diagnostics* table_diagnostics = nullptr;  ///< Of the table.
};

/// The JSON object of schema `ferrers.sweep/1`.
std::string write_sweep_json(const SweepDocument& document);

/// Whether the sweep whose `sweep.json` this is was made with the same options. Returns the first difference, or why it
/// cannot be told; empty: the same.
std::string find_other_options(const std::filesystem::path& file, const SweepDocument& document);

/// Why the sweep in a folder must not be replaced: it has not come to its end, or is not one of ours; empty: it may be.
std::string find_kept_sweep(const std::filesystem::path& folder);

}  // namespace ferrers
