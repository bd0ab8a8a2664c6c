#pragma once

#include <vector>

#include "ferrers/kinematics/constraint_blocks.h"
#include "ferrers/kinematics/scaling.h"
#include "ferrers/math/rank_sparse.h"

/// Problem: one verdict about the rank of G, from parts that have nothing to do with each other.
///
/// Given: the constraints closure by closure. Wanted: one rank decision over all clusters, and for each cluster its
/// rank and null spaces. Small clusters show their singular values; of large ones (more than `kLargestDense` rows and
/// columns) stand-ins by orthogonal elimination are judged (math/rank_sparse.h). The null spaces always come from the
/// elimination, so that a self-stress names the loops that it lives in and no others.
namespace ferrers {

constexpr int kLargestDense = 128;
/// Where only the rank is wanted, and soon: the largest cluster whose singular values are found faster than it is
/// eliminated.
constexpr int kLargestDenseInMotion = 16;

struct ClusterRank {
  std::vector<int> rows, columns;  ///< Of G, ascending.
  SparseRank elimination;          ///< On local indices of `rows` and `columns`, scaled.
  bool dense = true;               ///< Singular values were computed.
  MatrixXd G;                      ///< Scaled, only where `dense`.
  VectorXd values;                 ///< Singular values or their stand-ins.
  int rank = 0;
};

struct ClusterDecision {
  RankDecision decision;  ///< Over all clusters.
  bool exact = true;      ///< Every value is a singular value, none a stand-in.
  std::vector<ClusterRank> clusters;
};

ClusterDecision decide_clusters(const System& system, const Scaling& scaling, const ConstraintBlocks& blocks,
                                double blur = 0, int largest_dense = kLargestDense);

/// The scaled Jacobian of one cluster, dense, and its rows and columns.
struct ClusterBlock {
  std::vector<int> rows, columns;
  MatrixXd G;
};
ClusterBlock make_cluster_block(const System& system, const Scaling& scaling, const ConstraintBlocks& blocks,
                                const Cluster& cluster);

}  // namespace ferrers
