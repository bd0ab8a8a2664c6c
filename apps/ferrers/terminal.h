#pragma once

#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

/// What is written to the terminal: colours where there is one, aligned tables, wrapped lists, numbers for readers.

/// Colours for one stream: only where it is a terminal and the environment does not forbid it (NO_COLOR, TERM=dumb).
class Style {
 public:
  explicit Style(std::FILE* stream);
  /// No colours: what goes to a file.
  static Style plain() { return Style(); }
  std::string bold(std::string_view text) const { return paint("1", text); }
  std::string dim(std::string_view text) const { return paint("2", text); }
  std::string red(std::string_view text) const { return paint("1;31", text); }
  std::string green(std::string_view text) const { return paint("32", text); }
  std::string yellow(std::string_view text) const { return paint("33", text); }
  bool colored() const { return colored_; }

 private:
  Style() = default;
  std::string paint(std::string_view code, std::string_view text) const;
  bool colored_ = false;
};

bool is_terminal(std::FILE* stream);
/// Writes text as it is.
void print(std::FILE* stream, std::string_view text);

/// Rows of cells, every column as wide as its widest cell; the first row is the head.
std::string table(const std::vector<std::vector<std::string>>& rows, std::string_view indent, const Style& style);

/// "a, b, c" over as many lines as it takes, each after `indent`; the first line begins behind `lead`.
std::string wrapped_list(std::string_view lead, const std::vector<std::string>& words, std::string_view indent);

/// Running text over as many lines as it takes, the others after `indent`.
std::string wrapped_text(std::string_view lead, std::string_view text, std::string_view indent);

/// "1 joint", "2 joints".
std::string counted(long count, std::string_view noun);
/// Six significant digits; three where it is an error or a time.
std::string number(double value);
std::string rough(double value);
