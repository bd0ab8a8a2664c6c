#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>
#include <queue>

#include "ferrers/redundancy/release_search.h"

namespace ferrers {
namespace {

constexpr double kHealthy = 0.05;  // a part that is new by this much is taken for its number of rows
constexpr double kMostWork = 1e8;  // multiplications of one choice; beyond, self-stresses are too much of a tangle
constexpr double kPoorest = 1e-3;
constexpr double kDropped = 1e-6;  // far-off entries: they guide a choice whose conditioning is then computed in full
constexpr double kContained = 1e-9;
constexpr double kGrain = 1e-9;  // keys nearer than this are ties

using SparseRow = std::vector<std::pair<int, double>>;

bool is_sphere_in_cylinder_or_cross(const ReleaseKind& kind) {
  return kind.to == JointType::kUniversal || (kind.to == JointType::kPointOnLine && kind.from == JointType::kRevolute);
}

// Rows chosen so far as an orthonormal basis of sparse rows, and what a further row adds to it.
class RowSpace {
 public:
  explicit RowSpace(int columns) : of_column_(columns), work_(columns, 0.0), seen_(columns, false) {}

  int size() const { return static_cast<int>(basis_.size()); }
  double work() const { return work_done_; }  ///< Multiplications so far.

  /// The part of a row that is orthogonal to the basis, where it is so to the first `done` rows of it already.
  SparseRow residual(const SparseRow& row, int done = 0) {
    ++call_;
    overlapping_.clear();
    for (const auto& [column, value] : row) {
      touch(column);
      work_[column] += value;
      if (overlapping_.size() + done == basis_.size()) continue;
      const std::vector<int>& rows = of_column_[column];  // ascending
      for (auto it = rows.rbegin(); it != rows.rend() && *it >= done; ++it) {
        if (met_[*it] != call_) overlapping_.push_back(*it);
        met_[*it] = call_;
      }
    }
    std::sort(overlapping_.begin(), overlapping_.end());
    for (const int b : overlapping_) {
      work_done_ += 2.0 * static_cast<double>(basis_[b].size());
      double along = 0;
      for (const auto& [column, value] : basis_[b]) along += value * work_[column];
      for (const auto& [column, value] : basis_[b]) {
        touch(column);
        work_[column] -= along * value;
      }
    }
    SparseRow out;
    std::sort(touched_.begin(), touched_.end());
    for (const int column : touched_) {
      if (std::abs(work_[column]) > kDropped) out.emplace_back(column, work_[column]);
      work_[column] = 0;
      seen_[column] = false;
    }
    touched_.clear();
    return out;
  }

  void add(const SparseRow& row) {
    SparseRow rest = residual(residual(row));  // twice is enough
    double size = 0;
    for (const auto& [column, value] : rest) size += value * value;
    size = std::sqrt(size);
    for (auto& [column, value] : rest) {
      value /= size;
      of_column_[column].push_back(static_cast<int>(basis_.size()));
    }
    basis_.push_back(std::move(rest));
    met_.push_back(0);
  }

 private:
  void touch(int column) {
    if (!seen_[column]) touched_.push_back(column);
    seen_[column] = true;
  }
  std::vector<SparseRow> basis_;
  std::vector<std::vector<int>> of_column_;
  std::vector<double> work_;
  std::vector<bool> seen_;
  std::vector<int> touched_, overlapping_;
  std::vector<long> met_;  // per basis row: the call that met it last
  long call_ = 0;
  double work_done_ = 0;
};

double dot(const SparseRow& a, const SparseRow& b) {
  double sum = 0;
  for (std::size_t i = 0, k = 0; i < a.size() && k < b.size();) {
    if (a[i].first == b[k].first) {
      sum += a[i++].second * b[k++].second;
    } else if (a[i].first < b[k].first) {
      ++i;
    } else {
      ++k;
    }
  }
  return sum;
}

SparseRow combined(const std::vector<SparseRow>& rows, const VectorXd& weights) {
  SparseRow all, merged;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const auto& [column, value] : rows[i]) all.emplace_back(column, weights[static_cast<long>(i)] * value);
  }
  std::sort(all.begin(), all.end());
  for (const auto& [column, value] : all) {
    if (!merged.empty() && merged.back().first == column) {
      merged.back().second += value;
    } else {
      merged.emplace_back(column, value);
    }
  }
  return merged;
}

class Greedy {
 public:
  Greedy(const ReleaseGroup& group, const SpinAnalyzer& spins, const GreedyRules& rules)
      : group_(group), space_(group.size()) {
    fresh_.resize(group.candidates.size());
    const bool orthonormal = group.size() <= kLargestOrthonormal;
    const MatrixXd U = orthonormal ? triangular_factor(group) : MatrixXd();
    for (const ReleaseCandidate& one : group.candidates) {
      blocks_.push_back(orthonormal ? sparse_rows(orthonormal_rows(one.block, U)) : one.block);
    }
    for (std::size_t c = 0; c < group.candidates.size(); ++c) {
      const ReleaseCandidate& one = group.candidates[c];
      const ReleaseKind& kind = release_kinds()[one.kind];
      const auto [a, b] = spins.bodies_of(one.joint);
      const bool on_ground = spins.is_fixed(a) || spins.is_fixed(b);
      const bool allowed = (kind.count == 1 || rules.removal) && !(rules.moving_only && on_ground && kind.is_bearing) &&
                           !(rules.slide_and_align_only && is_sphere_in_cylinder_or_cross(kind));
      if (allowed) of_joint_[one.joint].push_back(static_cast<int>(c));
    }
  }

  double work() const { return space_.work(); }

  std::vector<int> run() {
    for (const auto& [joint, candidates] : of_joint_) {
      for (const int c : candidates) push(c);
    }
    int released = 0;
    while (!queue_.empty() && released < group_.size() && space_.work() < kMostWork) {
      const Entry top = queue_.top();
      queue_.pop();
      const double now = key(top.candidate);
      if (now < 0) continue;
      if (!queue_.empty() && now < queue_.top().key - kGrain) {
        queue_.push({now, top.candidate});
        continue;
      }
      const std::vector<SparseRow> rows = std::move(fresh_[top.candidate].rows);
      for (const SparseRow& row : rows) space_.add(row);
      released += static_cast<int>(rows.size());
      const int joint = group_.candidates[top.candidate].joint;
      chosen_[joint] = top.candidate;
      for (const int c : of_joint_[joint]) {
        if (c != top.candidate) push(c);
      }
    }
    std::vector<int> out;
    for (const auto& [joint, candidate] : chosen_) out.push_back(candidate);
    return out;
  }

 private:
  struct Entry {
    double key;
    int candidate;
    bool operator<(const Entry& o) const {
      return std::abs(key - o.key) > kGrain ? key < o.key : candidate > o.candidate;
    }
  };

  void push(int c) {
    fresh_[c] = {new_rows(c), 0};
    const double k = key(c);
    if (k >= 0) queue_.push({k, c});
  }

  // What a candidate releases beyond what its joint has released already; empty where it does not contain that.
  std::vector<SparseRow> new_rows(int c) const {
    const ReleaseCandidate& one = group_.candidates[c];
    const auto chosen = chosen_.find(one.joint);
    if (chosen == chosen_.end()) return blocks_[c];
    const MatrixXd& old = group_.candidates[chosen->second].rows;
    const MatrixXd shared = one.rows.transpose() * old;
    if (one.k() <= old.cols() || (one.rows * shared - old).cwiseAbs().maxCoeff() > kContained) return {};
    const MatrixXd full = shared.householderQr().householderQ();
    std::vector<SparseRow> rows;
    for (int i = static_cast<int>(old.cols()); i < one.k(); ++i) rows.push_back(combined(blocks_[c], full.col(i)));
    return rows;
  }

  // Number of rows plus the weighted conditioning of what is new; negative where nothing is.
  double key(int c) {
    Fresh& fresh_part = fresh_[c];
    std::vector<SparseRow>& rest = fresh_part.rows;
    if (rest.empty()) return -1;
    const int k = static_cast<int>(rest.size());
    for (SparseRow& row : rest) row = space_.residual(row, fresh_part.done);
    fresh_part.done = space_.size();
    MatrixXd gram(k, k);
    for (int a = 0; a < k; ++a) {
      for (int b = 0; b <= a; ++b) gram(a, b) = gram(b, a) = dot(rest[a], rest[b]);
    }
    const double least =
        k == 1 ? gram(0, 0) : Eigen::SelfAdjointEigenSolver<MatrixXd>(gram, Eigen::EigenvaluesOnly).eigenvalues()[0];
    const double fresh = std::sqrt(std::max(0.0, least));
    if (fresh < kPoorest) return -1;
    const double weighted = std::min(fresh, 1.0) * group_.candidates[c].preference;
    return fresh > kHealthy ? k + weighted : weighted;
  }

  static std::vector<SparseRow> sparse_rows(const MatrixXd& rows) {
    std::vector<SparseRow> out(rows.rows());
    for (long i = 0; i < rows.rows(); ++i) {
      for (int c = 0; c < rows.cols(); ++c) {
        if (std::abs(rows(i, c)) > kDropped) out[i].emplace_back(c, rows(i, c));
      }
    }
    return out;
  }

  // What of a candidate's rows is new to those chosen, kept up to date when it is looked at.
  struct Fresh {
    std::vector<SparseRow> rows;
    int done = 0;  // rows of the basis that they are orthogonal to
  };

  const ReleaseGroup& group_;
  std::vector<std::vector<SparseRow>> blocks_;  // by candidate
  std::vector<Fresh> fresh_;                    // by candidate
  RowSpace space_;
  std::map<int, std::vector<int>> of_joint_;
  std::map<int, int> chosen_;
  std::priority_queue<Entry> queue_;
};

}  // namespace

ReleaseSet choose_greedily(const ReleaseGroup& group, const SpinAnalyzer& spins, const GreedyRules& rules) {
  Greedy greedy(group, spins, rules);
  ReleaseSet set = make_release_set(group, greedy.run());
  set.work = greedy.work();
  if (!set.candidates.empty()) set.conditioning = release_conditioning(group, set.candidates);
  return set;
}

}  // namespace ferrers
