#pragma once

#include "ferrers/dynamics/composites.h"
#include "ferrers/kinematics/joint_wrenches.h"

namespace ferrers {

/// The equations of motion at one state [stepanyan, eq. (9)]:
///
///   M vdot + h = tau + B u + Gᵀ lambda,   G vdot = gamma
///
/// M: nv×nv mass matrix; h: nv, Coriolis and gravity; tau: nv, applied forces; B: nv×nu; u: nu drive efforts. One
/// struct holds every stage of an evaluation, allocated once and refilled.
struct Equations {
  PositionKinematics pos;
  VelocityKinematics vel;
  ConstraintKinematics constraints;
  PatternMatrix M;
  VectorXd h, tau;
  RowMatrixXd B_transposed;  ///< nu×nv: rows of the drives' rates, ∂(rate)/∂v.
  VectorXd u;                ///< Efforts of the drives that have an effort law, else 0.
  /// Drive components whose motion is prescribed here: their laws are rows of `constraints` after the system's m,
  /// phi = c(q) − f(t), G v = f'(t), G vdot = gamma, and their efforts are those rows' multipliers, not in u.
  std::vector<int> driven;
  std::vector<std::vector<int>> driven_columns;  ///< Per driven row: coordinates that it can touch, ascending.
  /// Where more drives act than the motion needs (inverse dynamics): efforts, nu × k, that the constraints balance with
  /// multipliers, m × k, so that the motion does not tell how much of them acts. Empty otherwise.
  MatrixXd idle_efforts, idle_lambda;
  VectorXd friction;  ///< Dry friction along each slip (dynamics/friction.h), in tau; zero until it is solved for. N.
  VectorXd force;     ///< tau + B u − h.

  // Work space.
  FormulaEvaluation lagrangian;  ///< Scalars of the energies at this state, and what was evaluated last.
  RowMatrixXd lagrangian_rows;   ///< Rows of those that are no entries of v.
  FormulaEvaluation drive_work;  ///< For drives by formulas.
  std::vector<BasicComposite<double>> composites;
  std::vector<Wrenches> applied;     ///< Per node, 6 × 1.
  std::vector<Matrix3d> inertias_N;  ///< Of the single bodies about the node's origin, node axes: constants.
};

Equations make_equations(const DynamicsModel& model, std::vector<int> driven = {});

/// Per coordinate, those that M can couple it with, itself left out; ascending.
std::vector<std::vector<int>> mass_couplings(const System& system);

/// Per drive component, coordinates that its rate can depend on; ascending.
std::vector<std::vector<int>> columns_of_drives(const DynamicsModel& model, const std::vector<int>& drives);

/// Inertia of each single body about its node's origin, node axes, kg·m².
std::vector<Matrix3d> inertias_about_origins(const DynamicsModel& model);

/// Fills everything for `state`; drives take their effort laws. Allocates nothing. Only entries of B that can differ
/// from zero are written: the others are zero since `make_equations`. Cost: O(bodies · depth + rows · loop).
void compute_equations(const DynamicsModel& model, const State& state, Equations& out);

/// The rows of prescribed drives, after the system's own. `work`: from `make_drive_evaluation`.
void compute_driven_rows(const DynamicsModel& model, const State& state, const std::vector<int>& driven,
                         const PositionKinematics& pos, const VelocityKinematics& vel, FormulaEvaluation& work,
                         ConstraintKinematics& out);

/// The parts of `compute_equations`, for callers that know some already.
void compute_kinematics(const DynamicsModel& model, const State& state, Equations& out);
void compute_mass_and_bias(const DynamicsModel& model, Equations& out);
/// `which`: kUntraced leaves out what native code knows by itself (dynamics/forward_program.h): springs between points
/// and on coordinates.
enum class ForceElements { kAll, kUntraced };
void compute_applied_forces(const DynamicsModel& model, const State& state, Equations& out,
                            ForceElements which = ForceElements::kAll);
/// tau + B u, of what `compute_applied_forces` left. `out`: nv.
void sum_applied_forces(const DynamicsModel& model, const Equations& eq, VectorXd& out);

/// The mass matrix alone, at poses already computed.
void compute_mass_matrix(const DynamicsModel& model, Equations& out);

struct Energy {
  /// J. Gravity is zero at the world's origin, and holds the potential energy given by formulas.
  double kinetic = 0, gravity = 0, elastic = 0;
  double total() const { return kinetic + gravity + elastic; }
};
Energy compute_energy(const DynamicsModel& model, const State& state, const PositionKinematics& pos,
                      const VelocityKinematics& vel);

/// Wrenches on the nodes from springs, bushings and loads, and efforts of joint springs and dampers along coordinates.
/// `efforts` (nv) takes those of tree coordinates, `on_nodes` everything else.
void compute_force_elements(const DynamicsModel& model, const State& state, const PositionKinematics& pos,
                            const VelocityKinematics& vel, std::vector<Wrenches>& on_nodes, VectorXd& efforts,
                            ForceElements which = ForceElements::kAll);

}  // namespace ferrers
