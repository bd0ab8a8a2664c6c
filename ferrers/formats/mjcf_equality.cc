#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "ferrers/formats/mjcf_import.h"

namespace ferrers::mjcf {
namespace {

using Terms = std::vector<std::pair<const TreeJoint*, double>>;

Expression sum_over(const Terms& terms) {
  std::vector<Expression> parts;
  for (const auto& [joint, coefficient] : terms) {
    parts.push_back(Expression::constant(coefficient) * position_of(*joint));
  }
  return sum_of(parts);
}

/// The same sum in the reference configuration.
double reference_of(const Terms& terms) {
  double sum = 0;
  for (const auto& [joint, coefficient] : terms) sum += coefficient * joint->ref;
  return sum;
}

class EqualityReader {
 public:
  EqualityReader(Import& import, const FixedTendons& tendons) : import_(import), tendons_(tendons) {}

  void read(const Element& element) {
    element.mark_read();
    const Attributes attributes = import_.defaults.of(element, "equality", "");
    const std::string_view kind = element.name();
    if (!attributes.truth("active", true)) {
      element.mark_read_with_all();
      element.diagnostics().notice("F603", element.at(), fmt::format("a <{}> that is not active is left out", kind));
      return;
    }
    if (kind == "connect" || kind == "weld") return read_closure(element, kind == "weld");
    if (kind == "joint") return read_joints(element);
    if (kind == "tendon") return read_tendons(element);
    element.mark_read_with_all();
    element.diagnostics().error("F602", element.at(), fmt::format("<{}> in <equality> is not supported", kind),
                                "write active=\"false\" to leave it out");
  }

 private:
  std::string add_name(const Element& element, const std::string& otherwise) {
    const std::string own = element.text_of("name");
    return import_.names.add("joints", "constraint", own.empty() ? otherwise : own);
  }

  const TreeSite* find_site(const Element& element, std::string_view attribute) const {
    const std::string name = element.text_of(attribute);
    const auto found = import_.tree.sites.find(name);
    if (found != import_.tree.sites.end()) return &found->second;
    element.diagnostics().error("F604", element.attribute_at(attribute),
                                name.empty() ? fmt::format("<{}> has no '{}'", element.name(), attribute)
                                             : fmt::format("there is no site '{}'", name));
    return nullptr;
  }

  void read_closure(const Element& element, bool weld) {
    const bool by_sites = element.attribute("site1") || element.attribute("site2");
    std::array<int, 2> bodies = {0, 0};
    std::array<Pose, 2> frames;
    if (by_sites) {
      const TreeSite* first = find_site(element, "site1");
      const TreeSite* second = find_site(element, "site2");
      if (first == nullptr || second == nullptr) return;
      bodies = {first->body, second->body};
      frames = {first->X_BS, second->X_BS};
    } else {
      bodies[0] = find_body(import_, element, "body1");
      bodies[1] = element.attribute("body2") ? find_body(import_, element, "body2") : 0;
      if (bodies[0] < 0 || bodies[1] < 0) return;
      const Pose X_12 = import_.body(bodies[0]).X_WB.inverse() * import_.body(bodies[1]).X_WB;
      frames = weld ? weld_frames(element, X_12) : connect_frames(element, X_12);
    }
    add_closure(element, weld, bodies, frames);
  }

  /// The anchor is given on the first body; on the second it is where the reference configuration has it.
  std::array<Pose, 2> connect_frames(const Element& element, const Pose& X_12) const {
    const Attributes attributes(element);
    if (!attributes.has("anchor")) {
      element.diagnostics().error("F202", element.at(), "<connect> has no 'anchor'");
    }
    const Pose anchor(Matrix3d::Identity(), attributes.vector("anchor", Vector3d::Zero()));
    return {anchor, X_12.inverse() * anchor};
  }

  /// The anchor is given on the second body; `relpose` says where its frame is on the first, if it has a quaternion.
  std::array<Pose, 2> weld_frames(const Element& element, const Pose& X_12) const {
    const Attributes attributes(element);
    const Pose anchor(Matrix3d::Identity(), attributes.vector("anchor", Vector3d::Zero()));
    const auto relpose = attributes.numbers("relpose", 7, 7);
    if (!relpose) return {X_12 * anchor, anchor};
    const Eigen::Vector4d q = Eigen::Map<const Eigen::Vector4d>(relpose->data() + 3).stableNormalized();
    if (q.norm() < 0.5) return {X_12 * anchor, anchor};
    return {Pose(quaternion_matrix(q.data()), Vector3d(relpose->data())), anchor};
  }

  void add_closure(const Element& element, bool weld, std::array<int, 2> bodies, const std::array<Pose, 2>& frames) {
    const TreeBody& first = import_.body(bodies[0]);
    const TreeBody& second = import_.body(bodies[1]);
    if (weld && Attributes(element).number("torquescale", 1) == 0) {
      element.diagnostics().notice("F603", element.attribute_at("torquescale"),
                                   "a <weld> with a 'torquescale' of zero holds a point only: it is read as <connect>");
      weld = false;
    }
    const SourceRange at = element.main_at();
    JointSpec spec;
    spec.name = {add_name(element, fmt::format("{}_{}_{}", weld ? "weld" : "connect", first.name, second.name)), at};
    spec.type = weld ? JointType::kWeld : JointType::kSpherical;
    spec.bodies = {NameRef(first.name, at), NameRef(second.name, at)};
    spec.frames = {pose_spec(frames[0], at), pose_spec(frames[1], at)};
    import_.spec().joints.push_back(std::move(spec));
  }

  void read_joints(const Element& element) {
    const TreeJoint* first = find_joint(import_, element, "joint1", true);
    const bool has_second = element.attribute("joint2").has_value();
    const TreeJoint* second = has_second ? find_joint(import_, element, "joint2", true) : nullptr;
    if (first == nullptr || (has_second && second == nullptr)) return;
    const std::string name = fmt::format("joint_{}_{}", first->name, has_second ? second->name : "fixed");
    Terms second_terms;
    if (has_second) second_terms.emplace_back(second, 1);
    add_relation(element, name, {{first, 1}}, second_terms);
  }

  std::optional<Terms> find_tendon(const Element& element, std::string_view attribute) const {
    const std::string name = element.text_of(attribute);
    const auto found = tendons_.find(name);
    if (found == tendons_.end()) {
      element.diagnostics().error("F604", element.attribute_at(attribute),
                                  fmt::format("there is no fixed tendon '{}'", name),
                                  "constraints on spatial tendons are not supported");
      return std::nullopt;
    }
    Terms terms;
    for (const auto& [place, coefficient] : found->second.terms) {
      const TreeJoint& joint = import_.body(place.first).joints[static_cast<std::size_t>(place.second)];
      const auto same = std::find_if(terms.begin(), terms.end(), [&](const auto& t) { return t.first == &joint; });
      if (same != terms.end()) same->second += coefficient;
      if (same == terms.end()) terms.emplace_back(&joint, coefficient);
    }
    return terms;
  }

  void read_tendons(const Element& element) {
    const auto first = find_tendon(element, "tendon1");
    const bool has_second = element.attribute("tendon2").has_value();
    const auto second = has_second ? find_tendon(element, "tendon2") : Terms();
    if (!first || !second) return;
    add_relation(element, fmt::format("tendon_{}_{}", element.text_of("tendon1"), element.text_of("tendon2")), *first,
                 *second);
  }

  /// first = a0 + a1 second + ... + a4 second⁴, both counted from the reference configuration.
  void add_relation(const Element& element, const std::string& name, const Terms& first, const Terms& second) {
    std::array<double, 5> a = {0, 1, 0, 0, 0};
    if (const auto given = Attributes(element).numbers("polycoef", 1, 5)) {
      std::copy(given->begin(), given->end(), a.begin());
    }
    if (second.empty()) a[1] = a[2] = a[3] = a[4] = 0;
    const SourceRange at = element.main_at();
    const double offset = reference_of(first) - a[1] * reference_of(second) + a[0];
    if (offset == 0 && a[2] == 0 && a[3] == 0 && a[4] == 0) {
      return add_coupling(add_name(element, name), at, first, second, a[1]);
    }
    const Expression x = sum_over(second) - Expression::constant(reference_of(second));
    Expression polynomial = Expression::constant(a[4]);
    for (const int power : {3, 2, 1, 0}) {
      polynomial = polynomial * x + Expression::constant(a[static_cast<std::size_t>(power)]);
    }
    ConstraintSpec spec;
    spec.name = {add_name(element, name), at};
    spec.formula = sum_over(first) - Expression::constant(reference_of(first)) - polynomial;
    spec.at = at;
    import_.spec().constraints.push_back(std::move(spec));
  }

  void add_coupling(const std::string& name, SourceRange at, Terms terms, const Terms& second, double slope) {
    for (const auto& term : second) {
      const auto same = std::find_if(terms.begin(), terms.end(), [&](const auto& t) { return t.first == term.first; });
      if (same != terms.end()) same->second -= slope * term.second;
      if (same == terms.end()) terms.emplace_back(term.first, -slope * term.second);
    }
    CouplingSpec spec;
    spec.name = {name, at};
    spec.at = at;
    for (const auto& [joint, coefficient] : terms) {
      spec.coordinates.push_back({{joint->name, at}, ""});
      spec.coefficients.emplace_back(coefficient);
    }
    import_.spec().couplings.push_back(std::move(spec));
  }

  Import& import_;
  const FixedTendons& tendons_;
};

}  // namespace

const TreeJoint* find_joint(const Import& import, const Element& element, std::string_view attribute, bool scalar) {
  const std::string name = element.text_of(attribute);
  const auto found = import.tree.joint_index.find(name);
  const auto fail = [&](const std::string& message, const std::string& hint = "") {
    element.diagnostics().error("F604", element.attribute_at(attribute), message, hint);
    return nullptr;
  };
  if (name.empty()) return fail(fmt::format("<{}> has no '{}'", element.name(), attribute));
  if (found == import.tree.joint_index.end()) {
    return fail(fmt::format("there is no joint '{}'", name), "what stands in <replicate> has a number behind its name");
  }
  const auto [body, index] = found->second;
  const TreeJoint& joint = import.body(body).joints[static_cast<std::size_t>(index)];
  if (scalar && !joint.scalar()) return fail(fmt::format("the joint '{}' is neither a hinge nor a slide", name));
  return &joint;
}

int find_body(const Import& import, const Element& element, std::string_view attribute) {
  const std::string name = element.text_of(attribute);
  const auto found = import.tree.body_index.find(name);
  if (found != import.tree.body_index.end()) return found->second;
  element.diagnostics().error("F604", element.attribute_at(attribute),
                              name.empty() ? fmt::format("<{}> has no '{}'", element.name(), attribute)
                                           : fmt::format("there is no body '{}'", name),
                              "what stands in <replicate> has a number behind its name");
  return -1;
}

void add_equalities(Import& import, const FixedTendons& tendons) {
  EqualityReader reader(import, tendons);
  for (const Element& section : import.root.children("equality")) {
    if (!import.settings.equality) section.mark_read_with_all();
    if (!import.settings.equality) continue;
    for (const Element& one : section.children()) reader.read(one);
  }
}

}  // namespace ferrers::mjcf
