#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

/// Rows of CSV as every file of results has them. Internal to the writers: the public headers do not need fmt.
namespace ferrers {

/// A number with seventeen significant digits; nothing where it is not finite.
void append_number(fmt::memory_buffer& out, double value);

/// A text as a cell: in quotes where it would not be one cell otherwise.
void append_cell(fmt::memory_buffer& out, std::string_view text);

void append_text(fmt::memory_buffer& out, std::string_view text);

/// The cells of a line that `append_cell` and `append_number` wrote.
std::vector<std::string> read_cells(std::string_view line);

/// A file that is appended to in large pieces. `open` and `close` return what went wrong, or an empty text.
class CsvFile {
 public:
  enum class Mode { kNew, kGoOn };
  std::string open(const std::filesystem::path& path, Mode mode = Mode::kNew);
  bool is_open() const { return stream_.is_open(); }
  fmt::memory_buffer& buffer() { return buffer_; }
  /// Brings the buffer to the file.
  void flush();
  bool is_good() const { return static_cast<bool>(stream_); }
  std::string close();

 private:
  std::filesystem::path path_;
  std::ofstream stream_;
  fmt::memory_buffer buffer_;
};

}  // namespace ferrers
