#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ferrers/kinematics/constraints.h"
#include "ferrers/kinematics/scaling.h"

/// Problem: find coordinates at which every loop closes, near a guess that may be far off, with redundant constraints.
///
/// Given: a system and starting coordinates, some of them held. Wanted: q with phi(q) = 0.
/// Method: Levenberg-Marquardt on the scaled residual with a damping tied to the residual, so that it is quadratic near
/// the solution whatever the rank, never needs one to be decided, and stays on the branch of the guess. Held
/// coordinates are moved to their values in small steps from the drawn pose. Where a start is stationary but open (all
/// bars in one line) it is kicked, always the same way. No mass and no time step enters.
namespace ferrers {

enum class AssemblyStatus {
  kAssembled,            ///< `state` is valid: every loop closes.
  kOpen,                 ///< Some joints stay open: `state` is the best found, `open_joints` says where.
  kInconsistentInitial,  ///< It closes, but not with the initial positions that were given as exact.
};

struct OpenJoint {
  std::string name;
  double gap_m = 0;      ///< Of the joint's force rows.
  double angle_rad = 0;  ///< Of its moment rows.
};

struct AssemblyOptions {
  bool use_initial = true;   ///< Take the model's `initial` positions; else the drawn pose.
  int max_iterations = 200;  ///< Per attempt.
  int attempts = 24;         ///< Kicked restarts where it stays open.
  unsigned seed = 1;
  double t = 0;  ///< Time at which constraints that move are to close, s.
};

struct AssemblyResult {
  AssemblyStatus status = AssemblyStatus::kOpen;
  State state;                         ///< At rest, at the time asked for.
  double residual = 0;                 ///< Largest scaled residual, m.
  std::vector<OpenJoint> open_joints;  ///< Largest first.
  int iterations = 0;
  std::string message;  ///< What happened, likely causes, what to try; empty when assembled.
};

/// Assembles the mechanism from its drawn pose and initial positions.
AssemblyResult assemble(const System& system, const AssemblyOptions& options = {});

/// Closes the loops from `state.q`, moving coordinates freely except `held` (velocity indices). Keeps `state.v` and t.
/// Returns the largest scaled residual, m. `iterations` counts up.
double close_loops(const System& system, const Scaling& scaling, const std::vector<int>& held, int max_iterations,
                   State& state, int& iterations);

/// Largest scaled residual that counts as closed, m: rounding times the size of the model.
double closed_tolerance(const Scaling& scaling);

}  // namespace ferrers
