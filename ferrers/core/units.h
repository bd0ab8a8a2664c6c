#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace ferrers {

/// Physical dimension as exponents of length, mass and time; an angle counts as a pure number.
struct Dimension {
  int length = 0;
  int mass = 0;
  int time = 0;

  bool operator==(const Dimension&) const = default;
  Dimension operator*(const Dimension& o) const { return {length + o.length, mass + o.mass, time + o.time}; }
  Dimension operator/(const Dimension& o) const { return {length - o.length, mass - o.mass, time - o.time}; }
};

inline constexpr Dimension kPureNumber{};
inline constexpr Dimension kLength{1, 0, 0};
inline constexpr Dimension kMass{0, 1, 0};
inline constexpr Dimension kTime{0, 0, 1};
inline constexpr Dimension kVelocity{1, 0, -1};
inline constexpr Dimension kAngularVelocity{0, 0, -1};
inline constexpr Dimension kAcceleration{1, 0, -2};
inline constexpr Dimension kForce{1, 1, -2};
inline constexpr Dimension kTorque{2, 1, -2};
inline constexpr Dimension kInertia{2, 1, 0};
inline constexpr Dimension kStiffness{0, 1, -2};
inline constexpr Dimension kDamping{0, 1, -1};
inline constexpr Dimension kTorsionDamping{2, 1, -1};

/// A unit: its value in SI, and its dimension. `200 N*m` is `200 * si` in SI.
struct Unit {
  double si = 1;
  Dimension dimension;
};

/// Reads a unit: names with SI prefixes joined by `*`, `·`, `/` and powers (`N*m`, `kg*m^2`, `mm/s²`, `deg`, `rpm`,
/// `in`), worked off from left to right: `N/m*s` is (N/m)·s. A leading `1/` is allowed. `Hz` is no unit: ambiguous by
/// 2π. Empty when the text is no unit. Cost: O(length).
std::optional<Unit> parse_unit(std::string_view text);

/// `value` in SI. Units that are a whole fraction of the SI unit divide, so that `0.7 mm^2` is the double nearest 7e-7.
double to_si(double value, const Unit& unit);

/// The dimension in the words of the field, for messages: "N/m", "kg*m^2", "a pure number".
std::string to_string(const Dimension& dimension);

}  // namespace ferrers
