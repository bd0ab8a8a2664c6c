#include "ferrers/redundancy/joint_jacobian.h"

#include "ferrers/core/checks.h"

namespace ferrers {
namespace {

// Adds the power of a wrench at p_M on the joint's second body, and of its opposite on the first.
void add_row(const System& system, const PositionKinematics& pos, const Joint& joint, const Vector3d& p_M,
             const Wrench& W, double factor, Eigen::Ref<Eigen::RowVectorXd> row) {
  const auto add = [&](BodyId body, double sign) {
    if (body == kGround) return;
    const Vector3d origin = pos.nodes[system.topology->forest.node_of_body[body.index()]].p;
    const Vector3d force = sign * factor * W.tail<3>();
    const int at = 6 * (body.index() - 1);
    row.segment<3>(at) += (sign * factor * W.head<3>() + (p_M - origin).cross(force)).transpose();
    row.segment<3>(at + 3) += force.transpose();
  };
  add(joint.second, 1);
  add(joint.first, -1);
}

}  // namespace

MatrixXd compute_joint_jacobian(const System& system, const State& state, const AllRows& rows) {
  const Model& model = *system.model;
  require_size(static_cast<long>(rows.first.size()),
               static_cast<long>(model.joints().size() + model.couplings().size()), "compute_joint_jacobian: rows");
  PositionKinematics pos = make_position_kinematics(system);
  compute_positions(system, state.q, pos);
  const std::vector<JointFrameWrenches> joints = compute_joint_frame_wrenches(system, state, pos);
  MatrixXd G = MatrixXd::Zero(rows.size(), 6 * system.topology->moving_bodies);
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
    for (std::size_t i = 0; i < coupling.coordinates.size(); ++i) {
      const JointCoordinate coordinate = coupling.coordinates[i];
      const JointFrameWrenches& joint = joints[coordinate.joint.index()];
      add_row(system, pos, model.joint(coordinate.joint), joint.p_M, effort_wrench(system, coordinate, joint),
              coupling.coefficients[i], row);
    }
    G.row(rows.first[model.joints().size() + c]) = row;
  }
  return G;
}

MatrixXd compute_scaled_joint_jacobian(const System& system, const State& state, const AllRows& rows, double length_m) {
  MatrixXd G = rows.scale.asDiagonal() * compute_joint_jacobian(system, state, rows);
  for (int column = 0; column < G.cols(); ++column) {
    if (column % 6 < 3) G.col(column) /= length_m;
  }
  return G;
}

}  // namespace ferrers
