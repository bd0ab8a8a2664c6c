#include <fmt/format.h>

#include <array>
#include <map>
#include <utility>

#include "ferrers/formats/urdf_import.h"
#include "ferrers/formats/urdf_values.h"
#include "ferrers/model/pose_spec.h"

namespace ferrers {
namespace {

/// The frames of a universal joint: its first axis is z of the one, its second is x of the other. `axes` holds two of
/// the letters X, Y, Z, both axes of the joint's frame.
Pose universal_frame(std::string_view axes) {
  const auto unit = [](char letter) { return Eigen::Vector3d(Eigen::Vector3d::Unit(letter - 'X')); };
  return {frame_from_zx(unit(axes[0]), unit(axes[1])), Eigen::Vector3d::Zero()};
}

/// The joint's type, and its frame in the child link's.
std::pair<JointType, Pose> type_and_frame(const UrdfJoint& joint) {
  constexpr std::string_view kUniversal = "universal ";
  if (joint.type == "revolute" || joint.type == "continuous") return {JointType::kRevolute, along_axis({}, joint.axis)};
  if (joint.type == "prismatic") return {JointType::kPrismatic, along_axis({}, joint.axis)};
  if (joint.type == "planar") return {JointType::kPlanar, along_axis({}, joint.axis)};
  if (joint.type == "floating") return {JointType::kFree, {}};
  if (joint.type == "spherical") return {JointType::kSpherical, {}};
  if (joint.type.rfind(kUniversal, 0) == 0) {
    return {JointType::kUniversal, universal_frame(std::string_view(joint.type).substr(kUniversal.size()))};
  }
  return {JointType::kWeld, {}};
}

void read_limits(UrdfImport& import, const UrdfJoint& joint, JointSpec& spec) {
  const XmlElement limit = joint.element.child("limit");
  if (!limit || (joint.type != "revolute" && joint.type != "prismatic")) return;
  const std::optional<Number> lower = attribute_number(limit, "lower", import.diagnostics());
  const std::optional<Number> upper = attribute_number(limit, "upper", import.diagnostics());
  if (lower && upper && lower->value == upper->value) {
    import.empty_limits.add(lower->at);
  } else if (lower && upper) {
    spec.limits = {*lower, *upper};
  } else if (lower || upper) {
    import.diagnostics().notice("F603", limit.at(),
                                fmt::format("the joint '{}' has one limit only, which is not used", joint.name),
                                "give both 'lower' and 'upper'");
  }
}

void read_dynamics(UrdfImport& import, const UrdfJoint& joint) {
  const XmlElement dynamics = joint.element.child("dynamics");
  if (!dynamics || !joint.has_one_coordinate()) return;
  const std::optional<Number> damping = attribute_number(dynamics, "damping", import.diagnostics());
  const std::optional<Number> friction = attribute_number(dynamics, "friction", import.diagnostics());
  if (import.context.options.ignore_damping) return;
  if (friction && friction->value != 0) import.dry_friction.add(friction->at);
  if (!damping || damping->value == 0) return;
  ForceSpec force;
  force.name = {import.names.add("forces", "force", joint.joint + "_damping"), damping->at};
  force.at = damping->at;
  force.element = JointDampingSpec{{NameRef(joint.joint, damping->at), ""}, *damping};
  import.spec().forces.push_back(std::move(force));
}

/// A replaced joint has other coordinates, so what the file says of the old ones means nothing.
void drop_of_replaced(UrdfImport& import, const UrdfJoint& joint) {
  for (const std::string_view name : {"limit", "dynamics"}) {
    const XmlElement element = joint.element.child(name);
    if (!element) continue;
    element.mark_read_with_all();
    import.diagnostics().notice(
        "F603", element.at(),
        fmt::format("<{}> of '{}' is not used: the file of closures gives the joint another type", name, joint.name));
  }
}

void add_joint(UrdfImport& import, UrdfJoint& joint) {
  const SourceRange at = joint.element.attribute_at("name");
  JointSpec spec;
  spec.name = {import.names.add("joints", "joint", joint.name), at};
  joint.joint = spec.name.name;
  const auto [type, X_JF] = type_and_frame(joint);
  spec.type = type;
  spec.bodies = {NameRef(import.link(joint.parent).body, at), NameRef(import.link(joint.child).body, at)};
  spec.frames = {pose_spec(joint.X_PJ * X_JF, at), pose_spec(X_JF, at)};
  if (joint.replaced) {
    drop_of_replaced(import, joint);
  } else {
    read_limits(import, joint, spec);
    read_dynamics(import, joint);
  }
  if (type == JointType::kWeld) mark_fixed(spec);
  import.spec().joints.push_back(std::move(spec));
}

/// q = multiplier * other + offset: a linear coupling, or a formula where there is an offset.
void read_mimic(UrdfImport& import, const UrdfJoint& joint) {
  Diagnostics& diagnostics = import.diagnostics();
  const XmlElement mimic = joint.element.child("mimic");
  if (!mimic) return;
  const std::optional<int> found = named_joint(import.tree, mimic, "joint", diagnostics);
  const Number multiplier = attribute_number(mimic, "multiplier", diagnostics).value_or(Number(1));
  const Number offset = attribute_number(mimic, "offset", diagnostics).value_or(Number(0));
  if (!found) return;
  if (joint.type == "fixed") {
    diagnostics.notice("F603", mimic.at(), fmt::format("<mimic> of the fixed joint '{}' is not used", joint.name));
    return;
  }
  const UrdfJoint& other = import.joint(*found);
  const SourceRange at = mimic.attribute_at("joint");
  for (const UrdfJoint* one : std::array<const UrdfJoint*, 2>{&joint, &other}) {
    if (one->has_one_coordinate()) continue;
    diagnostics.error("F604", at,
                      fmt::format("the joint '{}' mimics '{}', but the {} joint '{}' has no single coordinate",
                                  joint.name, other.name, one->type, one->name));
    return;
  }
  if (&joint == &other) {
    diagnostics.error("F604", at, fmt::format("the joint '{}' mimics itself", joint.name));
    return;
  }
  const NameRef name(import.names.add("joints", "coupling", joint.joint + "_mimic"), mimic.at());
  if (offset.value == 0) {
    CouplingSpec coupling;
    coupling.name = name;
    coupling.at = mimic.at();
    coupling.coordinates = {{NameRef(joint.joint, at), ""}, {NameRef(other.joint, at), ""}};
    coupling.coefficients = {Number(1), Number(-multiplier.value)};
    import.spec().couplings.push_back(std::move(coupling));
    return;
  }
  ConstraintSpec constraint;
  constraint.name = name;
  constraint.at = mimic.at();
  const auto position = [](const UrdfJoint& of) { return Expression::variable(of.joint + ".position"); };
  constraint.formula =
      position(joint) - (Expression::constant(multiplier.value) * position(other) + Expression::constant(offset.value));
  import.spec().constraints.push_back(std::move(constraint));
}

}  // namespace

void import_urdf_joints(UrdfImport& import) {
  for (UrdfJoint& joint : import.tree.joints) add_joint(import, joint);
  for (const UrdfJoint& joint : import.tree.joints) read_mimic(import, joint);
  if (import.empty_limits.count > 0) {
    import.diagnostics().notice("F603", import.empty_limits.first,
                                fmt::format("limits that leave no way to go ('lower' is 'upper') are not used, here{}",
                                            import.empty_limits.count > 1
                                                ? fmt::format(" and at {} other joints", import.empty_limits.count - 1)
                                                : ""));
  }
  if (import.dry_friction.count > 0) {
    import.diagnostics().notice(
        "F601", import.dry_friction.first,
        fmt::format("'friction' of <dynamics> is not read{}",
                    import.dry_friction.count > 1
                        ? fmt::format(", nor are {} more like it", import.dry_friction.count - 1)
                        : ""),
        "a torque or force of friction that does not depend on the load is none of the elements here");
  }
}

}  // namespace ferrers
