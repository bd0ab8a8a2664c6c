#pragma once

#include "ferrers/dynamics/equations.h"
#include "ferrers/kinematics/assembly.h"

namespace ferrers {

enum class InitialStateStatus {
  kReady,
  kNotAssembled,            ///< See `assembly`.
  kInconsistentVelocities,  ///< The velocities given contradict each other or the constraints: `residual`.
};

struct InitialStateResult {
  InitialStateStatus status = InitialStateStatus::kReady;
  State state;  ///< Assembled, with velocities.
  AssemblyResult assembly;
  double residual = 0;  ///< Of the velocities, scaled, m/s.
  std::string message;
};

/// The state a run starts from: assembled positions, velocities as given, the others the least in the mass metric that
/// the constraints allow: min vᵀ M v subject to G v = 0 and the given ones.
InitialStateResult make_initial_state(const DynamicsModel& model, const AssemblyOptions& options = {});

}  // namespace ferrers
