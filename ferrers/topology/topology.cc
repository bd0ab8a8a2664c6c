#include "ferrers/topology/topology.h"

#include <algorithm>
#include <numeric>

#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

// Joints whose coordinate is read or driven are simplest in the tree, where it is an entry of q.
std::vector<bool> coordinate_users(const Model& model) {
  std::vector<bool> used(model.joints().size(), false);
  const auto use = [&](JointCoordinate c) { used[c.joint.index()] = true; };
  const auto use_scalar = [&](const StateScalar& scalar) {
    if (!scalar.is_point()) use(scalar.coordinate);
  };
  for (const Coupling& coupling : model.couplings()) {
    for (const StateScalar& scalar : coupling.scalars) use_scalar(scalar);
  }
  for (const Drive& drive : model.drives()) {
    if (drive.kind == Drive::Kind::kCoordinate) use(drive.coordinate);
    for (const StateScalar& scalar : drive.scalars) use_scalar(scalar);
  }
  for (const StateScalar& scalar : model.lagrangian().scalars) use_scalar(scalar);
  for (const ForceElement& force : model.forces()) {
    if (const auto* spring = std::get_if<TorsionSpring>(&force.element)) use(spring->coordinate);
    if (const auto* damping = std::get_if<JointDamping>(&force.element)) use(damping->coordinate);
  }
  for (const InitialValue& initial : model.initial()) use(initial.coordinate);
  return used;
}

// Nodes strictly below the last common ancestor of a and b, on both branches.
void collect_path(const SpanningForest& forest, int a, int b, std::vector<int>& nodes) {
  while (a != b) {
    int& lower = forest.nodes[a].depth >= forest.nodes[b].depth ? a : b;
    nodes.push_back(lower);
    lower = forest.nodes[lower].parent;
  }
}

void sort_unique(std::vector<int>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

void collect_joint(const Model& model, const Topology& t, JointId joint, std::vector<int>& nodes) {
  if (t.node_of_joint[joint.index()] >= 0) {
    nodes.push_back(t.node_of_joint[joint.index()]);
    return;
  }
  collect_path(t.forest, t.forest.node_of_body[model.joint(joint).first.index()],
               t.forest.node_of_body[model.joint(joint).second.index()], nodes);
}

void collect_scalar(const Model& model, const Topology& t, const StateScalar& scalar, std::vector<int>& nodes) {
  if (!scalar.is_point()) return collect_joint(model, t, scalar.coordinate.joint, nodes);
  collect_path(t.forest, 0, t.forest.node_of_body[model.records()[scalar.point].body.index()], nodes);
}

void add_closures(const Model& model, Topology& t) {
  for (const JointId id : t.forest.cut_joints) {
    Closure closure{.joint = id,
                    .coupling = {},
                    .row = t.closure_rows,
                    .row_count = joint_type_info(model.joint(id).type).row_count(),
                    .nodes = {}};
    t.closure_of_joint[id.index()] = static_cast<int>(t.closures.size());
    collect_joint(model, t, id, closure.nodes);
    sort_unique(closure.nodes);
    t.closure_rows += closure.row_count;
    t.closures.push_back(std::move(closure));
  }
  for (std::size_t c = 0; c < model.couplings().size(); ++c) {
    Closure closure{.joint = {}, .coupling = CouplingId(c), .row = t.closure_rows, .row_count = 1, .nodes = {}};
    for (const StateScalar& scalar : model.couplings()[c].scalars) {
      collect_scalar(model, t, scalar, closure.nodes);
    }
    sort_unique(closure.nodes);
    t.closure_rows += 1;
    t.closures.push_back(std::move(closure));
  }
}

// Union-find over nodes that own coordinates; closures that meet at a node belong together.
std::vector<Cluster> make_clusters(const Topology& t) {
  std::vector<int> root(t.forest.nodes.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  for (const Closure& closure : t.closures) {
    for (const int node : closure.nodes) root[find(node)] = find(closure.nodes.front());
  }
  std::vector<int> cluster_of(t.forest.nodes.size(), -1);
  std::vector<Cluster> clusters;
  for (std::size_t c = 0; c < t.closures.size(); ++c) {
    const Closure& closure = t.closures[c];
    if (closure.nodes.empty()) {  // between bodies that do not move against each other
      clusters.push_back({{static_cast<int>(c)}, {}});
      continue;
    }
    int& cluster = cluster_of[find(closure.nodes.front())];
    if (cluster < 0) {
      cluster = static_cast<int>(clusters.size());
      clusters.emplace_back();
    }
    clusters[cluster].closures.push_back(static_cast<int>(c));
    clusters[cluster].nodes.insert(clusters[cluster].nodes.end(), closure.nodes.begin(), closure.nodes.end());
  }
  for (Cluster& cluster : clusters) sort_unique(cluster.nodes);
  return clusters;
}

}  // namespace

Topology make_topology(const Model& model, const TopologyOptions& options) {
  Topology t;
  t.forest = make_spanning_forest(model, coordinate_users(model), options.cut);
  t.node_of_joint.assign(model.joints().size(), -1);
  t.closure_of_joint.assign(model.joints().size(), -1);
  for (std::size_t i = 0; i < t.forest.nodes.size(); ++i) {
    const TreeNode& node = t.forest.nodes[i];
    t.q_of_node.push_back(t.nq);
    t.v_of_node.push_back(t.nv);
    if (i == 0) continue;
    const JointTypeInfo& type = node.joint.valid() ? joint_type_info(model.joint(node.joint).type) : kFreeJoint;
    if (node.joint.valid()) t.node_of_joint[node.joint.index()] = static_cast<int>(i);
    t.nq += type.nq;
    t.nv += type.nv;
  }
  add_closures(model, t);
  t.clusters = make_clusters(t);
  t.moving_bodies = static_cast<int>(model.bodies().size()) - 1;
  t.general_coordinates = static_cast<int>(model.joints().size() - model.coordinates_begin());
  for (const Joint& joint : model.joints()) t.joint_rows += joint_type_info(joint.type).row_count();
  t.joint_rows += static_cast<int>(model.couplings().size());
  return t;
}

}  // namespace ferrers
