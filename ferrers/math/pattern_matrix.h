#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

namespace ferrers {

/// A matrix that can have entries in places that were fixed when it was made, and keeps nothing else: memory and the
/// cost of a product follow the places, not rows × columns. Numbers may be zero in these places. What can be done with
/// it otherwise is Eigen's: products with vectors and dense matrices, `row(i)`, `transpose()`, becoming a dense matrix.
class PatternMatrix : public Eigen::SparseMatrix<double, Eigen::RowMajor> {
 public:
  using Base = Eigen::SparseMatrix<double, Eigen::RowMajor>;

  PatternMatrix() = default;
  /// All zero. `columns`: per row, ascending.
  PatternMatrix(const std::vector<std::vector<int>>& columns, int column_count);

  /// 0 outside of the pattern. Cost: logarithm of the row's length.
  double operator()(Eigen::Index row, Eigen::Index column) const { return coeff(row, column); }
  /// Dense, rows × columns of those named; each row and column at most once.
  Eigen::MatrixXd operator()(const std::vector<int>& rows, const std::vector<int>& columns) const;
  Eigen::MatrixXd dense_rows(const std::vector<int>& rows) const;

  /// Where a number of the pattern is, counted over all rows; asserts that there is one.
  int place(int row, int column) const;
  double& entry(int row, int column) { return valuePtr()[place(row, column)]; }
  /// Moves a row from `whole` (length: columns), which is zero afterwards; asserts that the pattern had all places.
  void take_row(int row, Eigen::RowVectorXd& whole);
};

}  // namespace ferrers
