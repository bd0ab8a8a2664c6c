#pragma once

#include <string>
#include <vector>

#include "ferrers/kinematics/constraints.h"
#include "ferrers/kinematics/scaling.h"

/// Problem: multipliers live on the cut joints' rows only. A reaction or a self-stress loads every joint.
///
/// Given: the multipliers of the closure rows, forces on the bodies and efforts in the joints. Wanted: the multipliers
/// of all joints' rows. Each tree joint carries what its outboard side needs for equilibrium; what its rows cannot
/// carry is the effort along its freedoms. Cost: O(bodies + rows).
namespace ferrers {

/// Rows of every joint and coupling in the order of the file (closure rows are some of them).
struct AllRows {
  std::vector<int> first;  ///< Per joint, then per coupling: first row.
  std::vector<int> count;
  std::vector<std::string> names;  ///< "joint/force_x"; a coupling's name.
  VectorXd scale;                  ///< Like Scaling::rows.
  std::vector<int> closure_row;    ///< Row of phi and G, or −1 for a tree joint's row.
  int size() const { return static_cast<int>(names.size()); }
};
AllRows make_all_rows(const System& system, const Scaling& scaling);

/// One joint's rows at a pose: where they act and their wrenches on the second body.
struct JointFrameWrenches {
  RelativeMotion motion;
  Vector3d p_M = Vector3d::Zero();                      ///< World, m.
  Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6> T;  ///< 6 × rows, (moment, force) at p_M, world axes.
};

/// All joints' at one pose, and the gradients of the couplings there.
struct JointWrenches {
  std::vector<JointFrameWrenches> joints;
  std::vector<std::vector<double>> coupling_coefficients;  ///< Per coupling and scalar.
  const JointFrameWrenches& operator[](std::size_t joint) const { return joints[joint]; }
  std::size_t size() const { return joints.size(); }
};

/// All joints' row wrenches at one pose.
JointWrenches compute_joint_frame_wrenches(const System& system, const State& state, const PositionKinematics& pos);

/// A wrench per unit effort along a scalar that is no entry of v: on the second node of its frames, opposite on the
/// first.
struct ScalarWrench {
  const FramePair* frames = nullptr;
  Vector3d p = Vector3d::Zero();  ///< World, m.
  Wrench w = Wrench::Zero();
};
ScalarWrench scalar_wrench(const System& system, const StateScalar& scalar, const CoordinateAccess& access,
                           const PositionKinematics& pos, const JointWrenches& joints);

/// Wrench per unit effort along scalar coordinate `index` of a joint, on its second body at p_M.
Wrench effort_wrench(const System& system, JointCoordinate coordinate, const JointFrameWrenches& joint);

using Wrenches = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// What loads the mechanism besides the tree joints' reactions: k load cases at once.
struct Loads {
  std::vector<Wrenches> on_nodes;  ///< Per node 6 × k, at its origin, world axes: applied minus inertia forces.
  MatrixXd lambda;                 ///< m × k: multipliers of the closure rows.
  MatrixXd tree_efforts;           ///< nv × k: efforts along tree coordinates (drives, springs), without couplings.
};
Loads make_loads(const System& system, int cases);

/// Adds `scale` times a wrench given at the world point `p` to the load on a node.
void add_wrench(const PositionKinematics& pos, int node, const Vector3d& p, const Eigen::Ref<const Wrenches>& w,
                double scale, std::vector<Wrenches>& on_nodes);

/// The part of a tree joint's wrenches (on its second body, at p_M) that its rows carry: least squares with moments
/// over `length`. Shape: rows × cases.
MatrixXd constraint_part(const JointFrameWrenches& joint, const Wrenches& w, double length_m);

/// Multipliers of all rows that balance the loads: AllRows::size() × k. Uses up `loads`.
MatrixXd distribute_to_joints(const System& system, const AllRows& rows, const Scaling& scaling,
                              const PositionKinematics& pos, const JointWrenches& joints, Loads loads);

}  // namespace ferrers
