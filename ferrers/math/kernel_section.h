#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "ferrers/math/straight_code.h"

namespace ferrers {

/// Problem: operations that are known one by one become straight code that is as short as the processor allows.
///
/// Given: operations, operands first, and which results are stored. Wanted: the code. A product that one sum alone
/// wants becomes one instruction with it; operands are computed shortly before they are wanted. Private to math/.
class KernelSection {
 public:
  /// Room for so many operations with what they read, beforehand.
  void reserve(std::size_t operations) { values_.reserve(2 * operations); }
  int constant(double value);
  int memory(const X86Assembler::Operand& place);
  int same_memory(const X86Assembler::Operand& place);  ///< One number for all lanes.
  /// `args`: what these functions returned, or −1.
  int operation(ExpressionOp op, const std::array<int, 3>& args);
  void store(int value, const X86Assembler::Operand& to) { stores_.push_back({value, to}); }

  bool is_empty() const { return stores_.empty(); }
  enum class Order {
    kDepthFirst,  ///< Operands shortly before what wants them: few registers.
    kJustInTime   ///< Each when its result is wanted, were there processors enough: long chains side by side.
  };
  /// See `StraightCode`. Call once.
  StraightCode take(int lanes, int repeat, Order order = Order::kDepthFirst);

 private:
  void fuse();
  std::vector<int> depth_first() const;
  std::vector<int> just_in_time() const;

  std::vector<StraightCode::Value> values_;
  std::vector<StraightCode::Store> stores_;
};

}  // namespace ferrers
