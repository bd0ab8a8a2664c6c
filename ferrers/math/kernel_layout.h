#pragma once

#include <vector>

namespace ferrers {

/// Problem: numbers that loops read and write four at a time are to stand side by side, each number once.
///
/// Given: rows of numbers that are written together, which have to be neighbours, and rows that are read together,
/// which had better be. A row may have gaps: who stands there belongs to no row, or to another one. Wanted: a place for
/// each number. Private to math/.
class KernelLayout {
 public:
  using Row = std::vector<int>;        ///< Numbers.
  using Positions = std::vector<int>;  ///< Of a row's numbers within it, ascending from 0: gaps where they skip.

  /// `count`: of all numbers that could be placed; they go by their index.
  explicit KernelLayout(int count);

  /// A number that stands on the board; `written`: at which time, from 0; −1: before all.
  void add(int number, int written);
  /// Positions that fit most of these rows, which are to be read at the same steps of a loop, as numbers stand by now.
  Positions find_positions(const std::vector<Row>& rows, std::size_t length) const;
  /// Numbers that one loop writes at its time, four at a time: gaps, and up to three places behind the row, are
  /// overwritten.
  void write_together(const Row& row, const Positions& positions);
  /// Numbers that had better stand so.
  void read_together(const Row& row, const Positions& positions);

  /// Places all. Call once, last.
  void place();
  int place_of(int number) const { return place_[number]; }
  /// Whether they came to stand so.
  bool is_row(const Row& row, const Positions& positions) const;
  /// Room for a further row of this length; its first place.
  int extend(int length);
  /// Places in use, with room behind them for a last reading of four.
  int size() const { return size_ + 3; }

 private:
  struct Written {
    int first = 0, length = 0, time = 0;
  };

  int new_gap();
  bool is_gap(int number) const { return number >= count_; }
  void link(int a, int b);
  void join(int a, int b, int distance);
  bool fill_gap(int gap, int number);
  int distance(int a, int b) const;

  int count_;
  std::vector<int> next_, previous_, written_, row_, place_;  ///< Per number, and per gap after them.
  std::vector<int> numbers_;                                  ///< In use, gaps too.
  std::vector<Written> rows_;
  int size_ = 0;
};

}  // namespace ferrers
