#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

namespace ferrers {

/// Problem: write the machine code of straight-line arithmetic on doubles, for x86-64 with AVX under the System V
/// calling convention.
///
/// Given: instructions, one call each. Wanted: their bytes. Doubles live in the registers ymm0 … ymm15, one or four in
/// each, and in memory relative to a general register, or among constants that are placed after the code. Private to
/// math/.
class X86Assembler {
 public:
  enum class Base : std::uint8_t { kRdx = 2, kRbx = 3, kRbp = 5, kRsi = 6, kRdi = 7, kR12 = 12, kConstant = 16 };

  /// The second source of an instruction: a register, memory at `base` + 8 · `index`, or the constants from number
  /// `index` on.
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

  /// With one rounding: ab + c, ab − c, c − ab.
  enum class Fused : std::uint8_t { kMultiplyAdd = 0x98, kMultiplySubtract = 0x9A, kSubtractProduct = 0x9C };

  /// 1, or 4: what follows works on so many doubles in each register and in as many places of memory.
  void use_lanes(int lanes) { lanes_ = lanes; }
  int lanes() const { return lanes_; }

  void load(int to, const Operand& from);                               ///< to = from
  void load_everywhere(int to, const Operand& from);                    ///< all lanes of to = one double in memory
  void store(const Operand& to, int from);                              ///< memory = from
  void compute(Arithmetic op, int to, int a, const Operand& b);         ///< to = a op b; kSqrt: √b
  void round_down(int to, const Operand& from);                         ///< to = ⌊from⌋
  void exclusive_or(int to, int a, const Operand& b);                   ///< 128 bits, or all lanes
  void conjunction(int to, int a, const Operand& b);                    ///< 128 bits, or all lanes
  void multiply_into_sum(Fused op, int c, int a, const Operand& b);     ///< c = a b with c, as `op` says
  void multiply_into_factor(Fused op, int a, int b, const Operand& c);  ///< a = a b with c
  void multiply_by_memory(Fused op, int a, int c, const Operand& b);    ///< a = a b with c
  void push(Base which);
  void pop(Base which);
  void move(Base to, Base from);
  void address(Base to, Base base, std::int32_t index);  ///< to = base + 8 · index
  void call(const void* function);                       ///< Destroys rax and all xmm.
  void count(std::int32_t times);                        ///< rcx = times
  std::size_t here() const { return code_.size(); }
  void repeat_from(std::size_t place);  ///< rcx −= 1; goes to `place` unless it is zero.
  void forget_lanes();                  ///< After four lanes, before code of others.
  void finish();                        ///< Returns to the caller.

  /// The number of a constant that fills all lanes.
  int constant(double value);
  int constant_pair(double value);  ///< Twice, or in all lanes: for operations on bits.

  /// The code with its constants after it. Call once.
  std::vector<std::uint8_t> take();

 private:
  void byte(int value) { code_.push_back(static_cast<std::uint8_t>(value)); }
  void word(std::int32_t value);
  // `prefix`: 0 none, 1 66, 2 F3, 3 F2; `map`: 1 0F, 2 0F38, 3 0F3A. `bytes_after`: of the instruction, after the
  // operand.
  void vex(int prefix, int map, int opcode, int reg, int source, const Operand& rm, bool wide = false,
           int bytes_after = 0);
  void mode(int reg, const Operand& rm, int bytes_after);
  void fused(int opcode, int reg, int source, const Operand& rm);
  int scalar_or_packed() const;
  int constants(double value, int copies);

  std::vector<std::uint8_t> code_;
  std::vector<double> constants_;
  std::map<std::pair<std::uint64_t, int>, int> known_constants_;  // by bits and number of copies
  struct Reference {
    std::size_t place;
    std::int32_t constant, bytes_after;
  };
  std::vector<Reference> references_;  ///< Displacements that still want the distance to a constant.
  int lanes_ = 1;
};

}  // namespace ferrers
