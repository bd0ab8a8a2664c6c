#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ferrers/core/diagnostics.h"
#include "ferrers/model/model.h"

/// Many sets of values for the parameters of one model: from a CSV file, or as a grid.
namespace ferrers {

/// One set per row; every row gives a value for the same parameters.
struct ParameterTable {
  std::vector<std::string> names;  ///< Parameters of the model, in the order of the columns.
  std::vector<double> values;      ///< SI, finite; row after row.

  std::size_t rows() const { return names.empty() ? 0 : values.size() / names.size(); }
  std::span<const double> row(std::size_t i) const { return std::span(values).subspan(i * names.size(), names.size()); }
};

struct ParameterTableResult {
  std::optional<ParameterTable> table;  ///< Present when there is no error.
  Diagnostics diagnostics;              ///< Sorted by place.
  std::string source;                   ///< The file's text, for `format_diagnostic`.
};

/// Most rows of a table, and most errors that are told of one.
inline constexpr std::size_t kMostParameterRows = 10'000'000;
inline constexpr std::size_t kMostTableErrors = 200;

/// Reads a table. The first line names the parameters, every other one is a set of values.
///
/// Cells are separated by commas, semicolons or tabs, which the first line tells; quotes around a cell and spaces
/// around it are left out. Numbers are written as in a model file, with a decimal point and a unit if wanted. Lines
/// that start with '#' are comments. Nothing is guessed: cells that are empty or no numbers, lines of another length,
/// unknown parameters, more than 64 MiB or `kMostParameterRows` are errors with their place; all of them are reported
/// at once. Cost: linear in the size of the file.
ParameterTableResult read_parameter_table(const std::filesystem::path& file, const Model& model);

/// The same from a text; `name` is how messages call it.
ParameterTableResult read_parameter_table_text(std::string text, std::string name, const Model& model);

/// All combinations of evenly spaced values: each entry of `ranges` is 'name=from:to:count' with `count` values from
/// `from` to `to`, both included, which may carry units. The last entry changes from row to row. Errors have no place.
ParameterTableResult make_parameter_grid(std::span<const std::string> ranges, const Model& model);

}  // namespace ferrers
