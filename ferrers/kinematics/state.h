#pragma once

#include "ferrers/kinematics/system.h"

namespace ferrers {

/// Where a mechanism is and how it moves, in tree joint coordinates.
struct State {
  double t = 0;
  VectorXd q;  ///< nq; rotations of spherical and free joints as unit quaternions (w, x, y, z).
  VectorXd v;  ///< nv.
  /// The last accepted value of every cut joint's angles (rad): a pose tells an angle only up to full turns, so the
  /// turn nearest to this reference is meant.
  VectorXd winding;
};

/// The drawn configuration at rest.
State make_drawn_state(const System& system);

/// qdot = E(q) v. Shapes: nq, nv → nq.
void compute_position_rates(const System& system, const VectorXd& q, const VectorXd& v, VectorXd& q_rate);

/// q ⊕ dv: moves q along the velocity-like displacement dv for unit time, quaternions by the exponential map.
void displace(const System& system, const VectorXd& dv, VectorXd& q);

/// Brings every quaternion back to unit length.
void normalize_quaternions(const System& system, VectorXd& q);

}  // namespace ferrers
