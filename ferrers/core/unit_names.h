#pragma once

#include <string_view>
#include <vector>

namespace ferrers {

/// A name that `parse_unit` reads, for pages that list them.
struct UnitName {
  std::string_view name;
  bool takes_prefixes = false;
};

/// Every unit name without a prefix, in the order of the table that is read by.
std::vector<UnitName> unit_names();
/// Every SI prefix: "k", "µ".
std::vector<std::string_view> unit_prefixes();

}  // namespace ferrers
