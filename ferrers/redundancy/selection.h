#pragma once

#include <Eigen/LU>
#include <Eigen/SparseLU>
#include <memory>

#include "ferrers/redundancy/analysis.h"
#include "ferrers/redundancy/cluster_rank.h"

namespace ferrers {

/// Independent rows and coordinates for a decision, well conditioned. Small clusters are pivoted as a whole; in large
/// ones each self-stress leaves out one row of its own place, and the coordinates that no pivot determined are free.
Selection select_rows_and_coordinates(const System& system, const ClusterDecision& decision);

/// G_d, the chosen rows on the dependent coordinates, factored: dense while it is small. Of a singular one the
/// solutions are not finite.
class DependentBlock {
 public:
  DependentBlock(const Selection& selection, const PatternMatrix& G);
  MatrixXd solve(const MatrixXd& right) const;             ///< G_d⁻¹ right.
  MatrixXd solve_transposed(const MatrixXd& right) const;  ///< G_d⁻ᵀ right.

 private:
  using Sparse = Eigen::SparseLU<Eigen::SparseMatrix<double>>;
  Eigen::PartialPivLU<MatrixXd> dense_;
  std::shared_ptr<Sparse> sparse_;  ///< Null: `dense_`.
};

/// A selection with further rows `first_row`, first_row + 1, … of G (prescribed motions, say), which take away as many
/// of the independent coordinates: those that they determine best on the admissible motions. `row_scale` (one per
/// further row) and `columns` make rows comparable. Cost: that of factoring G_d, and of a
/// solution per further row.
struct ExtendedSelection {
  Selection selection;
  std::vector<int> implied;      ///< Further rows (from 0) that the constraints imply by themselves: left out.
  std::vector<int> conflicting;  ///< Those that depend on other further rows: left out.
};
ExtendedSelection extend_selection(const Selection& base, const PatternMatrix& G, int first_row,
                                   const VectorXd& row_scale, const VectorXd& columns);

}  // namespace ferrers
