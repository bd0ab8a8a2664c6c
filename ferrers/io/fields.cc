#include "ferrers/io/fields.h"

#include <algorithm>
#include <stdexcept>

#include "ferrers/io/field_tables.h"

namespace ferrers {

const FieldInfo* ObjectType::find(std::string_view key) const {
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const FieldInfo& f) { return f.key == key; });
  return found == fields.end() ? nullptr : &*found;
}

const ObjectType* ObjectFamily::find_type(std::string_view tag) const {
  const auto found = std::find_if(types.begin(), types.end(), [&](const ObjectType& t) { return t.tag == tag; });
  return found == types.end() ? nullptr : &*found;
}

const std::vector<ObjectFamily>& object_families() {
  static const std::vector<ObjectFamily> families = [] {
    std::vector<ObjectFamily> all = make_body_families();
    for (auto* make : {make_joint_families, make_action_families}) {
      std::vector<ObjectFamily> more = make();
      std::move(more.begin(), more.end(), std::back_inserter(all));
    }
    return all;
  }();
  return families;
}

const ObjectFamily& object_family(Family family) {
  for (const ObjectFamily& candidate : object_families()) {
    if (candidate.id == family) return candidate;
  }
  throw std::invalid_argument("object_family: no such family");
}

bool is_model_name(std::string_view text) {
  const auto letter = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_'; };
  const auto inner = [&](char c) { return letter(c) || (c >= '0' && c <= '9'); };
  return !text.empty() && letter(text.front()) && std::all_of(text.begin(), text.end(), inner);
}

}  // namespace ferrers
