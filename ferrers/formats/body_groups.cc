#include "ferrers/formats/body_groups.h"

namespace ferrers {

const std::string& BodyGroups::root(const std::string& body) {
  const std::string* at = &body;
  while (true) {
    const auto [next, is_new] = next_.try_emplace(*at, *at);
    if (next->second == *at) return next->first;
    const auto after = next_.find(next->second);
    if (after != next_.end()) next->second = after->second;  // so that ways stay short
    at = &next->second;
  }
}

void BodyGroups::join(const std::string& a, const std::string& b) {
  const std::string to = root(b);
  next_[root(a)] = to;
}

}  // namespace ferrers
