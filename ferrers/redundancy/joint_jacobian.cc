#include "ferrers/redundancy/joint_jacobian.h"

#include "ferrers/core/checks.h"

namespace ferrers {
namespace {

// Adds the power of a wrench at p on a body.
void add_power(const System& system, const PositionKinematics& pos, BodyId body, const Vector3d& p, const Wrench& W,
               double factor, Eigen::Ref<Eigen::RowVectorXd> row) {
  if (body == kGround) return;
  const Vector3d origin = pos.nodes[system.topology->forest.node_of_body[body.index()]].p;
  const Vector3d force = factor * W.tail<3>();
  const int at = 6 * (body.index() - 1);
  row.segment<3>(at) += (factor * W.head<3>() + (p - origin).cross(force)).transpose();
  row.segment<3>(at + 3) += force.transpose();
}

// Of a wrench at p_M on the joint's second body, and of its opposite on the first.
void add_row(const System& system, const PositionKinematics& pos, const Joint& joint, const Vector3d& p_M,
             const Wrench& W, double factor, Eigen::Ref<Eigen::RowVectorXd> row) {
  add_power(system, pos, joint.second, p_M, W, factor, row);
  add_power(system, pos, joint.first, p_M, W, -factor, row);
}

}  // namespace

MatrixXd compute_joint_jacobian(const System& system, const State& state, const AllRows& rows) {
  const Model& model = *system.model;
  require_size(static_cast<long>(rows.first.size()),
               static_cast<long>(model.joints().size() + model.couplings().size()), "compute_joint_jacobian: rows");
  PositionKinematics pos = make_position_kinematics(system);
  compute_positions(system, state.q, pos);
  const JointWrenches joints = compute_joint_frame_wrenches(system, state, pos);
  MatrixXd G = MatrixXd::Zero(rows.size(), system.topology->full_velocities());
  Eigen::RowVectorXd row(G.cols());
  for (std::size_t j = 0; j < model.joints().size(); ++j) {
    for (int i = 0; i < rows.count[j]; ++i) {
      row.setZero();
      add_row(system, pos, model.joints()[j], joints[j].p_M, joints[j].T.col(i), 1, row);
      G.row(rows.first[j] + i) = row;
    }
  }
  for (std::size_t c = 0; c < model.couplings().size(); ++c) {
    const Coupling& coupling = model.couplings()[c];
    row.setZero();
    for (std::size_t i = 0; i < coupling.scalars.size(); ++i) {
      const StateScalar& scalar = coupling.scalars[i];
      const double factor = joints.coupling_coefficients[c][i];
      if (scalar.is_point()) {
        const RecordedPoint& point = model.records()[scalar.point];
        Wrench W = Wrench::Zero();
        W.tail<3>() = Vector3d::Unit(scalar.axis);
        add_power(system, pos, point.body, point_position(pos, system.point(point.body, point.point_m)), W, factor,
                  row);
        continue;
      }
      const JointId id = scalar.coordinate.joint;
      if (model.is_coordinate(id.index())) {
        row[6 * system.topology->moving_bodies + static_cast<long>(id.index() - model.coordinates_begin())] += factor;
        continue;
      }
      add_row(system, pos, model.joint(id), joints[id.index()].p_M,
              effort_wrench(system, scalar.coordinate, joints[id.index()]), factor, row);
    }
    G.row(rows.first[model.joints().size() + c]) = row;
  }
  return G;
}

MatrixXd compute_scaled_joint_jacobian(const System& system, const State& state, const AllRows& rows, double length_m) {
  MatrixXd G = rows.scale.asDiagonal() * compute_joint_jacobian(system, state, rows);
  const int of_bodies = 6 * system.topology->moving_bodies;
  for (int column = 0; column < of_bodies; ++column) {
    if (column % 6 < 3) G.col(column) /= length_m;
  }
  const Model& model = *system.model;
  for (std::size_t j = model.coordinates_begin(); j < model.joints().size(); ++j) {
    const bool angular = joint_type_info(model.joints()[j].type).coordinates[0].is_angular();
    if (angular) G.col(of_bodies + static_cast<long>(j - model.coordinates_begin())) /= length_m;
  }
  return G;
}

}  // namespace ferrers
