#include <fmt/format.h>

#include "ferrers/formats/urdf_import.h"
#include "ferrers/formats/urdf_values.h"
#include "ferrers/model/mass_properties.h"
#include "ferrers/model/pose_spec.h"

namespace ferrers {
namespace {

constexpr std::string_view kGround = "ground";

/// Files hold moments that no body has. They are taken as they are where the motion is determined with them, which
/// `build_model` warns of; a tensor of rounding errors, of a radius of gyration below 1e-6 m, is that of a point.
void treat_unphysical(BodySpec& body, Diagnostics& diagnostics) {
  const auto vector = [](const Number3& n) { return Eigen::Vector3d(n[0].value, n[1].value, n[2].value); };
  const Eigen::Matrix3d tensor = inertia_tensor(vector(body.inertia.moments), vector(body.inertia.products));
  const InertiaVerdict verdict = check_inertia(tensor);
  if (verdict == InertiaVerdict::kPhysical) return;
  body.inertia.unphysical = true;
  if (!(tensor.cwiseAbs().maxCoeff() <= 1e-12 * body.mass->value)) return;
  diagnostics.notice("F603", body.inertia.at,
                     fmt::format("the inertia of '{}' is rounding only: it is a point mass", body.name.name));
  body.inertia = InertiaSpec();
}

/// Mass, mass centre and tensor of `<inertial>`, about axes through the mass centre that its origin turns.
void read_inertial(const XmlElement& inertial, BodySpec& body, Diagnostics& diagnostics) {
  const XmlElement mass = required_child(inertial, "mass", diagnostics);
  if (mass) body.mass = required_number(mass, "value", diagnostics).value_or(Number(0));
  const Pose X_LC = read_origin(inertial, diagnostics);
  const XmlElement origin = inertial.child("origin");
  body.com = number3(X_LC.p, origin ? origin.at() : inertial.at());
  const XmlElement tensor = required_child(inertial, "inertia", diagnostics);
  if (!tensor) return;
  const auto entry = [&](std::string_view name) {
    return required_number(tensor, name, diagnostics).value_or(Number(0));
  };
  body.inertia.kind = InertiaSpec::Kind::kTensor;
  body.inertia.at = tensor.at();
  body.inertia.moments = {entry("ixx"), entry("iyy"), entry("izz")};
  body.inertia.products = {entry("ixy"), entry("ixz"), entry("iyz")};
  body.inertia.rotation = pose_spec(X_LC, origin ? origin.at() : tensor.at()).rotation;
  treat_unphysical(body, diagnostics);
}

/// A root link called 'world' that weighs nothing stands for the ground.
bool is_ground(const UrdfImport& import, const UrdfLink& link) {
  return link.parent_joint < 0 && link.name == "world" && import.context.options.base != ImportBase::kFree &&
         !link.element.child("inertial");
}

void place_root(UrdfImport& import, const UrdfLink& root) {
  const bool is_free = import.context.options.base == ImportBase::kFree;
  JointSpec base;
  base.name = {import.names.add("joints", "joint", is_free ? "floating_base" : "fixed_base"),
               root.element.attribute_at("name")};
  base.type = is_free ? JointType::kFree : JointType::kWeld;
  base.bodies = {NameRef(std::string(kGround)), NameRef(root.body, base.name.at)};
  base.frames = {PoseSpec(), PoseSpec()};
  import.spec().joints.push_back(std::move(base));
  import.diagnostics().notice("F603", root.element.attribute_at("name"),
                              is_free ? fmt::format("the root link '{}' floats", root.name)
                                      : fmt::format("the root link '{}' is fixed to ground", root.name));
}

}  // namespace

void import_urdf_links(UrdfImport& import) {
  for (const UrdfLink& link : import.tree.links) import.names.keep("bodies", link.name);
  for (const UrdfJoint& joint : import.tree.joints) import.names.keep("joints", joint.name);
  for (UrdfLink& link : import.tree.links) {
    const SourceRange at = link.element.attribute_at("name");
    if (is_ground(import, link)) {
      link.body = kGround;
      import.diagnostics().notice("F603", at, "the root link 'world' is the ground");
      continue;
    }
    BodySpec body;
    body.name = {import.names.add("bodies", "body", link.name), at};
    link.body = body.name.name;
    body.pose = pose_spec(link.X_WL, at);
    body.mass = Number(0);
    body.com = number3(0, 0, 0);
    if (const XmlElement inertial = link.element.child("inertial")) {
      read_inertial(inertial, body, import.diagnostics());
    }
    import.spec().bodies.push_back(std::move(body));
  }
}

void import_urdf_base(UrdfImport& import) {
  const UrdfLink& root = import.link(import.tree.root);
  if (root.body != kGround) place_root(import, root);
}

}  // namespace ferrers
