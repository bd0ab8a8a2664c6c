#include "ferrers/io/text_file.h"

#include <fmt/format.h>

#include <fstream>
#include <system_error>
#include <utility>

#include "ferrers/io/document.h"

namespace ferrers {

namespace fs = std::filesystem;

std::optional<std::string> load_text_file(const fs::path& path, Diagnostics& diagnostics) {
  std::error_code failed;
  const auto fail = [&](std::string_view code, std::string message) {
    diagnostics.error(code, {}, std::move(message));
    return std::nullopt;
  };
  const fs::file_status status = fs::status(path, failed);
  if (!fs::exists(status)) return fail("F101", "this file does not exist");
  if (fs::is_directory(status)) return fail("F101", "this is a folder, not a model file");
  const std::size_t limit = DocumentLimits().bytes;
  std::ifstream stream(path, std::ios::binary);
  std::string text;
  std::string piece(std::size_t{1} << 16U, '\0');
  while (stream && text.size() <= limit) {
    stream.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    text.append(piece, 0, static_cast<std::size_t>(stream.gcount()));
  }
  if (!stream.eof() && text.size() <= limit) return fail("F101", "this file cannot be read");
  if (text.size() > limit) return fail("F102", fmt::format("this file has more than {} bytes", limit));
  return text;
}

}  // namespace ferrers
