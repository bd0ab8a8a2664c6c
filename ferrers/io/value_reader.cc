#include "ferrers/io/value_reader.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <limits>

#include "ferrers/core/closest_name.h"
#include "ferrers/io/object_reader.h"

namespace ferrers {
namespace {

using Kind = DocumentNode::Kind;

constexpr double kReported = std::numeric_limits<double>::quiet_NaN();

Number reported_number(SourceRange at) {
  Number number(kReported);
  number.at = at;
  return number;
}

Number3 reported_vector(SourceRange at) { return {reported_number(at), reported_number(at), reported_number(at)}; }

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Length of the decimal number at the front: sign, digits with an optional point, exponent. 0 if there is none.
std::size_t scan_decimal(std::string_view text) {
  const auto digits = [&](std::size_t i) {
    std::size_t end = i;
    while (end < text.size() && is_digit(text[end])) ++end;
    return end - i;
  };
  std::size_t i = !text.empty() && (text[0] == '+' || text[0] == '-') ? 1 : 0;
  const std::size_t whole = digits(i);
  i += whole;
  std::size_t fraction = 0;
  if (i < text.size() && text[i] == '.') {
    fraction = digits(i + 1);
    if (whole + fraction > 0) i += 1 + fraction;
  }
  if (whole + fraction == 0) return 0;
  if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
    std::size_t exponent = i + 1;
    if (exponent < text.size() && (text[exponent] == '+' || text[exponent] == '-')) ++exponent;
    if (const std::size_t count = digits(exponent); count > 0) i = exponent + count;
  }
  return i;
}

std::string_view trim_left(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(' ');
  return begin == std::string_view::npos ? std::string_view() : text.substr(begin);
}

std::string_view trim(std::string_view text) {
  text = trim_left(text);
  return text.substr(0, text.find_last_not_of(' ') + 1);
}

bool is_word(std::string_view text, std::initializer_list<std::string_view> words) {
  for (const std::string_view word : words) {
    if (text == word) return true;
  }
  return false;
}

bool looks_boolean(std::string_view text) {
  return is_word(text, {"true", "True", "TRUE", "false", "False", "FALSE", "yes", "Yes", "YES", "no", "No",
                        "NO",   "on",   "On",   "ON",    "off",   "Off",   "OFF", "y",   "Y",   "n",  "N"});
}

std::string describe(const DocumentNode& node) {
  switch (node.kind) {
    case Kind::kSequence:
      return "a list";
    case Kind::kMap:
      return "a map";
    case Kind::kNull:
      return "nothing";
    case Kind::kPlain:
      if (scan_decimal(node.text) == node.text.size()) return "the number " + quoted_in_message(node.text);
      break;
    case Kind::kQuoted:
    case Kind::kBroken:
      break;
  }
  return "the text " + quoted_in_message(node.text);
}

/// What a mistaken unit tells about a mistaken field.
std::string dimension_hint(ValueLabel label, const Dimension& wanted, const Dimension& got) {
  const bool spring = label.owner_title == "a spring";
  if (label.key == "stiffness" && spring && got == kTorque) return "a rotational spring is a 'torsion_spring'";
  if (label.key == "stiffness" && label.owner_title == "a torsion spring" && got == kStiffness) {
    return "a spring between two points is a 'spring'";
  }
  if (label.key == "damping" && spring && got == kTorsionDamping) {
    return "a rotational damper is a 'joint_damping' or a 'torsion_spring'";
  }
  if (wanted == kMass && got == kForce) return "a weight is no mass: divide by 9.81 m/s^2";
  if (wanted == kAngularVelocity && got == kPureNumber) return "a speed of rotation is in rad/s, deg/s or rpm";
  if (wanted == kPureNumber && got == kLength) return "an angle is in rad or deg";
  if (wanted == kLength && got == kPureNumber) return "a length is in m, mm, in and the like";
  if (wanted == kInertia && got == kMass * kLength) return "an inertia is a mass times a length squared";
  return {};
}

}  // namespace

std::string quoted_in_message(std::string_view text) {
  constexpr std::size_t kShown = 60;
  if (text.size() <= kShown) return fmt::format("'{}'", text);
  std::size_t end = kShown;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
  return fmt::format("'{}...'", text.substr(0, end));
}

void ValueReader::error(std::string_view code, SourceRange at, std::string message, std::string hint) {
  diagnostics_.error(code, at, std::move(message), std::move(hint));
}

void ValueReader::wrong_type(const DocumentNode& node, ValueLabel label, std::string_view wanted, std::string hint) {
  if (node.kind == Kind::kBroken) return;
  if (node.kind == Kind::kNull) {
    error("F212", node.at, fmt::format("{} has no value", quoted_in_message(label.key)),
          hint.empty() ? fmt::format("it wants {}; leave the key out for its default", wanted) : std::move(hint));
    return;
  }
  error("F203", node.at, fmt::format("{} wants {}, got {}", quoted_in_message(label.key), wanted, describe(node)),
        std::move(hint));
}

/// `digits`: how many bytes at the front are a number (0: none).
void ValueReader::not_a_number(std::string_view text, SourceRange at, ValueLabel label, std::size_t digits) {
  const std::string_view rest = text.substr(digits);
  const std::string key = quoted_in_message(label.key);
  const std::string got = quoted_in_message(text);
  const std::string_view unsigned_text = !text.empty() && (text[0] == '-' || text[0] == '+') ? text.substr(1) : text;
  if (is_word(unsigned_text,
              {".inf", ".Inf", ".INF", ".nan", ".NaN", ".NAN", "inf", "nan", "Infinity", "NaN", "Inf"})) {
    return error("F206", at, fmt::format("{} wants a finite number, got {}", key, got));
  }
  if (digits == 0) {
    std::string hint;
    if (looks_boolean(text))
      hint = "true and false are no numbers";
    else if (!text.empty())
      hint = fmt::format("a formula starts with '=': \"= {}\"", text.substr(0, 60));
    return error("F203", at, fmt::format("{} wants a number, got the text {}", key, got), std::move(hint));
  }
  const char next = rest.empty() ? ' ' : rest.front();
  if (next == '_') return error("F206", at, fmt::format("{} is no decimal number", got), "leave out the '_'");
  if (next == ',') {
    return error("F206", at, fmt::format("{} is no decimal number", got), "the decimal sign is a point: 1.5");
  }
  if (is_word(text.substr(0, digits), {"0", "+0", "-0"}) && is_word(rest.substr(0, 1), {"x", "X", "o", "b", "B"})) {
    return error("F206", at, fmt::format("{} is no decimal number", got), "write it in decimal digits");
  }
  if (next == '.' || is_digit(next)) return error("F206", at, fmt::format("{} is no decimal number", got));
  const std::string_view unit = trim(rest);
  std::string hint = "units are written like mm, kg, N*m, N/m, kg*m^2, rad/s, deg, rpm";
  if (unit.find_first_of("+-*/()") == 0 || unit.find_first_of("+-()") != std::string_view::npos) {
    hint = fmt::format("a formula starts with '=': \"= {}\"", text.substr(0, 60));
  }
  error("F205", at, fmt::format("{} is no unit in {}", quoted_in_message(unit), key), std::move(hint));
}

std::optional<WrittenNumber> ValueReader::written_number(std::string_view text, SourceRange at, ValueLabel label,
                                                         std::optional<Dimension> wanted) {
  text = trim(text);
  const std::size_t digits = scan_decimal(text);
  const std::string_view rest = trim_left(text.substr(digits));
  const std::optional<Unit> unit = digits > 0 && !rest.empty() ? parse_unit(rest) : std::nullopt;
  if (digits == 0 || (!rest.empty() && !unit)) {
    not_a_number(text, at, label, digits);
    return std::nullopt;
  }
  std::string_view decimal = text.substr(0, digits);
  const bool negative = decimal.front() == '-';
  if (negative || decimal.front() == '+') decimal.remove_prefix(1);
  if (decimal.size() > 1 && decimal[0] == '0' && is_digit(decimal[1])) {
    const std::size_t zeros = std::min(decimal.find_first_not_of('0'), decimal.size() - 1);
    error("F206", at, fmt::format("{} starts with a zero", quoted_in_message(text)),
          fmt::format("numbers are decimal here, never octal: write {}",
                      decimal.substr(is_digit(decimal[zeros]) ? zeros : zeros - 1)));
    return std::nullopt;
  }
  double value = 0;
  const auto scanned = std::from_chars(decimal.data(), decimal.data() + decimal.size(), value);
  const bool tiny = scanned.ec == std::errc::result_out_of_range && value < 1;
  WrittenNumber number;
  number.value = (negative ? -value : value) * (unit ? unit->si : 1.0);
  if ((scanned.ec != std::errc() && !tiny) || tiny || !std::isfinite(number.value)) {
    error("F207", at, fmt::format("{} is beyond what a double precision number holds", quoted_in_message(text)));
    return std::nullopt;
  }
  if (unit) number.dimension = unit->dimension;
  if (unit && wanted && unit->dimension != *wanted) {
    error("F204", at,
          fmt::format("{} wants {}, got {}", quoted_in_message(label.key), to_string(*wanted),
                      to_string(unit->dimension)),
          dimension_hint(label, *wanted, unit->dimension));
    return std::nullopt;
  }
  return number;
}

std::optional<Expression> ValueReader::formula(const DocumentNode& node) {
  const bool placed = node.verbatim || !node.raw.empty();
  const std::string_view text = node.raw.empty() ? std::string_view(node.text) : std::string_view(node.raw);
  const std::size_t behind = text.find('=') + 1;
  if (placed && text.substr(0, behind).find('\n') == std::string_view::npos) {
    SourceRange at = node.text_at;
    at.column += static_cast<int>(behind);
    at.length = static_cast<int>(text.size() - behind);
    return Expression::parse(text.substr(behind), at, diagnostics_);
  }
  // Escaped text or a block of text: columns inside it mean nothing, so errors stand at its start.
  Diagnostics found;
  const std::string_view body = trim_left(node.text).substr(1);
  std::optional<Expression> parsed = Expression::parse(body, node.at, found);
  for (const Diagnostic& one : found.items()) diagnostics_.error(one.code, node.at, one.message, one.hint);
  return parsed;
}

Number ValueReader::number(const DocumentNode& node, ValueLabel label, std::optional<Dimension> wanted,
                           std::optional<Dimension>* written) {
  if (!node.is_scalar()) {
    wrong_type(node, label, "a number");
    return reported_number(node.at);
  }
  Number number;
  number.at = node.at;
  if (trim_left(node.text).substr(0, 1) == "=") {
    number.expression = formula(node);
    return number.expression ? number : reported_number(node.at);
  }
  if (node.kind == Kind::kQuoted && scan_decimal(node.text) == node.text.size() && !node.text.empty()) {
    error("F203", node.at, fmt::format("{} wants a number, got a text in quotes", quoted_in_message(label.key)),
          fmt::format("take the quotes away: {}", node.text.substr(0, 60)));
    return reported_number(node.at);
  }
  const auto read = written_number(node.text, node.at, label, wanted);
  if (!read) return reported_number(node.at);
  number.value = read->value;
  if (written != nullptr) *written = read->dimension;
  return number;
}

bool ValueReader::is_list(const DocumentNode& node, ValueLabel label, std::size_t count, std::string_view of) {
  const std::string wanted = count > 0 ? fmt::format("a list of {} {}", count, of) : fmt::format("a list of {}", of);
  if (node.kind != Kind::kSequence) {
    wrong_type(node, label, wanted);
    return false;
  }
  if (count == 0 || node.items.size() == count) return true;
  std::string hint;
  for (const DocumentNode& item : node.items) {
    if (item.kind == Kind::kPlain && item.text.substr(0, 1) == "=" && item.text.find('(') != std::string::npos &&
        item.text.find(')') == std::string::npos) {
      hint = "a formula with a comma needs quotes in a list";
    }
  }
  error("F208", node.at, fmt::format("{} wants {}, got {}", quoted_in_message(label.key), wanted, node.items.size()),
        std::move(hint));
  return false;
}

std::vector<Number> ValueReader::numbers(const DocumentNode& node, ValueLabel label, std::size_t count,
                                         std::span<const std::optional<Dimension>> wanted) {
  if (!is_list(node, label, count, "numbers")) return std::vector<Number>(count, reported_number(node.at));
  std::vector<Number> list;
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    const std::size_t which = wanted.size() == 1 ? 0 : i;
    list.push_back(number(node.items[i], label, which < wanted.size() ? wanted[which] : std::nullopt));
  }
  return list;
}

Number3 ValueReader::vector3(const DocumentNode& node, ValueLabel label, std::optional<Dimension> wanted) {
  const std::vector<Number> list = numbers(node, label, 3, std::span(&wanted, 1));
  return {list[0], list[1], list[2]};
}

Number3 ValueReader::vector3_or_scalar(const DocumentNode& node, ValueLabel label, std::optional<Dimension> wanted,
                                       bool may_be_rigid) {
  const auto one = [&](const DocumentNode& item) {
    if (!may_be_rigid || item.kind != Kind::kPlain || item.text != "rigid") return number(item, label, wanted);
    Number rigid(std::numeric_limits<double>::infinity());
    rigid.at = item.at;
    return rigid;
  };
  if (node.kind != Kind::kSequence) {
    const Number same = one(node);
    return {same, same, same};
  }
  if (!is_list(node, label, 3, "numbers")) return reported_vector(node.at);
  return {one(node.items[0]), one(node.items[1]), one(node.items[2])};
}

Number3 ValueReader::direction(const DocumentNode& node, ValueLabel label) {
  if (!node.is_scalar()) return vector3(node, label, kPureNumber);
  const bool negative = node.text.substr(0, 1) == "-";
  const std::string_view letter = std::string_view(node.text).substr(negative ? 1 : 0);
  const std::size_t which = letter.size() == 1 ? std::string_view("xyz").find(letter) : std::string_view::npos;
  if (which == std::string_view::npos) {
    error("F203", node.at, fmt::format("{} wants a direction, got {}", quoted_in_message(label.key), describe(node)),
          "x, y, z, -x, -y, -z, or a vector [x, y, z]");
    return reported_vector(node.at);
  }
  Number3 vector = number3(0, 0, 0);
  for (Number& entry : vector) entry.at = node.at;
  vector[which].value = negative ? -1.0 : 1.0;
  return vector;
}

PlaceSpec ValueReader::place(const DocumentNode& node, ValueLabel label, bool is_direction) {
  const auto one = [&](const DocumentNode& value) {
    return is_direction ? direction(value, label) : vector3(value, label, kLength);
  };
  PlaceSpec place;
  place.at = node.at;
  if (node.kind == Kind::kMap) {
    for (const DocumentEntry& entry : node.entries) {
      place.on_body.emplace_back(NameRef(entry.key, entry.key_at), one(entry.value));
    }
    if (place.on_body.empty()) {
      error("F202", node.at, fmt::format("{} names no body", quoted_in_message(label.key)),
            "give it for both bodies, or once as drawn");
      place.drawn = reported_vector(node.at);
    }
  } else {
    place.drawn = one(node);
  }
  return place;
}

std::optional<std::array<Number3, 2>> ValueReader::point_pair(const DocumentNode& node, ValueLabel label) {
  if (!is_list(node, label, 2, "points")) return std::nullopt;
  return std::array{vector3(node.items[0], label, kLength), vector3(node.items[1], label, kLength)};
}

std::optional<int> ValueReader::integer(const DocumentNode& node, ValueLabel label) {
  int value = 0;
  const std::string_view text = node.text;
  if (node.kind == Kind::kPlain && (text.size() == 1 || (!text.empty() && text[0] != '0'))) {
    const auto scanned = std::from_chars(text.data(), text.data() + text.size(), value);
    if (scanned.ec == std::errc() && scanned.ptr == text.data() + text.size()) return value;
  }
  wrong_type(node, label, "a whole number");
  return std::nullopt;
}

std::optional<bool> ValueReader::boolean(const DocumentNode& node, ValueLabel label) {
  if (node.kind == Kind::kPlain && node.text == "true") return true;
  if (node.kind == Kind::kPlain && node.text == "false") return false;
  wrong_type(node, label, "true or false", node.is_scalar() ? "only the words true and false are read as such" : "");
  return std::nullopt;
}

std::optional<std::string> ValueReader::text(const DocumentNode& node, ValueLabel label) {
  if (node.kind == Kind::kQuoted) return node.text;
  if (node.kind == Kind::kPlain) {
    const bool is_number = scan_decimal(node.text) == node.text.size();
    if (!is_number && !is_word(node.text, {"true", "false"})) return node.text;
    error("F203", node.at,
          fmt::format("{} wants a text, got {}", quoted_in_message(label.key), node.text.substr(0, 60)),
          fmt::format("a text that looks like something else needs quotes: \"{}\"", node.text.substr(0, 60)));
    return std::nullopt;
  }
  wrong_type(node, label, "a text");
  return std::nullopt;
}

std::optional<NameRef> ValueReader::name(const DocumentNode& node, ValueLabel label) {
  if (node.is_scalar() && !node.text.empty()) return NameRef(node.text, node.at);
  wrong_type(node, label, "a name");
  return std::nullopt;
}

std::optional<std::string_view> ValueReader::choice(const DocumentNode& node, ValueLabel label,
                                                    std::span<const std::string_view> choices) {
  if (!node.is_scalar()) {
    wrong_type(node, label, "a word", fmt::format("one of {}", fmt::join(choices, ", ")));
    return std::nullopt;
  }
  for (const std::string_view candidate : choices) {
    if (node.text == candidate) return candidate;
  }
  const std::string near = did_you_mean(node.text, choices);
  error("F209", node.at, fmt::format("{} cannot be {}", quoted_in_message(label.key), quoted_in_message(node.text)),
        near.empty() ? fmt::format("one of {}", fmt::join(choices, ", ")) : near);
  return std::nullopt;
}

std::optional<CoordinateRef> ValueReader::coordinate(const DocumentNode& node, ValueLabel label) {
  const std::optional<NameRef> whole = name(node, label);
  if (!whole) return std::nullopt;
  CoordinateRef ref;
  const std::size_t dot = whole->name.find('.');
  ref.joint = NameRef(whole->name.substr(0, dot), whole->at);
  if (dot != std::string::npos) ref.coordinate = whole->name.substr(dot + 1);
  return ref;
}

std::optional<Expression> ValueReader::expression(const DocumentNode& node, ValueLabel label) {
  if (node.is_scalar() && trim_left(node.text).substr(0, 1) == "=") return formula(node);
  std::string hint;
  if (node.is_scalar()) hint = fmt::format("a formula starts with '=': \"= {}\"", node.text.substr(0, 60));
  wrong_type(node, label, "a formula", std::move(hint));
  return std::nullopt;
}

std::optional<Expression> ValueReader::formula_or_number(const DocumentNode& node, ValueLabel label) {
  const Number value = number(node, label, std::nullopt);
  if (value.expression) return value.expression;
  if (!std::isfinite(value.value)) return std::nullopt;
  return Expression::constant(value.value);
}

std::vector<std::vector<Expression>> ValueReader::formula_matrix(const DocumentNode& node, ValueLabel label) {
  std::vector<std::vector<Expression>> rows;
  if (!is_list(node, label, 0, "rows")) return rows;
  for (const DocumentNode& row : node.items) {
    if (!is_list(row, label, 0, "formulas")) return {};
    std::vector<Expression>& entries = rows.emplace_back();
    for (const DocumentNode& entry : row.items)
      entries.push_back(formula_or_number(entry, label).value_or(Expression()));
  }
  return rows;
}

std::vector<std::pair<CoordinateRef, const DocumentNode*>> ValueReader::by_coordinate(const DocumentNode& node,
                                                                                      ValueLabel label) {
  std::vector<std::pair<CoordinateRef, const DocumentNode*>> out;
  if (node.kind == Kind::kNull || node.kind == Kind::kBroken) return out;
  if (node.kind != Kind::kMap) {
    wrong_type(node, label, "a map from coordinates to formulas", fmt::format("{}: {{theta: = ...}}", label.key));
    return out;
  }
  for (const DocumentEntry& entry : node.entries) {
    DocumentNode key;
    key.kind = Kind::kPlain;
    key.text = entry.key;
    key.at = entry.key_at;
    if (auto ref = coordinate(key, label)) out.emplace_back(std::move(*ref), &entry.value);
  }
  return out;
}

std::vector<std::pair<CoordinateRef, Expression>> ValueReader::coordinate_formulas(const DocumentNode& node,
                                                                                   ValueLabel label) {
  std::vector<std::pair<CoordinateRef, Expression>> out;
  for (auto& [ref, value] : by_coordinate(node, label)) {
    if (auto formula = formula_or_number(*value, label)) out.emplace_back(std::move(ref), std::move(*formula));
  }
  return out;
}

std::vector<std::pair<CoordinateRef, LawSpec>> ValueReader::coordinate_laws(const DocumentNode& node,
                                                                            ValueLabel label) {
  std::vector<std::pair<CoordinateRef, LawSpec>> out;
  for (auto& [ref, value] : by_coordinate(node, label)) {
    if (auto one = law(*value, label, std::nullopt)) out.emplace_back(std::move(ref), std::move(*one));
  }
  return out;
}

std::optional<LawSpec> ValueReader::law(const DocumentNode& node, ValueLabel label, std::optional<Dimension> wanted) {
  LawSpec law;
  law.at = node.at;
  if (node.kind == Kind::kMap) {
    ObjectReader object(*this, node, Family::kLawFile, {"", node.at});
    const std::optional<std::string> file = object.text("file");
    const std::optional<int> column = object.has("column") ? object.integer("column") : std::optional(2);
    if (!file || !column) return std::nullopt;
    if (*column < 2) {
      error("F215", object.place("column"), "the values of a law cannot stand in this column",
            "columns count from 1, and column 1 is the time");
      return std::nullopt;
    }
    law.file = *file;
    law.column = *column;
    law.samples = laws_.read(*file, *column, object.place("file"), diagnostics_);
    return law.samples ? std::optional(law) : std::nullopt;
  }
  if (!node.is_scalar()) {
    wrong_type(node, label, "a law", "a number, \"= formula of t\", or {file: law.csv, column: 2}");
    return std::nullopt;
  }
  const Number value = number(node, label, wanted);
  if (value.expression)
    law.expression = value.expression;
  else if (std::isfinite(value.value))
    law.expression = Expression::constant(value.value);
  return law.expression ? std::optional(law) : std::nullopt;
}

}  // namespace ferrers
