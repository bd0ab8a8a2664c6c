#include "ferrers/formats/sdf_links.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>

#include "ferrers/formats/sdf_visuals.h"
#include "ferrers/model/pose_spec.h"

namespace ferrers {
namespace {

constexpr std::string_view kInertiaHint = "give a <mass> and an <inertia>";

void read_inertia(const SdfElement& inertial, BodySpec& body) {
  const SdfElement tensor = inertial.child("inertia");
  InertiaSpec& inertia = body.inertia;
  inertia.kind = InertiaSpec::Kind::kTensor;
  inertia.at = tensor ? tensor.at() : inertial.at();
  inertia.moments = number3(1, 1, 1);  // what the format says of an absent one
  if (!tensor) {
    inertial.notice("F603", "the link has an <inertial> without <inertia>: its moments are 1 kg m^2, as SDF says");
    return;
  }
  constexpr std::array<std::string_view, 3> moments = {"ixx", "iyy", "izz"}, products = {"ixy", "ixz", "iyz"};
  for (std::size_t i = 0; i < 3; ++i) {
    inertia.moments[i] = tensor.number(moments[i], 1);
    inertia.products[i] = tensor.number(products[i], 0);
  }
}

void read_mass(const SdfElement& link, BodySpec& body) {
  const SdfElement inertial = link.child("inertial");
  body.com = number3(0, 0, 0);
  if (!inertial) {
    link.notice("F603",
                fmt::format("the link '{}' has no <inertial>: 1 kg and moments of 1 kg m^2, as SDF says",
                            link.attribute("name")),
                std::string(kInertiaHint));
    body.mass = Number(1);
    body.inertia.kind = InertiaSpec::Kind::kTensor;
    body.inertia.moments = number3(1, 1, 1);
    return;
  }
  if (inertial.flag_attribute("auto", false)) {
    inertial.xml().mark_read_with_all();
    inertial.warning("F602",
                     fmt::format("the mass of the link '{}' is not computed from its shapes ('auto'); it has none here",
                                 link.attribute("name")),
                     std::string(kInertiaHint));
    body.mass = Number(0);
    return;
  }
  body.mass = inertial.number("mass", 1);
  read_inertia(inertial, body);
  const SdfElement pose = inertial.child("pose");
  if (!pose) return;
  const std::string relative = pose.attribute("relative_to");
  if (!relative.empty()) {
    pose.attribute_error("relative_to", "F602", "the <pose> of an <inertial> is always relative to its link");
  }
  const Pose X_BC = pose.pose();
  body.com = numbers_of(X_BC.p, pose.text_at());
  body.inertia.rotation = pose_spec(X_BC, pose.text_at()).rotation;
}

/// Without gravity: a force at the mass centre that balances it.
void hold_up(const SdfElement& link, const BodySpec& body, NameMap& names, ModelSpec& spec) {
  const double mass = body.mass->value;
  LoadSpec lift;
  lift.body = body.name;
  lift.place = body.com;
  for (std::size_t i = 0; i < 3; ++i) {
    const double weight = mass * spec.gravity[i].value;
    lift.components[i].expression = Expression::constant(std::isfinite(weight) ? -weight : 0);
  }
  link.notice("F603", fmt::format("the link '{}' feels no gravity: a force holds its weight", link.attribute("name")));
  const SourceRange at = link.at();
  spec.forces.push_back({NameRef(names.add("forces", "force", body.name.name + "_weight"), at), lift, at});
}

}  // namespace

Number3 numbers_of(const Eigen::Vector3d& v, SourceRange at) {
  Number3 three = number3(v.x(), v.y(), v.z());
  for (Number& one : three) one.at = at;
  return three;
}

SdfBodies read_sdf_links(SdfTree& tree, NameMap& names, ImportedModel& model) {
  SdfBodies bodies;
  bodies.name_of_frame.resize(static_cast<std::size_t>(tree.frames.size()));
  bodies.name_of_frame[SdfFrames::kWorldFrame] = kGround;
  for (const SdfLink& link : tree.links) names.keep("bodies", tree.shown(link.path));
  for (const SdfJoint& joint : tree.joints) names.keep("joints", tree.shown(joint.path));
  for (const SdfLink& link : tree.links) {
    std::string& name = bodies.name_of_frame[static_cast<std::size_t>(link.frame)];
    const Pose X_WB = tree.frames.pose_in_world(link.frame);
    if (tree.models[static_cast<std::size_t>(link.model)].is_static) {
      name = kGround;
      if (const SdfElement inertial = link.element.child("inertial")) inertial.xml().mark_read_with_all();
      read_sdf_visuals(tree, link, name, X_WB, model.visuals);
      continue;
    }
    name = names.add("bodies", "body", tree.shown(link.path));
    BodySpec body;
    body.name = NameRef(name, link.element.attribute_at("name"));
    body.pose = pose_spec(X_WB, link.element.at());
    read_mass(link.element, body);
    if (!link.element.flag("gravity", true)) hold_up(link.element, body, names, model.spec);
    if (link.element.flag("kinematic", false)) {
      link.element.warning("F602", fmt::format("the link '{}' is kinematic in the file; here forces move it", name));
    }
    model.spec.bodies.push_back(std::move(body));
    read_sdf_visuals(tree, link, name, Pose(), model.visuals);
  }
  return bodies;
}

}  // namespace ferrers
