#include "ferrers/redundancy/cluster_system.h"

#include <algorithm>
#include <map>

#include "ferrers/math/rotation.h"

namespace ferrers {
namespace {

// Nodes that move with the cluster's coordinates: all between the two ends of its cuts, below where they meet.
std::vector<int> moving_nodes(const System& whole, const Cluster& cluster) {
  std::vector<int> nodes = cluster.nodes;
  const std::vector<TreeNode>& tree = whole.topology->forest.nodes;
  for (const int c : cluster.closures) {
    if (!whole.topology->closures[c].joint.valid()) continue;
    int a = whole.cuts[c].frames.node_1, b = whole.cuts[c].frames.node_2;
    while (a != b) {
      int& lower = tree[b].depth > tree[a].depth ? b : a;
      nodes.push_back(lower);
      lower = tree[lower].parent;
    }
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

// Renumbers what belongs to a cluster.
class Extractor {
 public:
  Extractor(const System& whole, ClusterSystem& out) : whole_(whole), out_(out) {}

  void run(const Cluster& cluster) {
    out_.system.model = whole_.model;
    out_.system.topology = whole_.topology;
    out_.system.nodes.push_back(whole_.nodes[0]);
    out_.system.body_nodes = 1;
    for (const int n : moving_nodes(whole_, cluster)) add_node(n);
    for (const int c : cluster.closures) {
      if (whole_.topology->closures[c].joint.valid()) add_cut(c);
    }
    for (const int c : cluster.closures) {
      if (!whole_.topology->closures[c].joint.valid()) add_coupling(whole_.topology->closures[c].coupling.index());
    }
    for (const auto& [whole_block, block] : blocks_) add_block(whole_.formulas[whole_block]);
    out_.system.m = static_cast<int>(out_.rows.size());
  }

 private:
  // What does not move with the cluster's coordinates is its ground.
  int node_of(int n) const {
    const auto at = nodes_.find(n);
    return at == nodes_.end() ? 0 : at->second;
  }

  void add_node(int n) {
    if (n == 0) return;
    Node node = whole_.nodes[n];
    nodes_[n] = static_cast<int>(out_.system.nodes.size());
    for (int k = 0; k < node.nq; ++k) out_.q.push_back(node.q + k);
    for (int k = 0; k < node.nv; ++k) {
      columns_[node.v + k] = static_cast<int>(out_.columns.size());
      out_.columns.push_back(node.v + k);
      out_.system.coordinate_names.push_back(whole_.coordinate_names[node.v + k]);
    }
    node.parent = node_of(node.parent);
    positions_[node.q] = out_.system.nq;
    node.q = out_.system.nq;
    node.v = out_.system.nv;
    out_.system.nq += node.nq;
    out_.system.nv += node.nv;
    if (node.type->carries_body) out_.system.body_nodes = static_cast<int>(out_.system.nodes.size()) + 1;
    out_.system.nodes.push_back(std::move(node));
  }

  int add_row(int row) {
    out_.rows.push_back(row);
    out_.system.row_names.push_back(whole_.row_names[row]);
    return static_cast<int>(out_.rows.size()) - 1;
  }

  void add_cut(int c) {
    CutJoint cut = whole_.cuts[c];
    cuts_[c] = static_cast<int>(out_.system.cuts.size());
    renumber(cut.frames);
    const int row = static_cast<int>(out_.rows.size());
    for (int i = 0; i < cut.type->row_count(); ++i) add_row(cut.row + i);
    cut.row = row;
    for (int i = 0; i < cut.type->winding_count; ++i) out_.winding.push_back(cut.winding + i);
    cut.winding = out_.system.winding_count;
    out_.system.winding_count += cut.type->winding_count;
    out_.system.cuts.push_back(std::move(cut));
  }

  void add_coupling(int coupling) {
    CouplingRow row = whole_.couplings[coupling];
    const auto& velocity_rows = whole_.velocity_rows;
    const bool on_velocities = std::find(velocity_rows.begin(), velocity_rows.end(), row.row) != velocity_rows.end();
    row.row = add_row(row.row);
    if (on_velocities) out_.system.velocity_rows.push_back(row.row);
    for (CoordinateAccess& access : row.scalars) renumber(access);
    if (row.block >= 0) row.block = blocks_.emplace(row.block, static_cast<int>(blocks_.size())).first->second;
    couplings_[coupling] = static_cast<int>(out_.system.couplings.size());
    out_.system.couplings.push_back(std::move(row));
  }

  // A block of relations belongs to one cluster as a whole.
  void add_block(FormulaBlock block) {
    for (CoordinateAccess& access : block.scalars) renumber(access);
    for (FormulaBlock::Row& row : block.rows) {
      row.coupling = couplings_.at(row.coupling);
      row.row = out_.system.couplings[row.coupling].row;
    }
    out_.system.formulas.push_back(std::move(block));
  }

  void renumber(CoordinateAccess& access) {
    if (access.in_tree) {
      access.v = columns_.at(access.v);
      if (access.q >= 0) access.q = node_position(access.q);
    } else if (access.point >= 0) {
      const auto [found, is_new] = points_.emplace(access.point, static_cast<int>(out_.system.points.size()));
      if (is_new) {
        FramePair frames = whole_.points[access.point];
        renumber(frames);
        out_.system.points.push_back(std::move(frames));
      }
      access.point = found->second;
    } else {
      const int winding = access.winding - whole_.cuts[access.cut].winding;
      access.cut = cuts_.at(access.cut);
      if (access.winding >= 0) access.winding = out_.system.cuts[access.cut].winding + winding;
    }
  }

  void renumber(FramePair& frames) const {
    frames.node_1 = node_of(frames.node_1);
    frames.node_2 = node_of(frames.node_2);
    for (FramePair::PathEntry& entry : frames.path) entry.node = node_of(entry.node);
  }

  int node_position(int q) const {
    const auto at = std::prev(positions_.upper_bound(q));
    return at->second + (q - at->first);
  }

  const System& whole_;
  ClusterSystem& out_;
  std::map<int, int> nodes_, columns_, cuts_, couplings_, blocks_, points_;
  std::map<int, int> positions_;  // first q of every node
};

}  // namespace

State ClusterSystem::restrict(const State& whole) const {
  State state;
  state.t = whole.t;
  state.q = whole.q(q);
  state.v = VectorXd::Zero(system.nv);
  state.winding = whole.winding(winding);
  return state;
}

ClusterSystem make_cluster_system(const System& whole, const Scaling& scaling, const Cluster& cluster) {
  ClusterSystem out;
  Extractor(whole, out).run(cluster);
  out.system.drawn_q = whole.drawn_q(out.q);
  out.system.drawn_winding = whole.drawn_winding(out.winding);
  out.system.scaling.length_m = scaling.length_m;
  out.system.scaling.rows = scaling.rows(out.rows);
  out.system.scaling.columns = scaling.columns(out.columns);
  return out;
}

PoseProbe::PoseProbe(const System& system, const Scaling& scaling)
    : system_(system),
      scaling_(scaling),
      pos_(make_position_kinematics(system)),
      vel_(make_velocity_kinematics(system)),
      rest_(make_velocity_kinematics(system)),
      constraints_(make_constraint_kinematics(system)) {}

void PoseProbe::go_to(const State& state) {
  moving_ = state;
  compute_positions(system_, state.q, pos_);
  compute_constraints(system_, state, pos_, rest_, constraints_);
}

LocalMotion PoseProbe::first_order(double blur) const {
  const VectorXd residual = constraints_.phi.cwiseProduct(scaling_.rows);
  if (residual.size() > 0) blur = std::max(blur, residual.cwiseAbs().maxCoeff() / scaling_.length_m);
  RankAnalysis analysis =
      analyze_rank(scaling_.rows.asDiagonal() * constraints_.G * scaling_.columns.asDiagonal(), 1.0, blur);
  return {std::move(analysis.decision), std::move(analysis.right_null), std::move(analysis.left_null)};
}

VectorXd PoseProbe::curvature(const VectorXd& x) {
  moving_.v = scaling_.columns.cwiseProduct(x);
  compute_velocities(system_, pos_, moving_.q, moving_.v, vel_);
  compute_constraints(system_, moving_, pos_, vel_, constraints_);
  return scaling_.length_m * constraints_.gamma.cwiseProduct(scaling_.rows);
}

VectorXd displacement(const System& system, const Scaling& scaling, const VectorXd& q_from, const VectorXd& q_to) {
  VectorXd d = VectorXd::Zero(system.nv);
  for (std::size_t i = 1; i < system.nodes.size(); ++i) {
    const Node& node = system.nodes[i];
    const int at = node.type->quaternion_at;
    if (at < 0) {
      for (int k = 0; k < node.nq; ++k) d[node.v + k] = q_to[node.q + k] - q_from[node.q + k];
      continue;
    }
    for (int k = 0; k < at; ++k) d[node.v + 3 + k] = q_to[node.q + k] - q_from[node.q + k];
    const Matrix3d from = quaternion_matrix(q_from.data() + node.q + at);
    const Matrix3d to = quaternion_matrix(q_to.data() + node.q + at);
    d.segment<3>(node.v) = rotation_log(to * from.transpose());
  }
  return d.cwiseQuotient(scaling.columns);
}

}  // namespace ferrers
