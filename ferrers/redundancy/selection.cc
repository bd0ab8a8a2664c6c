#include "ferrers/redundancy/selection.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

namespace ferrers {
namespace {

double smallest_pivot(const MatrixXd& block) {
  if (block.size() == 0) return 1;
  // not a rank decision: the size of the last pivot is wanted
  const Eigen::FullPivHouseholderQR<MatrixXd> qr(block);
  return std::abs(qr.matrixQR()(block.rows() - 1, block.cols() - 1));
}

// Rows first, then the coordinates that those rows determine best.
void choose_in_block(const ClusterBlock& block, int rank, Selection& out, std::vector<bool>& is_dependent) {
  const std::vector<int> rows = choose_independent_rows(block.G, rank);
  const MatrixXd kept = block.G(rows, Eigen::all);
  const std::vector<int> columns = choose_independent_columns(kept, rank);
  for (int i = 0; i < rank; ++i) {
    out.rows.push_back(block.rows[rows[i]]);
    is_dependent[block.columns[columns[i]]] = true;
  }
  out.smallest_pivot = std::min(out.smallest_pivot, smallest_pivot(kept(Eigen::all, columns)));
}

// Leaves out one row of each self-stress, group by group: rows on which the group is well conditioned once the groups
// before it are balanced on theirs.
class RowExclusion {
 public:
  explicit RowExclusion(std::size_t rows) : owner_(rows, -1) {}

  void add(const SparseRank::NullGroup& found) {
    Group group;
    for (const SparseRank::SparseVector& vector : found.vectors) group.vectors.push_back(reduced(vector));
    std::vector<int> rows;
    for (const Vector& vector : group.vectors) {
      for (const auto& [row, value] : vector) {
        if (owner_[row] < 0) rows.push_back(row);
      }
    }
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    const MatrixXd Z = values(group, rows);
    for (const int i : choose_independent_rows(Z, static_cast<int>(group.vectors.size()))) {
      group.rows.push_back(rows[i]);
      owner_[rows[i]] = static_cast<int>(groups_.size());
    }
    group.block.compute(values(group, group.rows));
    groups_.push_back(std::move(group));
  }

  bool excluded(std::size_t row) const { return owner_[row] >= 0; }

 private:
  using Vector = std::map<int, double>;
  struct Group {
    std::vector<Vector> vectors;
    std::vector<int> rows;
    Eigen::PartialPivLU<MatrixXd> block;  ///< Its vectors on its rows.
  };

  static MatrixXd values(const Group& group, const std::vector<int>& rows) {
    MatrixXd Z = MatrixXd::Zero(static_cast<long>(rows.size()), static_cast<long>(group.vectors.size()));
    for (std::size_t k = 0; k < group.vectors.size(); ++k) {
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto at = group.vectors[k].find(rows[i]);
        if (at != group.vectors[k].end()) Z(static_cast<long>(i), static_cast<long>(k)) = at->second;
      }
    }
    return Z;
  }

  // The vector with zeros on all rows that earlier groups leave out.
  Vector reduced(const SparseRank::SparseVector& vector) const {
    Vector z(vector.begin(), vector.end());
    std::set<int> pending;
    for (const auto& [row, value] : z) {
      if (owner_[row] >= 0) pending.insert(owner_[row]);
    }
    while (!pending.empty()) {
      const Group& group = groups_[*pending.begin()];
      pending.erase(pending.begin());
      VectorXd there(static_cast<long>(group.rows.size()));
      for (long i = 0; i < there.size(); ++i) there[i] = z[group.rows[i]];
      const VectorXd share = group.block.solve(there);
      for (std::size_t k = 0; k < group.vectors.size(); ++k) {
        for (const auto& [row, value] : group.vectors[k]) {
          z[row] -= share[static_cast<long>(k)] * value;
          if (owner_[row] >= 0 && &groups_[owner_[row]] > &group) pending.insert(owner_[row]);
        }
      }
      for (const int row : group.rows) z.erase(row);
    }
    return z;
  }

  std::vector<int> owner_;  ///< Per row: the group that leaves it out, or −1.
  std::vector<Group> groups_;
};

void choose_by_elimination(const ClusterRank& cluster, Selection& out, std::vector<bool>& is_dependent) {
  RowExclusion exclusion(cluster.rows.size());
  for (const SparseRank::NullGroup& group : cluster.elimination.left_null()) exclusion.add(group);
  for (std::size_t i = 0; i < cluster.rows.size(); ++i) {
    if (!exclusion.excluded(i)) out.rows.push_back(cluster.rows[i]);
  }
  for (const int column : cluster.columns) is_dependent[column] = true;
  for (const int column : cluster.elimination.free_columns()) is_dependent[cluster.columns[column]] = false;
}

// Near a pose where the rank falls as many values are in doubt as there are loops, and meet in one dense core.
constexpr int kLargestReselected = 10000;

int rows_of(const System& system, const Cluster& cluster) {
  int rows = 0;
  for (const int c : cluster.closures) rows += system.topology->closures[c].row_count;
  return rows;
}

// Pivoting it as a whole takes longer than a long motion.
bool is_large(const System& system, const Cluster& cluster) {
  int columns = 0;
  for (const int n : cluster.nodes) columns += system.nodes[n].nv;
  return rows_of(system, cluster) > kLargestDense && columns > kLargestDense;
}

void keep_choice(const System& system, const Cluster& cluster, const Selection& previous, Selection& out,
                 std::vector<bool>& is_dependent) {
  const auto holds = [](const std::vector<int>& sorted, int value) {
    return std::binary_search(sorted.begin(), sorted.end(), value);
  };
  for (const int c : cluster.closures) {
    const Closure& closure = system.topology->closures[c];
    for (int row = closure.row; row < closure.row + closure.row_count; ++row) {
      if (holds(previous.rows, row)) out.rows.push_back(row);
    }
  }
  for (const int n : cluster.nodes) {
    for (int v = system.nodes[n].v; v < system.nodes[n].v + system.nodes[n].nv; ++v) {
      is_dependent[v] = holds(previous.dependent, v);
    }
  }
}

// Rows and columns without entries get one that is no number: a matrix must not be singular by its pattern alone.
void spoil_empty_lines(long size, std::vector<Eigen::Triplet<double>>& entries) {
  std::vector<bool> row_held(static_cast<std::size_t>(size), false), column_held = row_held;
  for (const Eigen::Triplet<double>& e : entries) row_held[e.row()] = column_held[e.col()] = true;
  for (int i = 0; i < size; ++i) {
    if (!row_held[i] || !column_held[i]) entries.emplace_back(i, i, NAN);
  }
}

MatrixXd unknown(const MatrixXd& like) { return MatrixXd::Constant(like.rows(), like.cols(), NAN); }

void finish(const System& system, const std::vector<bool>& is_dependent, Selection& out) {
  std::sort(out.rows.begin(), out.rows.end());
  for (int v = 0; v < system.nv; ++v) (is_dependent[v] ? out.dependent : out.independent).push_back(v);
}

}  // namespace

std::vector<int> Selection::excluded_rows(int m) const {
  std::vector<int> excluded;
  for (int row = 0; row < m; ++row) {
    if (!std::binary_search(rows.begin(), rows.end(), row)) excluded.push_back(row);
  }
  return excluded;
}

Selection select_rows_and_coordinates(const System& system, const ClusterDecision& decision) {
  Selection out;
  std::vector<bool> is_dependent(system.nv, false);
  for (const ClusterRank& cluster : decision.clusters) {
    if (cluster.dense) {
      choose_in_block({cluster.rows, cluster.columns, cluster.G}, cluster.rank, out, is_dependent);
    } else {
      choose_by_elimination(cluster, out, is_dependent);
    }
  }
  finish(system, is_dependent, out);
  return out;
}

Selection select_independent(const System& system, const Scaling& scaling, const ConstraintKinematics& constraints,
                             RankDecision* decision) {
  const ConstraintBlocks blocks = cut_into_blocks(system, constraints);
  const ClusterDecision clusters = decide_clusters(system, scaling, blocks, 0, kLargestDenseInMotion);
  if (decision) *decision = clusters.decision;
  Selection out;
  std::vector<bool> is_dependent(system.nv, false);
  for (std::size_t c = 0; c < clusters.clusters.size(); ++c) {
    const ClusterRank& cluster = clusters.clusters[c];
    if (cluster.dense) {
      choose_in_block({cluster.rows, cluster.columns, cluster.G}, cluster.rank, out, is_dependent);
    } else if (is_large(system, system.topology->clusters[c])) {
      choose_by_elimination(cluster, out, is_dependent);
    } else {  // evaluation divides by the pivots of this block: they must be the best there are
      const ClusterBlock block = make_cluster_block(system, scaling, blocks, system.topology->clusters[c]);
      choose_in_block(block, cluster.rank, out, is_dependent);
    }
  }
  finish(system, is_dependent, out);
  return out;
}

Selection reselect(const System& system, const Scaling& scaling, const ConstraintKinematics& constraints,
                   const Selection& previous) {
  const ConstraintBlocks blocks = cut_into_blocks(system, constraints);
  const auto was_kept = [&](int row) { return std::binary_search(previous.rows.begin(), previous.rows.end(), row); };
  std::optional<ClusterDecision> eliminated;
  Selection out;
  std::vector<bool> is_dependent(system.nv, false);
  for (std::size_t c = 0; c < system.topology->clusters.size(); ++c) {
    const Cluster& cluster = system.topology->clusters[c];
    if (!is_large(system, cluster)) {
      const ClusterBlock block = make_cluster_block(system, scaling, blocks, cluster);
      const auto rank = std::count_if(block.rows.begin(), block.rows.end(), was_kept);
      choose_in_block(block, static_cast<int>(rank), out, is_dependent);
      continue;
    }
    if (rows_of(system, cluster) <= kLargestReselected) {
      if (!eliminated) eliminated = decide_clusters(system, scaling, blocks, 0, kLargestDenseInMotion);
      const ClusterRank& found = eliminated->clusters[c];
      if (found.rank == std::count_if(found.rows.begin(), found.rows.end(), was_kept)) {
        choose_by_elimination(found, out, is_dependent);
        continue;
      }
    }
    // Another rank just here, or near such a pose too much to look at: what was chosen stays.
    keep_choice(system, cluster, previous, out, is_dependent);
  }
  finish(system, is_dependent, out);
  return out;
}

DependentBlock::DependentBlock(const Selection& selection, const PatternMatrix& G) {
  if (selection.rows.size() <= kLargestDense) {
    dense_.compute(G(selection.rows, selection.dependent));
    return;
  }
  std::vector<int> position(static_cast<std::size_t>(G.cols()), -1);
  for (std::size_t k = 0; k < selection.dependent.size(); ++k) position[selection.dependent[k]] = static_cast<int>(k);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t i = 0; i < selection.rows.size(); ++i) {
    for (PatternMatrix::InnerIterator it(G, selection.rows[i]); it; ++it) {
      const int k = position[static_cast<std::size_t>(it.col())];
      if (k >= 0 && it.value() != 0) entries.emplace_back(static_cast<int>(i), k, it.value());
    }
  }
  const auto r = static_cast<long>(selection.rows.size());
  spoil_empty_lines(r, entries);
  Eigen::SparseMatrix<double> G_d(r, r);
  G_d.setFromTriplets(entries.begin(), entries.end());
  sparse_ = std::make_shared<Sparse>();
  sparse_->compute(G_d);
}

MatrixXd DependentBlock::solve(const MatrixXd& right) const {
  if (sparse_ == nullptr) return dense_.solve(right);
  if (sparse_->info() != Eigen::Success) return unknown(right);
  return sparse_->solve(right);
}

MatrixXd DependentBlock::solve_transposed(const MatrixXd& right) const {
  if (sparse_ == nullptr) return dense_.transpose().solve(right);
  if (sparse_->info() != Eigen::Success) return unknown(right);
  return sparse_->transpose().solve(right);
}

ExtendedSelection extend_selection(const Selection& base, const PatternMatrix& G, int first_row,
                                   const VectorXd& row_scale, const VectorXd& columns) {
  const auto k = static_cast<int>(row_scale.size());
  if (k == 0) return {base, {}, {}};
  RowMatrixXd D = G.middleRows(first_row, k);
  D = row_scale.asDiagonal() * D;
  MatrixXd A = D(Eigen::all, base.independent);
  if (!base.rows.empty()) {  // D_d G_d⁻¹ G_i by as many solutions as there are further rows
    const MatrixXd shares = DependentBlock(base, G).solve_transposed(D(Eigen::all, base.dependent).transpose());
    VectorXd of_all = VectorXd::Zero(G.rows());
    for (int row = 0; row < k; ++row) {
      of_all(base.rows) = shares.col(row);
      const VectorXd along = G.transpose() * of_all;
      A.row(row) -= along(base.independent).transpose();
    }
  }
  A *= columns(base.independent).asDiagonal();
  const int rank = analyze_rank(A, 1.0).decision.rank;
  const std::vector<int> rows = choose_independent_rows(A, rank);
  const std::vector<int> chosen = choose_independent_columns(A(rows, Eigen::all), rank);
  ExtendedSelection extended;
  Selection& out = extended.selection;
  out = base;
  out.independent.clear();
  for (const int row : rows) out.rows.push_back(first_row + row);
  for (int row = 0; row < k; ++row) {
    if (std::binary_search(rows.begin(), rows.end(), row)) continue;
    (is_negligible(A.row(row).norm(), 1.0) ? extended.implied : extended.conflicting).push_back(row);
  }
  for (int i = 0; i < static_cast<int>(base.independent.size()); ++i) {
    const bool taken = std::binary_search(chosen.begin(), chosen.end(), i);
    (taken ? out.dependent : out.independent).push_back(base.independent[i]);
  }
  std::sort(out.dependent.begin(), out.dependent.end());
  return extended;
}

MatrixXd self_stresses_of_selection(const System& system, const Selection& selection, const PatternMatrix& G) {
  const int r = static_cast<int>(selection.rows.size());
  const std::vector<int> excluded = selection.excluded_rows(system.m);
  MatrixXd Z = MatrixXd::Zero(system.m, static_cast<long>(excluded.size()));
  for (std::size_t e = 0; e < excluded.size(); ++e) Z(excluded[e], static_cast<long>(e)) = 1;
  if (r == 0 || excluded.empty()) return Z;
  const MatrixXd G_e = G(excluded, selection.dependent);
  // G_e = C G_d, so that y_e = 1 is balanced by y_r = −Cᵀ.
  const MatrixXd C_transposed = DependentBlock(selection, G).solve_transposed(G_e.transpose());
  for (int i = 0; i < r; ++i) Z.row(selection.rows[i]) = -C_transposed.row(i);
  return Z;
}

}  // namespace ferrers
