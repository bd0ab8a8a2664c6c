#pragma once

#include <stdexcept>
#include <string>

namespace ferrers {

/// Throws `std::invalid_argument` when a caller broke a precondition of a public entry; always on.
inline void require(bool condition, const char* message) {
  if (!condition) throw std::invalid_argument(message);
}

/// The same for a size that must match, with both values in the text.
inline void require_size(long got, long wanted, const char* what) {
  if (got != wanted) {
    throw std::invalid_argument(std::string(what) + ": size " + std::to_string(got) + ", wanted " +
                                std::to_string(wanted));
  }
}

}  // namespace ferrers
