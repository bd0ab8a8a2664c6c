#pragma once

#include <string>

#include "ferrers/math/rank.h"

namespace ferrers {

/// What every verb says where the rank at time t was no clear decision; empty where it was.
std::string doubtful_rank_notice(double t, const RankDecision& decision);

}  // namespace ferrers
