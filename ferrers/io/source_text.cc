#include "ferrers/io/source_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

namespace ferrers {
namespace {

bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

/// A decoded character; `length` is 0 where the bytes are no UTF-8 (overlong forms and surrogates are none).
struct Decoded {
  std::uint32_t code = 0;
  std::size_t length = 0;
};

Decoded decode(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i])); };
  const std::uint32_t first = byte(0);
  if (first < 0x80) return {first, 1};
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return {};
  std::uint32_t code = first & (0x7FU >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if (!is_continuation(text[i])) return {};
    code = (code << 6U) | (byte(i) & 0x3FU);
  }
  const bool overlong = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
  const bool surrogate = code >= 0xD800 && code < 0xE000;
  if (overlong || surrogate || code > 0x10FFFF) return {};
  return {code, length};
}

bool is_forbidden(std::uint32_t code, std::string_view rest) {
  if (code == '\t' || code == '\n') return false;
  if (code == '\r') return rest.size() < 2 || rest[1] != '\n';
  return code < 0x20 || (code >= 0x7F && code < 0xA0) || code == 0x2028 || code == 0x2029 || code == 0xFEFF ||
         code == 0xFFFE || code == 0xFFFF;
}

}  // namespace

SourceText::SourceText(std::string_view text) : text_(text), line_starts_{0} {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\n') line_starts_.push_back(i + 1);
  }
}

SourceRange SourceText::range(std::size_t offset, std::size_t length) const {
  offset = std::min(offset, text_.size());
  const auto next = std::upper_bound(line_starts_.begin(), line_starts_.end(), offset);
  const std::size_t start = *(next - 1);
  std::size_t end = next == line_starts_.end() ? text_.size() : *next - 1;
  if (end > offset && text_[end - 1] == '\r') --end;
  SourceRange range;
  range.line = static_cast<int>(next - line_starts_.begin());
  range.column = static_cast<int>(offset - start) + 1;
  range.length = static_cast<int>(std::min(length, end - offset));
  return range;
}

std::string_view SourceText::before_on_line(std::size_t offset) const {
  offset = std::min(offset, text_.size());
  const std::size_t start = *(std::upper_bound(line_starts_.begin(), line_starts_.end(), offset) - 1);
  return text_.substr(start, offset - start);
}

bool check_characters(const SourceText& source, Diagnostics& diagnostics) {
  const std::string_view text = source.text();
  std::size_t i = 0;
  if (text.substr(0, 3) == "\xEF\xBB\xBF") {
    diagnostics.error("F105", source.range(0, 3), "the file starts with a byte order mark",
                      "save it as UTF-8 without a byte order mark");
    i = 3;
  }
  bool control = false;
  while (i < text.size()) {
    const Decoded character = decode(text.substr(i));
    if (character.length == 0) {
      diagnostics.error("F104", source.range(i, 1),
                        fmt::format("byte 0x{:02x} is no UTF-8 text", static_cast<unsigned char>(text[i])),
                        "save the file as UTF-8");
      return false;
    }
    if (!control && is_forbidden(character.code, text.substr(i))) {
      diagnostics.error("F106", source.range(i, character.length),
                        fmt::format("control character U+{:04X}", character.code),
                        character.code == '\r' ? "end lines with a line feed" : "take it out");
      control = true;
    }
    i += character.length;
  }
  return !diagnostics.has_errors();
}

}  // namespace ferrers
