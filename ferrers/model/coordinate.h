#pragma once

#include <compare>

#include "ferrers/core/ids.h"

// g++ takes scoped enumerators for shadows of the dimensions of the same names; they are not.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"

namespace ferrers {

/// One coordinate of one joint: `index` counts the joint type's velocity coordinates, in the order of their names
/// (spherical: 0..2 are omega_x..z; free: 0..2 are omega_x..z, 3..5 are v_x..z).
struct JointCoordinate {
  JointId joint;
  int index = 0;
  auto operator<=>(const JointCoordinate&) const = default;
};

/// A value that a law reads: time, or a joint coordinate's position or velocity.
struct LawInput {
  enum class Kind { kTime, kPosition, kVelocity };
  Kind kind = Kind::kTime;
  JointCoordinate coordinate;  ///< Not used by kTime.
  bool operator==(const LawInput&) const = default;
};

}  // namespace ferrers

#pragma GCC diagnostic pop
