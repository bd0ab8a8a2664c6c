#pragma once

#include "ferrers/kinematics/joint_wrenches.h"

/// Problem: the closure Jacobian depends on a choice of tree. The same constraints can be written without one: all
/// joints' rows on the velocities of all bodies.
///
/// Given: a system at an assembled configuration. Wanted: G_all with G_all V = 0 for V = (ω, velocity of the node's
/// origin) of every moving body, world axes, six columns a body in the order of the file; rows as in `AllRows`. Its
/// rows minus its rank are the redundancy, 6·bodies minus its rank the mobility, whatever tree was chosen (tested), and
/// the self-stresses of a `RedundancyReport` are its left null space. Cost: O(rows · bodies), dense.
namespace ferrers {

/// G_all in SI units. Shape: rows × `Topology::full_velocities`: 6 per moving body, then the generalized coordinates.
MatrixXd compute_joint_jacobian(const System& system, const State& state, const AllRows& rows);

/// The same with rows and columns comparable: moment rows times L, angular columns divided by L.
MatrixXd compute_scaled_joint_jacobian(const System& system, const State& state, const AllRows& rows, double length_m);

}  // namespace ferrers
