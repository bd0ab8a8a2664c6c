#include "ferrers/math/rank_sparse.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <queue>
#include <utility>

namespace ferrers {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

using Qr = Eigen::ColPivHouseholderQR<MatrixXd>;

std::vector<int> permuted(const std::vector<int>& columns, const Qr& qr) {
  std::vector<int> out(columns.size());
  for (std::size_t i = 0; i < columns.size(); ++i)
    out[i] = columns[qr.colsPermutation().indices()[static_cast<long>(i)]];
  return out;
}

// How many leading diagonal entries of R pass a test.
template <typename Test>
int leading(const Qr& qr, Test test) {
  const long n = std::min(qr.rows(), qr.cols());
  int count = 0;
  while (count < n && test(std::abs(qr.matrixQR()(count, count)))) ++count;
  return count;
}

}  // namespace

/// The elimination while it runs.
struct SparseRank::Eliminator {
  SparseRank& out;
  double blur;
  std::vector<Element> elements = {};
  std::vector<std::vector<int>> elements_of = {};  ///< Per column; may name dead elements.
  std::vector<int> alive = {};                     ///< Per column: how many elements know it.
  std::vector<long> degree = {};                   ///< Per column: an upper bound of how many neighbours it has.
  std::vector<int> tried = {};                     ///< Per column: the element that it could not be eliminated from.
  std::vector<bool> done = {};
  int round = 0;  ///< How choosy pivots are (math/rank.h).
  std::priority_queue<std::pair<long, int>, std::vector<std::pair<long, int>>, std::greater<>> queue = {};

  void run(std::vector<RowBlock> blocks) {
    const auto n = static_cast<std::size_t>(out.n_);
    elements_of.resize(n);
    alive.assign(n, 0);
    degree.assign(n, 0);
    tried.assign(n, -1);
    done.assign(n, false);
    for (RowBlock& block : blocks) {
      out.m_ += static_cast<int>(block.rows.size());
      std::vector<Source> sources;
      for (const int row : block.rows) sources.push_back({-1, row});
      finish_front(std::move(sources), std::move(block.columns), 0, std::move(block.A));
    }
    for (; round < kPivotRounds; ++round) {
      tried.assign(n, -1);
      for (int column = 0; column < out.n_; ++column) push(column);
      empty_queue();
    }
    gather_cores();
    for (int column = 0; column < out.n_; ++column) {
      if (!done[column]) add_dead_column(column);
    }
  }

  void empty_queue() {
    while (!queue.empty()) {
      const auto [known_degree, column] = queue.top();
      queue.pop();
      if (!done[column] && known_degree == degree[column]) eliminate(column);
    }
  }

  // A column that no row knows.
  void add_dead_column(int column) {
    Front front;
    front.Q.resize(0, 0);
    front.others = front.dead = {column};
    front.R11.resize(0, 0);
    front.R12.resize(0, 1);
    out.fronts_.push_back(std::move(front));
  }

  const std::vector<int>& alive_elements(int column) {
    std::vector<int>& list = elements_of[column];
    list.erase(std::remove_if(list.begin(), list.end(), [&](int e) { return !elements[e].alive; }), list.end());
    return list;
  }

  void eliminate(int column) {
    const std::vector<int> members = alive_elements(column);
    if (members.empty() || (members.size() == 1 && members.front() == tried[column])) return;
    // Columns that only these elements know come first: they can be eliminated now.
    std::map<int, int> known;
    for (const int e : members) {
      for (const int c : elements[e].columns) ++known[c];
    }
    std::vector<int> columns, shared;
    for (const auto& [c, count] : known) {
      const bool inside = c == column || alive[c] == count;
      (inside ? columns : shared).push_back(c);
    }
    const int candidates = static_cast<int>(columns.size());
    columns.insert(columns.end(), shared.begin(), shared.end());
    std::map<int, int> place;
    for (std::size_t i = 0; i < columns.size(); ++i) place[columns[i]] = static_cast<int>(i);
    std::vector<Source> sources;
    long rows = 0;
    for (const int e : members) rows += elements[e].A.rows();
    MatrixXd A = MatrixXd::Zero(rows, static_cast<long>(columns.size()));
    long row = 0;
    for (const int e : members) {
      Element& element = elements[e];
      for (long i = 0; i < element.A.rows(); ++i) sources.push_back(source_of(element, i));
      for (std::size_t k = 0; k < element.columns.size(); ++k) {
        A.col(place[element.columns[k]]).segment(row, element.A.rows()) = element.A.col(static_cast<long>(k));
      }
      row += element.A.rows();
      remove(e);
    }
    finish_front(std::move(sources), std::move(columns), candidates, std::move(A));
  }

  Source source_of(const Element& element, long i) const {
    return {element.front, static_cast<int>(out.fronts_[element.front].pivots.size()) + static_cast<int>(i)};
  }

  void remove(int e) {
    Element& element = elements[e];
    element.alive = false;
    for (const int c : element.columns) {
      degree[c] -= static_cast<long>(element.columns.size());
      --alive[c];
    }
    element.A.resize(0, 0);
  }

  // Eliminates what is healthy among the first `candidates` columns, drops what is surely zero, passes on the rest.
  void finish_front(std::vector<Source> sources, std::vector<int> columns, int candidates, MatrixXd A) {
    Front front;
    front.rows = std::move(sources);
    const long rows = A.rows();
    front.Q = MatrixXd::Identity(rows, rows);
    std::vector<int> passed_columns(columns.begin() + candidates, columns.end());
    MatrixXd rest = A;  // rows and columns that are passed on
    if (candidates > 0) {
      const Qr qr(A.leftCols(candidates));
      const int k = leading(qr, [&](double v) { return is_healthy_pivot(v, round); });
      // A column is dead when nothing is left of it. What depends on an undecided column is undecided too.
      const int nonzero = leading(qr, [&](double v) { return !is_surely_zero(v, blur); });
      const int live = nonzero > k ? candidates : k;
      A.leftCols(candidates) = qr.matrixQR().template triangularView<Eigen::Upper>();
      A.rightCols(A.cols() - candidates).applyOnTheLeft(qr.householderQ().adjoint());
      front.Q = qr.householderQ();
      const std::vector<int> order = permuted(std::vector<int>(columns.begin(), columns.begin() + candidates), qr);
      front.pivots.assign(order.begin(), order.begin() + k);
      std::vector<int> delayed(order.begin() + k, order.begin() + live);
      front.dead.assign(order.begin() + live, order.end());
      for (int i = 0; i < k; ++i) out.pivots_.push_back(std::abs(A(i, i)));
      if (live < candidates && live < rows) drop(A.block(live, live, rows - live, candidates - live));
      front.R11 = A.topLeftCorner(k, k);
      front.R12 = A.block(0, k, k, A.cols() - k);
      front.others.assign(order.begin() + k, order.end());
      front.others.insert(front.others.end(), passed_columns.begin(), passed_columns.end());
      for (const int c : front.pivots) done[c] = true;
      for (const int c : front.dead) done[c] = true;
      passed_columns.insert(passed_columns.begin(), delayed.begin(), delayed.end());
      rest.resize(rows - k, static_cast<long>(passed_columns.size()));
      const long d = live - k;
      rest.leftCols(d) = A.block(k, k, rows - k, d);
      rest.rightCols(rest.cols() - d) = A.bottomRightCorner(rows - k, rest.cols() - d);
    }
    pass_on(std::move(front), std::move(passed_columns), rest, static_cast<int>(A.cols()) - candidates);
  }

  void drop(const MatrixXd& block) { out.largest_dropped_ = std::max(out.largest_dropped_, block.norm()); }

  void pass_on(Front front, std::vector<int> columns, const MatrixXd& rest, int shared) {
    const int index = static_cast<int>(out.fronts_.size());
    const long k = static_cast<long>(front.pivots.size());
    if (rest.rows() > 0 && rest.cols() > 0) {
      const Qr qr(rest);
      front.passed = leading(qr, [&](double v) { return !is_surely_zero(v, blur); });
      const MatrixXd R = qr.matrixQR().template triangularView<Eigen::Upper>();
      if (front.passed < std::min(R.rows(), R.cols())) {
        drop(R.bottomRightCorner(R.rows() - front.passed, R.cols() - front.passed));
      }
      front.Q.rightCols(rest.rows()) = (front.Q.rightCols(rest.rows()) * qr.householderQ()).eval();
      if (front.passed > 0) {
        Element element{index, permuted(columns, qr), R.topRows(front.passed)};
        add_element(std::move(element), static_cast<long>(columns.size()) - shared);
      } else {
        columns_left(columns);
      }
    } else {
      columns_left(columns);
    }
    out.eliminated_ += static_cast<int>(k);
    out.fronts_.push_back(std::move(front));
  }

  // No row of this front is passed on: its columns have one neighbourhood less.
  void columns_left(const std::vector<int>& columns) {
    for (const int c : columns) push(c);
  }

  void add_element(Element element, long delayed) {
    const int e = static_cast<int>(elements.size());
    for (const int c : element.columns) {
      elements_of[c].push_back(e);
      degree[c] += static_cast<long>(element.columns.size());
      ++alive[c];
    }
    if (delayed > 0) {  // what was not healthy here is tried again only together with other rows
      for (const int c : element.columns) tried[c] = e;
    }
    elements.push_back(std::move(element));
    for (const int c : elements.back().columns) push(c);
  }

  void push(int column) {
    if (!done[column]) queue.emplace(degree[column], column);
  }

  // What is left undecided, by connected parts.
  void gather_cores() {
    std::vector<bool> taken(elements.size(), false);
    for (std::size_t first = 0; first < elements.size(); ++first) {
      if (!elements[first].alive || taken[first]) continue;
      std::vector<int> members = {static_cast<int>(first)};
      taken[first] = true;
      std::map<int, int> place;
      for (std::size_t i = 0; i < members.size(); ++i) {
        for (const int c : elements[members[i]].columns) {
          if (!place.emplace(c, static_cast<int>(place.size())).second) continue;
          for (const int e : alive_elements(c)) {
            if (!taken[e]) members.push_back(e);
            taken[e] = true;
          }
        }
      }
      out.add_core(make_core(members, place));
    }
  }

  Core make_core(const std::vector<int>& members, const std::map<int, int>& place) {
    Core core;
    core.columns.resize(place.size());
    for (const auto& [c, at] : place) {
      core.columns[at] = c;
      done[c] = true;
    }
    long rows = 0;
    for (const int e : members) rows += elements[e].A.rows();
    core.A = MatrixXd::Zero(rows, static_cast<long>(place.size()));
    long row = 0;
    for (const int e : members) {
      const Element& element = elements[e];
      for (long i = 0; i < element.A.rows(); ++i) core.rows.push_back(source_of(element, i));
      for (std::size_t k = 0; k < element.columns.size(); ++k) {
        core.A.col(place.at(element.columns[k])).segment(row, element.A.rows()) = element.A.col(static_cast<long>(k));
      }
      row += element.A.rows();
    }
    return core;
  }
};

SparseRank::SparseRank(int columns, std::vector<RowBlock> blocks, double blur) : n_(columns) {
  Eliminator{*this, blur}.run(std::move(blocks));
  estimate_smallest();
  rank_ = eliminated_;
}

void SparseRank::add_core(Core core) {
  const Eigen::JacobiSVD<MatrixXd> svd(core.A, Eigen::ComputeFullU | Eigen::ComputeFullV);
  core.U = svd.matrixU();
  core.V = svd.matrixV();
  core.values = svd.singularValues();
  core_limit_ += static_cast<int>(core.values.size());
  cores_.push_back(std::move(core));
}

VectorXd SparseRank::values() const {
  std::vector<double> all = pivots_;
  for (const Core& core : cores_) all.insert(all.end(), core.values.data(), core.values.data() + core.values.size());
  if (!pivots_.empty()) {
    double& least = *std::min_element(all.begin(), all.begin() + static_cast<long>(pivots_.size()));
    least = std::min(least, smallest_);
  }
  const auto count = static_cast<std::size_t>(std::min(m_, n_));
  while (all.size() < count) all.push_back(largest_dropped_);
  std::sort(all.begin(), all.end(), std::greater<>());
  return Eigen::Map<const VectorXd>(all.data(), static_cast<long>(all.size()));
}

void SparseRank::set_rank(int rank) {
  rank_ = std::clamp(rank, smallest_rank(), largest_rank());
  // The largest of the cores' singular values are kept.
  std::vector<std::pair<double, std::size_t>> all;
  for (std::size_t c = 0; c < cores_.size(); ++c) {
    cores_[c].rank = 0;
    for (const double value : cores_[c].values) all.emplace_back(value, c);
  }
  std::sort(all.begin(), all.end(), std::greater<>());
  for (int i = 0; i < rank_ - eliminated_; ++i) ++cores_[all[i].second].rank;
}

SparseRank::SparseVector SparseRank::expand(const std::vector<Source>& rows, const VectorXd& weights) const {
  SparseVector out;
  std::map<int, VectorXd, std::greater<>> pending;  // weights of fronts' transformed rows, parents first
  const auto spread = [&](const std::vector<Source>& sources, const VectorXd& w) {
    for (std::size_t i = 0; i < sources.size(); ++i) {
      const double value = w[static_cast<long>(i)];
      if (value == 0) continue;
      if (sources[i].front < 0) {
        out.emplace_back(sources[i].index, value);
        continue;
      }
      VectorXd& there = pending[sources[i].front];
      if (there.size() == 0) there = VectorXd::Zero(static_cast<long>(fronts_[sources[i].front].rows.size()));
      there[sources[i].index] += value;
    }
  };
  spread(rows, weights);
  while (!pending.empty()) {
    const auto [front, transformed] = *pending.begin();
    pending.erase(pending.begin());
    spread(fronts_[front].rows, fronts_[front].Q * transformed);
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::vector<SparseRank::NullGroup> SparseRank::left_null() const {
  std::vector<NullGroup> groups;
  for (const Front& front : fronts_) {
    const long first = static_cast<long>(front.pivots.size()) + front.passed;
    NullGroup group;
    for (long i = first; i < static_cast<long>(front.rows.size()); ++i) {
      group.vectors.push_back(expand(front.rows, front.Q.col(i)));
    }
    if (!group.vectors.empty()) groups.push_back(std::move(group));
  }
  for (const Core& core : cores_) {
    NullGroup group;
    for (long i = core.rank; i < core.U.cols(); ++i) group.vectors.push_back(expand(core.rows, core.U.col(i)));
    if (!group.vectors.empty()) groups.push_back(std::move(group));
  }
  return groups;
}

std::vector<int> SparseRank::free_columns() const {
  std::vector<int> free;
  for (const Front& front : fronts_) free.insert(free.end(), front.dead.begin(), front.dead.end());
  for (const Core& core : cores_) {
    std::vector<bool> chosen(core.columns.size(), false);
    for (const int c : choose_independent_columns(core.A, core.rank)) chosen[c] = true;
    for (std::size_t c = 0; c < chosen.size(); ++c) {
      if (!chosen[c]) free.push_back(core.columns[c]);
    }
  }
  std::sort(free.begin(), free.end());
  return free;
}

VectorXd SparseRank::null_vector(const VectorXd& weights) const {
  VectorXd x = VectorXd::Zero(n_);
  long at = 0;
  for (const Front& front : fronts_) {
    for (const int c : front.dead) x[c] = weights[at++];
  }
  for (const Core& core : cores_) {
    const long k = core.V.cols() - core.rank;
    const VectorXd part = core.V.rightCols(k) * weights.segment(at, k);
    at += k;
    for (std::size_t c = 0; c < core.columns.size(); ++c) x[core.columns[c]] = part[static_cast<long>(c)];
  }
  solve_upper(x);
  return x;
}

// R11 x_p = x_p − R12 x_o, parents first: what the free columns hold is carried to the others.
void SparseRank::solve_upper(VectorXd& x) const {
  for (auto front = fronts_.rbegin(); front != fronts_.rend(); ++front) {
    if (front->pivots.empty()) continue;
    VectorXd b = x(front->pivots);
    if (!front->others.empty()) b -= front->R12 * x(front->others);
    const VectorXd y = front->R11.triangularView<Eigen::Upper>().solve(b);
    x(front->pivots) = y;
  }
}

// The transposed equations, children first. Entries of columns without a pivot are workspace.
void SparseRank::solve_lower(VectorXd& x) const {
  for (const Front& front : fronts_) {
    if (front.pivots.empty()) continue;
    const VectorXd b = x(front.pivots);
    const VectorXd y = front.R11.transpose().triangularView<Eigen::Lower>().solve(b);
    x(front.pivots) = y;
    if (!front.others.empty()) x(front.others) -= front.R12.transpose() * y;
  }
}

// Inverse iteration on RᵀR of the eliminated columns: from above, close enough after a few turns.
void SparseRank::estimate_smallest() {
  if (pivots_.empty()) return;
  std::vector<int> live;
  for (const Front& front : fronts_) live.insert(live.end(), front.pivots.begin(), front.pivots.end());
  const auto keep_live = [&](const VectorXd& x) {
    VectorXd y = VectorXd::Zero(n_);
    y(live) = x(live);
    return y;
  };
  VectorXd x = VectorXd::Zero(n_);
  for (std::size_t i = 0; i < live.size(); ++i) x[live[i]] = 1 + 0.37 * std::sin(1.0 + static_cast<double>(7 * i));
  x /= x.norm();
  smallest_ = *std::min_element(pivots_.begin(), pivots_.end());
  for (int turn = 0; turn < 12; ++turn) {
    solve_lower(x);
    x = keep_live(x);
    solve_upper(x);
    x = keep_live(x);
    const double growth = x.norm();
    if (!(growth > 0)) return;
    smallest_ = std::min(smallest_, 1 / std::sqrt(growth));
    x /= growth;
  }
}

}  // namespace ferrers
