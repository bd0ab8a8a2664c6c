#pragma once

#include "ferrers/dynamics/equations.h"

/// Problem: energies and forces given as formulas add to those of the bodies.
///
/// Given: T, V, R and f over scalars x_k (model/relation.h), each with its row R_k and bias β_k. Wanted, added to what
/// bodies and force elements give [stepanyan, eq. (5), (9)]:
///
///   M += R_kᵀ M_kl R_l,   h += R_kᵀ (h_k + M_kl β_l),   tau += R_kᵀ Q_k
///
/// Where every x_k is an entry of q, R_k is a unit row and all of this is a scatter. Nothing here allocates.
namespace ferrers {

/// Columns of v that the inertia of the formulas can couple: pairs, both orders, without duplicates.
std::vector<std::pair<int, int>> lagrangian_mass_pattern(const System& system);

/// Values and rates of the scalars at a state: first of all, in `compute_kinematics`, where they are needed. They are
/// not where there are no bodies and no forces by formulas: the program of the constraints has computed the inertia
/// along (kinematics/formula_rows.h).
bool needs_lagrangian_inputs(const DynamicsModel& model);
void read_lagrangian_inputs(const DynamicsModel& model, const State& state, const PositionKinematics& pos,
                            const VelocityKinematics& vel, FormulaEvaluation& out);

/// Adds to M and, with `with_bias`, to h. `clear_lagrangian_mass` before the sweep over the bodies, which writes only
/// its own entries of M.
void clear_lagrangian_mass(const DynamicsModel& model, PatternMatrix& M);
void add_lagrangian_inertia(const DynamicsModel& model, Equations& eq, bool with_bias);

/// Adds generalized forces: along tree coordinates to `efforts` (nv), others to `on_nodes`.
void add_lagrangian_forces(const DynamicsModel& model, const PositionKinematics& pos, FormulaEvaluation& at,
                           std::vector<Wrenches>& on_nodes, VectorXd& efforts);

/// What the inertia of the formulas takes in a motion (accelerations `vdot`), as loads: −(M_kl ẍ_l + h_k) along x_k.
/// `bias`: with h_k and β_k; else for a change of accelerations alone.
void add_lagrangian_loads(const DynamicsModel& model, const Equations& eq, const VectorXd& vdot, bool bias, int column,
                          Loads& loads);

struct LagrangianEnergy {
  double kinetic = 0, potential = 0;  ///< ẋ·∂T/∂ẋ − T, which is T where T is quadratic in the rates; V. J.
  double power_of_time = 0;           ///< ∂V/∂t − ∂T/∂t, W.
};
LagrangianEnergy compute_lagrangian_energy(const DynamicsModel& model, const State& state,
                                           const PositionKinematics& pos, const VelocityKinematics& vel);

}  // namespace ferrers
