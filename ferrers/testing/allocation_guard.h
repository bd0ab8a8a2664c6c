#pragma once

namespace ferrers::witness {

/// Counts heap allocations of the current thread while it lives: operator new in all its forms, and malloc, calloc,
/// realloc and aligned allocation, which Eigen uses.
///
///     AllocationGuard guard;
///     compute_positions(...);
///     EXPECT_EQ(guard.count(), 0);
///
/// Linking this unit replaces the C allocation functions of the program by ones that count and forward to the C library
/// (glibc only; under a sanitizer or another C library `available()` is false and counts stay zero). Guards may be
/// nested.
class AllocationGuard {
 public:
  AllocationGuard();
  AllocationGuard(const AllocationGuard&) = delete;
  AllocationGuard& operator=(const AllocationGuard&) = delete;

  long count() const;       ///< Allocations since the guard was made.
  static bool available();  ///< Whether this program counts: try one allocation under a guard.

 private:
  long start_;
};

}  // namespace ferrers::witness
