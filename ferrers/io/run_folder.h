#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ferrers/core/diagnostics.h"
#include "ferrers/simulate/simulation.h"

/// Problem: the files of a run must be complete when it ends, useful when it is killed, and never half written.
///
/// A run's folder holds `result.csv` and `reactions.csv`, appended row by row, `summary.json`, written once at the end,
/// and the model file as run. Numbers have seventeen significant digits, so that a file read back is the same run; a
/// value that is not known is an empty cell.
namespace ferrers {

/// Appends the rows of a run to `result.csv` and `reactions.csv`.
///
/// Rows reach the files at the latest with the next row or `flush_if_due` that comes a tenth of a second later, and
/// when the object goes. A reaction that rigid bodies do not determine has an empty value, always. Errors: `open` and
/// `close` return what went wrong; after an error rows are dropped. Cost of a row: formatting its numbers.
class RunFolder {
 public:
  RunFolder();
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  /// Makes the folder and starts both files; removes the files of an earlier run there. `reactions` without names: none
  /// are written; `with_ranges`: `reactions.csv` gets columns `low` and `high`. Returns what went wrong, or an empty
  /// text.
  std::string open(const std::filesystem::path& folder, const std::vector<std::string>& columns,
                   const ReactionNames& reactions, bool with_ranges = false);
  void add(const RunSample& sample);
  /// Brings rows to the files when the last time was a tenth of a second ago.
  void flush_if_due();
  /// Brings everything to the files. Returns what went wrong since `open`, or an empty text.
  std::string close();

  bool is_open() const;
  long rows() const;

 private:
  struct Files;
  std::unique_ptr<Files> files_;
};

/// Writes a file by way of a neighbour that is renamed: readers see the old content or the new one, never a part.
/// Returns what went wrong, or an empty text.
std::string write_file_whole(const std::filesystem::path& file, std::string_view text);

/// The largest effort of one drive over a run.
struct DrivePeak {
  std::string drive, unit;       ///< "N" or "N·m".
  std::optional<double> effort;  ///< The one of largest size, with its sign; none where efforts are not known.
  double t = 0;
};

/// Follows the efforts of every drive through the rows of a run.
class DrivePeaks {
 public:
  DrivePeaks() = default;
  explicit DrivePeaks(const DynamicsModel& model);
  void add(const RunSample& sample);
  const std::vector<DrivePeak>& peaks() const { return peaks_; }
  /// Position in `RunSample::values` of each drive's effort.
  const std::vector<std::size_t>& columns() const { return columns_; }

 private:
  std::vector<DrivePeak> peaks_;
  std::vector<std::size_t> columns_;
};

/// One run as `summary.json` tells it. `RunSummary` is null where the run did not begin.
struct RunDocument {
  std::string verb, model;  ///< An empty model: not known.
  const RunSummary* summary = nullptr;
  bool interrupted = false;           ///< Stopped from outside.
  std::vector<std::string> joints;    ///< Names, in the order of `RunSummary::peaks`.
  std::vector<DrivePeak> drives;      ///< Largest efforts.
  bool with_reactions = true;         ///< False: kinematics; loads are not known.
  std::optional<std::string> folder;  ///< Where the files are; none when nothing was written.
  const Diagnostics* diagnostics = nullptr;
};

/// "finished", "interrupted", "stopped", "not_assembled" and so on.
std::string_view run_status_name(RunStatus status, bool interrupted);

/// The JSON object of schema `ferrers.run/1`. Loads that are not determined are null: `status` of a joint is
/// `determined`, `distributed` (determined with the stiffness that `distribution` names), `partly` (the peaks are those
/// of the times at which they are determined), `undetermined`.
std::string write_summary_json(const RunDocument& document);

}  // namespace ferrers
