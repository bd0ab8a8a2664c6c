#include "ferrers/math/machine_memory.h"

#if defined(__x86_64__) && defined(__linux__)
#include <sys/mman.h>

#include <cstring>
#define FERRERS_HAS_MACHINE_CODE 1
#else
#define FERRERS_HAS_MACHINE_CODE 0
#endif

namespace ferrers {

#if FERRERS_HAS_MACHINE_CODE

std::shared_ptr<const MachineMemory> MachineMemory::make(std::span<const std::uint8_t> code) {
  if (code.empty()) return nullptr;
  void* const memory = mmap(nullptr, code.size(), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return nullptr;
  std::shared_ptr<const MachineMemory> owned(new MachineMemory(memory, code.size()));
  std::memcpy(memory, code.data(), code.size());
  return mprotect(memory, code.size(), PROT_READ | PROT_EXEC) == 0 ? owned : nullptr;
}

MachineMemory::~MachineMemory() { munmap(begin_, size_); }

bool has_machine_code() { return __builtin_cpu_supports("avx"); }
bool has_fused_instructions() { return __builtin_cpu_supports("fma"); }

#else

std::shared_ptr<const MachineMemory> MachineMemory::make(std::span<const std::uint8_t>) { return nullptr; }
MachineMemory::~MachineMemory() = default;
bool has_machine_code() { return false; }
bool has_fused_instructions() { return false; }

#endif

}  // namespace ferrers
