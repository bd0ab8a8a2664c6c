#pragma once

#include "ferrers/redundancy/analysis.h"
#include "ferrers/redundancy/cluster_rank.h"

namespace ferrers {

/// Independent rows and coordinates for a decision, well conditioned. Small clusters are pivoted as a whole; in large
/// ones each self-stress leaves out one row of its own place, and the coordinates that no pivot determined are free.
Selection select_rows_and_coordinates(const System& system, const ClusterDecision& decision);

/// A selection with further rows `first_row`, first_row + 1, … of G (prescribed motions, say), which take away as many
/// of the independent coordinates: those that they determine best on the admissible motions. `row_scale` (one per
/// further row) and `columns` make rows comparable. Cost: O(r³).
struct ExtendedSelection {
  Selection selection;
  std::vector<int> implied;      ///< Further rows (from 0) that the constraints imply by themselves: left out.
  std::vector<int> conflicting;  ///< Those that depend on other further rows: left out.
};
ExtendedSelection extend_selection(const Selection& base, const RowMatrixXd& G, int first_row,
                                   const VectorXd& row_scale, const VectorXd& columns);

}  // namespace ferrers
