#include "ferrers/kinematics/self_stress.h"

#include <algorithm>
#include <functional>

namespace ferrers {

SelfStressExtender::SelfStressExtender(const System& system, const Scaling& scaling, const AllRows& rows,
                                       const PositionKinematics& pos, const JointWrenches& joints)
    : system_(system),
      scaling_(scaling),
      rows_(rows),
      pos_(pos),
      joints_(joints),
      closure_of_row_(static_cast<std::size_t>(system.m)),
      first_all_row_(system.topology->closures.size()),
      on_nodes_(system.nodes.size(), Wrench::Zero()),
      efforts_(system.nodes.size(), Wrench::Zero()),
      is_touched_(system.nodes.size(), false) {
  const std::vector<Closure>& closures = system.topology->closures;
  for (std::size_t c = 0; c < closures.size(); ++c) {
    for (int i = 0; i < closures[c].row_count; ++i) closure_of_row_[closures[c].row + i] = static_cast<int>(c);
    const std::size_t owner = closures[c].joint.valid() ? closures[c].joint.index()
                                                        : system.model->joints().size() + closures[c].coupling.index();
    first_all_row_[c] = rows.first[owner];
  }
}

void SelfStressExtender::touch(int node) {
  if (!is_touched_[node]) touched_.push_back(node);
  is_touched_[node] = true;
}

void SelfStressExtender::add_pair(const FramePair& frames, const Vector3d& p_M, const Wrench& w) {
  const auto add = [&](int node, double sign) {
    touch(node);
    const Vector3d force = sign * w.tail<3>();
    on_nodes_[node].head<3>() += sign * w.head<3>() + (p_M - pos_.nodes[node].p).cross(force);
    on_nodes_[node].tail<3>() += force;
  };
  add(frames.node_2, 1);
  add(frames.node_1, -1);
}

void SelfStressExtender::load(const SparseRows& closure_rows) {
  for (const auto& [row, value] : closure_rows) {
    const Closure& closure = system_.topology->closures[closure_of_row_[row]];
    for (const int node : closure.nodes) touch(node);
    if (closure.joint.valid()) {
      const CutJoint& cut = system_.cuts[closure_of_row_[row]];
      const JointFrameWrenches& joint = joints_[cut.joint.index()];
      add_pair(cut.frames, joint.p_M, joint.T.col(row - cut.row) * value);
      continue;
    }
    const Coupling& coupling = system_.model->couplings()[closure.coupling.index()];
    const CouplingRow& c = system_.couplings[closure.coupling.index()];
    for (std::size_t i = 0; i < c.scalars.size(); ++i) {
      const double effort = joints_.coupling_coefficients[closure.coupling.index()][i] * value;
      if (!c.scalars[i].in_tree) {
        const ScalarWrench scalar = scalar_wrench(system_, coupling.scalars[i], c.scalars[i], pos_, joints_);
        add_pair(*scalar.frames, scalar.p, scalar.w * effort);
        continue;
      }
      const JointCoordinate coordinate = coupling.scalars[i].coordinate;
      efforts_[system_.topology->node_of_joint[coordinate.joint.index()]] +=
          effort_wrench(system_, coordinate, joints_[coordinate.joint.index()]) * effort;
    }
  }
}

SparseRows SelfStressExtender::extend(const SparseRows& closure_rows) {
  SparseRows out;
  for (const auto& [row, value] : closure_rows) {
    const int c = closure_of_row_[row];
    out.emplace_back(first_all_row_[c] + row - system_.topology->closures[c].row, value);
  }
  load(closure_rows);
  std::sort(touched_.begin(), touched_.end(), std::greater<>());
  const std::size_t count = touched_.size();  // a parent beyond these carries nothing: pairs cancel there
  for (std::size_t i = 0; i < count; ++i) {
    const int node = touched_[i];
    const JointId id = system_.topology->forest.nodes[node].joint;
    Wrench& w = on_nodes_[node];
    if (id.valid() && rows_.count[id.index()] > 0) {
      const JointFrameWrenches& joint = joints_[id.index()];
      Wrench carried = (system_.nodes[node].forward ? -1.0 : 1.0) * w;
      carried.head<3>() += (pos_.nodes[node].p - joint.p_M).cross(carried.tail<3>());
      carried -= efforts_[node];
      const VectorXd part = constraint_part(joint, carried, scaling_.length_m);
      for (int k = 0; k < part.size(); ++k) out.emplace_back(rows_.first[id.index()] + k, part[k]);
    }
    if (const int parent = system_.nodes[node].parent; parent >= 0 && is_touched_[parent]) {
      on_nodes_[parent].head<3>() += w.head<3>() + (pos_.nodes[node].p - pos_.nodes[parent].p).cross(w.tail<3>());
      on_nodes_[parent].tail<3>() += w.tail<3>();
    }
    w.setZero();
    efforts_[node].setZero();
    is_touched_[node] = false;
  }
  touched_.clear();
  return out;
}

}  // namespace ferrers
