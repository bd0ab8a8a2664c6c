#pragma once

#include <array>
#include <vector>

#include "ferrers/model/spec.h"

/// Mechanisms that cannot be put together, by a known amount: parts described on each body by itself.
namespace ferrers::witness {

/// Bennett's linkage link by link: twists 50 and 110 degrees, sides 1 and b; one side of length b is longer by
/// `error_m`. Joints J1 … J4, links link1 … link3 posed where they belong without the error.
ModelSpec make_bennett_links(double error_m);

/// A 1 m arm on a pin about z at the origin, drawn along x, and rods rod0 … from `feet` to its tip, of `lengths_m`.
ModelSpec make_arm_on_rods(const std::vector<std::array<double, 3>>& feet, const std::vector<double>& lengths_m);

/// A door on two hinges about z, 1.7 m apart, whose upper one sits off the axis of the lower one on the door: by
/// `offset_m` along x, turned by `tilt_rad` about x.
ModelSpec make_door_with_odd_hinge(double offset_m, double tilt_rad);

/// A plate on two guides along x at one place; the second one's axis on the plate is turned by `turn_rad` about z.
ModelSpec make_plate_on_skew_guides(double turn_rad);

/// Gives all joints of a specification the same stiffness.
void set_stiffness(ModelSpec& spec, double force, double moment);

}  // namespace ferrers::witness
