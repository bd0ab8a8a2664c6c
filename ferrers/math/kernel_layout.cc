#include "ferrers/math/kernel_layout.h"

#include <algorithm>
#include <array>

#include "ferrers/core/checks.h"

namespace ferrers {
namespace {

constexpr int kLanes = 4;
constexpr int kFarthest = 4;  // of two neighbours in a row with gaps
constexpr int kAbsent = -2;   // not on the board

int rounded_up(int length) { return (length + kLanes - 1) / kLanes * kLanes; }

}  // namespace

KernelLayout::KernelLayout(int count)
    : count_(count),
      next_(count, -1),
      previous_(count, -1),
      written_(count, kAbsent),
      row_(count, -1),
      place_(count, -1) {}

void KernelLayout::add(int number, int written) {
  if (written_[number] == kAbsent) numbers_.push_back(number);
  written_[number] = written;
}

int KernelLayout::new_gap() {
  const int gap = static_cast<int>(next_.size());
  for (std::vector<int>* one : {&next_, &previous_, &row_, &place_}) one->push_back(-1);
  written_.push_back(kAbsent);
  numbers_.push_back(gap);
  return gap;
}

void KernelLayout::link(int a, int b) {
  next_[a] = b;
  previous_[b] = a;
}

// 0: not within reach.
int KernelLayout::distance(int a, int b) const {
  int at = a;
  for (int steps = 1; steps <= kFarthest; ++steps) {
    at = next_[at];
    if (at < 0) return 0;
    if (at == b) return steps;
  }
  return 0;
}

KernelLayout::Positions KernelLayout::find_positions(const std::vector<Row>& rows, std::size_t length) const {
  Positions positions(length, 0);
  for (std::size_t i = 0; i + 1 < length; ++i) {
    std::array<int, kFarthest + 1> votes{};
    for (const Row& row : rows) {
      if (row[i] != row[i + 1]) ++votes[static_cast<std::size_t>(distance(row[i], row[i + 1]))];
    }
    votes[0] = 0;
    const auto most = std::max_element(votes.begin(), votes.end());
    const int step = *most == 0 ? 1 : static_cast<int>(most - votes.begin());
    positions[i + 1] = positions[i] + step;
  }
  return positions;
}

void KernelLayout::write_together(const Row& row, const Positions& positions) {
  const int id = static_cast<int>(rows_.size()), time = written_[row.front()];
  int before = -1;
  for (std::size_t i = 0; i < row.size(); ++i) {
    for (int gap = i == 0 ? 0 : positions[i] - positions[i - 1] - 1; gap > 0; --gap) {
      const int empty = new_gap();
      row_[empty] = id;
      written_[empty] = time;
      link(before, empty);
      before = empty;
    }
    row_[row[i]] = id;
    if (before >= 0) link(before, row[i]);
    before = row[i];
  }
  rows_.push_back({row.front(), positions.back() + 1, time});
}

// Puts a number that is written later into a gap of a row.
bool KernelLayout::fill_gap(int gap, int number) {
  if (next_[number] >= 0 || previous_[number] >= 0 || written_[number] <= written_[gap]) return false;
  const int before = previous_[gap], after = next_[gap];
  next_[gap] = previous_[gap] = -1;
  link(before, number);
  link(number, after);
  row_[number] = row_[gap];  // as a member it is, but for being written later
  place_[gap] = 0;           // it wants none any more
  return true;
}

void KernelLayout::join(int a, int b, int distance) {
  int at = a;
  for (int step = 1; step < distance; ++step) {
    if (next_[at] < 0) {
      if (previous_[b] >= 0) return;
      link(at, new_gap());
    }
    at = next_[at];
    if (at == b) return;
  }
  if (next_[at] == b) return;
  if (next_[at] < 0 && previous_[b] < 0) return link(at, b);
  if (next_[at] >= 0 && is_gap(next_[at])) fill_gap(next_[at], b);
}

void KernelLayout::read_together(const Row& row, const Positions& positions) {
  for (const int number : row) {
    if (written_[number] == kAbsent) return;
  }
  for (std::size_t i = 0; i + 1 < row.size(); ++i) {
    if (row[i] != row[i + 1]) join(row[i], row[i + 1], positions[i + 1] - positions[i]);
  }
}

void KernelLayout::place() {
  const auto follow = [&](int number) {
    size_ = rounded_up(size_);
    int clear_from = 0, row = -1;  // until where the last row written before overwrites, and when
    for (; number >= 0 && place_[number] < 0; number = next_[number]) {
      if (row >= 0 && row_[number] != row && size_ < clear_from && written_[number] <= rows_[row].time) {
        size_ = rounded_up(clear_from);  // no neighbour of that row
      }
      if (row_[number] >= 0 && row_[number] != row) {
        row = row_[number];
        clear_from = size_ + rounded_up(rows_[row].length);
      }
      place_[number] = size_++;
    }
    if (size_ < clear_from) size_ = clear_from;
  };
  for (const int number : numbers_) {
    if (previous_[number] < 0) follow(number);
  }
  for (const int number : numbers_) {  // rings; not from within a row that is written together
    const bool inside = row_[number] >= 0 && rows_[row_[number]].first != number;
    if (place_[number] < 0 && !inside) follow(number);
  }
  for (const int number : numbers_) require(place_[number] >= 0, "KernelLayout: a number without a place");
}

bool KernelLayout::is_row(const Row& row, const Positions& positions) const {
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (place_[row[i]] != place_[row[0]] + positions[i]) return false;
  }
  return true;
}

int KernelLayout::extend(int length) {
  const int first = rounded_up(size_);
  size_ = first + rounded_up(length);
  return first;
}

}  // namespace ferrers
