#include "ferrers/redundancy/release_search.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace ferrers {
namespace {

constexpr double kMostWork = 2.5e8;     // multiplications of a group's greedy choices, after which no other is tried
constexpr double kPoorest = 1e-3;       // conditioning below which a change is no remedy
constexpr int kLargestEnumerated = 15;  // self-stresses
constexpr int kOneLoop = 3;             // self-stresses
constexpr double kSame = 1e-9;          // values that differ by rounding only

double least_singular_value(const MatrixXd& B) {
  if (B.rows() < B.cols()) return 0;
  if (B.cols() == 3) {
    Eigen::SelfAdjointEigenSolver<Matrix3d> direct;
    direct.computeDirect(Matrix3d(B.transpose() * B), Eigen::EigenvaluesOnly);
    return std::sqrt(std::max(0.0, direct.eigenvalues()[0]));
  }
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(B.transpose() * B, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, eigen.eigenvalues()[0]));
}

// Inverse iteration on BᵀB x = σ² ZᵀZ x.
double sparse_conditioning(const ReleaseGroup& group, const std::vector<int>& candidates) {
  using Triplet = Eigen::Triplet<double>;
  std::vector<Triplet> entries;
  int row = 0;
  for (const int c : candidates) {
    for (const auto& line : group.candidates[c].block) {
      for (const auto& [column, value] : line) entries.emplace_back(row, column, value);
      ++row;
    }
  }
  if (row != group.size()) return 0;
  SparseMatrixXd B(row, row);
  B.setFromTriplets(entries.begin(), entries.end());
  entries.clear();
  for (std::size_t i = 0; i < group.rows.size(); ++i) {
    for (const auto& [column, value] : group.rows[i].second) entries.emplace_back(static_cast<int>(i), column, value);
  }
  SparseMatrixXd Z(static_cast<int>(group.rows.size()), row);
  Z.setFromTriplets(entries.begin(), entries.end());
  const SparseMatrixXd Bt = B.transpose();
  Eigen::SparseLU<SparseMatrixXd> lu(B), lu_t(Bt);
  if (lu.info() != Eigen::Success || lu_t.info() != Eigen::Success) return 0;
  VectorXd x = VectorXd::LinSpaced(row, 1, 2);
  double sigma = 0;
  constexpr int kIterations = 60;
  for (int i = 0; i < kIterations; ++i) {
    const VectorXd right = lu_t.solve(Z.transpose() * (Z * x));
    x = lu.solve(right);
    const double size = x.norm();
    if (!std::isfinite(size) || size == 0) return 0;
    x /= size;
    sigma = (B * x).norm() / (Z * x).norm();
  }
  return sigma;
}

// All sets of a few changes, best of each pattern.
class Enumeration {
 public:
  Enumeration(const ReleaseGroup& group, const SpinAnalyzer& spins, const ReleaseSearchOptions& options, bool removal)
      : group_(group), spins_(spins), options_(options) {
    const MatrixXd U = triangular_factor(group);
    blocks_.resize(group.candidates.size());
    for (std::size_t c = 0; c < group.candidates.size(); ++c) {
      const ReleaseCandidate& one = group.candidates[c];
      if (release_kinds()[one.kind].count > 1 && !removal) continue;
      if (by_joint_.empty() || group.candidates[by_joint_.back().front()].joint != one.joint) by_joint_.emplace_back();
      by_joint_.back().push_back(static_cast<int>(c));
      largest_ = std::max(largest_, one.k());
      blocks_[c] = orthonormal_rows(one.block, U);
    }
  }

  ReleaseSearch run() {
    ReleaseSearch out;
    if (largest_ == 0) return out;
    const int least = (group_.size() + largest_ - 1) / largest_;
    const int most = std::min(options_.max_changes, std::max(least + 1, options_.idle_spins ? 3 : 0));
    for (int n = least; n <= most; ++n) {
      auto before = best_;
      descend(0, n, 0);
      if (evaluations_ <= options_.evaluations) continue;
      best_ = std::move(before);
      out.cut = true;
      break;
    }
    for (auto& [pattern, entry] : best_) {
      if (entry.set.spins == 0) entry.set.alternatives = static_cast<int>(entry.places.size()) - 1;
      out.sets.push_back(std::move(entry.set));
    }
    return out;
  }

 private:
  struct Entry {
    ReleaseSet set;
    std::set<std::vector<std::pair<int, int>>> places;  // (joint, kind)
  };

  void descend(std::size_t from, int left, int sum) {
    if (left == 0) {
      if (sum >= group_.size()) evaluate(sum);
      return;
    }
    for (std::size_t j = from; j < by_joint_.size(); ++j) {
      for (const int c : by_joint_[j]) {
        const int next = sum + group_.candidates[c].k();
        if (next > group_.size() + (options_.idle_spins ? 1 : 0) || next + (left - 1) * largest_ < group_.size())
          continue;
        if (++evaluations_ > options_.evaluations) return;
        chosen_.push_back(c);
        descend(j + 1, left - 1, next);
        chosen_.pop_back();
      }
    }
  }

  void evaluate(int sum) {
    MatrixXd B(sum, group_.size());
    for (int row = 0; const int c : chosen_) {
      B.middleRows(row, blocks_[c].rows()) = blocks_[c];
      row += static_cast<int>(blocks_[c].rows());
    }
    const double conditioning = least_singular_value(B);
    if (conditioning < kPoorest) return;
    ReleaseSet set = make_release_set(group_, chosen_);
    set.conditioning = conditioning;
    set.spins = sum - group_.size();
    const auto known = best_.find(set.pattern);
    const bool better = known == best_.end() || is_better(set, known->second.set);
    if (set.spins > 0 && (!better || !adds_one_spin())) return;
    std::vector<std::pair<int, int>> place;
    for (const int c : chosen_) place.emplace_back(group_.candidates[c].joint, group_.candidates[c].kind);
    Entry& entry = best_[set.pattern];
    entry.places.insert(std::move(place));
    if (better) entry.set = std::move(set);
  }

  bool adds_one_spin() const {
    std::vector<std::pair<int, const MatrixXd*>> released;
    std::set<int> bodies;
    for (const int c : chosen_) {
      const ReleaseCandidate& one = group_.candidates[c];
      released.emplace_back(one.joint, &one.rows);
      bodies.insert(spins_.bodies_of(one.joint).first);
      bodies.insert(spins_.bodies_of(one.joint).second);
    }
    long added = 0;
    for (const int body : bodies) {
      Vector3d p = Vector3d::Zero();
      added += spins_.spins(body, released, p).cols() - spins_.spins(body, {}, p).cols();
    }
    return added == 1;
  }

  const ReleaseGroup& group_;
  const SpinAnalyzer& spins_;
  ReleaseSearchOptions options_;
  std::vector<std::vector<int>> by_joint_;
  std::vector<MatrixXd> blocks_;  // by candidate
  std::map<std::vector<int>, Entry> best_;
  std::vector<int> chosen_;
  int largest_ = 0, evaluations_ = 0;
};

bool any_complete(const std::vector<ReleaseSet>& sets) {
  return std::any_of(sets.begin(), sets.end(), [](const ReleaseSet& s) { return s.complete; });
}

// Greedy choices for several tastes; for very large groups two, unless those fail, and none more once much was spent.
void add_greedy(const ReleaseGroup& group, const SpinAnalyzer& spins, bool removal, double& spent,
                std::vector<ReleaseSet>& sets) {
  // {slide_and_align_only, moving_only, removal}; joints between moving bodies belong to few loops, so they come first.
  const GreedyRules tastes[] = {
      {false, true, removal}, {true, true, removal}, {false, false, removal}, {true, false, removal}};
  int tried = 0;
  bool moving_fails = false;
  for (const GreedyRules& taste : tastes) {
    if (spent > kMostWork) break;
    if (++tried > 2 && group.size() > kLargestOrthonormal && any_complete(sets)) break;
    if (moving_fails && taste.moving_only && group.size() > kLargestOrthonormal) continue;
    ReleaseSet set = choose_greedily(group, spins, taste);
    spent += set.work;
    moving_fails = moving_fails || (taste.moving_only && !set.complete);
    if (set.candidates.empty() || !set.complete || set.conditioning < kPoorest) continue;
    const auto same =
        std::find_if(sets.begin(), sets.end(), [&](const ReleaseSet& other) { return other.pattern == set.pattern; });
    if (same == sets.end()) {
      sets.push_back(std::move(set));
    } else if (same->candidates != set.candidates && is_better(set, *same)) {
      set.alternatives = same->alternatives;
      *same = std::move(set);
    }
  }
}

}  // namespace

int conditioning_grade(double conditioning) { return conditioning >= 0.05 ? 0 : conditioning >= 0.005 ? 1 : 2; }

bool is_preferred(double conditioning_a, double preference_a, double conditioning_b, double preference_b) {
  const int grade_a = conditioning_grade(conditioning_a), grade_b = conditioning_grade(conditioning_b);
  if (grade_a != grade_b) return grade_a < grade_b;
  if (std::abs(preference_a - preference_b) > kSame) return preference_a > preference_b;
  return conditioning_a > conditioning_b + kSame;
}

bool is_better(const ReleaseSet& a, const ReleaseSet& b) {
  if (a.complete != b.complete) return a.complete;
  if (a.spins != b.spins) return a.spins < b.spins;
  if (a.counted != b.counted) return a.counted < b.counted;
  return is_preferred(a.conditioning, a.preference, b.conditioning, b.preference);
}

ReleaseSet make_release_set(const ReleaseGroup& group, std::vector<int> candidates) {
  ReleaseSet set;
  for (const int c : candidates) {
    const ReleaseCandidate& one = group.candidates[c];
    set.pattern.push_back(one.kind);
    set.counted += release_kinds()[one.kind].count;
    set.released += one.k();
    set.preference += std::log(one.preference) / static_cast<double>(candidates.size());
  }
  std::sort(set.pattern.begin(), set.pattern.end());
  set.complete = set.released >= group.size();
  set.candidates = std::move(candidates);
  return set;
}

double release_conditioning(const ReleaseGroup& group, const std::vector<int>& candidates) {
  if (group.size() > kLargestOrthonormal) return sparse_conditioning(group, candidates);
  const MatrixXd U = triangular_factor(group);
  int rows = 0;
  for (const int c : candidates) rows += group.candidates[c].k();
  MatrixXd B(rows, group.size());
  for (int row = 0; const int c : candidates) {
    B.middleRows(row, group.candidates[c].k()) = orthonormal_rows(group.candidates[c].block, U);
    row += group.candidates[c].k();
  }
  // Of a set that is not complete: of its own rows.
  return rows < group.size() ? least_singular_value(B.transpose()) : least_singular_value(B);
}

ReleaseSearch search_group(const ReleaseGroup& group, const SpinAnalyzer& spins, const ReleaseSearchOptions& options) {
  ReleaseSearch out;
  double spent = 0;
  for (const bool removal : {false, true}) {
    if (group.size() <= kLargestEnumerated) {
      ReleaseSearch found = Enumeration(group, spins, options, removal).run();
      out.sets = std::move(found.sets);
      out.cut = out.cut || found.cut;
    }
    out.cut = out.cut || group.size() > kLargestEnumerated;
    if (!any_complete(out.sets) || out.cut || group.size() > kOneLoop)
      add_greedy(group, spins, removal, spent, out.sets);
    if (any_complete(out.sets)) break;
  }
  if (out.sets.empty() && spent <= kMostWork) {
    ReleaseSet part = choose_greedily(group, spins, {});
    if (!part.candidates.empty()) out.sets.push_back(std::move(part));
  }
  std::stable_sort(out.sets.begin(), out.sets.end(), is_better);
  if (static_cast<int>(out.sets.size()) <= options.most) return out;
  // The best with an idle spin keeps a place.
  const auto idle = std::find_if(out.sets.begin() + options.most, out.sets.end(),
                                 [](const ReleaseSet& set) { return set.spins > 0; });
  if (idle != out.sets.end() && out.sets[options.most - 1].spins == 0) out.sets[options.most - 1] = std::move(*idle);
  out.sets.resize(options.most);
  return out;
}

}  // namespace ferrers
