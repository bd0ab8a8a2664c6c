#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "ferrers/model/joints/joint_type.h"
#include "ferrers/model/model.h"
#include "ferrers/topology/topology.h"

/// A model with a choice of tree, laid out for evaluation. Const; shared by every stage and thread.
///
/// Every body gets a *node frame*: its side of its inboard joint. Twists, accelerations and wrenches of a body are
/// taken at the node frame's origin, in world axes, so that nothing depends on how far away the world's origin is.
namespace ferrers {

using VectorXd = Eigen::VectorXd;
using MatrixXd = Eigen::MatrixXd;
using RowMatrixXd = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Constants of one body of the tree.
struct Node {
  int parent = -1;
  int q = 0, v = 0, nq = 0, nv = 0;  ///< First coordinate, and how many.
  bool forward = true;               ///< The parent is the joint's first body.
  const JointTypeInfo* type = nullptr;
  JointConstants constants;
  Pose X_PJ;  ///< Parent's side of the joint, in the parent's node frame.
  Pose X_BN;  ///< This node's frame in its body's frame.
  BodyId body;
};

/// A pair of frames, F on node 1 and M on node 2, whose relative motion is measured.
struct FramePair {
  int node_1 = 0, node_2 = 0;
  Pose X_1F, X_2M;  ///< In the node frames.
  /// Nodes whose coordinates move M against F, with the sign of their share.
  struct PathEntry {
    int node;
    double sign;
  };
  std::vector<PathEntry> path;
};

/// A cut joint as it is evaluated.
struct CutJoint {
  JointId joint;
  const JointTypeInfo* type = nullptr;
  JointConstants constants;
  FramePair frames;
  int row = 0;
  int winding = 0;  ///< First of its references in `State::winding`.
};

/// Where a joint coordinate is found: an entry of q and v, or a function of a cut joint's pose.
struct CoordinateAccess {
  bool in_tree = true;
  int q = -1, v = -1;
  int cut = -1;      ///< Index into `System::cuts`.
  int jet = -1;      ///< Which of the type's coordinate jets.
  int winding = -1;  ///< Reference of an angle, or −1.
};

struct CouplingRow {
  int row = 0;
  std::vector<CoordinateAccess> coordinates;
  std::vector<double> coefficients;
};

/// A point fixed on a node.
struct NodePoint {
  int node = 0;
  Eigen::Vector3d p_N = Eigen::Vector3d::Zero();
};

struct System {
  std::shared_ptr<const Model> model;
  std::shared_ptr<const Topology> topology;
  int nq = 0, nv = 0, m = 0, winding_count = 0;
  std::vector<Node> nodes;  ///< [0] is ground; parents come first.
  std::vector<CutJoint> cuts;
  std::vector<CouplingRow> couplings;
  std::vector<std::string> row_names;         ///< m: "joint/moment_x", or the coupling's name.
  std::vector<std::string> coordinate_names;  ///< nv: "joint" or "joint.coordinate".
  VectorXd drawn_winding;                     ///< Angles of the cut joints as drawn.

  const Joint& joint(const CutJoint& cut) const { return model->joint(cut.joint); }
  CoordinateAccess access(JointCoordinate coordinate) const;
  FramePair frame_pair(BodyId first, const Pose& X_1F, BodyId second, const Pose& X_2M) const;
  /// F and M of any joint, in the tree or cut.
  FramePair frame_pair(JointId joint) const;
  NodePoint point(BodyId body, const Eigen::Vector3d& p_B) const;
};

/// Lays a model out. Cost: linear in the model, times the depth of its loops.
std::shared_ptr<const System> make_system(std::shared_ptr<const Model> model, const TopologyOptions& options = {});
std::shared_ptr<const System> make_system(Model model, const TopologyOptions& options = {});

}  // namespace ferrers
