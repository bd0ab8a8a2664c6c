#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "ferrers/formats/mjcf_values.h"

namespace ferrers::mjcf {

/// The tree of default classes.
///
/// Errors: F302 for a class that is defined twice, F202 for a nested one without a name, F604 for a class that nobody
/// defines.
class Defaults {
 public:
  explicit Defaults(const Element& root);

  /// An element's attributes with the defaults of its kind ("joint", "geom", "site", "equality"): those of its `class`,
  /// else of `childclass` (empty: none), else of the main class.
  Attributes of(const Element& element, std::string_view kind, const std::string& childclass) const;

  /// Says so where nobody defines `attribute` of `element`, which names a class.
  void check_class(const Element& element, std::string_view attribute) const;

 private:
  struct Class {
    int parent = -1;
    std::map<std::string, std::vector<Element>, std::less<>> by_kind;
  };
  void add(const Element& element, int parent, int depth);

  std::vector<Class> classes_;  ///< [0] is the main class.
  std::map<std::string, int, std::less<>> index_;
};

}  // namespace ferrers::mjcf
