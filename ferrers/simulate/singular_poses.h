#pragma once

#include <optional>

#include "ferrers/simulate/step_control.h"

/// Problem: a motion crosses a pose where the rank drops; when exactly, and what changes there?
///
/// Given: a step that goes across such a pose, as dense output between two accepted states. Wanted: the time at which
/// the smallest singular value that is kept elsewhere vanishes, and the rank there.
/// Method: golden section on that value, which falls and rises like |t − t*|, then its straight flanks are made to
/// meet; at poses whose loops are closed. The rank is decided at the pose found (math/rank.h); where that is in doubt,
/// nothing is reported. Cost: some twenty singular value decompositions, for such steps only.
namespace ferrers {

std::optional<SingularPose> find_singular_pose(const System& system, const Scaling& scaling, const Hermite& step,
                                               int rank);

}  // namespace ferrers
