#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "ferrers/study/sweep_summary.h"
#include "ferrers/study/variants.h"

/// Problem: what a long sweep has computed must be in its folder at any time, and another call must be able to go on.
///
/// `sweep.csv` has a row per variant, in order: `index`, the parameters, `status`, `rank`, `mobility`, `redundant`, the
/// last row by the columns of `result.csv`, `energy_start`, `energy_end`, `balance_error` (J), `steps`, `evaluations`,
/// `notices` (how many), `message`. Numbers have seventeen significant digits; what is not known is an empty cell.
namespace ferrers {

class SweepFolder {
 public:
  /// `columns`: of a run's rows (`run_columns`). Both outlive this object.
  SweepFolder(const ParameterTable& table, const std::vector<std::string>& columns);
  ~SweepFolder();
  SweepFolder(const SweepFolder&) = delete;
  SweepFolder& operator=(const SweepFolder&) = delete;

  /// Makes the folder and begins its `sweep.csv`; an earlier one is replaced. Returns what went wrong, or an empty
  /// text.
  std::string begin(const std::filesystem::path& folder);
  /// Goes on behind the last whole row of the folder's `sweep.csv`, if its header and its rows are those of the table;
  /// adds them to `tally`. Returns why not, or an empty text. Cost: one pass over the file.
  std::string go_on(const std::filesystem::path& folder, SweepTally& tally);

  /// Appends the next variant's row; it is in the file when this returns. After an error rows are dropped.
  void add(const VariantResult& result);
  bool is_good() const;  ///< False: the file cannot be written any more.
  std::size_t rows() const { return rows_; }
  /// What went wrong since the beginning; empty: nothing.
  std::string close();

 private:
  struct File;
  std::string header() const;
  std::string check_row(const std::string& line, SweepTally& tally) const;

  const ParameterTable& table_;
  const std::vector<std::string>& columns_;
  std::unique_ptr<File> file_;
  std::size_t rows_ = 0;
};

}  // namespace ferrers
