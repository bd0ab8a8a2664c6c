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

/// A scalar of the state that formulas read: a joint coordinate, a generalized coordinate (see `Model::joints`), or
/// one world coordinate of a recorded point.
struct StateScalar {
  JointCoordinate coordinate;  ///< Not used by points.
  int point = -1;              ///< Index into `Model::records`, or −1: a coordinate.
  int axis = 0;                ///< 0, 1, 2: x, y, z of the point.
  bool is_point() const { return point >= 0; }
  auto operator<=>(const StateScalar&) const = default;
};

/// A value that a law reads: time, or a scalar's position or velocity.
struct LawInput {
  enum class Kind { kTime, kPosition, kVelocity };
  Kind kind = Kind::kTime;
  StateScalar scalar;  ///< Not used by kTime.
  bool operator==(const LawInput&) const = default;
};

}  // namespace ferrers

#pragma GCC diagnostic pop
