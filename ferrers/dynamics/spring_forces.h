#pragma once

#include <cmath>

#include "ferrers/dynamics/dynamics_model.h"
#include "ferrers/kinematics/constants.h"

/// Force elements that are written once for numbers and for traced ones (dynamics/traced_equations.h). T: `double` or
/// `Traced`.
namespace ferrers {

template <class T>
struct MovingPoint {
  Eigen::Matrix<T, 3, 1> arm;          ///< From its node's origin, world axes, m.
  Eigen::Matrix<T, 3, 1> place, rate;  ///< m, m/s.
};

template <class T>
MovingPoint<T> moving_point(const BasicPositionKinematics<T>& pos, const BasicVelocityKinematics<T>& vel,
                            const NodePoint& point) {
  MovingPoint<T> out;
  const auto& node = pos.nodes[point.node];
  const auto& motion = vel.nodes[point.node];
  out.arm = node.R * as_constants<T>(point.p_N);
  out.place = node.p + out.arm;
  out.rate = motion.v + motion.w.cross(out.arm);
  return out;
}

/// What a spring pulls its first point with, N: k (|d| − L0) + c d|d|/dt along d, from the first point to the second.
/// Not a number where the points coincide.
template <class T>
Eigen::Matrix<T, 3, 1> spring_force(const BoundSpring& spring, const MovingPoint<T>& first,
                                    const MovingPoint<T>& second) {
  using std::sqrt;
  const Eigen::Matrix<T, 3, 1> d = second.place - first.place;
  const T length = sqrt(d.squaredNorm());
  const Eigen::Matrix<T, 3, 1> along = d / length;
  const Eigen::Matrix<T, 3, 1> parting = second.rate - first.rate;
  const T tension = T(spring.stiffness) * (length - T(spring.free_length_m)) + T(spring.damping) * along.dot(parting);
  return tension * along;
}

/// Effort of a spring and damper along a coordinate, N or N·m.
template <class T>
T torsion_spring_effort(const BoundTorsionSpring& spring, const T& value, const T& rate) {
  return -(T(spring.stiffness) * (value - T(spring.free_angle)) + T(spring.damping) * rate);
}

/// Whether native code knows a spring by itself: its coordinate is an entry of q.
inline bool is_traced(const BoundTorsionSpring& spring) { return spring.access.in_tree; }

}  // namespace ferrers
