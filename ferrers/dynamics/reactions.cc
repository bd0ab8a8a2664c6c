#include "ferrers/dynamics/reactions.h"

#include "ferrers/core/checks.h"

namespace ferrers {

std::string_view to_string(ReactionStatus status) {
  switch (status) {
    case ReactionStatus::kUnique:
      return "unique";
    case ReactionStatus::kDistributed:
      return "distributed";
    case ReactionStatus::kUndetermined:
      break;
  }
  return "undetermined";
}

namespace {

// Minus what a body's acceleration takes, gravity included, at its node's origin.
Wrench inertia_load(const DynamicsModel& model, const PositionKinematics& pos, const VelocityKinematics& acc, int i) {
  const NodeInertia& body = model.inertias[i];
  const Matrix3d& R = pos.nodes[i].R;
  const VelocityKinematics::NodeVelocity& k = acc.nodes[i];
  const Vector3d r = R * body.com_N;
  const Matrix3d I_c = R * body.I_N * R.transpose();
  const Vector3d force =
      body.mass_kg * (k.a + k.alpha.cross(r) + k.w.cross(k.w.cross(r)) - model.system->model->gravity());
  Wrench w;
  w.head<3>() = -(I_c * k.alpha + k.w.cross(I_c * k.w) + r.cross(force));
  w.tail<3>() = -force;
  return w;
}

// Efforts of drives: along tree coordinates, or as pairs of wrenches at their frames.
void add_drive_efforts(const DynamicsModel& model, const State& state, const Equations& eq, const VectorXd& u,
                       Loads& loads) {
  for (int i = 0; i < model.nu(); ++i) {
    const DriveComponent& drive = model.drives[i];
    if (drive.kind == Drive::Kind::kCoordinate && drive.access.in_tree) {
      loads.tree_efforts(drive.access.v, 0) += u[i];
      continue;
    }
    const FramePair& frames =
        drive.kind == Drive::Kind::kCoordinate ? model.system->cuts[drive.access.cut].frames : drive.frames;
    const Wrench w = measure_drive(model, drive, state, eq.pos, eq.vel).W * u[i];
    const Vector3d p_M = point_position(eq.pos, {frames.node_2, frames.X_2M.p});
    add_wrench(eq.pos, frames.node_2, p_M, w, 1, loads.on_nodes);
    add_wrench(eq.pos, frames.node_1, p_M, w, -1, loads.on_nodes);
  }
}

Loads make_motion_loads(const DynamicsModel& model, const State& state, const Equations& eq, const VectorXd& vdot,
                        const VectorXd& lambda, const VectorXd& u) {
  const System& system = *model.system;
  Loads loads = make_loads(system, 1);
  VelocityKinematics acc = make_velocity_kinematics(system);
  compute_accelerations(system, eq.pos, eq.vel, vdot, acc);
  VectorXd efforts = VectorXd::Zero(system.nv);
  compute_force_elements(model, state, eq.pos, eq.vel, loads.on_nodes, efforts);
  for (std::size_t i = 1; i < system.nodes.size(); ++i) {
    loads.on_nodes[i].col(0) += inertia_load(model, eq.pos, acc, static_cast<int>(i));
  }
  loads.lambda.col(0) = lambda;
  loads.tree_efforts.col(0) = efforts;
  add_drive_efforts(model, state, eq, u, loads);
  return loads;
}

}  // namespace

ReactionSolver::ReactionSolver(std::shared_ptr<const DynamicsModel> model)
    : model_(std::move(model)),
      scaling_(make_scaling(*model_->system)),
      rows_(make_all_rows(*model_->system, scaling_)) {}

std::vector<JointReaction> ReactionSolver::solve(const State& state, const Equations& eq, const Selection& selection,
                                                 const VectorXd& vdot, const VectorXd& lambda, const VectorXd& u,
                                                 ReactionAxes axes) const {
  const System& system = *model_->system;
  require_size(vdot.size(), system.nv, "ReactionSolver::solve: vdot");
  require_size(lambda.size(), system.m, "ReactionSolver::solve: lambda");
  require_size(u.size(), model_->nu(), "ReactionSolver::solve: u");
  std::vector<JointFrameWrenches> joints = compute_joint_frame_wrenches(system, state, eq.pos);
  const MatrixXd all = distribute_to_joints(system, rows_, scaling_, eq.pos, joints,
                                            make_motion_loads(*model_, state, eq, vdot, lambda, u));
  const MatrixXd Z = complete_self_stresses(system, scaling_, rows_, eq.pos, joints,
                                            self_stresses_of_selection(system, selection, eq.constraints.G));
  std::vector<JointReaction> reactions(joints.size());
  for (std::size_t j = 0; j < joints.size(); ++j) {
    JointFrameWrenches& joint = joints[j];
    const Vector3d to_M = -reaction_point_from_M(system.model->joints()[j], joint.motion);
    joint.T.topRows<3>() += cross_matrix(to_M) * joint.T.bottomRows<3>();
    const Wrench w = joint.T * all.col(0).segment(rows_.first[j], rows_.count[j]);
    const auto Z_joint = Z.middleRows(rows_.first[j], rows_.count[j]);
    for (int k = 0; k < 6; ++k) {
      Wrench direction = Wrench::Zero();
      const Vector3d axis =
          axes == ReactionAxes::kWorld ? Vector3d::Unit(k % 3) : Vector3d(joint.motion.R_F.col(k % 3));
      direction.segment<3>(k < 3 ? 3 : 0) = axis;
      reactions[j].value[k] = direction.dot(w);
      const bool unique = is_unique_component(direction, joint, Z_joint, scaling_.length_m);
      reactions[j].status[k] = unique ? ReactionStatus::kUnique : ReactionStatus::kUndetermined;
    }
  }
  return reactions;
}

}  // namespace ferrers
