#include "ferrers/formats/asmt_law.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <utility>

namespace ferrers {
namespace {

constexpr std::string_view kDigits = "0123456789";
constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kWords = {{{"time", "t"},
                                                                                  {"pi", "pi"},
                                                                                  {"abs", "abs"},
                                                                                  {"sin", "sin"},
                                                                                  {"cos", "cos"},
                                                                                  {"asin", "asin"},
                                                                                  {"arcsin", "asin"},
                                                                                  {"arctan", "atan"}}};
constexpr std::array<std::string_view, 6> kWithoutCounterpart = {"spline",    "integral",  "rampstep",
                                                                 "piecewise", "functions", "transitions"};

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return kDigits.find(c) != std::string_view::npos; }

/// Writes the formula again in the language of `Expression`.
class LawTranslator {
 public:
  LawTranslator(std::string_view text, SourceRange at, Diagnostics& diagnostics)
      : text_(text), at_(at), diagnostics_(diagnostics) {}

  /// Nothing, with an error, where a word or sign is not understood; whether the whole is a formula is seen later.
  std::optional<std::string> translate();

 private:
  bool word();
  bool number(bool negative);
  bool sign_or_parenthesis();
  bool signed_number_follows() const;
  bool fail(std::string_view code, std::size_t length, std::string message, std::string hint = {});

  std::string_view text_;
  SourceRange at_;
  Diagnostics& diagnostics_;
  std::size_t next_ = 0;
  char last_ = '\0';  ///< The last sign or parenthesis; '0' after a number, 'a' after a word.
  std::string written_;
};

bool LawTranslator::fail(std::string_view code, std::size_t length, std::string message, std::string hint) {
  SourceRange at = at_;
  if (at.known()) at.column += static_cast<int>(next_);
  at.length = static_cast<int>(length);
  diagnostics_.error(code, at, std::move(message), std::move(hint));
  return false;
}

bool LawTranslator::word() {
  std::size_t end = next_;
  while (end < text_.size() && (is_letter(text_[end]) || is_digit(text_[end]))) ++end;
  const std::string_view name = text_.substr(next_, end - next_);
  const auto* known = std::find_if(kWords.begin(), kWords.end(), [&](const auto& one) { return one.first == name; });
  if (std::find(kWithoutCounterpart.begin(), kWithoutCounterpart.end(), name) != kWithoutCounterpart.end()) {
    return fail("F602", name.size(), fmt::format("the function '{}' is not supported", name),
                "write the motion as a table of the native format");
  }
  if (known == kWords.end()) {
    return fail("F401", name.size(), fmt::format("the formula uses '{}', which is neither 'time' nor a function", name),
                "functions are abs, sin, cos, asin, arcsin and arctan");
  }
  written_ += known->second;
  next_ = end;
  last_ = 'a';
  return true;
}

bool LawTranslator::number(bool negative) {
  const std::size_t start = next_ + (negative ? 1 : 0);
  std::size_t end = std::min(text_.find_first_not_of("0123456789.", start), text_.size());
  double exponent = 0;
  std::size_t past = end;
  if (end < text_.size() && (text_[end] == 'e' || text_[end] == 'd')) {
    past = end + 1;
    std::size_t digits = past;
    if (digits < text_.size() && (text_[digits] == '+' || text_[digits] == '-')) ++digits;
    const std::size_t stop = std::min(text_.find_first_not_of(kDigits, digits), text_.size());
    if (stop > digits) {
      int whole = 0;
      const char* const first = text_.data() + (text_[past] == '+' ? past + 1 : past);
      if (std::from_chars(first, text_.data() + stop, whole).ec != std::errc()) whole = 1000;
      exponent = whole;
      past = stop;
    }
  }
  double mantissa = 0;
  const std::from_chars_result read = std::from_chars(text_.data() + start, text_.data() + end, mantissa);
  const double value = (negative ? -mantissa : mantissa) * std::pow(10.0, exponent);
  if (read.ec != std::errc() || read.ptr != text_.data() + end || !std::isfinite(value)) {
    return fail("F401", past - next_, fmt::format("'{}' is no number", text_.substr(next_, past - next_)));
  }
  written_ += negative ? fmt::format("({})", value) : fmt::format("{}", value);
  next_ = past;
  last_ = '0';
  return true;
}

bool LawTranslator::signed_number_follows() const {
  const bool after_operator = last_ == '*' || last_ == '/' || last_ == '^';
  const bool signed_now = text_[next_] == '-' && next_ + 1 < text_.size();
  return after_operator && signed_now && (is_digit(text_[next_ + 1]) || text_[next_ + 1] == '.');
}

bool LawTranslator::sign_or_parenthesis() {
  const char c = text_[next_];
  if (std::string_view("+-*/^()").find(c) == std::string_view::npos) {
    return fail("F401", 1, fmt::format("a formula cannot hold '{}'", c));
  }
  written_ += c;
  ++next_;
  last_ = c;
  return true;
}

std::optional<std::string> LawTranslator::translate() {
  while (next_ < text_.size()) {
    const char c = text_[next_];
    if (c == ' ' || c == '\t') {
      ++next_;
      continue;
    }
    const bool value = is_letter(c) || is_digit(c) || c == '.';
    if (value && (last_ == '0' || last_ == 'a' || last_ == ')')) {
      fail("F401", 1, "an operator is missing here");
      return std::nullopt;
    }
    const bool understood = is_letter(c)              ? word()
                            : signed_number_follows() ? number(true)
                            : value                   ? number(false)
                                                      : sign_or_parenthesis();
    if (!understood) return std::nullopt;
  }
  return written_;
}

}  // namespace

std::optional<Expression> read_asmt_law(std::string_view text, SourceRange at, double factor,
                                        Diagnostics& diagnostics) {
  if (text.find_first_not_of(" \t") == std::string_view::npos) return Expression();
  const std::optional<std::string> translated = LawTranslator(text, at, diagnostics).translate();
  if (!translated) return std::nullopt;
  Diagnostics own;
  const std::optional<Expression> law = Expression::parse(*translated, {}, own);
  if (!law) {
    const std::string reason = own.items().empty() ? std::string() : own.items().front().message;
    diagnostics.error("F401", at, fmt::format("the formula '{}' cannot be read: {}", text.substr(0, 60), reason));
    return std::nullopt;
  }
  return factor == 1 ? *law : Expression::constant(factor) * *law;
}

}  // namespace ferrers
