#include <fmt/format.h>

#include "ferrers/formats/mjcf_import.h"

namespace ferrers::mjcf {
namespace {

/// What acts through a tendon besides actuators and constraints.
void tell_of_forces(const Element& tendon) {
  for (const char* name : {"stiffness", "damping", "armature", "frictionloss"}) {
    const auto text = tendon.attribute(name);
    if (!text || *text == "0") continue;
    tendon.diagnostics().warning("F601", tendon.attribute_at(name),
                                 fmt::format("'{}' of the tendon '{}' is not read", name, tendon.text_of("name")));
  }
}

FixedTendon read_fixed(const Import& import, const Element& element) {
  FixedTendon tendon;
  tendon.element = element;
  for (const Element& term : element.children("joint")) {
    const TreeJoint* joint = find_joint(import, term, "joint", true);
    const double coefficient = Attributes(term).number("coef", 0);
    if (!Attributes(term).has("coef")) {
      term.diagnostics().error("F202", term.at(), "a <joint> of a tendon has no 'coef'");
    }
    if (joint == nullptr) continue;
    tendon.terms.emplace_back(import.tree.joint_index.find(joint->original)->second, coefficient);
  }
  return tendon;
}

}  // namespace

FixedTendons read_tendons(Import& import) {
  FixedTendons tendons;
  for (const Element& section : import.root.children("tendon")) {
    for (const Element& element : section.children("fixed")) {
      const std::string name = element.text_of("name");
      tell_of_forces(element);
      FixedTendon tendon = read_fixed(import, element);
      if (name.empty() || tendons.emplace(name, std::move(tendon)).second) continue;
      element.diagnostics().error("F302", element.attribute_at("name"),
                                  fmt::format("two tendons are named '{}'", name));
    }
    for (const Element& element : section.children("spatial")) {
      tell_of_forces(element);
      element.mark_read_with_all();
      element.diagnostics().notice("F601", element.at(),
                                   fmt::format("the spatial tendon '{}' is not read", element.text_of("name")));
    }
  }
  return tendons;
}

}  // namespace ferrers::mjcf
