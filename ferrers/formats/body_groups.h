#pragma once

#include <map>
#include <string>

namespace ferrers {

/// Which bodies hang together through joints (disjoint sets by name).
class BodyGroups {
 public:
  bool are_joined(const std::string& a, const std::string& b) { return root(a) == root(b); }
  void join(const std::string& a, const std::string& b);

 private:
  const std::string& root(const std::string& body);

  std::map<std::string, std::string> next_;  // another of the same group, the last to itself
};

}  // namespace ferrers
