#include "ferrers/kinematics/joint_wrenches.h"

#include <Eigen/QR>

#include "ferrers/kinematics/coordinates.h"

namespace ferrers {

AllRows make_all_rows(const System& system, const Scaling& scaling) {
  AllRows rows;
  const Model& model = *system.model;
  for (std::size_t j = 0; j < model.joints().size(); ++j) {
    const JointTypeInfo& type = joint_type_info(model.joints()[j].type);
    const int closure = system.topology->closure_of_joint[j];
    rows.first.push_back(rows.size());
    rows.count.push_back(type.row_count());
    for (int i = 0; i < type.row_count(); ++i) {
      const int component = type.row_components[i];
      rows.names.push_back(model.joints()[j].name + "/" + std::string(kComponentNames[component]));
      rows.closure_row.push_back(closure >= 0 ? system.cuts[closure].row + i : -1);
    }
  }
  for (std::size_t c = 0; c < system.couplings.size(); ++c) {
    rows.first.push_back(rows.size());
    rows.count.push_back(1);
    rows.names.push_back(model.couplings()[c].name);
    rows.closure_row.push_back(system.couplings[c].row);
  }
  rows.scale = VectorXd::Ones(rows.size());
  for (int r = 0; r < rows.size(); ++r) {
    if (rows.closure_row[r] >= 0) {
      rows.scale[r] = scaling.rows[rows.closure_row[r]];
    } else if (rows.names[r].rfind("/moment_") != std::string::npos) {
      rows.scale[r] = scaling.length_m;
    }
  }
  return rows;
}

std::vector<JointFrameWrenches> compute_joint_frame_wrenches(const System& system, const State& state,
                                                             const PositionKinematics& pos) {
  const VelocityKinematics rest = make_velocity_kinematics(system);
  std::vector<JointFrameWrenches> out(system.model->joints().size());
  Jet jets[6];
  for (std::size_t j = 0; j < out.size(); ++j) {
    const Joint& joint = system.model->joints()[j];
    compute_joint_rows(system, JointId(j), state, pos, rest, out[j].motion, jets);
    const int count = joint_type_info(joint.type).row_count();
    out[j].T.resize(6, count);
    for (int i = 0; i < count; ++i) out[j].T.col(i) = jets[i].W;
    out[j].p_M = point_position(pos, system.point(joint.second, joint.X_2M.p));
  }
  return out;
}

Wrench effort_wrench(const System& system, JointCoordinate coordinate, const JointFrameWrenches& joint) {
  const Joint& definition = system.model->joint(coordinate.joint);
  const JointTypeInfo& type = joint_type_info(definition.type);
  if (type.coordinate_jets) {
    Jet jets[6];
    type.coordinate_jets(definition.constants, joint.motion, jets);
    return jets[coordinate.index].W;
  }
  Wrench w = Wrench::Zero();  // spherical and free: moments, then forces, along F's axes
  const bool angular = type.coordinates[coordinate.index].kind == CoordinateKind::kRotationRate;
  w.segment<3>(angular ? 0 : 3) = joint.motion.R_F.col(coordinate.index % 3);
  return w;
}

Loads make_loads(const System& system) {
  return {std::vector<Wrench>(system.nodes.size(), Wrench::Zero()), VectorXd::Zero(system.m),
          VectorXd::Zero(system.nv)};
}

namespace {

// A wrench given at the point `p` acts on a node: shifted to its origin.
void add_wrench(const PositionKinematics& pos, int node, const Vector3d& p, const Wrench& w, double scale,
                std::vector<Wrench>& on_nodes) {
  on_nodes[node].head<3>() += scale * (w.head<3>() + (p - pos.nodes[node].p).cross(w.tail<3>()));
  on_nodes[node].tail<3>() += scale * w.tail<3>();
}

void add_pair(const PositionKinematics& pos, const CutJoint& cut, const Vector3d& p_M,
              const Wrench& w, double scale, Loads& loads) {
  add_wrench(pos, cut.frames.node_2, p_M, w, scale, loads.on_nodes);
  add_wrench(pos, cut.frames.node_1, p_M, w, -scale, loads.on_nodes);
}

// Multipliers of couplings act as efforts along the coordinates they join.
void add_coupling_efforts(const System& system, const PositionKinematics& pos,
                          const std::vector<JointFrameWrenches>& joints, Loads& loads) {
  for (std::size_t c = 0; c < system.couplings.size(); ++c) {
    const CouplingRow& row = system.couplings[c];
    const Coupling& coupling = system.model->couplings()[c];
    for (std::size_t i = 0; i < row.coordinates.size(); ++i) {
      const double effort = row.coefficients[i] * loads.lambda[row.row];
      const CoordinateAccess& access = row.coordinates[i];
      if (access.in_tree) {
        loads.tree_efforts[access.v] += effort;
        continue;
      }
      const JointFrameWrenches& joint = joints[coupling.coordinates[i].joint.index()];
      const Wrench w = effort_wrench(system, coupling.coordinates[i], joint);
      add_pair(pos, system.cuts[access.cut], joint.p_M, w, effort, loads);
    }
  }
}

// The part of a tree joint's wrench (on its second body, at p_M) that its rows carry.
VectorXd constraint_part(const JointFrameWrenches& joint, const Wrench& w, double length) {
  Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6> T = joint.T;
  Wrench rhs = w;
  T.topRows<3>() /= length;
  rhs.head<3>() /= length;
  return T.colPivHouseholderQr().solve(rhs);
}

}  // namespace

VectorXd distribute_to_joints(const System& system, const AllRows& rows, const Scaling& scaling,
                              const PositionKinematics& pos,
                              const std::vector<JointFrameWrenches>& joints, Loads loads) {
  VectorXd all = VectorXd::Zero(rows.size());
  add_coupling_efforts(system, pos, joints, loads);
  for (int r = 0; r < rows.size(); ++r) {
    if (rows.closure_row[r] >= 0) all[r] = loads.lambda[rows.closure_row[r]];
  }
  for (const CutJoint& cut : system.cuts) {
    const JointFrameWrenches& joint = joints[cut.joint.index()];
    const Wrench w = joint.T * loads.lambda.segment(cut.row, cut.type->row_count());
    add_pair(pos, cut, joint.p_M, w, 1, loads);
  }
  for (int i = static_cast<int>(system.nodes.size()) - 1; i > 0; --i) {
    const Node& node = system.nodes[i];
    const Wrench& load = loads.on_nodes[i];
    const JointId id = system.topology->forest.nodes[i].joint;
    if (id.valid()) {
      const JointFrameWrenches& joint = joints[id.index()];
      // The joint holds the outboard side: −load on this node; turned to the second body, at p_M.
      Wrench w = node.forward ? Wrench(-load) : load;
      w.head<3>() += (pos.nodes[i].p - joint.p_M).cross(w.tail<3>());
      for (int k = 0; k < node.nv; ++k) {
        const double effort = loads.tree_efforts[node.v + k];
        if (effort != 0) w -= effort * effort_wrench(system, {id, k}, joint);
      }
      const int index = id.index();
      if (rows.count[index] > 0) {
        all.segment(rows.first[index], rows.count[index]) = constraint_part(joint, w, scaling.length_m);
      }
    }
    Wrench& parent = loads.on_nodes[node.parent];
    parent.head<3>() += load.head<3>() + (pos.nodes[i].p - pos.nodes[node.parent].p).cross(load.tail<3>());
    parent.tail<3>() += load.tail<3>();
  }
  return all;
}

}  // namespace ferrers
