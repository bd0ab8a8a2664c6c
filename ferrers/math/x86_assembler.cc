#include "ferrers/math/x86_assembler.h"

#include <cstring>
#include <utility>

namespace ferrers {
namespace {

constexpr int kScalarDouble = 3, kPackedDouble = 1;  // the prefixes F2 and 66 as VEX has them
constexpr int kNoSource = 0;

bool is_byte(std::int64_t value) { return value >= -128 && value <= 127; }

}  // namespace

void X86Assembler::word(std::int32_t value) {
  for (int shift = 0; shift < 32; shift += 8) byte((static_cast<std::uint32_t>(value) >> shift) & 0xFF);
}

// The register field `reg` and the operand that stands in its place.
void X86Assembler::mode(int reg, const Operand& rm) {
  const int field = (reg & 7) << 3;
  if (rm.in_register) return byte(0xC0 | field | (rm.xmm & 7));
  if (rm.base == Base::kConstant) {  // relative to the next instruction
    byte(field | 5);
    references_.push_back({code_.size(), rm.index});
    return word(0);
  }
  const std::int64_t distance = std::int64_t{8} * rm.index;
  const int base = static_cast<int>(rm.base) & 7;
  const bool is_short = is_byte(distance);
  byte((is_short ? 0x40 : 0x80) | field | base);
  if (base == 4) byte(0x24);
  if (is_short) return byte(static_cast<int>(distance));
  word(static_cast<std::int32_t>(distance));
}

void X86Assembler::vex(int prefix, int opcode, int reg, int source, const Operand& rm) {
  const bool extended = rm.in_register ? rm.xmm > 7 : rm.base == Base::kR12;
  const int tail = (~source & 15) << 3 | prefix;
  if (!extended) {
    byte(0xC5);
    byte((reg > 7 ? 0 : 0x80) | tail);
  } else {
    byte(0xC4);
    byte((reg > 7 ? 0 : 0x80) | 0x40 | 1);
    byte(tail);
  }
  byte(opcode);
  mode(reg, rm);
}

void X86Assembler::load(int to, const Operand& from) {
  if (from.in_register) return vex(kPackedDouble, 0x28, to, kNoSource, from);
  vex(kScalarDouble, 0x10, to, kNoSource, from);
}

void X86Assembler::store(const Operand& to, int from) { vex(kScalarDouble, 0x11, from, kNoSource, to); }

void X86Assembler::compute(Arithmetic op, int to, int a, const Operand& b) {
  vex(kScalarDouble, static_cast<int>(op), to, a, b);
}

void X86Assembler::exclusive_or(int to, int a, const Operand& b) { vex(kPackedDouble, 0x57, to, a, b); }
void X86Assembler::conjunction(int to, int a, const Operand& b) { vex(kPackedDouble, 0x54, to, a, b); }

void X86Assembler::push(Base which) {
  if (which == Base::kR12) byte(0x41);
  byte(0x50 | (static_cast<int>(which) & 7));
}

void X86Assembler::pop(Base which) {
  if (which == Base::kR12) byte(0x41);
  byte(0x58 | (static_cast<int>(which) & 7));
}

void X86Assembler::move(Base to, Base from) {
  byte(0x48 | (from == Base::kR12 ? 4 : 0) | (to == Base::kR12 ? 1 : 0));
  byte(0x89);
  byte(0xC0 | (static_cast<int>(from) & 7) << 3 | (static_cast<int>(to) & 7));
}

void X86Assembler::address(Base to, Base base, std::int32_t index) {
  byte(0x48 | (to == Base::kR12 ? 4 : 0) | (base == Base::kR12 ? 1 : 0));
  byte(0x8D);
  mode(static_cast<int>(to), Operand::at(base, index));
}

void X86Assembler::call(const void* function) {
  byte(0x48);
  byte(0xB8);  // mov rax, function
  const auto place = reinterpret_cast<std::uintptr_t>(function);
  for (int shift = 0; shift < 64; shift += 8) byte(static_cast<int>(place >> shift & 0xFF));
  byte(0xFF);
  byte(0xD0);  // call rax
}

void X86Assembler::change_stack(std::int32_t bytes) {
  byte(0x48);
  byte(0x81);
  byte(0xC4);
  word(bytes);
}

void X86Assembler::finish() { byte(0xC3); }

int X86Assembler::constant(double value) {
  constants_.push_back(value);
  return static_cast<int>(constants_.size()) - 1;
}

int X86Assembler::constant_pair(double first, double second) {
  constants_.insert(constants_.end(), {first, second});
  return static_cast<int>(constants_.size()) - 2;
}

std::vector<std::uint8_t> X86Assembler::take() {
  while (code_.size() % 16 != 0) byte(0xCC);
  const std::size_t begin = code_.size();
  code_.resize(begin + constants_.size() * sizeof(double));
  if (!constants_.empty()) std::memcpy(code_.data() + begin, constants_.data(), constants_.size() * sizeof(double));
  for (const Reference& reference : references_) {
    const std::int64_t next = static_cast<std::int64_t>(reference.place) + 4;
    const std::int64_t to = static_cast<std::int64_t>(begin) + std::int64_t{8} * reference.constant;
    const auto distance = static_cast<std::int32_t>(to - next);
    std::memcpy(code_.data() + reference.place, &distance, sizeof(distance));
  }
  return std::move(code_);
}

}  // namespace ferrers
