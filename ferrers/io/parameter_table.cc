#include "ferrers/io/parameter_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <system_error>
#include <utility>

#include "ferrers/core/closest_name.h"
#include "ferrers/io/source_text.h"
#include "ferrers/io/value_reader.h"

namespace ferrers {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMostBytes = std::uintmax_t{64} << 20U;
constexpr std::size_t kMostColumns = 10'000;

/// A cell without its quotes, and where it stands in the text.
struct Cell {
  std::string_view text;
  std::size_t begin = 0;
};

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(' ');
  return begin == std::string_view::npos ? text.substr(0, 0)
                                         : text.substr(begin, text.find_last_not_of(' ') + 1 - begin);
}

char separator_of(std::string_view header) {
  for (const char candidate : {';', '\t', ','}) {
    if (header.find(candidate) != std::string_view::npos) return candidate;
  }
  return ',';
}

class TableReader {
 public:
  TableReader(std::string_view text, const Model& model, Diagnostics& diagnostics)
      : source_(text), model_(model), diagnostics_(diagnostics), laws_(std::nullopt), values_(laws_, diagnostics) {}

  std::optional<ParameterTable> read() {
    if (!check_characters(source_, diagnostics_)) return std::nullopt;
    const std::string_view text = source_.text();
    // Line ends behind the last row are no rows.
    const std::size_t end = text.find_last_not_of(" \r\n") + 1;
    bool has_rows = false;
    for (std::size_t at = 0; at < end && !is_too_much(); at = std::min(text.find('\n', at), end) + 1) {
      std::string_view line = text.substr(at, std::min(text.find('\n', at), end) - at);
      if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
      if (trimmed(line).substr(0, 1) == "#" || (columns_.empty() && trimmed(line).empty())) continue;
      if (columns_.empty()) {
        separator_ = separator_of(line);
        read_names(line, at);
      } else {
        has_rows = true;
        read_row(line, at);
      }
    }
    if (columns_.empty()) {
      error("F103", {}, "this table is empty", "its first line names parameters, every other one is a set of values");
    } else if (!has_rows) {
      error("F103", {}, "this table has no rows", "every line below the names is a set of values");
    }
    diagnostics_.sort_by_place();
    if (diagnostics_.has_errors()) return std::nullopt;
    return std::move(table_);
  }

 private:
  void error(std::string_view code, SourceRange at, std::string message, std::string hint = {}) {
    diagnostics_.error(code, at, std::move(message), std::move(hint));
  }
  SourceRange place(const Cell& cell) const { return source_.range(cell.begin, cell.text.size()); }

  bool is_too_much() {
    if (rows_ > kMostParameterRows) {
      error("F102", {}, fmt::format("this table has more than {} rows", kMostParameterRows));
      return true;
    }
    if (diagnostics_.items().size() < kMostTableErrors) return false;
    error("F218", {}, "the rest of this table is not looked at");
    return true;
  }

  /// The cells of a line; none, with a message, where quotes are amiss or cells too many.
  std::vector<Cell>& split(std::string_view line, std::size_t at) {
    cells_.clear();
    for (std::size_t i = 0;;) {
      std::size_t end = std::min(line.find(separator_, i), line.size());
      std::string_view text = trimmed(line.substr(i, end - i));
      if (text.substr(0, 1) == "\"") {
        const std::size_t open = static_cast<std::size_t>(text.data() - line.data());
        const std::size_t close = line.find('"', open + 1);
        const std::size_t behind = close == std::string_view::npos ? close : line.find_first_not_of(' ', close + 1);
        if (close == std::string_view::npos || (behind != std::string_view::npos && line[behind] != separator_)) {
          error("F116", source_.range(at + open, 1), "this quote begins a cell that no quote ends",
                "a cell in quotes is \"12 mm\", without quotes inside");
          cells_.clear();
          return cells_;
        }
        text = trimmed(line.substr(open + 1, close - open - 1));
        end = std::min(behind, line.size());
      }
      if (cells_.size() == kMostColumns) {
        error("F102", source_.range(at, 1), fmt::format("this line has more than {} cells", kMostColumns));
        cells_.clear();
        return cells_;
      }
      cells_.push_back({text, at + static_cast<std::size_t>(text.data() - line.data())});
      if (end == line.size()) return cells_;
      i = end + 1;
    }
  }

  void read_names(std::string_view line, std::size_t at) {
    std::vector<std::string_view> known;
    for (const Parameter& parameter : model_.parameters()) known.push_back(parameter.name);
    columns_.resize(1);  // read, whatever stands there
    const std::vector<Cell>& cells = split(line, at);
    if (cells.empty()) return;
    columns_.assign(cells.size(), nullptr);
    for (std::size_t i = 0; i < cells.size() && diagnostics_.items().size() < kMostTableErrors; ++i) {
      const std::string name(cells[i].text);
      if (name.empty()) {
        error("F212", place(cells[i]), fmt::format("column {} has no name", i + 1), "it is a parameter of the model");
        continue;
      }
      const auto found = std::find(known.begin(), known.end(), name);
      if (found == known.end()) {
        const bool number = name.find_first_not_of("+-.0123456789eE") == std::string::npos;
        error("F216", place(cells[i]), fmt::format("the model has no parameter {}", quoted_in_message(name)),
              number ? "the first line names the parameters" : did_you_mean(name, known));
        continue;
      }
      if (std::find(table_.names.begin(), table_.names.end(), name) != table_.names.end()) {
        error("F216", place(cells[i]), fmt::format("the parameter '{}' has a column already", name));
      }
      table_.names.push_back(name);
      columns_[i] = &model_.parameters()[static_cast<std::size_t>(found - known.begin())];
    }
  }

  void read_row(std::string_view line, std::size_t at) {
    ++rows_;
    const std::vector<Cell>& cells = split(line, at);
    if (cells.empty()) return;
    if (cells.size() == 1 && cells.front().text.empty() && columns_.size() > 1) {
      return error("F116", source_.range(at, line.size()), "this line is empty", "a comment starts with '#'");
    }
    if (cells.size() != columns_.size()) {
      return error("F116", source_.range(at, line.size()),
                   fmt::format("this row has {} cell{}, but the table {} column{}", cells.size(),
                               cells.size() == 1 ? "" : "s", columns_.size(), columns_.size() == 1 ? "" : "s"));
    }
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (columns_[i] == nullptr) continue;  // reported with its name
      const std::string& name = columns_[i]->name;
      if (cells[i].text.empty()) {
        error("F212", place(cells[i]), fmt::format("'{}' has no value here", name), "every row gives every value");
        continue;
      }
      const auto written = values_.written_number(cells[i].text, place(cells[i]), {name, {}}, columns_[i]->dimension);
      if (written) table_.values.push_back(written->value);
    }
  }

  SourceText source_;
  const Model& model_;
  Diagnostics& diagnostics_;
  LawFiles laws_;
  ValueReader values_;
  char separator_ = ',';
  std::vector<const Parameter*> columns_;  ///< Null: not known. Empty: the first line is still to come.
  std::vector<Cell> cells_;
  std::size_t rows_ = 0;
  ParameterTable table_;
};

std::string load(const fs::path& file, Diagnostics& diagnostics) {
  std::error_code failed;
  const auto fail = [&](std::string_view code, std::string message) {
    diagnostics.error(code, {}, std::move(message));
    return "";
  };
  if (!fs::exists(file, failed)) return fail("F101", "this file does not exist");
  if (!fs::is_regular_file(file, failed)) return fail("F101", "this is no file");
  const std::uintmax_t size = fs::file_size(file, failed);
  if (failed) return fail("F101", "this file cannot be read");
  if (size > kMostBytes) return fail("F102", "this table has more than 64 MiB");
  std::string text(static_cast<std::size_t>(size), '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!stream) return fail("F101", "this file cannot be read");
  return text;
}

}  // namespace

ParameterTableResult read_parameter_table_text(std::string text, std::string name, const Model& model) {
  ParameterTableResult result;
  result.source = std::move(text);
  result.diagnostics.set_file(std::move(name));
  result.table = TableReader(result.source, model, result.diagnostics).read();
  return result;
}

ParameterTableResult read_parameter_table(const fs::path& file, const Model& model) {
  Diagnostics diagnostics(file.string());
  std::string text = load(file, diagnostics);
  if (!diagnostics.has_errors()) return read_parameter_table_text(std::move(text), file.string(), model);
  ParameterTableResult result;
  result.diagnostics = std::move(diagnostics);
  return result;
}

}  // namespace ferrers
