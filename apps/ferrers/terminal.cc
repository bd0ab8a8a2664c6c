#include "terminal.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

namespace {

constexpr std::size_t kLineWidth = 100;

/// Characters that a text shows, colours apart: bytes that begin a UTF-8 character, outside escape sequences.
std::size_t shown_width(std::string_view text) {
  std::size_t width = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\033') {
      i = std::min(text.find('m', i), text.size() - 1);
    } else if ((static_cast<unsigned char>(text[i]) & 0xC0U) != 0x80U) {
      ++width;
    }
  }
  return width;
}

}  // namespace

bool is_terminal(std::FILE* stream) { return isatty(fileno(stream)) != 0; }

void print(std::FILE* stream, std::string_view text) { std::fwrite(text.data(), 1, text.size(), stream); }

Style::Style(std::FILE* stream) {
  const char* no_color = std::getenv("NO_COLOR");
  const char* term = std::getenv("TERM");
  const bool forbidden =
      (no_color != nullptr && *no_color != '\0') || (term != nullptr && std::string_view(term) == "dumb");
  colored_ = !forbidden && is_terminal(stream);
}

std::string Style::paint(std::string_view code, std::string_view text) const {
  return colored_ ? fmt::format("\033[{}m{}\033[0m", code, text) : std::string(text);
}

std::string table(const std::vector<std::vector<std::string>>& rows, std::string_view indent, const Style& style) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    if (widths.size() < row.size()) widths.resize(row.size(), 0);
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], shown_width(row[i]));
  }
  std::string out;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    std::string line(indent);
    for (std::size_t i = 0; i < rows[r].size(); ++i) {
      const std::string& cell = rows[r][i];
      line += r == 0 ? style.dim(cell) : cell;
      if (i + 1 < rows[r].size()) line.append(widths[i] - shown_width(cell) + 2, ' ');
    }
    while (!line.empty() && line.back() == ' ') line.pop_back();
    out += line + "\n";
  }
  return out;
}

std::string wrapped_list(std::string_view lead, const std::vector<std::string>& words, std::string_view indent) {
  std::string out, line(lead);
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string word = words[i] + (i + 1 < words.size() ? "," : "");
    if (shown_width(line) + 1 + word.size() > kLineWidth) {
      out += line + "\n";
      line = std::string(indent) + word;
    } else {
      line += (line.empty() || line.back() == ' ' ? "" : " ") + word;
    }
  }
  return out + line + "\n";
}

std::string wrapped_text(std::string_view lead, std::string_view text, std::string_view indent) {
  std::string out, line(lead);
  bool fresh = true;  // nothing but the lead or the indent stands on this line
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string_view word = text.substr(at, end - at);
    if (!fresh && shown_width(line) + 1 + shown_width(word) > kLineWidth) {
      out += line + "\n";
      line = std::string(indent);
      fresh = true;
    }
    if (!fresh) line += ' ';
    line += word;
    fresh = false;
    at = end + 1;
  }
  return out + line + "\n";
}

std::string counted(long count, std::string_view noun) {
  if (count == 1) return fmt::format("1 {}", noun);
  if (!noun.empty() && noun.back() == 'y') return fmt::format("{} {}ies", count, noun.substr(0, noun.size() - 1));
  return fmt::format("{} {}s", count, noun);
}

std::string number(double value) { return fmt::format("{:.6g}", value); }

std::string rough(double value) { return fmt::format("{:.3g}", value); }
