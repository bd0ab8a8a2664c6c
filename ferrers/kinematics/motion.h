#pragma once

#include <vector>

#include "ferrers/kinematics/state.h"

namespace ferrers {

/// Poses of all nodes and the tree joints' motion subspaces. Valid after `compute_positions`. T: `double`, or `Traced`
/// where an evaluation is written down (dynamics/forward_program.h).
template <class T>
struct BasicPositionKinematics {
  using Vector = Eigen::Matrix<T, 3, 1>;
  using Matrix = Eigen::Matrix<T, 3, 3>;
  struct NodePosition {
    Matrix R = Matrix::Identity();    ///< Node frame in the world.
    Vector p = Vector::Zero();        ///< Its origin, m.
    Vector lever = Vector::Zero();    ///< p_F − p_M of a reversed inboard joint, else zero.
    Matrix R_F = Matrix::Identity();  ///< F of the inboard joint in the world.
  };
  std::vector<NodePosition> nodes;
  /// nv columns: twist of node i per unit velocity coordinate, world axes, at the node's origin.
  std::vector<Eigen::Matrix<T, 6, 1>> S;
};
using PositionKinematics = BasicPositionKinematics<double>;

/// Twists of all nodes, and the accelerations that they have when every vdot is zero. Valid after `compute_velocities`.
template <class T>
struct BasicVelocityKinematics {
  using Vector = Eigen::Matrix<T, 3, 1>;
  struct NodeVelocity {
    Vector w = Vector::Zero();      ///< ω, rad/s.
    Vector v = Vector::Zero();      ///< Velocity of the node's origin, m/s.
    Vector alpha = Vector::Zero();  ///< Bias of ω̇.
    Vector a = Vector::Zero();      ///< Bias of the acceleration of the origin.
  };
  std::vector<NodeVelocity> nodes;
};
using VelocityKinematics = BasicVelocityKinematics<double>;

template <class T>
BasicPositionKinematics<T> make_basic_position_kinematics(const System& system);
template <class T>
BasicVelocityKinematics<T> make_basic_velocity_kinematics(const System& system);
PositionKinematics make_position_kinematics(const System& system);
VelocityKinematics make_velocity_kinematics(const System& system);

/// q → poses and S. Allocates nothing. Cost: O(bodies).
template <class T>
void compute_positions(const System& system, const Eigen::Matrix<T, Eigen::Dynamic, 1>& q,
                       BasicPositionKinematics<T>& out);

/// v → twists and bias accelerations. Allocates nothing. Cost: O(bodies).
template <class T>
void compute_velocities(const System& system, const BasicPositionKinematics<T>& pos,
                        const Eigen::Matrix<T, Eigen::Dynamic, 1>& q, const Eigen::Matrix<T, Eigen::Dynamic, 1>& v,
                        BasicVelocityKinematics<T>& out);

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
