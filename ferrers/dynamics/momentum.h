#pragma once

#include "ferrers/dynamics/dynamics_model.h"

namespace ferrers {

/// Momentum of all bodies about the world's origin, world axes:
///   p = Σ m v_c,   L = Σ (r_c × m v_c + I_c ω).
/// Constant where nothing outside acts along it: of a free system up to gravity, about an axis without friction.
/// Units: kg·m/s, kg·m²/s. Cost: linear in the bodies.
struct Momentum {
  Vector3d linear = Vector3d::Zero(), angular = Vector3d::Zero();
};
Momentum compute_momentum(const DynamicsModel& model, const PositionKinematics& pos, const VelocityKinematics& vel);

}  // namespace ferrers
