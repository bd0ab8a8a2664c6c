#pragma once

#include <span>
#include <string>
#include <string_view>

namespace ferrers {

/// The candidate that a mistyped `name` most likely stood for, or empty when none is near.
///
/// Nearness counts letters inserted, left out, replaced, or swapped with a neighbour; letter case counts half. One
/// third of the name may be wrong. The first of equally near candidates wins. Cost: O(candidates · length²).
std::string_view closest_name(std::string_view name, std::span<const std::string_view> candidates);
std::string_view closest_name(std::string_view name, std::span<const std::string> candidates);

/// The hint "did you mean 'x'?", or empty when nothing is near.
std::string did_you_mean(std::string_view name, std::span<const std::string_view> candidates);
std::string did_you_mean(std::string_view name, std::span<const std::string> candidates);

}  // namespace ferrers
