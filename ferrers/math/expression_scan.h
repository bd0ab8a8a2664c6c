#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "ferrers/core/diagnostics.h"

/// The words of formulas: names, numbers, units, and places in the text. Private to expression_parse.cc and its tests.
namespace ferrers {

inline bool is_digit(char c) { return c >= '0' && c <= '9'; }
inline bool is_name_start(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
inline bool is_name_char(char c) { return is_name_start(c) || is_digit(c); }

/// A cursor over the text of a formula. Reading past the end gives NUL bytes, which no rule accepts.
class ExpressionScanner {
 public:
  ExpressionScanner(std::string_view text, SourceRange at) : text_(text), at_(at) {}

  std::size_t position() const { return position_; }
  void move_to(std::size_t position) { position_ = position; }
  bool at_end() const { return position_ >= text_.size(); }
  char peek(std::size_t ahead = 0) const { return byte(position_ + ahead); }
  std::string_view text(std::size_t begin, std::size_t end) const { return text_.substr(begin, end - begin); }

  void skip_spaces();
  bool take(std::string_view token);  ///< Skips spaces, then the token if it is there.

  /// Each moves over the word that starts here and returns it; empty when none does.
  std::string_view take_name();    ///< Dotted: `main.position`.
  std::string_view take_number();  ///< Digits with a point and an exponent, without a sign.
  std::string_view take_unit();    ///< The longest run of units, without spaces.
  std::string_view unit_word();    ///< The letters that would start a unit here; does not move.

  /// The line and column of a stretch of the text.
  SourceRange place(std::size_t begin, std::size_t end) const;

  /// The character here, as a message may show it: 'θ', or "byte 0x07" where it cannot be shown.
  std::string shown_character() const;
  std::size_t character_length() const;  ///< In bytes, 1 for broken UTF-8.

 private:
  char byte(std::size_t index) const { return index < text_.size() ? text_[index] : '\0'; }
  std::size_t unit_word_end(std::size_t begin) const;
  std::size_t unit_power_end(std::size_t begin) const;
  bool is_unit_word(std::size_t begin, std::size_t end, bool after_operator) const;

  std::string_view text_;
  SourceRange at_;
  std::size_t position_ = 0;
};

}  // namespace ferrers
