#include "ferrers/kinematics/system.h"

#include <algorithm>
#include <cmath>

#include "ferrers/core/checks.h"
#include "ferrers/kinematics/constraints.h"
#include "ferrers/kinematics/formula_rows.h"
#include "ferrers/kinematics/state.h"

namespace ferrers {
namespace {

constexpr double kRoundedToZero = 1e-13;  // rad or m

// Where a floating body is held: its mass centre, else the first place a joint sits on it.
Pose floating_frame(const Model& model, BodyId id) {
  const Body& body = model.body(id);
  if (body.has_mass) return {Matrix3d::Identity(), body.com_m};
  for (const Joint& joint : model.joints()) {
    if (joint.first == id) return {Matrix3d::Identity(), joint.X_1F.p};
    if (joint.second == id) return {Matrix3d::Identity(), joint.X_2M.p};
  }
  return {};
}

Node make_node(const System& system, const TreeNode& tree, int index) {
  const Model& model = *system.model;
  Node node;
  node.parent = tree.parent;
  node.body = tree.body;
  node.forward = tree.forward;
  node.q = system.topology->q_of_node[index];
  node.v = system.topology->v_of_node[index];
  if (index == 0) return node;
  if (!tree.body.valid()) {  // a generalized coordinate
    node.type = &joint_type_info(model.joint(tree.joint).type);
    node.nq = node.nv = 1;
    return node;
  }
  Pose X_parent_body, X_body;  // the joint's frames in the two bodies' frames
  if (tree.joint.valid()) {
    const Joint& joint = model.joint(tree.joint);
    node.type = &joint_type_info(joint.type);
    node.constants = joint.constants;
    X_parent_body = tree.forward ? joint.X_1F : joint.X_2M;
    X_body = tree.forward ? joint.X_2M : joint.X_1F;
  } else {
    node.type = &kFreeJoint;
    X_body = floating_frame(model, tree.body);
    X_parent_body = model.body(tree.body).X_WB * X_body;
  }
  node.nq = node.type->nq;
  node.nv = node.type->nv;
  node.X_BN = X_body;
  node.X_PJ = system.nodes[tree.parent].X_BN.inverse() * X_parent_body;
  return node;
}

void name_coordinates(System& system) {
  const Model& model = *system.model;
  for (std::size_t i = 1; i < system.nodes.size(); ++i) {
    const Node& node = system.nodes[i];
    const JointId joint = system.topology->forest.nodes[i].joint;
    const std::string owner = joint.valid() ? model.joint(joint).name : model.body(node.body).name;
    for (const CoordinateInfo& info : node.type->coordinates) {
      system.coordinate_names.push_back(node.nv == 1 ? owner : owner + "." + std::string(info.name));
    }
  }
}

void name_rows(System& system) {
  const Model& model = *system.model;
  for (const CutJoint& cut : system.cuts) {
    for (const int component : cut.type->row_components) {
      system.row_names.push_back(model.joint(cut.joint).name + "/" + std::string(kComponentNames[component]));
    }
  }
  for (const Coupling& coupling : model.couplings()) system.row_names.push_back(coupling.name);
}

void add_cuts(System& system) {
  for (const Closure& closure : system.topology->closures) {
    if (!closure.joint.valid()) continue;
    const Joint& joint = system.model->joint(closure.joint);
    CutJoint cut;
    cut.joint = closure.joint;
    cut.type = &joint_type_info(joint.type);
    cut.constants = joint.constants;
    cut.frames = system.frame_pair(joint.first, joint.X_1F, joint.second, joint.X_2M);
    cut.row = closure.row;
    cut.winding = system.winding_count;
    system.winding_count += cut.type->winding_count;
    system.cuts.push_back(std::move(cut));
  }
}

RelativeMotion drawn_motion(const Model& model, const Joint& joint) {
  const Pose X_WF = model.body(joint.first).X_WB * joint.X_1F;
  const Pose X_WM = model.body(joint.second).X_WB * joint.X_2M;
  RelativeMotion drawn;
  drawn.R_F = X_WF.R;
  drawn.R_M = X_WM.R;
  drawn.d = X_WM.p - X_WF.p;
  return drawn;
}

// Of a joint given by frames, in `q`. What rounding leaves of a zero is zero.
void set_drawn_coordinates(const Model& model, const Joint& joint, const Node& node, double* q) {
  const RelativeMotion drawn = drawn_motion(model, joint);
  if (node.type->quaternion_at >= 0) {
    const Eigen::Quaterniond turn(Matrix3d(drawn.R_F.transpose() * drawn.R_M));
    const double numbers[] = {turn.w(), turn.x(), turn.y(), turn.z()};
    std::copy(numbers, numbers + 4, q + node.type->quaternion_at);
    const Vector3d place = drawn.R_F.transpose() * drawn.d;
    for (int i = 0; i < node.type->quaternion_at; ++i) q[i] = place[i];
  } else if (node.nq > 0) {
    Jet coordinates[6];
    node.type->coordinate_jets(node.constants, drawn, coordinates);
    for (int i = 0; i < node.nq; ++i) q[i] = coordinates[i].value;
  }
  for (int i = 0; i < node.nq; ++i) {
    if (std::abs(q[i]) < kRoundedToZero) q[i] = 0;
  }
}

void set_drawn_coordinates(System& system) {
  system.drawn_q = VectorXd::Zero(system.nq);
  for (std::size_t i = 1; i < system.nodes.size(); ++i) {
    const Node& node = system.nodes[i];
    if (node.type->quaternion_at >= 0) system.drawn_q[node.q + node.type->quaternion_at] = 1;
    const JointId id = system.topology->forest.nodes[i].joint;
    if (!id.valid() || !system.model->joint(id).by_frames) continue;
    set_drawn_coordinates(*system.model, system.model->joint(id), node, system.drawn_q.data() + node.q);
  }
}

// The turns of every angle and the offsets of gear meshes are counted from the drawing.
void set_drawn_references(System& system) {
  system.drawn_winding = VectorXd::Zero(system.winding_count);
  for (CutJoint& cut : system.cuts) {
    const Joint& joint = system.joint(cut);
    if (cut.type->winding_count == 0) continue;
    const RelativeMotion drawn = drawn_motion(*system.model, joint);
    Jet angles[2], rows[6];
    cut.type->angles(cut.constants, drawn, angles);
    for (int i = 0; i < cut.type->winding_count; ++i) system.drawn_winding[cut.winding + i] = angles[i].value;
    if (joint.type != JointType::kGearMesh || cut.constants.mesh_holds_as_drawn_only) continue;
    cut.constants.mesh_offset_m = 0;
    cut.type->rows(cut.constants, drawn, system.drawn_winding.data() + cut.winding, rows);
    cut.constants.mesh_offset_m = -rows[0].value;
  }
}

}  // namespace

CoordinateAccess System::scalar_access(const StateScalar& scalar) const {
  if (!scalar.is_point()) return access(scalar.coordinate);
  CoordinateAccess a;
  a.in_tree = false;
  a.point = scalar.point;
  a.axis = scalar.axis;
  return a;
}

CoordinateAccess System::access(JointCoordinate coordinate) const {
  CoordinateAccess a;
  const int node = topology->node_of_joint.at(coordinate.joint.index());
  const JointTypeInfo& type = joint_type_info(model->joint(coordinate.joint).type);
  if (node >= 0) {
    a.v = nodes[node].v + coordinate.index;
    a.q = type.quaternion_at < 0 ? nodes[node].q + coordinate.index : -1;
    return a;
  }
  a.in_tree = false;
  a.cut = topology->closure_of_joint[coordinate.joint.index()];
  a.jet = coordinate.index;
  if (type.coordinates[coordinate.index].kind == CoordinateKind::kAngle) {
    int slot = 0;
    for (int i = 0; i < coordinate.index; ++i) slot += type.coordinates[i].kind == CoordinateKind::kAngle ? 1 : 0;
    a.winding = cuts[a.cut].winding + slot;
  }
  return a;
}

FramePair System::frame_pair(BodyId first, const Pose& X_1F, BodyId second, const Pose& X_2M) const {
  FramePair pair;
  pair.node_1 = topology->forest.node_of_body.at(first.index());
  pair.node_2 = topology->forest.node_of_body.at(second.index());
  pair.X_1F = nodes[pair.node_1].X_BN.inverse() * X_1F;
  pair.X_2M = nodes[pair.node_2].X_BN.inverse() * X_2M;
  int a = pair.node_1, b = pair.node_2;
  const std::vector<TreeNode>& tree = topology->forest.nodes;
  while (a != b) {
    const bool second_is_lower = tree[b].depth > tree[a].depth;
    int& lower = second_is_lower ? b : a;
    if (nodes[lower].nv > 0) pair.path.push_back({lower, second_is_lower ? 1.0 : -1.0});
    lower = tree[lower].parent;
  }
  return pair;
}

FramePair System::frame_pair(JointId id) const {
  const Joint& joint = model->joint(id);
  return frame_pair(joint.first, joint.X_1F, joint.second, joint.X_2M);
}

NodePoint System::point(BodyId body, const Eigen::Vector3d& p_B) const {
  const int node = topology->forest.node_of_body.at(body.index());
  return {node, nodes[node].X_BN.inverse() * p_B};
}

std::shared_ptr<const System> make_system(std::shared_ptr<const Model> model, const TopologyOptions& options) {
  require(model != nullptr, "make_system: no model");
  auto system = std::make_shared<System>();
  system->model = std::move(model);
  system->topology = std::make_shared<Topology>(make_topology(*system->model, options));
  const Topology& t = *system->topology;
  system->nq = t.nq;
  system->nv = t.nv;
  system->m = t.closure_rows;
  for (std::size_t i = 0; i < t.forest.nodes.size(); ++i) {
    system->nodes.push_back(make_node(*system, t.forest.nodes[i], static_cast<int>(i)));
    if (t.forest.nodes[i].body.valid()) system->body_nodes = static_cast<int>(i) + 1;
  }
  add_cuts(*system);
  for (const RecordedPoint& point : system->model->records()) {
    system->points.push_back(system->frame_pair(kGround, Pose(), point.body, {Matrix3d::Identity(), point.point_m}));
  }
  for (const Closure& closure : t.closures) {
    if (!closure.coupling.valid()) continue;
    const Coupling& coupling = system->model->couplings()[closure.coupling.index()];
    CouplingRow row;
    row.row = closure.row;
    row.coefficients = coupling.coefficients;
    for (const StateScalar& scalar : coupling.scalars) row.scalars.push_back(system->scalar_access(scalar));
    if (coupling.relation) {
      if (coupling.relation->on_velocities) system->velocity_rows.push_back(row.row);
      system->knows_time = system->knows_time || coupling.relation->knows_time;
    }
    system->couplings.push_back(std::move(row));
  }
  add_formula_blocks(*system);
  name_coordinates(*system);
  name_rows(*system);
  set_drawn_coordinates(*system);
  set_drawn_references(*system);
  system->scaling = make_scaling(*system);
  return system;
}

std::shared_ptr<const System> make_system(Model model, const TopologyOptions& options) {
  return make_system(std::make_shared<const Model>(std::move(model)), options);
}

}  // namespace ferrers
