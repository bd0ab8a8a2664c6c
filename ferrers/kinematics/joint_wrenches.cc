#include "ferrers/kinematics/joint_wrenches.h"

#include <Eigen/Cholesky>

#include "ferrers/kinematics/coordinates.h"
#include "ferrers/kinematics/formula_rows.h"

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

JointWrenches compute_joint_frame_wrenches(const System& system, const State& state, const PositionKinematics& pos) {
  const VelocityKinematics rest = make_velocity_kinematics(system);
  JointWrenches out;
  out.joints.resize(system.model->joints().size());
  Jet jets[6];
  for (std::size_t j = 0; j < out.size(); ++j) {
    const Joint& joint = system.model->joints()[j];
    JointFrameWrenches& at = out.joints[j];
    const int count = joint_type_info(joint.type).row_count();
    at.T.resize(6, count);
    if (system.model->is_coordinate(j)) continue;
    compute_joint_rows(system, JointId(j), state, pos, rest, at.motion, jets);
    for (int i = 0; i < count; ++i) at.T.col(i) = jets[i].W;
    at.p_M = point_position(pos, system.point(joint.second, joint.X_2M.p));
  }
  out.coupling_coefficients = coupling_coefficients(system, state, pos);
  return out;
}

ScalarWrench scalar_wrench(const System& system, const StateScalar& scalar, const CoordinateAccess& access,
                           const PositionKinematics& pos, const JointWrenches& joints) {
  ScalarWrench out;
  out.frames = &system.frames(access);
  if (access.point >= 0) {
    out.p = point_position(pos, {out.frames->node_2, out.frames->X_2M.p});
    out.w.tail<3>() = Vector3d::Unit(access.axis);
  } else {
    const JointFrameWrenches& joint = joints[scalar.coordinate.joint.index()];
    out.p = joint.p_M;
    out.w = effort_wrench(system, scalar.coordinate, joint);
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

Loads make_loads(const System& system, int cases) {
  return {std::vector<Wrenches>(system.nodes.size(), Wrenches::Zero(6, cases)), MatrixXd::Zero(system.m, cases),
          MatrixXd::Zero(system.nv, cases)};
}

void add_wrench(const PositionKinematics& pos, int node, const Vector3d& p, const Eigen::Ref<const Wrenches>& w,
                double scale, std::vector<Wrenches>& on_nodes) {
  const Matrix3d lever = cross_matrix(p - pos.nodes[node].p);
  on_nodes[node].topRows<3>() += scale * (w.topRows<3>() + lever * w.bottomRows<3>());
  on_nodes[node].bottomRows<3>() += scale * w.bottomRows<3>();
}

namespace {

// A wrench on the second node of two frames at p_M, and its opposite on the first.
void add_pair(const PositionKinematics& pos, const FramePair& frames, const Vector3d& p_M, const Wrenches& w,
              Loads& loads) {
  add_wrench(pos, frames.node_2, p_M, w, 1, loads.on_nodes);
  add_wrench(pos, frames.node_1, p_M, w, -1, loads.on_nodes);
}

// Multipliers of couplings act as efforts along the coordinates they join.
void add_coupling_efforts(const System& system, const PositionKinematics& pos, const JointWrenches& joints,
                          Loads& loads) {
  for (std::size_t c = 0; c < system.couplings.size(); ++c) {
    const CouplingRow& row = system.couplings[c];
    const Coupling& coupling = system.model->couplings()[c];
    for (std::size_t i = 0; i < row.scalars.size(); ++i) {
      const Eigen::RowVectorXd effort = joints.coupling_coefficients[c][i] * loads.lambda.row(row.row);
      const CoordinateAccess& access = row.scalars[i];
      if (access.in_tree) {
        loads.tree_efforts.row(access.v) += effort;
        continue;
      }
      const ScalarWrench scalar = scalar_wrench(system, coupling.scalars[i], access, pos, joints);
      add_pair(pos, *scalar.frames, scalar.p, scalar.w * effort, loads);
    }
  }
}

// What a tree joint gives to its second body, at p_M, so that the outboard side is in balance; without its efforts.
Wrenches tree_joint_wrench(const System& system, int index, const PositionKinematics& pos,
                           const JointFrameWrenches& joint, const Loads& loads) {
  const Node& node = system.nodes[index];
  const JointId id = system.topology->forest.nodes[index].joint;
  Wrenches w = (node.forward ? -1.0 : 1.0) * loads.on_nodes[index];
  w.topRows<3>() += cross_matrix(pos.nodes[index].p - joint.p_M) * w.bottomRows<3>();
  for (int k = 0; k < node.nv; ++k) {
    const auto effort = loads.tree_efforts.row(node.v + k);
    if (!effort.isZero(0)) w -= effort_wrench(system, {id, k}, joint) * effort;
  }
  return w;
}

}  // namespace

MatrixXd constraint_part(const JointFrameWrenches& joint, const Wrenches& w, double length_m) {
  Eigen::Matrix<double, 6, 1> weight;
  weight << Vector3d::Constant(1 / (length_m * length_m)), Vector3d::Ones();
  const MatrixXd weighted = joint.T.transpose() * weight.asDiagonal();
  const MatrixXd normal = weighted * joint.T;
  return normal.ldlt().solve(weighted * w);
}

MatrixXd distribute_to_joints(const System& system, const AllRows& rows, const Scaling& scaling,
                              const PositionKinematics& pos, const JointWrenches& joints, Loads loads) {
  MatrixXd all = MatrixXd::Zero(rows.size(), loads.lambda.cols());
  add_coupling_efforts(system, pos, joints, loads);
  for (int r = 0; r < rows.size(); ++r) {
    if (rows.closure_row[r] >= 0) all.row(r) = loads.lambda.row(rows.closure_row[r]);
  }
  for (const CutJoint& cut : system.cuts) {
    const JointFrameWrenches& joint = joints[cut.joint.index()];
    add_pair(pos, cut.frames, joint.p_M, joint.T * loads.lambda.middleRows(cut.row, cut.type->row_count()), loads);
  }
  for (int i = static_cast<int>(system.nodes.size()) - 1; i > 0; --i) {
    const JointId id = system.topology->forest.nodes[i].joint;
    if (id.valid() && rows.count[id.index()] > 0) {
      const JointFrameWrenches& joint = joints[id.index()];
      all.middleRows(rows.first[id.index()], rows.count[id.index()]) =
          constraint_part(joint, tree_joint_wrench(system, i, pos, joint, loads), scaling.length_m);
    }
    add_wrench(pos, system.nodes[i].parent, pos.nodes[i].p, loads.on_nodes[i], 1, loads.on_nodes);
  }
  return all;
}

}  // namespace ferrers
