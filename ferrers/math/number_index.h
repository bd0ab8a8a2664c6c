#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ferrers {

/// Finds things by their content among things that are numbered from 0 and kept elsewhere: a hash table of numbers
/// alone. Private to math/.
class NumberIndex {
 public:
  /// The number of what has the hash and `is_same(number)`, or `next`, which then is what the thing must be numbered.
  /// Cost: O(1).
  template <class IsSame>
  int find_or_add(std::uint64_t hash, int next, const IsSame& is_same) {
    if (2 * (count_ + 1) > slots_.size()) grow();
    const auto tag = static_cast<std::uint32_t>(hash >> 32U);
    for (std::size_t at = tag & (slots_.size() - 1);; at = (at + 1) & (slots_.size() - 1)) {
      Slot& slot = slots_[at];
      if (slot.number < 0) {
        slot = {tag, next};
        ++count_;
        return next;
      }
      if (slot.tag == tag && is_same(slot.number)) return slot.number;
    }
  }

 private:
  struct Slot {
    std::uint32_t tag = 0;
    int number = -1;
  };

  void grow() {
    std::vector<Slot> old(slots_.empty() ? 64 : 2 * slots_.size());
    old.swap(slots_);
    for (const Slot& slot : old) {
      if (slot.number < 0) continue;
      std::size_t at = slot.tag & (slots_.size() - 1);
      while (slots_[at].number >= 0) at = (at + 1) & (slots_.size() - 1);
      slots_[at] = slot;
    }
  }

  std::vector<Slot> slots_;  ///< A power of two of them.
  std::size_t count_ = 0;
};

/// Spreads a key over all bits of a hash.
inline std::uint64_t mixed(std::uint64_t key) {
  key = (key ^ key >> 32U) * 0x9e3779b97f4a7c15U;
  return (key ^ key >> 29U) * 0xbf58476d1ce4e5b9U;
}

}  // namespace ferrers
