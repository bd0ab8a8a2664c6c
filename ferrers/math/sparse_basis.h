#pragma once

#include <Eigen/Core>

/// Problem: a subspace has many bases; one whose vectors have many zeros can be read.
///
/// Given: a basis (rows × k, orthonormal). Wanted: another basis of the same subspace, its vectors of unit norm and
/// with as many zeros as can be found. Method: Gauss-Jordan elimination on k pivot rows gives vectors with at least k −
/// 1 zeros each; several choices of pivot rows (seeded, always the same) give candidates, of which the sparsest
/// independent ones are taken. Finding the sparsest basis of all is NP-hard [coleman1986]. Entries that are negligible
/// (math/rank.h) are exactly zero in the result. Cost: O(rows · k²) per choice of pivots.
namespace ferrers {

Eigen::MatrixXd make_sparse_basis(const Eigen::MatrixXd& orthonormal);

}  // namespace ferrers
