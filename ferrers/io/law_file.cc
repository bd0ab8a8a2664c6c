#include "ferrers/io/law_file.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string_view>
#include <system_error>

namespace ferrers {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxBytes = std::uintmax_t{64} << 20U;

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

std::optional<double> decimal(std::string_view cell) {
  cell = trimmed(cell);
  if (!cell.empty() && cell.front() == '+') cell.remove_prefix(1);
  double value = 0;
  const auto [end, code] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (code != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// Cell number `column` (from 1) of a row; empty when the row is shorter.
std::optional<std::string_view> cell(std::string_view row, int column, char separator) {
  for (int i = 1; i < column; ++i) {
    const std::size_t end = row.find(separator);
    if (end == std::string_view::npos) return std::nullopt;
    row.remove_prefix(end + 1);
  }
  return trimmed(row.substr(0, row.find(separator)));
}

char separator_of(std::string_view row) {
  for (const char candidate : {';', '\t', ','}) {
    if (row.find(candidate) != std::string_view::npos) return candidate;
  }
  return ',';
}

bool is_inside(const fs::path& file, const fs::path& folder) {
  auto part = file.begin();
  for (const fs::path& wanted : folder) {
    if (wanted.empty()) continue;
    if (part == file.end() || *part != wanted) return false;
    ++part;
  }
  return true;
}

}  // namespace

std::optional<std::string> LawFiles::load(const std::string& file, SourceRange at, Diagnostics& diagnostics) {
  const auto fail = [&](std::string_view code, std::string message, std::string hint) {
    diagnostics.error(code, at, std::move(message), std::move(hint));
    return std::nullopt;
  };
  const fs::path path(file);
  bool climbs = path.is_absolute() || path.has_root_path();
  for (const fs::path& part : path) climbs = climbs || part == "..";
  const std::string inside = "a law file lies in the model's folder or below; write its path from there";
  if (climbs) return fail("F214", fmt::format("'{}' leaves the folder of the model", file), inside);
  if (!folder_) {
    return fail("F213", fmt::format("the law file '{}' cannot be found: this model has no folder", file),
                "a model that names law files is read from a file");
  }
  std::error_code failed;
  const fs::path folder = fs::canonical(folder_->empty() ? fs::path(".") : *folder_, failed);
  const fs::path target = failed ? fs::path() : fs::canonical(folder / path, failed);
  if (failed) return fail("F213", fmt::format("the law file '{}' does not exist", file), inside);
  if (!is_inside(target, folder)) {
    return fail("F214", fmt::format("'{}' leads out of the folder of the model", file), inside);
  }
  if (!fs::is_regular_file(target, failed)) return fail("F213", fmt::format("'{}' is no file", file), {});
  if (fs::file_size(target, failed) > kMaxBytes || failed) {
    return fail("F213", fmt::format("the law file '{}' is larger than 64 MiB", file), {});
  }
  std::ifstream stream(target, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) return fail("F213", fmt::format("the law file '{}' cannot be read", file), {});
  return text.str();
}

std::optional<LawSamples> LawFiles::read(const std::string& file, int column, SourceRange at,
                                         Diagnostics& diagnostics) {
  if (texts_.count(file) == 0) texts_[file] = load(file, at, diagnostics);
  const std::optional<std::string>& text = texts_[file];
  if (!text) return std::nullopt;
  LawSamples samples;
  char separator = 0;
  bool header_seen = false;
  int line = 0;
  const auto fail = [&](std::string message, std::string hint = {}) {
    diagnostics.error("F215", at, fmt::format("{}:{}: {}", file, line, message), std::move(hint));
    return std::nullopt;
  };
  for (std::string_view rest = *text; !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view row = trimmed(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    ++line;
    if (row.empty() || row.front() == '#') continue;
    if (separator == 0) separator = separator_of(row);
    const std::string_view time_cell = *cell(row, 1, separator);
    const std::optional<double> time = decimal(time_cell);
    if (!time && samples.first.empty() && !header_seen) {
      header_seen = true;
      continue;
    }
    if (!time) return fail("the time in column 1 is no number", "numbers have a decimal point and no unit");
    const auto value_cell = cell(row, column, separator);
    if (!value_cell) return fail(fmt::format("there is no column {}", column), "columns count from 1, the time");
    const std::optional<double> value = decimal(*value_cell);
    if (!value) return fail(fmt::format("column {} is no number", column), "numbers have a decimal point and no unit");
    if (!samples.first.empty() && *time <= samples.first.back()) {
      return fail(fmt::format("the time {} is not after the time {} before it", *time, samples.first.back()),
                  "times increase from row to row");
    }
    samples.first.push_back(*time);
    samples.second.push_back(*value);
  }
  if (samples.first.size() < 2) return fail("a law needs at least two rows");
  return samples;
}

}  // namespace ferrers
