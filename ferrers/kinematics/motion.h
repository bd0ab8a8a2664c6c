#pragma once

#include <vector>

#include "ferrers/kinematics/state.h"

namespace ferrers {

/// Poses of all nodes and the tree joints' motion subspaces. Valid after `compute_positions`.
struct PositionKinematics {
  struct NodePosition {
    Matrix3d R = Matrix3d::Identity();    ///< Node frame in the world.
    Vector3d p = Vector3d::Zero();        ///< Its origin, m.
    Vector3d lever = Vector3d::Zero();    ///< p_F − p_M of a reversed inboard joint, else zero.
    Matrix3d R_F = Matrix3d::Identity();  ///< F of the inboard joint in the world.
  };
  std::vector<NodePosition> nodes;
  /// nv columns: twist of node i per unit velocity coordinate, world axes, at the node's origin.
  std::vector<Twist> S;
};

/// Twists of all nodes, and the accelerations that they have when every vdot is zero. Valid after `compute_velocities`.
struct VelocityKinematics {
  struct NodeVelocity {
    Vector3d w = Vector3d::Zero();      ///< ω, rad/s.
    Vector3d v = Vector3d::Zero();      ///< Velocity of the node's origin, m/s.
    Vector3d alpha = Vector3d::Zero();  ///< Bias of ω̇.
    Vector3d a = Vector3d::Zero();      ///< Bias of the acceleration of the origin.
  };
  std::vector<NodeVelocity> nodes;
};

PositionKinematics make_position_kinematics(const System& system);
VelocityKinematics make_velocity_kinematics(const System& system);

/// q → poses and S. Allocates nothing. Cost: O(bodies).
void compute_positions(const System& system, const VectorXd& q, PositionKinematics& out);

/// v → twists and bias accelerations. Allocates nothing. Cost: O(bodies).
void compute_velocities(const System& system, const PositionKinematics& pos, const VectorXd& q, const VectorXd& v,
                        VelocityKinematics& out);

/// Accelerations of all nodes with `vdot`: like the bias fields of `vel`, but complete. `out` may have been made by
/// `make_velocity_kinematics`; its twists are copied. Cost: O(bodies).
void compute_accelerations(const System& system, const PositionKinematics& pos, const VelocityKinematics& vel,
                           const VectorXd& vdot, VelocityKinematics& out);

/// Pose of a body's own frame in the world.
Pose body_pose(const System& system, const PositionKinematics& pos, BodyId body);

Vector3d point_position(const PositionKinematics& pos, const NodePoint& point);
Vector3d point_velocity(const PositionKinematics& pos, const VelocityKinematics& vel, const NodePoint& point);
Vector3d point_acceleration(const PositionKinematics& pos, const VelocityKinematics& acc, const NodePoint& point);

}  // namespace ferrers
