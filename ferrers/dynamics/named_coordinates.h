#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ferrers/dynamics/dynamics_model.h"
#include "ferrers/kinematics/scaling.h"
#include "ferrers/redundancy/analysis.h"

/// Problem: positions and motions are found in tree coordinates; people think in joints, those that close loops too.
///
/// Given: a state, or a motion v. Wanted: the coordinates of all joints in the order of the file, named
/// "joint.coordinate" as in result.csv, with their units (rad, m; none: a part of a quaternion). Cost: O(bodies).
namespace ferrers {

struct NamedCoordinate {
  enum class Unit { kRadian, kMetre, kNone };
  std::string name;
  Unit unit = Unit::kNone;
  double value = 0;
};

/// Positions of all joints' coordinates; angles of joints that close loops with the turns of `state.winding`.
std::vector<NamedCoordinate> measure_positions(const System& system, const State& state);

/// Rates of all joints' coordinates when the tree coordinates move with `v` (nv); rotations of spherical and free
/// joints as omega_x … in first-body axes.
std::vector<NamedCoordinate> measure_rates(const System& system, const State& state, const VectorXd& v);

/// The independent coordinates of a selection, with their rates in `v` (nv).
std::vector<NamedCoordinate> name_independent(const System& system, const Selection& selection, const VectorXd& v);

/// The coordinates that take the largest part in a motion, most first, each with its value and the suffix of its unit:
/// "pivot.angle (-9.81 rad/s²), …".
std::string name_motion(const System& system, const Scaling& scaling, const State& state, const VectorXd& v,
                        std::string_view unit_suffix);

std::string_view to_string(NamedCoordinate::Unit unit);

}  // namespace ferrers
