#pragma once

#include "ferrers/kinematics/constraints.h"

namespace ferrers {

/// One scalar of the state as a jet: value, rate, and (for a cut joint or a point) W and bias at its frames. For a tree
/// joint W is unused: the coordinate is an entry of q and v.
Jet measure_coordinate(const System& system, const CoordinateAccess& access, const State& state,
                       const PositionKinematics& pos, const VelocityKinematics& acc);

/// Zeros the entries of `row` (nv) that `add_coordinate_row` can change.
void clear_coordinate_row(const System& system, const CoordinateAccess& access, Eigen::Ref<Eigen::RowVectorXd> row);

/// Adds `scale` · ∂(rate)/∂v of a coordinate to `row` (nv).
void add_coordinate_row(const System& system, const CoordinateAccess& access, const PositionKinematics& pos,
                        const Jet& jet, double scale, Eigen::Ref<Eigen::RowVectorXd> row);

/// All coordinates of one joint, in the tree or cut: positions (nq of its type), velocities and accelerations (nv).
/// `acc` must hold complete accelerations. Cut angles are continued from `state.winding`.
struct JointMotion {
  double q[7] = {};
  double v[6] = {};
  double vdot[6] = {};
};
JointMotion measure_joint(const System& system, JointId joint, const State& state, const VectorXd& vdot,
                          const PositionKinematics& pos, const VelocityKinematics& acc);

}  // namespace ferrers
