#pragma once

#include "ferrers/dynamics/equations.h"
#include "ferrers/kinematics/joint_wrenches.h"

/// What loads the joints of a mechanism that moves: applied and inertia forces of the bodies, multipliers of the
/// closure rows, efforts in the joints. `distribute_to_joints` makes every joint's reaction of it.
namespace ferrers {

/// The loads at one state: `eq` filled there, with accelerations `vdot` (nv), multipliers `lambda` (the first m entries
/// are read) and drive efforts `u` (nu). Dry friction is that in `eq.friction`. One load case. Cost: O(bodies).
Loads make_motion_loads(const DynamicsModel& model, const State& state, const Equations& eq, const VectorXd& vdot,
                        const VectorXd& lambda, const VectorXd& u);

/// By how much the loads change with accelerations, multipliers, drive efforts and dry friction: the linear part of
/// `make_motion_loads`, one load case per column. Shapes: nv × k, m × k (more rows are not read), nu × k, nf × k.
struct LoadChanges {
  MatrixXd vdot, lambda, u, friction;
};
Loads make_changed_loads(const DynamicsModel& model, const State& state, const Equations& eq,
                         const LoadChanges& changes);

}  // namespace ferrers
