#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ferrers/core/diagnostics.h"

namespace ferrers {

/// Times (s, increasing) and values (SI) of a sampled law.
using LawSamples = std::pair<std::vector<double>, std::vector<double>>;

/// Laws sampled in CSV files beside a model.
///
/// A file has one row per time: the time in column 1, values in the others, separated by commas, semicolons or tabs;
/// decimal points; one header row and rows that start with '#' are passed over. The path is relative to the model's
/// folder and stays inside it, symbolic links followed. Each file is read once.
class LawFiles {
 public:
  /// Without a folder no law file can be read.
  explicit LawFiles(std::optional<std::filesystem::path> folder) : folder_(std::move(folder)) {}

  /// Column `column` (from 1, the time being 1) of `file`. Errors, at `at` in the model, name the file and its line.
  std::optional<LawSamples> read(const std::string& file, int column, SourceRange at, Diagnostics& diagnostics);

 private:
  std::optional<std::string> load(const std::string& file, SourceRange at, Diagnostics& diagnostics);

  std::optional<std::filesystem::path> folder_;
  std::map<std::string, std::optional<std::string>> texts_;  // By path as written.
};

}  // namespace ferrers
