#pragma once

#include <charconv>
#include <optional>
#include <string_view>

/// Versions of SDF whose meaning differs, by their minor number (7 is 1.7).
namespace ferrers {

inline constexpr int kOldestSdf = 3;
inline constexpr int kNewestSdf = 12;
inline constexpr int kAxisInJointFrame = 5;  ///< Before: axes are given in the model's frame.
inline constexpr int kUniqueFrameNames = 7;  ///< Before: a joint may be called as a link.

/// 7 of "1.7"; nothing where it is no version 1.x.
inline std::optional<int> sdf_minor_version(std::string_view text) {
  if (!text.starts_with("1.")) return std::nullopt;
  text.remove_prefix(2);
  int minor = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), minor);
  if (fault != std::errc() || end != text.data() + text.size() || minor < 0) return std::nullopt;
  return minor;
}

}  // namespace ferrers
