#pragma once

#include <optional>
#include <string>

#include "ferrers/kinematics/constraints.h"
#include "ferrers/kinematics/scaling.h"

namespace ferrers {

/// A constraint whose rate does not follow from the others', though its row of G depends on theirs.
struct RateConflict {
  std::string row;
  double residual = 0;  ///< How far its rate G v − ν is off where the independent rows' vanish, in its own unit per s.
};

/// What to tell its user.
std::string rate_conflict_message(const RateConflict& conflict);

/// Constraints that move by themselves (functions of time) or are conditions on velocities ask for rates G v = ν. Where
/// rows of G are dependent, no v may satisfy all: the worst such row, in scaled units; nothing where all agree. The
/// independent rows come from the rank decision of this pose. Costs that decision.
std::optional<RateConflict> find_rate_conflict(const System& system, const Scaling& scaling,
                                               const ConstraintKinematics& constraints);

}  // namespace ferrers
