#include "ferrers/math/sparse_basis.h"

#include <Eigen/LU>
#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

#include "ferrers/math/rank.h"

namespace ferrers {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Candidate {
  long nonzeros;
  VectorXd vector;
};

// The first k rows in `order` that are far from depending on those before; fewer where there are none.
std::vector<int> choose_pivot_rows(const MatrixXd& basis, const std::vector<int>& order) {
  std::vector<int> rows;
  MatrixXd directions(basis.cols(), basis.cols());  // orthonormal, of the rows chosen
  for (const int row : order) {
    const auto chosen = directions.leftCols(static_cast<long>(rows.size()));
    VectorXd left = basis.row(row).transpose();
    const double size = left.norm();
    left -= chosen * (chosen.transpose() * left);
    if (is_negligible(size, 1.0) || left.norm() < 0.3 * size) continue;
    directions.col(static_cast<long>(rows.size())) = left.normalized();
    rows.push_back(row);
    if (static_cast<long>(rows.size()) == basis.cols()) break;
  }
  return rows;
}

// The basis with the identity on the pivot rows, cleaned and normalized. False where the pivots are poor.
bool reduce(const MatrixXd& basis, const std::vector<int>& pivots, std::vector<Candidate>& out) {
  if (static_cast<long>(pivots.size()) < basis.cols()) return false;
  const MatrixXd block = basis(pivots, Eigen::all);
  const MatrixXd reduced = block.transpose().partialPivLu().solve(basis.transpose()).transpose();
  for (long k = 0; k < reduced.cols(); ++k) {
    VectorXd v = reduced.col(k).normalized();
    for (double& value : v) {
      if (is_surely_zero(value)) value = 0;
    }
    out.push_back({(v.array() != 0).count(), v});
  }
  return true;
}

int trials(long k) {
  if (k > 40) return 1;
  return k > 8 ? 6 : 20;
}

}  // namespace

MatrixXd make_sparse_basis(const MatrixXd& basis) {
  const long k = basis.cols();
  if (k == 0) return basis;
  std::vector<int> order(static_cast<std::size_t>(basis.rows()));
  std::iota(order.begin(), order.end(), 0);
  std::vector<Candidate> candidates;
  std::mt19937 random(1);
  for (int trial = 0; trial < (k == 1 ? 1 : trials(k)); ++trial) {
    reduce(basis, choose_pivot_rows(basis, order), candidates);
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random() % i]);
  }
  if (static_cast<long>(candidates.size()) < k) {  // no choice of rows was good: by pivoting
    candidates.clear();
    reduce(basis, choose_independent_rows(basis, static_cast<int>(k)), candidates);
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.nonzeros < b.nonzeros; });
  MatrixXd out(basis.rows(), k), directions(basis.rows(), k);
  long count = 0;
  for (const Candidate& candidate : candidates) {
    if (count == k) break;
    const auto chosen = directions.leftCols(count);
    const VectorXd left = candidate.vector - chosen * (chosen.transpose() * candidate.vector);
    if (left.norm() < 0.1) continue;
    directions.col(count) = left.normalized();
    out.col(count++) = candidate.vector;
  }
  if (count < k) return basis;
  return out;
}

}  // namespace ferrers
