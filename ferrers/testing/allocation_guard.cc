#include "ferrers/testing/allocation_guard.h"

#include <cerrno>
#include <cstdlib>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define FERRERS_COUNTS_ALLOCATIONS 0
#elif defined(__GLIBC__)
#define FERRERS_COUNTS_ALLOCATIONS 1
#else
#define FERRERS_COUNTS_ALLOCATIONS 0
#endif

namespace {
// Constant initialised, so that counting before main is safe; initial-exec needs no allocation of its own.
thread_local long allocations __attribute__((tls_model("initial-exec"))) = 0;
}  // namespace

#if FERRERS_COUNTS_ALLOCATIONS
// operator new of libstdc++ calls malloc and aligned_alloc, so these cover it. free needs no replacement: memory comes
// from the same allocator.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) {
  ++allocations;
  return __libc_calloc(count, size);
}

void* realloc(void* old, std::size_t size) {
  ++allocations;
  return __libc_realloc(old, size);
}

void* memalign(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}

int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  ++allocations;
  *out = __libc_memalign(alignment, size);
  return *out == nullptr ? ENOMEM : 0;
}
}  // extern "C"
#endif

namespace ferrers::witness {

AllocationGuard::AllocationGuard() : start_(allocations) {}

long AllocationGuard::count() const { return allocations - start_; }

bool AllocationGuard::available() {
  const AllocationGuard guard;
  void* volatile probe = std::malloc(16);
  std::free(probe);
  return guard.count() > 0;
}

}  // namespace ferrers::witness
