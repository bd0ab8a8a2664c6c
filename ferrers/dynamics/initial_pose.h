#pragma once

#include "ferrers/kinematics/state.h"

namespace ferrers {

/// The specification with this pose as `initial`: every tree joint's position as a guess that is already closed, at
/// rest. A body that floats without a joint gets a free joint to ground for it, "float_BODY", which constrains nothing:
/// initial values belong to joints. `spec` must be the one that `system` was built from; else std::invalid_argument.
ModelSpec with_initial_pose(ModelSpec spec, const System& system, const State& state);

}  // namespace ferrers
