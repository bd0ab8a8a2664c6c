#include "ferrers/core/closest_name.h"

#include <algorithm>
#include <array>
#include <vector>

namespace ferrers {
namespace {

constexpr std::size_t kMaxNameLength = 64;  // Longer names get no suggestion.

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// Twice the edit distance with neighbour swaps; a letter of the other case costs 1, any other change 2.
int doubled_distance(std::string_view a, std::string_view b) {
  using Row = std::array<int, kMaxNameLength + 1>;
  Row before{}, above{}, row{};
  for (std::size_t j = 0; j <= b.size(); ++j) above[j] = static_cast<int>(2 * j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = static_cast<int>(2 * i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int change = a[i - 1] == b[j - 1] ? 0 : lower(a[i - 1]) == lower(b[j - 1]) ? 1 : 2;
      row[j] = std::min({above[j] + 2, row[j - 1] + 2, above[j - 1] + change});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 2);
    }
    before = above;
    above = row;
  }
  return above[b.size()];
}

template <class Text>
std::string_view closest(std::string_view name, std::span<const Text> candidates) {
  if (name.empty() || name.size() > kMaxNameLength) return {};
  std::string_view best;
  int best_distance = std::max<int>(2, static_cast<int>(2 * name.size() / 3)) + 1;
  for (const std::string_view candidate : candidates) {
    if (candidate.empty() || candidate.size() > kMaxNameLength) continue;
    const int distance = doubled_distance(name, candidate);
    // Two changes never turn one short name into a plausible other one.
    if (distance >= 2 * static_cast<int>(std::max(name.size(), candidate.size()))) continue;
    if (distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

std::string hint(std::string_view found) {
  return found.empty() ? std::string() : "did you mean '" + std::string(found) + "'?";
}

}  // namespace

std::string_view closest_name(std::string_view name, std::span<const std::string_view> candidates) {
  return closest(name, candidates);
}
std::string_view closest_name(std::string_view name, std::span<const std::string> candidates) {
  return closest(name, candidates);
}
std::string did_you_mean(std::string_view name, std::span<const std::string_view> candidates) {
  return hint(closest(name, candidates));
}
std::string did_you_mean(std::string_view name, std::span<const std::string> candidates) {
  return hint(closest(name, candidates));
}

}  // namespace ferrers
