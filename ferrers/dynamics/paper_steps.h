#pragma once

#include <vector>

#include "ferrers/dynamics/equations.h"
#include "ferrers/redundancy/analysis.h"

/// Problem: follow the paper step by step, each step by itself and open to inspection.
///
/// Given: a model, a decision about rows and coordinates (`Selection`: r rows kept, r dependent and w independent
/// coordinates) and the independent coordinates' values. Wanted: what each step of the direct and of the inverse
/// problem computes [stepanyan, "direct problem", steps 1-5, "inverse problem", steps 1-4]. Everything is in the
/// r rows kept; the rows left out hold by themselves as long as the redundancy does.
///
/// These are the steps in their plainest form, one dense solve each, for reading, teaching and checking: runs take
/// dynamics/inverse.h and simulate/simulation.h, which add continuation, other choices of coordinates on the way, and
/// watches; the results agree to rounding (tested). docs/method.md walks through them.
/// Errors: `std::invalid_argument` where sizes or the selection are not those of the model.
namespace ferrers {

/// How the dependent coordinates were found.
struct PositionSolution {
  bool closed = false;            ///< Every kept row is closed, to `closed_tolerance`.
  std::vector<double> residuals;  ///< Largest scaled residual before each correction and after the last one, m.
};

/// Solves phi_r(q) = 0 for the dependent coordinates by Newton's method from where they are; independent ones stay
/// [stepanyan, eq. (6)]:
///
///   G_d Δq_d = −phi_r,   q ← q ⊕ Δq.
///
/// `state`: q is replaced, v and t stay. Cost: O(r³) per iteration, at most `max_iterations`.
PositionSolution solve_dependent_positions(const DynamicsModel& model, const Selection& selection, State& state,
                                           int max_iterations = 25);

/// Solves G_r v = nu_r for the dependent velocities [stepanyan, eq. (7)]:
///
///   G_d v_d = nu_r − G_i v_i.
///
/// `state`: v is replaced at the dependent coordinates. Cost: O(r³).
void solve_dependent_velocities(const DynamicsModel& model, const Selection& selection, State& state);

/// Solves G_r vdot = gamma_r for the dependent accelerations [stepanyan, eq. (8)]:
///
///   G_d vdot_d = gamma_r − G_i vdot_i.
///
/// `eq` filled at the state; `independent`: w accelerations in the order of `selection.independent`. Returns n.
/// Cost: O(r³).
VectorXd solve_dependent_accelerations(const Equations& eq, const Selection& selection, const VectorXd& independent);

/// What balances a motion: multipliers of the kept rows and efforts of the drives.
struct MotionForces {
  VectorXd lambda;  ///< m, zero at the rows left out: one choice of many.
  VectorXd u;       ///< nu = w: unique.
};

/// Solves the n equations of motion for r multipliers and n − r efforts [stepanyan, eq. (9)]:
///
///   [G_rᵀ B] [lambda; u] = M vdot + h − tau.
///
/// `eq` filled at the state. There must be as many drives as motions, w. Cost: O(n³).
MotionForces solve_multipliers_and_efforts(const Equations& eq, const Selection& selection, const VectorXd& vdot);

/// The independent coordinates one step on, their accelerations held [stepanyan, "inverse problem", step 4]:
///
///   v_i' = v_i + vdot_i Δt,   q_i' = q_i + v_i Δt + vdot_i Δt²/2,   t' = t + Δt.
///
/// Dependent coordinates and velocities stay as they were: steps 1 and 2 at the new time find them. Rotations of
/// spherical and free joints move by the exponential map. Cost: O(n).
State hold_accelerations(const System& system, const Selection& selection, const State& state, const VectorXd& vdot,
                         double dt_s);

}  // namespace ferrers
