#include "ferrers/dynamics/motion_loads.h"

#include "ferrers/dynamics/friction.h"
#include "ferrers/dynamics/lagrangian_terms.h"

namespace ferrers {
namespace {

// Minus what accelerations take, at the node's origin; `with_motion`: with the body's spin and gravity.
Wrench inertia_load(const DynamicsModel& model, const PositionKinematics& pos, const VelocityKinematics& acc, int i,
                    bool with_motion) {
  const NodeInertia& body = model.inertias[i];
  const Matrix3d& R = pos.nodes[i].R;
  const VelocityKinematics::NodeVelocity& k = acc.nodes[i];
  const Vector3d r = R * body.com_N;
  const Matrix3d I_c = R * body.I_N * R.transpose();
  Vector3d force = k.a + k.alpha.cross(r), moment = I_c * k.alpha;
  if (with_motion) {
    force += k.w.cross(k.w.cross(r)) - model.system->model->gravity();
    moment += k.w.cross(I_c * k.w);
  }
  force *= body.mass_kg;
  Wrench w;
  w.head<3>() = -(moment + r.cross(force));
  w.tail<3>() = -force;
  return w;
}

void add_pair(const Equations& eq, const FramePair& frames, const Wrench& w,
              const Eigen::Ref<const Eigen::RowVectorXd>& efforts, Loads& loads) {
  if (efforts.isZero(0)) return;
  const Vector3d p_M = point_position(eq.pos, {frames.node_2, frames.X_2M.p});
  const Wrenches cases = w * efforts;
  add_wrench(eq.pos, frames.node_2, p_M, cases, 1, loads.on_nodes);
  add_wrench(eq.pos, frames.node_1, p_M, cases, -1, loads.on_nodes);
}

// Of a drive by a formula: its gradient along each of its scalars.
void add_formula_efforts(const DynamicsModel& model, const Equations& eq, const FormulaBlock& block,
                         const FormulaEvaluation& at, const Eigen::Ref<const Eigen::RowVectorXd>& efforts,
                         Loads& loads) {
  const double* const d = at.outputs.data() + block.rows.front().first_output + 3;
  for (std::size_t k = 0; k < block.scalars.size(); ++k) {
    const CoordinateAccess& access = block.scalars[k];
    if (access.in_tree) {
      loads.tree_efforts.row(access.v) += d[k] * efforts;
    } else {
      add_pair(eq, model.system->frames(access), at.jets[k].W * d[k], efforts, loads);
    }
  }
}

// Efforts of drives (nu × k): along tree coordinates, or as pairs of wrenches at their frames.
void add_drive_efforts(const DynamicsModel& model, const State& state, const Equations& eq, const MatrixXd& u,
                       Loads& loads) {
  FormulaEvaluation work = make_drive_evaluation(model);
  for (int i = 0; i < model.nu(); ++i) {
    const DriveComponent& drive = model.drives[i];
    if (!drive.acts) continue;
    if (drive.kind == Drive::Kind::kCoordinate && drive.access.in_tree) {
      loads.tree_efforts.row(drive.access.v) += u.row(i);
      continue;
    }
    const Jet jet = measure_drive(model, drive, state, eq.pos, eq.vel, work);
    if (drive.kind == Drive::Kind::kFormula) {
      add_formula_efforts(model, eq, drive.formula, work, u.row(i), loads);
      continue;
    }
    const FramePair& frames =
        drive.kind == Drive::Kind::kCoordinate ? model.system->cuts[drive.access.cut].frames : drive.frames;
    add_pair(eq, frames, jet.W, u.row(i), loads);
  }
}

// Dry friction (nf × k): pairs of wrenches along the slips.
void add_friction(const DynamicsModel& model, const Equations& eq, const MatrixXd& friction, Loads& loads) {
  Wrench slips[kMostSlips];
  for (const BoundFriction& contact : model.frictions) {
    compute_slip_wrenches(contact, eq.pos, slips);
    for (int i = 0; i < contact.slips; ++i) {
      add_pair(eq, contact.frames, slips[i], friction.row(contact.first + i), loads);
    }
  }
}

}  // namespace

Loads make_motion_loads(const DynamicsModel& model, const State& state, const Equations& eq, const VectorXd& vdot,
                        const VectorXd& lambda, const VectorXd& u) {
  const System& system = *model.system;
  Loads loads = make_loads(system, 1);
  VelocityKinematics acc = make_velocity_kinematics(system);
  compute_accelerations(system, eq.pos, eq.vel, vdot, acc);
  VectorXd efforts = VectorXd::Zero(system.nv);
  compute_force_elements(model, state, eq.pos, eq.vel, loads.on_nodes, efforts);
  FormulaEvaluation formulas = eq.lagrangian;
  add_lagrangian_forces(model, eq.pos, formulas, loads.on_nodes, efforts);
  for (std::size_t i = 1; i < system.nodes.size(); ++i) {
    loads.on_nodes[i].col(0) += inertia_load(model, eq.pos, acc, static_cast<int>(i), true);
  }
  loads.lambda.col(0) = lambda.head(system.m);
  loads.tree_efforts.col(0) = efforts;
  add_lagrangian_loads(model, eq, vdot, true, 0, loads);
  add_drive_efforts(model, state, eq, u, loads);
  add_friction(model, eq, eq.friction, loads);
  return loads;
}

Loads make_changed_loads(const DynamicsModel& model, const State& state, const Equations& eq,
                         const LoadChanges& changes) {
  const System& system = *model.system;
  const int cases = static_cast<int>(changes.lambda.cols());
  Loads loads = make_loads(system, cases);
  const VelocityKinematics rest = make_velocity_kinematics(system);
  VelocityKinematics acc = rest;
  for (int k = 0; k < cases; ++k) {
    if (changes.vdot.col(k).isZero(0)) continue;
    compute_accelerations(system, eq.pos, rest, changes.vdot.col(k), acc);
    for (std::size_t i = 1; i < system.nodes.size(); ++i) {
      loads.on_nodes[i].col(k) += inertia_load(model, eq.pos, acc, static_cast<int>(i), false);
    }
    add_lagrangian_loads(model, eq, changes.vdot.col(k), false, k, loads);
  }
  loads.lambda = changes.lambda.topRows(system.m);
  add_drive_efforts(model, state, eq, changes.u, loads);
  add_friction(model, eq, changes.friction, loads);
  return loads;
}

}  // namespace ferrers
