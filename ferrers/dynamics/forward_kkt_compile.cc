#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

#include "ferrers/dynamics/forward_kkt.h"

namespace ferrers {
namespace {

constexpr double kLargestGrowth = 10;  // of |c| while the order is chosen

using Indices = std::vector<int>;

Indices merged(const Indices& a, const Indices& b) {
  Indices out;
  out.reserve(a.size() + b.size());
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(out));
  return out;
}

void remove(Indices& from, int value) {
  const auto at = std::lower_bound(from.begin(), from.end(), value);
  if (at != from.end() && *at == value) from.erase(at);
}

bool holds(const Indices& a, int value) { return std::binary_search(a.begin(), a.end(), value); }

struct Entry {
  int column;
  double value;
};
using Row = std::vector<Entry>;  // ascending columns; entries of the structure, zeros too

/// One step of the elimination, with coordinates by their own index.
struct Step {
  int row = -1, column = -1;  ///< No row: the coordinate is eliminated by its mass.
  Indices touched;            ///< U: what it couples, ascending.
  Indices in_row;             ///< J ⊆ U: the rest of the row.
  Indices other_rows;         ///< That hold the coordinate.
};

/// Chooses the steps: an elimination with values, entries in sorted lists.
class Ordering {
 public:
  Ordering(const KktStructure& structure, const VectorXd& column_scale)
      : scale_(column_scale), mass_(structure.mass), holders_(structure.mass.size()) {
    for (std::size_t k = 0; k < structure.rows.size(); ++k) {
      Row row;
      for (std::size_t i = 0; i < structure.rows[k].size(); ++i) {
        const int column = structure.rows[k][i];
        row.push_back({column, structure.values.at(k).at(i)});
        holders_[column].push_back(static_cast<int>(k));
      }
      size_.push_back(largest(row));
      rows_.push_back(std::move(row));
    }
  }

  /// False where some row has no coordinate left.
  bool choose() {
    best_.resize(rows_.size());
    for (std::size_t k = 0; k < rows_.size(); ++k) enqueue(static_cast<int>(k));
    while (!queue_.empty()) {
      const int row = queue_.begin()->second;
      if (best_[row].column < 0) return false;
      queue_.erase(queue_.begin());
      eliminate_pair(row, best_[row].column);
    }
    eliminate_the_rest();
    return true;
  }

  const std::vector<Step>& steps() const { return steps_; }
  double row_size(int row) const { return size_[row]; }

 private:
  struct Candidate {
    double cost = 0;
    int column = -1;
  };

  double largest(const Row& row) const {
    double size = 0;
    for (const Entry& e : row) size = std::max(size, std::abs(e.value) * scale_[e.column]);
    return size;
  }

  // The work of a pivot, times how many times smaller it is than the largest of its row.
  Candidate best_of(const Row& row) const {
    Candidate best{INFINITY, -1};
    const double size = largest(row), others = static_cast<double>(row.size()) - 1;
    for (const Entry& e : row) {
      const double ratio = size > 0 ? std::abs(e.value) * scale_[e.column] / size : 1;
      if (!(ratio * kLargestGrowth >= 1)) continue;
      const double coupled = others + static_cast<double>(mass_[e.column].size());
      const double work = coupled * coupled + others * (static_cast<double>(holders_[e.column].size()) - 1) + 1;
      if (work / ratio < best.cost) best = {work / ratio, e.column};
    }
    return best;
  }

  void enqueue(int row) {
    best_[row] = best_of(rows_[row]);
    queue_.insert({best_[row].cost, row});
  }

  void eliminate_pair(int row, int column) {
    Step step{row, column, {}, {}, {}};
    double pivot = 0;
    for (const Entry& e : rows_[row]) {
      remove(holders_[e.column], row);
      if (e.column == column) {
        pivot = e.value;
      } else {
        step.in_row.push_back(e.column);
      }
    }
    step.other_rows = holders_[column];
    step.touched = merged(step.in_row, mass_[column]);
    std::set<int> changed;
    for (const int k : step.touched) changed.insert(holders_[k].begin(), holders_[k].end());
    changed.insert(step.other_rows.begin(), step.other_rows.end());
    for (const int k : changed) queue_.erase({best_[k].cost, k});
    for (const int k : step.other_rows) subtract(row, column, pivot, k);
    for (const int p : step.touched) {
      remove(mass_[p], column);
      mass_[p] = merged(mass_[p], holds(step.in_row, p) ? step.touched : step.in_row);
      remove(mass_[p], p);
    }
    for (const int k : changed) enqueue(k);
    steps_.push_back(std::move(step));
  }

  // Row `to` without `column`.
  void subtract(int from, int column, double pivot, int to) {
    const Row &a = rows_[to], &b = rows_[from];
    const auto here = std::find_if(a.begin(), a.end(), [&](const Entry& e) { return e.column == column; });
    const double factor = pivot != 0 ? here->value / pivot : 0;
    Row out;
    for (std::size_t i = 0, j = 0; i < a.size() || j < b.size();) {
      const bool only_a = j == b.size() || (i < a.size() && a[i].column < b[j].column);
      const bool only_b = !only_a && (i == a.size() || b[j].column < a[i].column);
      const int at = only_b ? b[j].column : a[i].column;
      const double value = (only_b ? 0 : a[i].value) - (only_a ? 0 : factor * b[j].value);
      if (at != column) out.push_back({at, value});
      if (only_b) {
        const auto place = std::lower_bound(holders_[at].begin(), holders_[at].end(), to);
        holders_[at].insert(place, to);
      }
      i += only_b ? 0 : 1;
      j += only_a ? 0 : 1;
    }
    rows_[to] = std::move(out);
  }

  // Coordinates without a partner, the one with the fewest neighbours first.
  void eliminate_the_rest() {
    std::vector<bool> done(mass_.size(), false);
    for (const Step& step : steps_) done[step.column] = true;
    std::set<std::pair<std::size_t, int>> queue;
    for (std::size_t j = 0; j < mass_.size(); ++j) {
      if (!done[j]) queue.insert({mass_[j].size(), static_cast<int>(j)});
    }
    while (!queue.empty()) {
      const int j = queue.begin()->second;
      queue.erase(queue.begin());
      for (const int p : mass_[j]) {
        queue.erase({mass_[p].size(), p});
        remove(mass_[p], j);
        mass_[p] = merged(mass_[p], mass_[j]);
        remove(mass_[p], p);
        queue.insert({mass_[p].size(), p});
      }
      steps_.push_back({-1, j, mass_[j], {}, {}});
    }
  }

  const VectorXd& scale_;
  std::vector<Row> rows_;
  std::vector<double> size_;  // largest entry of each row at first, scaled
  std::vector<Indices> mass_, holders_;
  std::vector<Candidate> best_;
  std::set<std::pair<double, int>> queue_;
  std::vector<Step> steps_;
};

}  // namespace

/// Lays the entries out and writes the runs.
class KktCompiler {
 public:
  KktCompiler(SparseKkt& out, const std::vector<Step>& steps) : out_(out), position_(steps.size()) {
    for (std::size_t s = 0; s < steps.size(); ++s) {
      position_[steps[s].column] = static_cast<int>(s);
      out_.order_.push_back(steps[s].column);
    }
    for (const Step& step : steps) {
      steps_.push_back({step.row, step.column, by_position(step.touched), by_position(step.in_row), step.other_rows});
    }
  }

  void compile(const KktStructure& structure, const Indices& rows, const Ordering& ordering,
               const VectorXd& column_scale) {
    lay_out(rows.size());
    for (std::size_t s = 0; s < steps_.size(); ++s) {
      if (steps_[s].row >= 0) {
        const double size = ordering.row_size(steps_[s].row);
        write_pair(steps_[s], static_cast<int>(s), rows[steps_[s].row],
                   size > 0 ? column_scale[steps_[s].column] / size : 1);
      } else {
        write_single(steps_[s], static_cast<int>(s));
      }
    }
    write_moves(structure, rows);
    out_.f_.resize(steps_.size());
    out_.b_.resize(rows.size());
    out_.lambda_.resize(rows.size());
    out_.began_.resize(out_.singles_.size());
  }

 private:
  // From here on coordinates go by their position in the order.
  Indices by_position(const Indices& columns) const {
    Indices out;
    for (const int column : columns) out.push_back(position_[column]);
    std::sort(out.begin(), out.end());
    return out;
  }

  // A row of G: what it holds of coordinates eliminated before it, its pivot, c. A row of M: its diagonal, u.
  struct Stored {
    int begin = 0;
    Indices columns;  // positions, ascending
    int at(int position) const {
      const auto place = std::lower_bound(columns.begin(), columns.end(), position);
      return begin + static_cast<int>(place - columns.begin());
    }
  };

  void lay_out(std::size_t row_count) {
    row_.resize(row_count);
    pair_of_row_.resize(row_count);
    mass_.resize(steps_.size());
    for (std::size_t s = 0; s < steps_.size(); ++s) {
      for (const int k : steps_[s].other_rows) row_[k].columns.push_back(static_cast<int>(s));
    }
    int size = 0, pairs = 0;
    for (std::size_t s = 0; s < steps_.size(); ++s) {
      const Step& step = steps_[s];
      const auto place = [&](Stored& stored) {
        stored.begin = size;
        stored.columns.push_back(static_cast<int>(s));
        stored.columns.insert(stored.columns.end(), step.touched.begin(), step.touched.end());
        size += static_cast<int>(stored.columns.size());
      };
      if (step.row >= 0) {
        place(row_[step.row]);
        pair_of_row_[step.row] = pairs++;
      }
      place(mass_[s]);
    }
    out_.x_.assign(static_cast<std::size_t>(size), 0.0);
  }

  int begin_columns(const Indices& touched) {
    const int begin = static_cast<int>(out_.columns_.size());
    out_.columns_.insert(out_.columns_.end(), touched.begin(), touched.end());
    return begin;
  }

  // Appends to the last run of `range` where it goes on.
  void add(SparseKkt::Range& range, int target, int p, int q, int products) {
    out_.operations_ += products;
    if (range.begin < range.end) {
      SparseKkt::Run& last = out_.runs_.back();
      if (last.p == p && last.target + last.length == target && last.q + last.length == q) {
        ++last.length;
        return;
      }
    }
    out_.runs_.push_back({target, p, q, 1});
    range.end = static_cast<int>(out_.runs_.size());
  }

  SparseKkt::Range no_runs() const {
    const int here = static_cast<int>(out_.runs_.size());
    return {here, here};
  }

  void write_pair(const Step& step, int position, int row, double weight) {
    SparseKkt::Pair pair;
    pair.row = row;
    pair.position = position;
    pair.pivot = row_[step.row].at(position);
    pair.diagonal = mass_[position].begin;
    pair.count = static_cast<int>(step.touched.size());
    pair.columns = begin_columns(step.touched);
    pair.weight = weight;
    out_.operations_ += 2 * pair.count + 2;
    const auto index = [&](int column) {
      return static_cast<int>(std::lower_bound(step.touched.begin(), step.touched.end(), column) -
                              step.touched.begin());
    };
    pair.multipliers.begin = static_cast<int>(out_.multipliers_.size());
    pair.row_runs = no_runs();
    for (const int k : step.other_rows) {
      const int multiplier = row_[k].at(position);
      out_.multipliers_.push_back({multiplier, pair_of_row_[k]});
      for (const int q : step.in_row) add(pair.row_runs, row_[k].at(q), multiplier, index(q), 1);
    }
    pair.multipliers.end = static_cast<int>(out_.multipliers_.size());
    pair.full_runs = no_runs();
    for (const int p : step.in_row) {
      for (const int q : step.touched) {
        if (q >= p) add(pair.full_runs, mass_[p].at(q), index(p), index(q), 2);
      }
    }
    pair.c_runs = no_runs();
    for (const int p : step.touched) {
      if (holds(step.in_row, p)) continue;
      for (const int q : step.in_row) {
        if (q >= p) add(pair.c_runs, mass_[p].at(q), index(p), index(q), 1);
      }
    }
    out_.pairs_.push_back(pair);
  }

  void write_single(const Step& step, int position) {
    SparseKkt::Single single;
    single.position = position;
    single.diagonal = mass_[position].begin;
    single.count = static_cast<int>(step.touched.size());
    single.columns = begin_columns(step.touched);
    single.runs = no_runs();
    for (int p = 0; p < single.count; ++p) {
      for (int q = p; q < single.count; ++q) {
        add(single.runs, mass_[step.touched[p]].at(step.touched[q]), p, q, 1);
      }
    }
    out_.operations_ += single.count + 1;
    out_.singles_.push_back(single);
  }

  void write_moves(const KktStructure& structure, const Indices& rows) {
    for (std::size_t k = 0; k < rows.size(); ++k) {
      for (const int column : structure.rows[k]) {
        out_.row_moves_.push_back({row_[k].at(position_[column]), rows[k], column, 0});
      }
    }
    for (int s = 0; s < static_cast<int>(steps_.size()); ++s) {
      const int p = out_.order_[s];
      out_.mass_moves_.push_back({mass_[s].begin, p, p, 0});
      for (const int q : structure.mass[p]) {
        if (position_[q] > s) out_.mass_moves_.push_back({mass_[s].at(position_[q]), p, q, 0});
      }
    }
  }

  SparseKkt& out_;
  Indices position_;          // of each coordinate
  std::vector<Step> steps_;   // with positions
  std::vector<Stored> row_;   // per chosen row
  std::vector<Stored> mass_;  // per position
  Indices pair_of_row_;
};

SparseKkt::SparseKkt(const KktStructure& structure, const std::vector<int>& rows, const VectorXd& column_scale) {
  Ordering ordering(structure, column_scale);
  complete_ = ordering.choose();
  if (!complete_) return;
  KktCompiler(*this, ordering.steps()).compile(structure, rows, ordering, column_scale);
}

}  // namespace ferrers
