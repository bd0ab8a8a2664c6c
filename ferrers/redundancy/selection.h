#pragma once

#include "ferrers/redundancy/analysis.h"
#include "ferrers/redundancy/cluster_rank.h"

namespace ferrers {

/// Independent rows and coordinates for a decision, well conditioned. Small clusters are pivoted as a whole; in large
/// ones each self-stress leaves out one row of its own place, and the coordinates that no pivot determined are free.
Selection select_rows_and_coordinates(const System& system, const ClusterDecision& decision);

}  // namespace ferrers
