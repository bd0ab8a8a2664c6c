#include "ferrers/formats/mjcf_defaults.h"

#include <fmt/format.h>

#include <algorithm>

namespace ferrers::mjcf {
namespace {

constexpr std::string_view kMain = "main";

/// What the reader may ask a default for. It is noted as read here, since a class need not be used.
struct KindAttributes {
  std::string_view kind;
  std::vector<std::string_view> names;
};

const std::vector<KindAttributes>& kinds() {
  static const std::vector<KindAttributes> all = {
      {"joint",
       {"type", "pos", "axis", "range", "limited", "ref", "stiffness", "springref", "damping", "armature",
        "frictionloss", "springdamper", "springyield", "group"}},
      {"geom",
       {"type", "size", "mass", "density", "shellinertia", "pos", "quat", "axisangle", "xyaxes", "zaxis", "euler",
        "fromto", "group", "mesh", "rgba"}},
      {"site", {"pos", "quat", "axisangle", "xyaxes", "zaxis", "euler", "fromto"}},
      {"equality", {"active"}},
  };
  return all;
}

}  // namespace

Defaults::Defaults(const Element& root) {
  classes_.emplace_back();
  index_.emplace(kMain, 0);
  for (const Element& one : root.children("default")) {
    const std::string name = one.text_of("class");
    if (!name.empty()) index_.emplace(name, 0);
    add(one, -1, 0);
  }
}

void Defaults::add(const Element& element, int parent, int depth) {
  int own = 0;
  if (parent >= 0) {
    own = static_cast<int>(classes_.size());
    const std::string name = element.text_of("class");
    if (name.empty()) element.diagnostics().error("F202", element.at(), "a nested <default> has no 'class'");
    if (!name.empty() && !index_.emplace(name, own).second) {
      element.diagnostics().error("F302", element.attribute_at("class"),
                                  fmt::format("the default class '{}' is defined twice", name));
    }
    classes_.emplace_back();
    classes_.back().parent = parent;
  }
  for (const Element& child : element.children()) {
    if (child.name() == "default") {
      child.mark_read();
      add(child, own, depth + 1);
      continue;
    }
    const auto known = std::find_if(kinds().begin(), kinds().end(),
                                    [&](const KindAttributes& kind) { return kind.kind == child.name(); });
    if (known == kinds().end()) continue;
    child.mark_read();
    for (const std::string_view name : known->names) child.attribute(name);
    classes_[static_cast<std::size_t>(own)].by_kind[std::string(child.name())].push_back(child);
  }
}

Attributes Defaults::of(const Element& element, std::string_view kind, const std::string& childclass) const {
  const std::string own = element.text_of("class");
  const auto found = index_.find(own.empty() ? childclass : own);
  if (found == index_.end() && !own.empty()) check_class(element, "class");
  std::vector<Element> chain;
  for (int at = found == index_.end() ? 0 : found->second; at >= 0;
       at = classes_[static_cast<std::size_t>(at)].parent) {
    const auto elements = classes_[static_cast<std::size_t>(at)].by_kind.find(kind);
    if (elements == classes_[static_cast<std::size_t>(at)].by_kind.end()) continue;
    chain.insert(chain.end(), elements->second.rbegin(), elements->second.rend());
  }
  return Attributes(element, std::move(chain));
}

void Defaults::check_class(const Element& element, std::string_view attribute) const {
  const std::string name = element.text_of(attribute);
  if (name.empty() || index_.count(name) != 0) return;
  element.diagnostics().error("F604", element.attribute_at(attribute),
                              fmt::format("no <default> defines the class '{}'", name));
}

}  // namespace ferrers::mjcf
