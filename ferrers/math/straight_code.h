#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "ferrers/math/expression_node.h"
#include "ferrers/math/x86_assembler.h"

namespace ferrers {

/// Problem: a sequence of operations on numbers becomes machine code that seldom waits for memory.
///
/// Given: the operations in their order, where their operands stand in memory, and where results are wanted. Wanted:
/// instructions. Values stay in registers; what has to leave one is what is needed last [belady1966]. The same code
/// works on one number or on four at a time. Private to math/.
struct StraightCode {
  using Op = std::uint8_t;  ///< An `ExpressionOp`, or one of the following, which round once.
  enum : Op {
    kMultiplyAdd = static_cast<Op>(ExpressionOp::kIf) + 1,  ///< ab + c
    kMultiplySubtract,                                      ///< ab − c
    kSubtractProduct                                        ///< c − ab
  };

  /// kLiteral: a constant; kVariable: a number at `place`; else an operation on earlier values.
  struct Value {
    Op op = static_cast<Op>(ExpressionOp::kLiteral);
    std::array<int, 3> args{-1, -1, -1};
    double constant = 0;
    X86Assembler::Operand place;
    bool same_in_all_lanes = false;  ///< One number at `place`.

    bool is_operation() const { return op > static_cast<Op>(ExpressionOp::kVariable); }
  };
  struct Store {
    int value;
    X86Assembler::Operand to;
  };

  std::vector<Value> values;
  std::vector<Store> stores;
  int lanes = 1;
  /// How many times; each time `rbx` stands `lanes` doubles further. Operands elsewhere stay.
  int repeat = 1;

  int add(const Value& value) {
    values.push_back(value);
    return static_cast<int>(values.size()) - 1;
  }
};

/// Whether an operation is an instruction; others are calls, and are done one lane at a time only.
bool is_instruction(ExpressionOp op);

/// Appends the code. r12: scratch. Returns how many doubles of it are used. Destroys rax, rcx and all xmm; calls
/// destroy what calls do. Cost: O(number of operations).
int write_straight_code(const StraightCode& code, X86Assembler& out);

}  // namespace ferrers
