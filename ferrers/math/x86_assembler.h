#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace ferrers {

/// Problem: write the machine code of straight-line arithmetic on doubles, for x86-64 with AVX under the System V
/// calling convention.
///
/// Given: instructions, one call each. Wanted: their bytes. Doubles live in the registers xmm0 … xmm15 and in memory
/// relative to a general register, or among constants that are placed after the code. Private to math/.
class X86Assembler {
 public:
  enum class Base : std::uint8_t {
    kRax = 0,
    kRcx = 1,
    kRdx = 2,
    kRbx = 3,
    kRsp = 4,
    kRbp = 5,
    kRsi = 6,
    kRdi = 7,
    kR12 = 12,
    kConstant = 16
  };

  /// The second source of an instruction: a register, memory at `base` + 8 · `index`, or constant number `index`.
  struct Operand {
    bool in_register = true;
    int xmm = 0;
    Base base = Base::kRbx;
    std::int32_t index = 0;

    static Operand of(int xmm) { return {true, xmm, Base::kRbx, 0}; }
    static Operand at(Base base, std::int32_t index) { return {false, 0, base, index}; }
  };

  enum class Arithmetic : std::uint8_t {
    kAdd = 0x58,
    kMultiply = 0x59,
    kSubtract = 0x5C,
    kDivide = 0x5E,
    kSqrt = 0x51
  };

  void load(int to, const Operand& from);                        ///< to = from
  void store(const Operand& to, int from);                       ///< memory = from
  void compute(Arithmetic op, int to, int a, const Operand& b);  ///< to = a op b; kSqrt: √b
  void exclusive_or(int to, int a, const Operand& b);            ///< 128 bits
  void conjunction(int to, int a, const Operand& b);             ///< 128 bits
  void push(Base which);
  void pop(Base which);
  void move(Base to, Base from);
  void address(Base to, Base base, std::int32_t index);  ///< to = base + 8 · index
  void call(const void* function);                       ///< Destroys rax and all xmm.
  void change_stack(std::int32_t bytes);                 ///< rsp += bytes
  void finish();                                         ///< Returns to the caller.

  /// The number of a new constant.
  int constant(double value);
  int constant_pair(double first, double second);  ///< For operations on 128 bits.

  /// The code with its constants after it. Call once.
  std::vector<std::uint8_t> take();

 private:
  void byte(int value) { code_.push_back(static_cast<std::uint8_t>(value)); }
  void word(std::int32_t value);
  void vex(int prefix, int opcode, int reg, int source, const Operand& rm);
  void mode(int reg, const Operand& rm);

  std::vector<std::uint8_t> code_;
  std::vector<double> constants_;
  struct Reference {
    std::size_t place;
    std::int32_t constant;
  };
  std::vector<Reference> references_;  ///< Displacements that still want the distance to a constant.
};

}  // namespace ferrers
