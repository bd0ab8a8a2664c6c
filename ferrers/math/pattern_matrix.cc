#include "ferrers/math/pattern_matrix.h"

#include <algorithm>
#include <cassert>

namespace ferrers {

PatternMatrix::PatternMatrix(const std::vector<std::vector<int>>& columns, int column_count)
    : Base(static_cast<Eigen::Index>(columns.size()), column_count) {
  std::size_t size = 0;
  for (const std::vector<int>& row : columns) size += row.size();
  resizeNonZeros(static_cast<Eigen::Index>(size));
  int at = 0;
  for (std::size_t row = 0; row < columns.size(); ++row) {
    assert(std::is_sorted(columns[row].begin(), columns[row].end()));
    std::copy(columns[row].begin(), columns[row].end(), innerIndexPtr() + at);
    at += static_cast<int>(columns[row].size());
    outerIndexPtr()[row + 1] = at;
  }
  std::fill_n(valuePtr(), size, 0.0);
}

Eigen::MatrixXd PatternMatrix::operator()(const std::vector<int>& rows, const std::vector<int>& columns) const {
  std::vector<int> position(static_cast<std::size_t>(cols()), -1);
  for (std::size_t k = 0; k < columns.size(); ++k) position[columns[k]] = static_cast<int>(k);
  Eigen::MatrixXd out =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (InnerIterator it(*this, rows[i]); it; ++it) {
      if (position[it.col()] >= 0) out(static_cast<Eigen::Index>(i), position[it.col()]) = it.value();
    }
  }
  return out;
}

Eigen::MatrixXd PatternMatrix::dense_rows(const std::vector<int>& rows) const {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(rows.size()), cols());
  for (std::size_t i = 0; i < rows.size(); ++i) out.row(static_cast<Eigen::Index>(i)) = row(rows[i]);
  return out;
}

int PatternMatrix::place(int row, int column) const {
  const int* const begin = innerIndexPtr() + outerIndexPtr()[row];
  const int* const end = innerIndexPtr() + outerIndexPtr()[row + 1];
  const int* const at = std::lower_bound(begin, end, column);
  assert(at != end && *at == column);
  return static_cast<int>(at - innerIndexPtr());
}

void PatternMatrix::take_row(int row, Eigen::RowVectorXd& whole) {
  for (int i = outerIndexPtr()[row]; i < outerIndexPtr()[row + 1]; ++i) {
    double& source = whole[innerIndexPtr()[i]];
    valuePtr()[i] = source;
    source = 0;
  }
  assert(whole.isZero(0));  // else the pattern lacks a place
}

}  // namespace ferrers
