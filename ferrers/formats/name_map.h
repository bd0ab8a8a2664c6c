#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "ferrers/formats/imported_model.h"

namespace ferrers {

/// Gives names of other programs a form that the native format allows: letters, digits and '_', no digit in front, no
/// name twice among things that share a space of names, none of the words that formulas know.
///
/// `renamed` lists those that changed. Cost: O(log n).
class NameMap {
 public:
  /// A new thing's name. `space`: within it names are unique ("bodies"; "joints" for joints, couplings, constraints and
  /// coordinates; ...). An `original` that was added before to this space gets a further name with a number.
  std::string add(std::string_view space, std::string_view kind, std::string_view original);

  /// Told of an original before any is added: where it is allowed as it is, nothing else in the space gets it.
  void keep(std::string_view space, std::string_view original);

  const std::vector<RenamedThing>& renamed() const { return renamed_; }

 private:
  struct Space {
    std::set<std::string> taken, kept;
    std::map<std::string, int> numbers;  ///< The next number to try behind a name that is taken.
  };
  std::map<std::string, Space> spaces_;
  std::vector<RenamedThing> renamed_;
};

}  // namespace ferrers
