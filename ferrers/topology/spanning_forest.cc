#include "ferrers/topology/spanning_forest.h"

#include <queue>
#include <tuple>

#include "ferrers/core/checks.h"
#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

// Candidate edge of Prim's algorithm; the smallest is taken first.
struct Edge {
  int freedoms, not_preferred, depth, joint, from_node;
  BodyId to;
  bool operator>(const Edge& o) const {
    return std::tie(freedoms, not_preferred, depth, joint) > std::tie(o.freedoms, o.not_preferred, o.depth, o.joint);
  }
};

class ForestGrower {
 public:
  ForestGrower(const Model& model, const std::vector<bool>& preferred, const std::vector<bool>& forbidden)
      : model_(model), preferred_(preferred), forbidden_(forbidden), joints_of_body_(model.bodies().size()) {
    forest_.node_of_body.assign(model.bodies().size(), -1);
    for (std::size_t j = 0; j < model.coordinates_begin(); ++j) {
      joints_of_body_[model.joints()[j].first.index()].push_back(static_cast<int>(j));
      joints_of_body_[model.joints()[j].second.index()].push_back(static_cast<int>(j));
    }
  }

  SpanningForest grow() {
    add_node({.body = kGround});
    take_edges();
    for (std::size_t b = 1; b < model_.bodies().size(); ++b) {
      if (forest_.node_of_body[b] >= 0) continue;
      add_node({.body = BodyId(b), .parent = 0, .depth = 1});
      take_edges();
    }
    for (std::size_t j = model_.coordinates_begin(); j < model_.joints().size(); ++j) {
      forest_.nodes.push_back({.body = {}, .parent = 0, .joint = JointId(j), .depth = 1});
    }
    std::vector<bool> in_tree(model_.joints().size(), false);
    for (const TreeNode& node : forest_.nodes) {
      if (node.joint.valid()) in_tree[node.joint.index()] = true;
    }
    for (std::size_t j = 0; j < in_tree.size(); ++j) {
      if (!in_tree[j]) forest_.cut_joints.emplace_back(j);
    }
    return std::move(forest_);
  }

 private:
  void add_node(const TreeNode& node) {
    const int index = static_cast<int>(forest_.nodes.size());
    forest_.node_of_body[node.body.index()] = index;
    forest_.nodes.push_back(node);
    for (const int j : joints_of_body_[node.body.index()]) {
      const Joint& joint = model_.joints()[j];
      const JointTypeInfo& type = joint_type_info(joint.type);
      const BodyId other = joint.first == node.body ? joint.second : joint.first;
      const bool cut = !type.can_be_tree || (!forbidden_.empty() && forbidden_[j]);
      if (cut || forest_.node_of_body[other.index()] >= 0) continue;
      const bool preferred = !preferred_.empty() && preferred_[j];
      edges_.push({type.freedoms(), preferred ? 0 : 1, node.depth + 1, j, index, other});
    }
  }

  void take_edges() {
    while (!edges_.empty()) {
      const Edge edge = edges_.top();
      edges_.pop();
      if (forest_.node_of_body[edge.to.index()] >= 0) continue;
      const JointId joint(edge.joint);
      const bool forward = model_.joint(joint).second == edge.to;
      add_node({.body = edge.to, .parent = edge.from_node, .joint = joint, .forward = forward, .depth = edge.depth});
    }
  }

  const Model& model_;
  const std::vector<bool>& preferred_;
  const std::vector<bool>& forbidden_;
  std::vector<std::vector<int>> joints_of_body_;
  std::priority_queue<Edge, std::vector<Edge>, std::greater<>> edges_;
  SpanningForest forest_;
};

}  // namespace

SpanningForest make_spanning_forest(const Model& model, const std::vector<bool>& preferred,
                                    const std::vector<bool>& forbidden) {
  require(preferred.empty() || preferred.size() == model.joints().size(),
          "make_spanning_forest: wrong size of preferred");
  require(forbidden.empty() || forbidden.size() == model.joints().size(),
          "make_spanning_forest: wrong size of forbidden");
  return ForestGrower(model, preferred, forbidden).grow();
}

}  // namespace ferrers
