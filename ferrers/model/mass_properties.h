#pragma once

#include <Eigen/Core>

/// Inertia tensors of simple solids about their mass centre, and whether a tensor can be that of a body.
///
/// Tensors are 3×3, symmetric, kg·m², with products of inertia as entries (I_xy = −∫ x y dm). Masses in kg, lengths in
/// m. Cost: O(1) each. None of these checks its arguments' signs: `build_model` does, where it can say what is wrong.
namespace ferrers {

/// A thin straight rod of which only the direction and length of `span` (end to end) matter:
/// I = m/12 (|s|² 1 − s sᵀ); zero about its own line.
Eigen::Matrix3d rod_inertia(double mass_kg, const Eigen::Vector3d& span_m);

/// A solid box with the given edge lengths along the axes: I_xx = m/12 (b² + c²), and so on.
Eigen::Matrix3d box_inertia(double mass_kg, const Eigen::Vector3d& size_m);

/// A solid circular cylinder with axis `span` (end to end) and a radius: m r²/2 about the axis, m (3 r² + l²)/12
/// across. `span` must not be zero.
Eigen::Matrix3d cylinder_inertia(double mass_kg, const Eigen::Vector3d& span_m, double radius_m);

/// A solid sphere: 2/5 m r² about every axis.
Eigen::Matrix3d sphere_inertia(double mass_kg, double radius_m);

/// The tensor with the given diagonal (I_xx, I_yy, I_zz) and off-diagonal entries (I_xy, I_xz, I_yz).
Eigen::Matrix3d inertia_tensor(const Eigen::Vector3d& moments_kgm2, const Eigen::Vector3d& products_kgm2);

/// The tensor in other axes: R I Rᵀ, where R's columns are the old axes in the new ones.
Eigen::Matrix3d rotate_inertia(const Eigen::Matrix3d& inertia_kgm2, const Eigen::Matrix3d& R);

enum class InertiaVerdict {
  kPhysical,
  kNegative,  ///< A principal moment is negative.
  kTriangle,  ///< A principal moment exceeds the sum of the other two.
};

/// Whether some distribution of mass about the mass centre has this tensor: principal moments I1 ≤ I2 ≤ I3 with I1 ≥ 0
/// and I3 ≤ I1 + I2. Equality (flat bodies, thin rods, points) is physical; what rounding in a file does, a millionth
/// of the trace, is forgiven. Non-finite entries count as physical (they are reported where they come from).
InertiaVerdict check_inertia(const Eigen::Matrix3d& inertia_kgm2);

}  // namespace ferrers
