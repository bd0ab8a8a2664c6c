#include "ferrers/dynamics/equations.h"

#include <algorithm>
#include <utility>

#include "ferrers/core/checks.h"
#include "ferrers/dynamics/lagrangian_terms.h"
#include "ferrers/dynamics/traced_equations.h"

namespace ferrers {

namespace {

// Calls `visit` with every coordinate that a drive's rate can depend on.
template <typename Visit>
void for_each_column(const System& system, const DriveComponent& drive, Visit visit) {
  const bool is_coordinate = drive.kind == Drive::Kind::kCoordinate;
  if (is_coordinate && drive.access.in_tree) return visit(drive.access.v);
  if (drive.kind == Drive::Kind::kFormula) {
    for (const CoordinateAccess& access : drive.formula.scalars) {
      if (access.in_tree) {
        visit(access.v);
        continue;
      }
      for (const FramePair::PathEntry& entry : system.frames(access).path) {
        const Node& node = system.nodes[entry.node];
        for (int k = node.v; k < node.v + node.nv; ++k) visit(k);
      }
    }
    return;
  }
  const FramePair& frames = is_coordinate ? system.cuts[drive.access.cut].frames : drive.frames;
  for (const FramePair::PathEntry& entry : frames.path) {
    const Node& node = system.nodes[entry.node];
    for (int k = node.v; k < node.v + node.nv; ++k) visit(k);
  }
}

// ∂(rate)/∂v of a drive; entries that are always zero are not written.
void fill_drive_row(const DynamicsModel& model, const DriveComponent& drive, const PositionKinematics& pos,
                    const Jet& jet, const FormulaEvaluation& work, Eigen::Ref<Eigen::RowVectorXd> row) {
  for_each_column(*model.system, drive, [&](int k) { row[k] = 0; });
  add_drive_row(model, drive, pos, jet, work, row);
}

std::vector<std::vector<int>> with_diagonal(std::vector<std::vector<int>> rows) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const int own = static_cast<int>(i);
    rows[i].insert(std::lower_bound(rows[i].begin(), rows[i].end(), own), own);
  }
  return rows;
}

}  // namespace

std::vector<Matrix3d> inertias_about_origins(const DynamicsModel& model) {
  std::vector<Matrix3d> out;
  for (const NodeInertia& body : model.inertias) {  // parallel axes: I = I_c + m (|c|² 1 − c cᵀ)
    const Vector3d& c = body.com_N;
    out.push_back(body.I_N + body.mass_kg * (c.squaredNorm() * Matrix3d::Identity() - c * c.transpose()));
  }
  return out;
}

// Coordinates of one node, of those that carry it and of those that it carries.
std::vector<std::vector<int>> mass_couplings(const System& system) {
  std::vector<std::vector<int>> mass(system.nv);
  for (std::size_t i = 1; i < system.nodes.size(); ++i) {
    const Node& node = system.nodes[i];
    std::vector<int> above;
    for (int a = node.parent; a > 0; a = system.nodes[a].parent) {
      for (int k = 0; k < system.nodes[a].nv; ++k) above.push_back(system.nodes[a].v + k);
    }
    for (int k = node.v; k < node.v + node.nv; ++k) {
      for (int own = node.v; own < node.v + node.nv; ++own) {
        if (own != k) mass[k].push_back(own);
      }
      for (const int a : above) {
        mass[k].push_back(a);
        mass[a].push_back(k);
      }
    }
  }
  for (const auto& [a, b] : lagrangian_mass_pattern(system)) {
    if (a != b) mass[a].push_back(b);
  }
  for (std::vector<int>& coupled : mass) {
    std::sort(coupled.begin(), coupled.end());
    coupled.erase(std::unique(coupled.begin(), coupled.end()), coupled.end());
  }
  return mass;
}

std::vector<std::vector<int>> columns_of_drives(const DynamicsModel& model, const std::vector<int>& drives) {
  std::vector<std::vector<int>> out;
  for (const int i : drives) {
    std::vector<int> columns;
    for_each_column(*model.system, model.drives[i], [&](int k) { columns.push_back(k); });
    std::sort(columns.begin(), columns.end());
    columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
    out.push_back(std::move(columns));
  }
  return out;
}

Equations make_equations(const DynamicsModel& model, std::vector<int> driven) {
  const System& system = *model.system;
  Equations eq;
  for (const int i : driven) require(model.drives.at(i).motion.has_value(), "make_equations: a driven drive has a law");
  eq.pos = make_position_kinematics(system);
  eq.vel = make_velocity_kinematics(system);
  eq.driven_columns = columns_of_drives(model, driven);
  eq.constraints = make_constraint_kinematics(system, eq.driven_columns);
  eq.driven = std::move(driven);
  eq.M = PatternMatrix(with_diagonal(mass_couplings(system)), system.nv);
  eq.h = eq.tau = eq.force = VectorXd::Zero(system.nv);
  eq.B_transposed = RowMatrixXd::Zero(model.nu(), system.nv);
  eq.u = VectorXd::Zero(model.nu());
  eq.friction = VectorXd::Zero(model.friction_slips);
  eq.idle_efforts = MatrixXd::Zero(model.nu(), 0);
  eq.idle_lambda = MatrixXd::Zero(system.m, 0);
  eq.composites.resize(system.nodes.size());
  eq.inertias_N = inertias_about_origins(model);
  eq.applied.assign(system.nodes.size(), Wrenches::Zero(6, 1));
  eq.lagrangian = make_lagrangian_evaluation(model.lagrangian);
  if (!model.lagrangian.in_tree) {
    eq.lagrangian_rows = RowMatrixXd::Zero(static_cast<long>(model.lagrangian.scalars.size()), system.nv);
  }
  eq.drive_work = make_drive_evaluation(model);
  return eq;
}

namespace {

void sweep(const DynamicsModel& model, Equations& eq, bool with_bias) {
  const System& system = *model.system;
  if (with_bias) eq.h.tail(system.topology->general_coordinates).setZero();  // what the bodies do not write
  load_composites<double>(model, eq.inertias_N, eq.pos, with_bias ? &eq.vel : nullptr, eq.composites);
  sweep_composites<double>(
      system, eq.pos, eq.composites,
      [&](int k, int column, double value) { eq.M.entry(k, column) = eq.M.entry(column, k) = value; },
      [&](int k, double value) {
        if (with_bias) eq.h[k] = value;
      });
}

}  // namespace

void compute_driven_rows(const DynamicsModel& model, const State& state, const std::vector<int>& driven,
                         const PositionKinematics& pos, const VelocityKinematics& vel, FormulaEvaluation& work,
                         ConstraintKinematics& out) {
  int row = model.system->m;
  for (const int i : driven) {
    const DriveComponent& drive = model.drives[i];
    const Law::Motion law = drive.motion->motion(state.t);
    const Jet jet = measure_drive(model, drive, state, pos, vel, work);
    out.phi[row] = jet.value - law.value;
    out.rate[row] = jet.rate;
    out.nu[row] = law.rate;
    out.gamma[row] = law.acceleration - jet.bias;
    add_drive_row(model, drive, pos, jet, work, out.whole_row);
    out.G.take_row(row, out.whole_row);
    ++row;
  }
}

void compute_kinematics(const DynamicsModel& model, const State& state, Equations& out) {
  const System& system = *model.system;
  compute_positions(system, state.q, out.pos);
  compute_velocities(system, out.pos, state.q, state.v, out.vel);
  compute_constraints(system, state, out.pos, out.vel, out.constraints);
  compute_driven_rows(model, state, out.driven, out.pos, out.vel, out.drive_work, out.constraints);
  if (needs_lagrangian_inputs(model)) read_lagrangian_inputs(model, state, out.pos, out.vel, out.lagrangian);
}

void compute_mass_and_bias(const DynamicsModel& model, Equations& out) {
  clear_lagrangian_mass(model, out.M);
  sweep(model, out, true);
  add_lagrangian_inertia(model, out, true);
}

void compute_mass_matrix(const DynamicsModel& model, Equations& out) {
  for (BasicComposite<double>& c : out.composites) {
    c.moment.setZero();
    c.force.setZero();
  }
  clear_lagrangian_mass(model, out.M);
  sweep(model, out, false);
  add_lagrangian_inertia(model, out, false);
}

void compute_applied_forces(const DynamicsModel& model, const State& state, Equations& out, ForceElements which) {
  const System& system = *model.system;
  out.tau.setZero();
  out.friction.setZero();
  if (which == ForceElements::kAll ? model.has_forces : has_untraced_forces(model)) {
    for (Wrenches& w : out.applied) w.setZero();
    compute_force_elements(model, state, out.pos, out.vel, out.applied, out.tau, which);
    add_lagrangian_forces(model, out.pos, out.lagrangian, out.applied, out.tau);
    for (int i = system.body_nodes - 1; i > 0; --i) {
      const Node& node = system.nodes[i];
      const auto w = out.applied[i].col(0);
      for (int k = node.v; k < node.v + node.nv; ++k) out.tau[k] += w.dot(out.pos.S[k]);
      auto parent = out.applied[node.parent].col(0);
      parent.head<3>() +=
          w.head<3>() + (out.pos.nodes[i].p - out.pos.nodes[node.parent].p).cross(Vector3d(w.tail<3>()));
      parent.tail<3>() += w.tail<3>();
    }
  }
  for (int i = 0; i < model.nu(); ++i) {
    const DriveComponent& drive = model.drives[i];
    if (!drive.acts) continue;
    if (drive.kind == Drive::Kind::kCoordinate && drive.access.in_tree) {
      out.B_transposed(i, drive.access.v) = 1;
    } else {
      const Jet jet = measure_drive(model, drive, state, out.pos, out.vel, out.drive_work);
      fill_drive_row(model, drive, out.pos, jet, out.drive_work, out.B_transposed.row(i));
    }
    out.u[i] = drive.effort ? drive.effort->evaluate(system, state, out.pos, out.vel) : 0;
  }
  for (const int i : out.driven) out.u[i] = 0;
}

void sum_applied_forces(const DynamicsModel& model, const Equations& eq, VectorXd& out) {
  out = eq.tau;
  for (int i = 0; i < model.nu(); ++i) {
    if (eq.u[i] == 0) continue;
    if (model.drives[i].kind == Drive::Kind::kFormula) {  // whose columns come more than once
      out += eq.u[i] * eq.B_transposed.row(i).transpose();
      continue;
    }
    for_each_column(*model.system, model.drives[i], [&](int k) { out[k] += eq.u[i] * eq.B_transposed(i, k); });
  }
}

void compute_equations(const DynamicsModel& model, const State& state, Equations& out) {
  compute_kinematics(model, state, out);
  compute_mass_and_bias(model, out);
  compute_applied_forces(model, state, out);
  sum_applied_forces(model, out, out.force);
  out.force -= out.h;
}

Energy compute_energy(const DynamicsModel& model, const State& state, const PositionKinematics& pos,
                      const VelocityKinematics& vel) {
  Energy energy;
  const Vector3d gravity = model.system->model->gravity();
  for (std::size_t i = 1; i < model.inertias.size(); ++i) {
    const NodeInertia& body = model.inertias[i];
    const NodePoint com{static_cast<int>(i), body.com_N};
    const Vector3d w_N = pos.nodes[i].R.transpose() * vel.nodes[i].w;
    energy.kinetic += 0.5 * body.mass_kg * point_velocity(pos, vel, com).squaredNorm() + 0.5 * w_N.dot(body.I_N * w_N);
    energy.gravity -= body.mass_kg * gravity.dot(point_position(pos, com));
  }
  for (const BoundSpring& s : model.springs) {
    const double stretch = (point_position(pos, s.point_2) - point_position(pos, s.point_1)).norm() - s.free_length_m;
    energy.elastic += 0.5 * s.stiffness * stretch * stretch;
  }
  for (const BoundTorsionSpring& s : model.torsion_springs) {
    const double turn = measure_coordinate(*model.system, s.access, state, pos, vel).value - s.free_angle;
    energy.elastic += 0.5 * s.stiffness * turn * turn;
  }
  for (const BoundBushing& b : model.bushings) {
    const RelativeMotion m = compute_relative_motion(b.frames, pos, vel);
    const Vector3d d = m.R_F.transpose() * m.d, theta = rotation_log(m.R_F.transpose() * m.R_M);
    energy.elastic +=
        0.5 * d.dot(b.stiffness.head<3>().cwiseProduct(d)) + 0.5 * theta.dot(b.stiffness.tail<3>().cwiseProduct(theta));
  }
  const LagrangianEnergy formulas = compute_lagrangian_energy(model, state, pos, vel);
  energy.kinetic += formulas.kinetic;
  energy.gravity += formulas.potential;
  return energy;
}

}  // namespace ferrers
