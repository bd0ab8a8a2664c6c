#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "ferrers/model/spec.h"

/// The same mechanism described otherwise, for invariance tests: what is physics must not change.
///
/// All of them want literal numbers and drawn places, or posed bodies (a number with an expression throws
/// `std::invalid_argument`: its meaning would change). Joint frames move with the mechanism: where the joint's x axis
/// was left to the default, it is written out first, so that rows keep their meaning. Spherical, weld, free and
/// distance joints have no x key: their frames stay world axes as drawn, so components of their reactions are not
/// comparable.
namespace ferrers::witness {

/// Turned about the world's origin: x → R x, gravity included.
/// Loads of three laws are recombined. Initial values of spherical and free joints throw.
ModelSpec rotated(const ModelSpec& spec, const Eigen::Matrix3d& R);

/// Moved by p. Nothing but places changes (potential energy does, by a constant).
ModelSpec shifted(const ModelSpec& spec, const Eigen::Vector3d& p);

/// Similar mechanism with every length times s; angles, masses and time stay. So gravity and forces are times s,
/// moments, torsional stiffness and damping times s², inertias times s², and translational stiffness and damping stay.
/// Accelerations are times s (angular ones stay), constraint forces times s, constraint moments times s².
ModelSpec scaled(const ModelSpec& spec, double s);

/// The order of bodies, joints, couplings, forces and drives shuffled; names, and each joint's first and second, stay.
ModelSpec permuted(const ModelSpec& spec, std::uint64_t seed);

/// Every body in parts: the file's, a second one with a share of its mass and inertia and a frame of its own, and
/// sometimes a third without mass, held together by welds with `merge`; joints with drawn places sit on any of them.
/// Bodies keep their names and places in the list, parts and welds come after all others.
ModelSpec in_parts(const ModelSpec& spec, std::uint64_t seed);

}  // namespace ferrers::witness
