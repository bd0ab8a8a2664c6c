#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "ferrers/core/diagnostics.h"

namespace ferrers {

/// The text of a file with its lines: turns byte offsets into places.
///
/// Given: UTF-8 text that outlives this object. Offsets count bytes from 0; a line ends at '\n'.
/// Cost: O(size) to make, O(log lines) per place.
class SourceText {
 public:
  explicit SourceText(std::string_view text);

  std::string_view text() const { return text_; }
  /// The place of `length` bytes at `offset`, cut at the end of the line. Offsets beyond the end mean the end.
  SourceRange range(std::size_t offset, std::size_t length) const;
  /// What stands before `offset` on its line.
  std::string_view before_on_line(std::size_t offset) const;

 private:
  std::string_view text_;
  std::vector<std::size_t> line_starts_;
};

/// Refuses bytes that a model file never holds: a byte order mark, broken UTF-8, control characters.
/// Reports each kind once, at its first place. Returns whether the text may be read on.
bool check_characters(const SourceText& source, Diagnostics& diagnostics);

}  // namespace ferrers
