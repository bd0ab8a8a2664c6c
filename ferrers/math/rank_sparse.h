#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "ferrers/math/rank.h"

/// Problem: the rank and both null spaces of a large matrix whose rows touch few columns each, with the care of a
/// singular value decomposition at a cost that grows with the number of local blocks only.
///
/// Given: A as blocks of rows on few columns, scaled so that its entries are comparable. Wanted: rank, a basis of the
/// left null space whose vectors touch few rows, one of the right null space, and what the rank decision rests on.
/// Method: orthogonal elimination of one column after the other, fewest neighbours first (multifrontal QR). Each front
/// gathers the rows that know a column and pivots among the columns that nobody else knows. Pivots that are healthy are
/// eliminated; what is surely zero is dropped (a dropped row is a vector of the left null space, in terms of the rows
/// of that part of the matrix only); everything in between is passed on undecided. What nobody could decide meets in a
/// small core, whose singular values tell. Rows are transformed orthogonally only, so that nothing grows: what is
/// dropped bounds σ_{r+1} from above, and the smallest singular value of the eliminated part is estimated by inverse
/// iteration.
/// Cost: O(n · front²); memory linear.
namespace ferrers {

/// Rows of A that share their columns.
struct RowBlock {
  std::vector<int> rows, columns;
  Eigen::MatrixXd A;  ///< rows × columns.
};

class SparseRank {
 public:
  /// `columns`: how many A has. `blur`: see `decide_rank`.
  SparseRank(int columns, std::vector<RowBlock> blocks, double blur = 0);

  /// Stand-ins for all min(m, n) singular values, descending: pivots, the core's singular values, bounds on what was
  /// dropped. The smallest of the kept ones is estimated.
  Eigen::VectorXd values() const;

  /// Rank that the core can have at least and at most; then `set_rank` fixes it.
  int smallest_rank() const { return eliminated_; }
  int largest_rank() const { return eliminated_ + core_limit_; }
  void set_rank(int rank);
  int decided_rank() const { return rank_; }

  /// A vector of the left null space: (row, value), orthonormal to all others.
  using SparseVector = std::vector<std::pair<int, double>>;
  struct NullGroup {
    std::vector<SparseVector> vectors;  ///< Found at one place: on the same rows.
  };
  std::vector<NullGroup> left_null() const;

  /// Columns that the others follow from, n − r, ascending: a well-conditioned choice.
  std::vector<int> free_columns() const;
  /// The vector of the right null space with these weights (n − r) of the free directions.
  Eigen::VectorXd null_vector(const Eigen::VectorXd& weights) const;

 private:
  struct Source {
    int front;  ///< −1: a row of A.
    int index;
  };
  struct Front {
    std::vector<Source> rows;
    Eigen::MatrixXd Q;                ///< Its rows times Q are: pivot rows, rows passed on, null rows.
    std::vector<int> pivots, others;  ///< Columns of R11 and of R12.
    std::vector<int> dead;            ///< Columns without a pivot, part of `others`.
    Eigen::MatrixXd R11, R12;
    int passed = 0;
    int null_rows() const { return static_cast<int>(rows.size() - pivots.size()) - passed; }
  };
  struct Element {  ///< Rows not yet eliminated.
    int front = 0;
    std::vector<int> columns;
    Eigen::MatrixXd A;
    bool alive = true;
  };
  struct Core {
    std::vector<Source> rows;
    std::vector<int> columns;
    Eigen::MatrixXd A, U, V;
    Eigen::VectorXd values;
    int rank = 0;
  };
  struct Eliminator;

  void add_core(Core core);
  void estimate_smallest();
  void solve_upper(Eigen::VectorXd& x) const;
  void solve_lower(Eigen::VectorXd& x) const;
  SparseVector expand(const std::vector<Source>& rows, const Eigen::VectorXd& weights) const;

  int m_ = 0, n_ = 0, eliminated_ = 0, core_limit_ = 0, rank_ = 0;
  double largest_dropped_ = 0, smallest_ = 0;
  std::vector<double> pivots_;
  std::vector<Front> fronts_;
  std::vector<Core> cores_;
};

}  // namespace ferrers
