#include "ferrers/core/units.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "ferrers/core/unit_names.h"

namespace ferrers {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kMaxPower = 99;

/// A unit as `factor · 10^decade`: decades are added up as integers, so that `mm^2` is exactly the double 1e-6.
struct Scaled {
  double factor = 1;
  int decade = 0;
  Dimension dimension;
};

struct NamedUnit {
  std::string_view name;
  Scaled unit;
  bool prefixes = false;  // Takes SI prefixes.
};

// Hz is left out on purpose: read as an angular velocity it would be wrong by 2π without a word.
constexpr NamedUnit kUnits[] = {
    {"m", {1, 0, kLength}, true},
    {"g", {1, -3, kMass}, true},
    {"s", {1, 0, kTime}, true},
    {"N", {1, 0, kForce}, true},
    {"J", {1, 0, kTorque}, true},
    {"W", {1, 0, {2, 1, -3}}, true},
    {"Pa", {1, 0, {-1, 1, -2}}, true},
    {"bar", {1, 5, {-1, 1, -2}}, true},
    {"rad", {1, 0, kPureNumber}, true},
    {"deg", {kPi / 180, 0, kPureNumber}},
    {"°", {kPi / 180, 0, kPureNumber}},
    {"rev", {2 * kPi, 0, kPureNumber}},
    {"turn", {2 * kPi, 0, kPureNumber}},
    {"rpm", {kPi / 30, 0, kAngularVelocity}},
    {"min", {60, 0, kTime}},
    {"h", {3600, 0, kTime}},
    {"tonne", {1, 3, kMass}},
    {"in", {254, -4, kLength}},
    {"ft", {3048, -4, kLength}},
    {"lb", {45359237, -8, kMass}},
    {"lbf", {4.4482216152605, 0, kForce}},
    {"kgf", {9.80665, 0, kForce}},
    {"psi", {6894.757293168361, 0, {-1, 1, -2}}},
};

struct Prefix {
  std::string_view name;
  int decade;
};

constexpr Prefix kPrefixes[] = {
    {"p", -12},
    {"n", -9},
    {"u", -6},
    {"µ", -6} /* micro sign */,
    {"μ", -6} /* Greek mu */,
    {"m", -3},
    {"c", -2},
    {"d", -1},
    {"h", 2},
    {"k", 3},
    {"M", 6},
    {"G", 9},
    {"T", 12},
};

std::optional<Scaled> find_unit(std::string_view word) {
  for (const NamedUnit& unit : kUnits) {
    if (unit.name == word) return unit.unit;
  }
  for (const NamedUnit& unit : kUnits) {
    if (!unit.prefixes || !word.ends_with(unit.name)) continue;
    const std::string_view front = word.substr(0, word.size() - unit.name.size());
    for (const Prefix& prefix : kPrefixes) {
      if (prefix.name != front) continue;
      Scaled scaled = unit.unit;
      scaled.decade += prefix.decade;
      return scaled;
    }
  }
  return std::nullopt;
}

/// Reads a unit left to right; every `take_` moves on only when it succeeds.
class UnitReader {
 public:
  explicit UnitReader(std::string_view text) : rest_(text) {}

  std::optional<Scaled> read() {
    skip_spaces();
    Scaled total;
    bool divide = false;
    if (take("1")) {  // "1/s"
      skip_spaces();
      if (!take("/")) return std::nullopt;
      divide = true;
      skip_spaces();
    }
    while (true) {
      const std::optional<Scaled> unit = find_unit(take_word());
      if (!unit) return std::nullopt;
      const std::optional<int> power = take_power();
      if (!power) return std::nullopt;
      multiply(total, *unit, divide ? -*power : *power);
      skip_spaces();
      if (rest_.empty()) return total;
      divide = take("/");
      if (!divide && !take("*") && !take("·")) return std::nullopt;
      skip_spaces();
    }
  }

 private:
  static void multiply(Scaled& total, const Scaled& unit, int power) {
    total.factor *= std::pow(unit.factor, power);
    total.decade += power * unit.decade;
    total.dimension.length += power * unit.dimension.length;
    total.dimension.mass += power * unit.dimension.mass;
    total.dimension.time += power * unit.dimension.time;
  }

  void skip_spaces() {
    while (!rest_.empty() && (rest_.front() == ' ' || rest_.front() == '\t')) rest_.remove_prefix(1);
  }

  bool take(std::string_view token) {
    if (!rest_.starts_with(token)) return false;
    rest_.remove_prefix(token.size());
    return true;
  }

  /// ASCII letters, and the three other signs that unit names use.
  std::string_view take_word() {
    const std::string_view start = rest_;
    while (!rest_.empty()) {
      const char c = rest_.front();
      if ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z')) {
        rest_.remove_prefix(1);
      } else if (!take("µ") && !take("μ") && !take("°")) {
        break;
      }
    }
    return start.substr(0, start.size() - rest_.size());
  }

  /// `^-2`, `²`; 1 when there is none, empty when it is malformed.
  std::optional<int> take_power() {
    const bool caret = take("^");
    const bool negative = caret ? take("-") : take("⁻");
    int power = 0, digits = 0;
    for (int digit = caret ? take_ascii_digit() : take_superscript(); digit >= 0; ++digits) {
      power = std::min(10 * power + digit, kMaxPower + 1);
      digit = caret ? take_ascii_digit() : take_superscript();
    }
    if (digits == 0) return caret || negative ? std::nullopt : std::optional(1);
    if (power > kMaxPower) return std::nullopt;
    return negative ? -power : power;
  }

  int take_ascii_digit() {
    if (rest_.empty() || rest_.front() < '0' || rest_.front() > '9') return -1;
    const int digit = rest_.front() - '0';
    rest_.remove_prefix(1);
    return digit;
  }

  int take_superscript() {
    constexpr std::string_view kDigits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    for (int digit = 0; digit < 10; ++digit) {
      if (take(kDigits[digit])) return digit;
    }
    return -1;
  }

  std::string_view rest_;
};

}  // namespace

std::optional<Unit> parse_unit(std::string_view text) {
  constexpr std::size_t kMaxLength = 100;  // Keeps every sum of exponents far from overflow.
  if (text.size() > kMaxLength) return std::nullopt;
  const std::optional<Scaled> scaled = UnitReader(text).read();
  if (!scaled || std::abs(scaled->decade) > 300) return std::nullopt;
  const double power = std::pow(10.0, std::abs(scaled->decade));
  const double si = scaled->decade < 0 ? scaled->factor / power : scaled->factor * power;
  if (!std::isnormal(si)) return std::nullopt;
  return Unit{si, scaled->dimension};
}

std::vector<UnitName> unit_names() {
  std::vector<UnitName> names;
  for (const NamedUnit& unit : kUnits) names.push_back({unit.name, unit.prefixes});
  return names;
}

std::vector<std::string_view> unit_prefixes() {
  std::vector<std::string_view> names;
  for (const Prefix& prefix : kPrefixes) names.push_back(prefix.name);
  return names;
}

double to_si(double value, const Unit& unit) {
  const double parts = 1.0 / unit.si;
  return parts > 1.0 && parts == std::floor(parts) ? value / parts : value * unit.si;
}

std::string to_string(const Dimension& dimension) {
  static constexpr struct {
    Dimension dimension;
    std::string_view words;
  } kWords[] = {
      {kPureNumber, "a pure number"}, {kForce, "N"},     {kTorque, "N*m"},    {kStiffness, "N/m"}, {kDamping, "N*s/m"},
      {kTorsionDamping, "N*m*s"},     {{2, 1, -3}, "W"}, {{-1, 1, -2}, "Pa"},
  };
  for (const auto& known : kWords) {
    if (known.dimension == dimension) return std::string(known.words);
  }
  const std::pair<std::string_view, int> bases[] = {
      {"kg", dimension.mass}, {"m", dimension.length}, {"s", dimension.time}};
  std::string above, below;
  for (const auto& [name, exponent] : bases) {
    if (exponent == 0) continue;
    std::string& side = exponent > 0 ? above : below;
    if (exponent < 0) {
      side += "/";
    } else if (!side.empty()) {
      side += "*";
    }
    side += name;
    if (std::abs(exponent) != 1) side += "^" + std::to_string(std::abs(exponent));
  }
  return (above.empty() ? "1" : above) + below;
}

}  // namespace ferrers
