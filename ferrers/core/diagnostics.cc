#include "ferrers/core/diagnostics.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>
#include <utility>

namespace ferrers {
namespace {

constexpr std::size_t kExcerptWidth = 120;  // Characters of a source line that are shown.
constexpr std::size_t kExcerptLead = 60;    // Of these, at most so many before the place, once the line is too wide.

std::string_view word(Severity severity) {
  switch (severity) {
    case Severity::kError:
      return "error";
    case Severity::kWarning:
      return "warning";
    case Severity::kNotice:
      break;
  }
  return "notice";
}

/// Bytes of the UTF-8 character at the front of `text`; 0 when it is none. Overlong forms are let through: harmless
/// here.
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const std::size_t length = byte(0) < 0x80             ? 1
                             : (byte(0) & 0xE0) == 0xC0 ? 2
                             : (byte(0) & 0xF0) == 0xE0 ? 3
                             : (byte(0) & 0xF8) == 0xF0 ? 4
                                                        : 0;
  if (length == 0 || length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
  }
  return length;
}

/// One character of a source line: what to print for it, and where it started.
struct Cell {
  std::string_view text;
  std::size_t offset = 0;
};

/// The characters of a line as a terminal may safely show them: control bytes and broken UTF-8 become '?'.
std::vector<Cell> cells_of(std::string_view line) {
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < line.size();) {
    const std::size_t length = character_length(line.substr(i));
    const auto first = static_cast<unsigned char>(line[i]);
    const bool c1_control = length == 2 && first == 0xC2 && static_cast<unsigned char>(line[i + 1]) < 0xA0;
    const bool shown = length > 0 && !c1_control && ((first >= 0x20 && first != 0x7F) || first == '\t');
    cells.push_back({shown ? line.substr(i, length) : std::string_view("?"), i});
    i += std::max<std::size_t>(length, 1);
  }
  return cells;
}

std::string printable(std::string_view text) {
  std::string out;
  for (const Cell& cell : cells_of(text)) out += cell.text;
  return out;
}

/// Line `number` of `source` (from 1) without its end of line; empty pointer when there is no such line.
std::string_view line_of(std::string_view source, int number) {
  for (int i = 1; i < number; ++i) {
    const std::size_t end = source.find('\n');
    if (end == std::string_view::npos) return {};
    source.remove_prefix(end + 1);
  }
  source = source.substr(0, source.find('\n'));
  if (!source.empty() && source.back() == '\r') source.remove_suffix(1);
  return source;
}

std::string excerpt(const SourceRange& at, std::string_view line) {
  const std::vector<Cell> cells = cells_of(line);
  const std::size_t begin = static_cast<std::size_t>(std::max(at.column, 1) - 1);
  const std::size_t end = begin + static_cast<std::size_t>(std::max(at.length, 1));
  const auto cell_at = [&](std::size_t offset) {
    const auto after = [](std::size_t o, const Cell& cell) { return o < cell.offset; };
    const auto found = std::upper_bound(cells.begin(), cells.end(), offset, after);
    return offset >= line.size() ? cells.size() : static_cast<std::size_t>(found - cells.begin()) - 1;
  };
  const std::size_t mark = cell_at(begin);
  const std::size_t mark_end = std::max(mark + 1, end >= line.size() ? cells.size() : cell_at(end));
  const std::size_t from = cells.size() > kExcerptWidth && mark > kExcerptLead ? mark - kExcerptLead : 0;
  const std::size_t to = std::min(cells.size(), from + kExcerptWidth);

  std::string text = from > 0 ? "..." : "";
  std::string under = from > 0 ? "   " : "";
  for (std::size_t i = from; i < to; ++i) {
    text += cells[i].text;
    if (i < mark) under += cells[i].text == "\t" ? "\t" : " ";
  }
  if (to < cells.size()) text += "...";
  under += '^';
  if (const std::size_t last = std::min(mark_end, to); last > mark + 1) under.append(last - mark - 1, '~');
  return fmt::format("\n{:>5} | {}\n{:>5} | {}", at.line, text, "", under);
}

}  // namespace

void Diagnostics::error(std::string_view code, SourceRange at, std::string message, std::string hint) {
  items_.push_back({Severity::kError, std::string(code), at, std::move(message), std::move(hint)});
}

void Diagnostics::warning(std::string_view code, SourceRange at, std::string message, std::string hint) {
  items_.push_back({Severity::kWarning, std::string(code), at, std::move(message), std::move(hint)});
}

void Diagnostics::notice(std::string_view code, SourceRange at, std::string message, std::string hint) {
  items_.push_back({Severity::kNotice, std::string(code), at, std::move(message), std::move(hint)});
}

void Diagnostics::append(const Diagnostics& other) {
  const std::vector<Diagnostic> copy = other.items_;  // `other` may be this very list
  items_.insert(items_.end(), copy.begin(), copy.end());
}

bool Diagnostics::has_errors() const {
  return std::any_of(items_.begin(), items_.end(), [](const Diagnostic& d) { return d.severity == Severity::kError; });
}

void Diagnostics::sort_by_place() {
  std::stable_sort(items_.begin(), items_.end(), [](const Diagnostic& a, const Diagnostic& b) {
    if (!a.at.known() || !b.at.known()) return a.at.known() && !b.at.known();
    return std::tie(a.at.line, a.at.column) < std::tie(b.at.line, b.at.column);
  });
}

std::string format_diagnostic(const Diagnostic& diagnostic, std::string_view file, std::string_view source) {
  const SourceRange& at = diagnostic.at;
  std::string out = printable(file);
  if (at.known()) out += fmt::format("{}{}:{}", out.empty() ? "" : ":", at.line, std::max(at.column, 1));
  if (!out.empty()) out += ": ";
  out += fmt::format("{}[{}]: {}", word(diagnostic.severity), diagnostic.code, printable(diagnostic.message));
  if (at.known() && !source.empty()) {
    if (const std::string_view line = line_of(source, at.line); line.data() != nullptr) out += excerpt(at, line);
  }
  if (!diagnostic.hint.empty()) out += "\n  hint: " + printable(diagnostic.hint);
  return out;
}

}  // namespace ferrers
