#include "ferrers/io/csv_file.h"

#include <fmt/compile.h>

#include <cmath>
#include <iterator>

namespace ferrers {

void append_text(fmt::memory_buffer& out, std::string_view text) { out.append(text.data(), text.data() + text.size()); }

void append_number(fmt::memory_buffer& out, double value) {
  if (std::isfinite(value)) fmt::format_to(std::back_inserter(out), FMT_COMPILE("{:.17g}"), value);
}

void append_cell(fmt::memory_buffer& out, std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return append_text(out, text);
  out.push_back('"');
  for (const char c : text) {
    if (c == '"') out.push_back('"');
    out.push_back(c);
  }
  out.push_back('"');
}

std::vector<std::string> read_cells(std::string_view line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"') {
      if (quoted && line.substr(i + 1, 1) == "\"")
        cells.back() += line[i++];
      else
        quoted = !quoted;
    } else if (c == ',' && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

std::string CsvFile::open(const std::filesystem::path& path, Mode mode) {
  path_ = path;
  stream_.open(path, std::ios::binary | (mode == Mode::kNew ? std::ios::trunc : std::ios::app));
  return stream_ ? "" : fmt::format("'{}' cannot be written", path.string());
}

void CsvFile::flush() {
  if (!stream_.is_open() || buffer_.size() == 0) return;
  stream_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
  stream_.flush();
  buffer_.clear();
}

std::string CsvFile::close() {
  if (!stream_.is_open()) return "";
  flush();
  const bool good = static_cast<bool>(stream_);
  stream_.close();
  return good && stream_ ? "" : fmt::format("'{}' could not be written to its end", path_.string());
}

}  // namespace ferrers
