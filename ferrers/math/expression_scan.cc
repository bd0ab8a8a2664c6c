#include "ferrers/math/expression_scan.h"

#include <fmt/format.h>

#include <algorithm>

#include "ferrers/core/units.h"

namespace ferrers {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

bool is_letter(char c) { return is_name_start(c) && c != '_'; }

}  // namespace

void ExpressionScanner::skip_spaces() {
  while (!at_end() && is_space(peek())) ++position_;
}

bool ExpressionScanner::take(std::string_view token) {
  skip_spaces();
  if (!text_.substr(position_).starts_with(token)) return false;
  position_ += token.size();
  return true;
}

std::string_view ExpressionScanner::take_name() {
  const std::size_t begin = position_;
  if (!is_name_start(peek())) return {};
  while (is_name_char(peek()) || (peek() == '.' && is_name_start(peek(1)))) ++position_;
  return text(begin, position_);
}

std::string_view ExpressionScanner::take_number() {
  const std::size_t begin = position_;
  if (!is_digit(peek()) && !(peek() == '.' && is_digit(peek(1)))) return {};
  while (is_digit(peek())) ++position_;
  if (peek() == '.') ++position_;
  while (is_digit(peek())) ++position_;
  if (peek() == 'e' || peek() == 'E') {
    const std::size_t sign = peek(1) == '+' || peek(1) == '-' ? 1 : 0;
    if (is_digit(peek(1 + sign))) {
      position_ += 1 + sign;
      while (is_digit(peek())) ++position_;
    }
  }
  return text(begin, position_);
}

std::size_t ExpressionScanner::unit_word_end(std::size_t begin) const {
  std::size_t end = begin;
  while (end < text_.size()) {
    const std::string_view rest = text_.substr(end);
    if (is_letter(rest.front())) {
      ++end;
    } else if (rest.starts_with("µ") || rest.starts_with("μ") || rest.starts_with("°")) {
      end += 2;
    } else {
      break;
    }
  }
  return end;
}

std::string_view ExpressionScanner::unit_word() { return text(position_, unit_word_end(position_)); }

/// Whether the letters are a unit and not the start of a longer name; after an operator also not of a call.
bool ExpressionScanner::is_unit_word(std::size_t begin, std::size_t end, bool after_operator) const {
  if (end == begin || is_name_char(byte(end)) || (byte(end) == '.' && is_name_start(byte(end + 1)))) return false;
  std::size_t next = end;
  while (is_space(byte(next))) ++next;
  if (after_operator && byte(next) == '(') return false;
  return parse_unit(text(begin, end)).has_value();
}

/// The end of `^2`, `^-1` or `²` at `begin`; `begin` itself when no whole power stands there.
std::size_t ExpressionScanner::unit_power_end(std::size_t begin) const {
  std::size_t end = begin;
  if (byte(end) == '^') {
    ++end;
    if (byte(end) == '-') ++end;
    const std::size_t digits = end;
    while (is_digit(byte(end))) ++end;
    const bool goes_on = is_name_char(byte(end)) || byte(end) == '.';
    return end == digits || goes_on ? begin : end;
  }
  while (true) {
    const std::string_view rest = text_.substr(std::min(end, text_.size()));
    const auto starts = [&](std::string_view sign) { return rest.starts_with(sign); };
    if (starts("¹") || starts("²") || starts("³")) {
      end += 2;
    } else if (starts("⁻") || starts("⁰") ||
               (starts("\xE2\x81") && rest.size() > 2 && rest[2] >= '\xB4' && rest[2] <= '\xB9')) {
      end += 3;
    } else {
      return end;
    }
  }
}

std::string_view ExpressionScanner::take_unit() {
  const std::size_t begin = position_;
  std::size_t end = begin;
  for (std::size_t word = begin;;) {
    const std::size_t word_end = unit_word_end(word);
    if (!is_unit_word(word, word_end, word != begin)) break;
    end = unit_power_end(word_end);
    const std::size_t op = byte(end) == '*' || byte(end) == '/' ? 1 : text_.substr(end).starts_with("·") ? 2 : 0;
    if (op == 0) break;
    word = end + op;
  }
  position_ = end;
  return text(begin, end);
}

SourceRange ExpressionScanner::place(std::size_t begin, std::size_t end) const {
  begin = std::min(begin, text_.size());
  SourceRange range;
  range.length = static_cast<int>(std::min(end, text_.size()) - begin);
  range.line = at_.line;
  range.column = std::max(at_.column, 1) + static_cast<int>(begin);
  const std::string_view before = text_.substr(0, begin);
  if (const std::size_t line_end = before.rfind('\n'); line_end != std::string_view::npos) {
    if (at_.known()) range.line += static_cast<int>(std::count(before.begin(), before.end(), '\n'));
    range.column = static_cast<int>(begin - line_end);
  }
  return range;
}

std::size_t ExpressionScanner::character_length() const {
  const auto first = static_cast<unsigned char>(peek());
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : first >= 0xC2 ? 2 : 1;
  for (std::size_t i = 1; i < length; ++i) {
    if ((static_cast<unsigned char>(peek(i)) & 0xC0) != 0x80) return 1;
  }
  return length;
}

std::string ExpressionScanner::shown_character() const {
  const auto first = static_cast<unsigned char>(peek());
  const std::size_t length = character_length();
  const bool control = first < 0x20 || first == 0x7F || (length == 1 && first >= 0x80) ||
                       (first == 0xC2 && static_cast<unsigned char>(peek(1)) < 0xA0);
  if (control) return fmt::format("byte 0x{:02X}", first);
  return fmt::format("'{}'", text(position_, position_ + length));
}

}  // namespace ferrers
