#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace ferrers {

/// Native code in memory of its own that can be executed and no longer written. Private to math/.
class MachineMemory {
 public:
  /// Nothing where the operating system allows no such memory.
  static std::shared_ptr<const MachineMemory> make(std::span<const std::uint8_t> code);
  MachineMemory(const MachineMemory&) = delete;
  MachineMemory& operator=(const MachineMemory&) = delete;
  ~MachineMemory();

  const void* begin() const { return begin_; }

 private:
  MachineMemory(void* begin, std::size_t size) : begin_(begin), size_(size) {}

  void* begin_;
  std::size_t size_;
};

/// Whether this processor executes the instructions that X86Assembler writes.
bool has_machine_code();
/// Whether it multiplies and adds with one rounding.
bool has_fused_instructions();

}  // namespace ferrers
