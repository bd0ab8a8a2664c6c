#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "ferrers/kinematics/scaling.h"
#include "ferrers/model/joints/joint_type.h"
#include "ferrers/model/model.h"
#include "ferrers/model/state_program.h"
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

/// Where a scalar of the state is found: an entry of q and v, a function of a cut joint's pose, or of a point's.
struct CoordinateAccess {
  bool in_tree = true;
  int q = -1, v = -1;
  int cut = -1;      ///< Index into `System::cuts`.
  int jet = -1;      ///< Which of the type's coordinate jets.
  int winding = -1;  ///< Reference of an angle, or −1.
  int point = -1;    ///< Index into `System::points`, or −1.
  int axis = 0;      ///< Of the point's position, world axes.
};

struct CouplingRow {
  int row = 0;
  std::vector<CoordinateAccess> scalars;
  std::vector<double> coefficients;  ///< Of a linear coupling; else empty.
  int block = -1, relation = -1;     ///< Of a relation: where it is evaluated. −1: linear.
};

/// Relations of one cluster, evaluated by one program so that what they share is computed once. Its inputs are the
/// values of `scalars`, their rates, and t; its outputs are, relation by relation, phi, b, c and a_k
/// (model/relation.h).
struct FormulaBlock {
  struct Row {
    int coupling = 0;          ///< Index into `System::couplings`.
    int row = 0;               ///< Of phi and G.
    int first_output = 0;      ///< phi; then b, c and one a per scalar.
    std::vector<int> scalars;  ///< Indices into those of the block.
    bool in_tree = true;       ///< All its scalars are entries of v.
  };
  std::vector<CoordinateAccess> scalars;
  std::vector<Row> rows;
  StateProgram program;
  int input_count() const { return 2 * static_cast<int>(scalars.size()) + 1; }
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
  std::vector<Node> nodes;  ///< [0] is ground; parents come first, generalized coordinates last.
  int body_nodes = 0;       ///< How many of them are bodies, ground included: those that have a pose.
  std::vector<CutJoint> cuts;
  std::vector<CouplingRow> couplings;  ///< As many as the model's, in their order.
  std::vector<FormulaBlock> formulas;
  std::vector<FramePair> points;              ///< Ground's origin to each recorded point of the model.
  bool knows_time = false;                    ///< Some relation moves by itself: nu is not 0.
  std::vector<int> velocity_rows;             ///< Rows that hold for velocities only: phi is 0 there whatever q is.
  std::vector<std::string> row_names;         ///< m: "joint/moment_x", or the coupling's name.
  std::vector<std::string> coordinate_names;  ///< nv: "joint" or "joint.coordinate".
  VectorXd drawn_q;                           ///< nq: coordinates as drawn.
  VectorXd drawn_winding;                     ///< Angles of the cut joints as drawn.
  Scaling scaling;

  const Joint& joint(const CutJoint& cut) const { return model->joint(cut.joint); }
  CoordinateAccess access(JointCoordinate coordinate) const;
  CoordinateAccess scalar_access(const StateScalar& scalar) const;
  /// The frames whose motion a scalar that is no entry of v measures.
  const FramePair& frames(const CoordinateAccess& access) const {
    return access.point >= 0 ? points[access.point] : cuts[access.cut].frames;
  }
  FramePair frame_pair(BodyId first, const Pose& X_1F, BodyId second, const Pose& X_2M) const;
  /// F and M of any joint, in the tree or cut.
  FramePair frame_pair(JointId joint) const;
  NodePoint point(BodyId body, const Eigen::Vector3d& p_B) const;
};

/// Lays a model out. Cost: linear in the model, times the depth of its loops.
std::shared_ptr<const System> make_system(std::shared_ptr<const Model> model, const TopologyOptions& options = {});
std::shared_ptr<const System> make_system(Model model, const TopologyOptions& options = {});

}  // namespace ferrers
