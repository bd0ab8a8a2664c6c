#include "ferrers/math/x86_assembler.h"

#include <bit>
#include <cstring>
#include <utility>

namespace ferrers {
namespace {

constexpr int kPacked = 1, kScalar = 3;  // the prefixes 66 and F2 as VEX has them
constexpr int kNone = 0;
constexpr int kMap0F = 1, kMap0F38 = 2, kMap0F3A = 3;

bool is_byte(std::int64_t value) { return value >= -128 && value <= 127; }

}  // namespace

void X86Assembler::word(std::int32_t value) {
  for (int shift = 0; shift < 32; shift += 8) byte((static_cast<std::uint32_t>(value) >> shift) & 0xFF);
}

// The register field `reg` and the operand that stands in its place.
void X86Assembler::mode(int reg, const Operand& rm, int bytes_after) {
  const int field = (reg & 7) << 3;
  if (rm.in_register) return byte(0xC0 | field | (rm.xmm & 7));
  if (rm.base == Base::kConstant) {  // relative to the next instruction
    byte(field | 5);
    references_.push_back({code_.size(), rm.index, bytes_after});
    return word(0);
  }
  const std::int64_t distance = std::int64_t{8} * rm.index;
  const int base = static_cast<int>(rm.base) & 7;
  const bool is_short = is_byte(distance);
  byte((is_short ? 0x40 : 0x80) | field | base);
  if (base == 4) byte(0x24);  // r12 wants a byte that says: no index
  if (is_short) return byte(static_cast<int>(distance));
  word(static_cast<std::int32_t>(distance));
}

void X86Assembler::vex(int prefix, int map, int opcode, int reg, int source, const Operand& rm, bool wide,
                       int bytes_after) {
  const bool extended = rm.in_register ? rm.xmm > 7 : rm.base == Base::kR12;
  const int length = lanes_ > 1 && prefix != kScalar ? 4 : 0;
  const int tail = (~source & 15) << 3 | length | prefix;
  if (!extended && map == kMap0F && !wide) {
    byte(0xC5);
    byte((reg > 7 ? 0 : 0x80) | tail);
  } else {
    byte(0xC4);
    byte((reg > 7 ? 0 : 0x80) | 0x40 | (extended ? 0 : 0x20) | map);
    byte((wide ? 0x80 : 0) | tail);
  }
  byte(opcode);
  mode(reg, rm, bytes_after);
}

int X86Assembler::scalar_or_packed() const { return lanes_ > 1 ? kPacked : kScalar; }

void X86Assembler::load(int to, const Operand& from) {
  if (from.in_register) return vex(kPacked, kMap0F, 0x28, to, kNone, from);
  vex(scalar_or_packed(), kMap0F, 0x10, to, kNone, from);
}

void X86Assembler::load_everywhere(int to, const Operand& from) {
  if (lanes_ == 1) return load(to, from);
  vex(kPacked, kMap0F38, 0x19, to, kNone, from);
}

void X86Assembler::store(const Operand& to, int from) { vex(scalar_or_packed(), kMap0F, 0x11, from, kNone, to); }

void X86Assembler::compute(Arithmetic op, int to, int a, const Operand& b) {
  const bool is_packed_root = op == Arithmetic::kSqrt && lanes_ > 1;  // which has one source
  vex(scalar_or_packed(), kMap0F, static_cast<int>(op), to, is_packed_root ? kNone : a, b);
}

void X86Assembler::round_down(int to, const Operand& from) {
  const bool packed = lanes_ > 1;
  vex(kPacked, kMap0F3A, packed ? 0x09 : 0x0B, to, packed ? kNone : to, from, false, 1);
  byte(9);  // towards −∞, and no exception
}

void X86Assembler::exclusive_or(int to, int a, const Operand& b) { vex(kPacked, kMap0F, 0x57, to, a, b); }
void X86Assembler::conjunction(int to, int a, const Operand& b) { vex(kPacked, kMap0F, 0x54, to, a, b); }

// The opcodes of one operation stand 16 apart by which operands are multiplied; the scalar ones follow the packed ones.
void X86Assembler::fused(int opcode, int reg, int source, const Operand& rm) {
  vex(kPacked, kMap0F38, opcode + (lanes_ > 1 ? 0 : 1), reg, source, rm, true);
}
void X86Assembler::multiply_by_memory(Fused op, int a, int c, const Operand& b) {
  fused(static_cast<int>(op), a, c, b);
}
void X86Assembler::multiply_into_factor(Fused op, int a, int b, const Operand& c) {
  fused(static_cast<int>(op) + 0x10, a, b, c);
}
void X86Assembler::multiply_into_sum(Fused op, int c, int a, const Operand& b) {
  fused(static_cast<int>(op) + 0x20, c, a, b);
}

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
  mode(static_cast<int>(to), Operand::at(base, index), 0);
}

void X86Assembler::call(const void* function) {
  byte(0x48);
  byte(0xB8);  // mov rax, function
  const auto place = reinterpret_cast<std::uintptr_t>(function);
  for (int shift = 0; shift < 64; shift += 8) byte(static_cast<int>(place >> shift & 0xFF));
  byte(0xFF);
  byte(0xD0);  // call rax
}

void X86Assembler::count(std::int32_t times) {
  byte(0xB9);  // mov ecx, times
  word(times);
}

void X86Assembler::repeat_from(std::size_t place) {
  byte(0xFF);
  byte(0xC9);  // dec ecx
  byte(0x0F);
  byte(0x85);  // jnz place
  word(static_cast<std::int32_t>(static_cast<std::int64_t>(place) - static_cast<std::int64_t>(code_.size()) - 4));
}

void X86Assembler::forget_lanes() {
  byte(0xC5);
  byte(0xF8);
  byte(0x77);  // vzeroupper
}

void X86Assembler::finish() { byte(0xC3); }

int X86Assembler::constants(double value, int copies) {
  const auto [place, is_new] =
      known_constants_.try_emplace({std::bit_cast<std::uint64_t>(value), copies}, static_cast<int>(constants_.size()));
  if (is_new) constants_.insert(constants_.end(), static_cast<std::size_t>(copies), value);
  return place->second;
}

int X86Assembler::constant(double value) { return constants(value, lanes_); }
int X86Assembler::constant_pair(double value) { return constants(value, lanes_ > 1 ? lanes_ : 2); }

std::vector<std::uint8_t> X86Assembler::take() {
  while (code_.size() % 32 != 0) byte(0xCC);
  const std::size_t begin = code_.size();
  code_.resize(begin + constants_.size() * sizeof(double));
  if (!constants_.empty()) std::memcpy(code_.data() + begin, constants_.data(), constants_.size() * sizeof(double));
  for (const Reference& reference : references_) {
    const std::int64_t next = static_cast<std::int64_t>(reference.place) + 4 + reference.bytes_after;
    const std::int64_t to = static_cast<std::int64_t>(begin) + std::int64_t{8} * reference.constant;
    const auto distance = static_cast<std::int32_t>(to - next);
    std::memcpy(code_.data() + reference.place, &distance, sizeof(distance));
  }
  return std::move(code_);
}

}  // namespace ferrers
