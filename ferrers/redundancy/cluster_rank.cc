#include "ferrers/redundancy/cluster_rank.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <functional>

namespace ferrers {
namespace {

MatrixXd scaled_block(const Scaling& scaling, const ConstraintBlock& block) {
  return scaling.rows.segment(block.row, block.G.rows()).asDiagonal() * block.G *
         scaling.columns(block.columns).asDiagonal();
}

void list_indices(const System& system, const Cluster& cluster, std::vector<int>& rows, std::vector<int>& columns) {
  for (const int c : cluster.closures) {
    const Closure& closure = system.topology->closures[c];
    for (int i = 0; i < closure.row_count; ++i) rows.push_back(closure.row + i);
  }
  for (const int n : cluster.nodes) {
    for (int k = 0; k < system.nodes[n].nv; ++k) columns.push_back(system.nodes[n].v + k);
  }
  std::sort(columns.begin(), columns.end());
}

int place(const std::vector<int>& sorted, int value) {
  return static_cast<int>(std::lower_bound(sorted.begin(), sorted.end(), value) - sorted.begin());
}

std::vector<int> places(const std::vector<int>& sorted, std::vector<int> values) {
  for (int& value : values) value = place(sorted, value);
  return values;
}

ClusterRank analyze_cluster(const System& system, const Scaling& scaling, const ConstraintBlocks& blocks,
                            const Cluster& cluster, double blur, int largest_dense) {
  std::vector<int> rows, columns;
  list_indices(system, cluster, rows, columns);
  std::vector<RowBlock> parts;
  int row = 0;
  for (const int c : cluster.closures) {
    const ConstraintBlock& block = blocks.blocks[c];
    RowBlock part{{}, places(columns, block.columns), scaled_block(scaling, block)};
    for (long i = 0; i < block.G.rows(); ++i) part.rows.push_back(row++);
    parts.push_back(std::move(part));
  }
  const int n = static_cast<int>(columns.size());
  ClusterRank out{std::move(rows), std::move(columns), SparseRank(n, std::move(parts), blur), true, {}, {}, 0};
  out.dense = std::min<std::size_t>(out.rows.size(), out.columns.size()) <= static_cast<std::size_t>(largest_dense);
  if (out.dense) {
    out.G = make_cluster_block(system, scaling, blocks, cluster).G;
    out.values = compute_singular_values(out.G);
  } else {
    out.values = out.elimination.values();
  }
  return out;
}

}  // namespace

ClusterBlock make_cluster_block(const System& system, const Scaling& scaling, const ConstraintBlocks& blocks,
                                const Cluster& cluster) {
  ClusterBlock out;
  list_indices(system, cluster, out.rows, out.columns);
  out.G = MatrixXd::Zero(static_cast<long>(out.rows.size()), static_cast<long>(out.columns.size()));
  long row = 0;
  for (const int c : cluster.closures) {
    const ConstraintBlock& block = blocks.blocks[c];
    const MatrixXd scaled = scaled_block(scaling, block);
    const std::vector<int> at = places(out.columns, block.columns);
    for (std::size_t k = 0; k < at.size(); ++k) {
      out.G.col(at[k]).segment(row, scaled.rows()) = scaled.col(static_cast<long>(k));
    }
    row += scaled.rows();
  }
  return out;
}

ClusterDecision decide_clusters(const System& system, const Scaling& scaling, const ConstraintBlocks& blocks,
                                double blur, int largest_dense) {
  ClusterDecision out;
  std::vector<double> all;
  for (const Cluster& cluster : system.topology->clusters) {
    out.clusters.push_back(analyze_cluster(system, scaling, blocks, cluster, blur, largest_dense));
    const ClusterRank& c = out.clusters.back();
    all.insert(all.end(), c.values.data(), c.values.data() + c.values.size());
    out.exact = out.exact && c.dense;
  }
  std::sort(all.begin(), all.end(), std::greater<>());
  const double scale = std::max(1.0, all.empty() ? 0.0 : all.front());
  out.decision = decide_rank(Eigen::Map<const VectorXd>(all.data(), static_cast<long>(all.size())), scale, blur);
  // Each cluster keeps what lies above the common cut.
  const double cut = out.decision.rank > 0 ? out.decision.singular_values[out.decision.rank - 1] : INFINITY;
  int total = 0;
  for (ClusterRank& c : out.clusters) {
    c.rank = static_cast<int>(std::count_if(c.values.begin(), c.values.end(), [&](double v) { return v >= cut; }));
    c.elimination.set_rank(c.rank);
    // The elimination has dropped or kept for sure what the common cut reads otherwise: that is a doubt.
    if (c.elimination.decided_rank() != c.rank) {
      out.decision.confident = false;
      out.decision.other_rank = out.decision.rank;
    }
    c.rank = c.elimination.decided_rank();
    total += c.rank;
  }
  out.decision.rank = total;
  return out;
}

}  // namespace ferrers
