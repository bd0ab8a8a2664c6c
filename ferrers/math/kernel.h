#pragma once

#include <memory>
#include <span>
#include <vector>

#include "ferrers/math/kernel_cells.h"
#include "ferrers/math/machine_memory.h"

namespace ferrers {

class X86Assembler;

/// Problem: the values of a large graph, as fast as the processor can compute them.
///
/// Given: a graph and which of its values are wanted. Wanted: native code. Equal cells of the graph (kernel_cells.h)
/// are done four at a time in loops, the rest as straight code; a product that only a sum wants is rounded with it. All
/// numbers live on one board: what is equal of neighbouring cells stands side by side there. Private to math/.
class Kernel {
 public:
  /// Numbers to work on, so aligned that four neighbours seldom lie across two lines of the cache.
  class Board {
   public:
    double* data() { return blocks_.empty() ? nullptr : blocks_.front().numbers; }
    double& operator[](std::size_t place) { return data()[place]; }

   private:
    friend class Kernel;
    struct alignas(64) Block {
      double numbers[8];
    };
    std::vector<Block> blocks_;
  };

  Kernel() = default;
  /// Nothing where no native code can be made: `is_native()`. Cost: O(size of the graph).
  Kernel(const ExpressionGraph& graph, std::span<const int> outputs, const KernelTags& tags);
  /// The same for `count` independent evaluations, a multiple of four, four at a time: place p of the board has `count`
  /// numbers, from p `count` on. Nothing where an operation is no instruction.
  static Kernel in_lanes(const ExpressionGraph& graph, std::span<const int> outputs, int count);

  bool is_native() const { return run_ != nullptr; }
  std::size_t code_bytes() const { return code_bytes_; }
  /// How many operations are done four at a time, over all.
  double shared_part() const { return shared_part_; }

  /// A board to work on: what is constant is in its places.
  Board make_board() const;
  /// Place of an input on the board, or −1: it is not wanted.
  std::span<const int> inputs() const { return inputs_; }
  std::span<const int> outputs() const { return outputs_; }
  /// From inputs to outputs. Several threads may run it on boards of their own. Allocates nothing.
  void run(Board& board) const { run_(board.data()); }

 private:
  using Function = void (*)(double* board);
  void assemble(X86Assembler& code);

  Function run_ = nullptr;
  std::vector<double> board_;
  std::vector<int> inputs_, outputs_;
  std::size_t code_bytes_ = 0;
  double shared_part_ = 0;
  std::shared_ptr<const MachineMemory> memory_;
};

}  // namespace ferrers
