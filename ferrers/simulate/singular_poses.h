#pragma once

#include <functional>
#include <optional>

#include "ferrers/simulate/evaluator.h"

/// Problem: a motion crosses a pose where the rank drops; when exactly, and what changes there?
///
/// Given: a step that goes across such a pose, as dense output. Wanted: the time at which the smallest pivot of the
/// rows and coordinates in force vanishes, and the rank there.
/// Method: golden section on that pivot, which falls and rises like |t − t*|, then its straight flanks are made to
/// meet. The rank is decided at the pose found (math/rank.h) with its loops closed; where that is in doubt, nothing is
/// reported. Cost: some twenty evaluations and one rank decision, for such steps only.
namespace ferrers {

std::optional<SingularPose> find_singular_pose(Evaluator& evaluator,
                                               const std::function<void(double, State&)>& state_at, double from,
                                               double to);

}  // namespace ferrers
