#include "ferrers/formats/sdf_axis_data.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>

namespace ferrers {
namespace {

constexpr double kNoLimit = 1e16;  // what SDF writes where there is none

/// A bound, also in the words that stand for none.
Number bound(const SdfElement& limit, std::string_view name, double fallback) {
  const SdfElement written = limit.child(name);
  if (!written) return fallback;
  const std::string text = written.text();
  const std::string_view word = std::string_view(text).substr(text.starts_with('-') || text.starts_with('+') ? 1 : 0);
  if (word == "inf" || word == "Inf" || word == "INF" || word == "infinity") {
    return text.starts_with('-') ? -kNoLimit : kNoLimit;
  }
  return limit.number(name, fallback);
}

void read_limits(const SdfElement& axis, const SdfAxisOwner& owner, JointSpec& joint) {
  const SdfElement limit = axis.child("limit");
  if (!limit || owner.type == "continuous") return;
  const Number low = bound(limit, "lower", -kNoLimit);
  const Number high = bound(limit, "upper", kNoLimit);
  if (low.value <= -kNoLimit && high.value >= kNoLimit) return;
  if (owner.axes != 1) {
    limit.notice("F601", fmt::format("limits of the {} joint '{}' are not read", owner.type, owner.name));
  } else if (!(low.value < high.value)) {
    limit.warning("F602",
                  fmt::format("the limits of '{}' leave it no way ({:.6g} to {:.6g}): it is read without limits",
                              owner.name, low.value, high.value),
                  "a joint that does not move is of type 'fixed'");
  } else {
    joint.limits = {low, high};
  }
}

void read_dynamics(const SdfElement& axis, const SdfAxisOwner& owner, int which, const ImportOptions& options,
                   NameMap& names, std::vector<ForceSpec>& forces) {
  const SdfElement dynamics = axis.child("dynamics");
  if (!dynamics) return;
  const Number damping = dynamics.number("damping", 0);
  const Number friction = dynamics.number("friction", 0);
  const Number stiffness = dynamics.number("spring_stiffness", 0);
  const Number reference = dynamics.number("spring_reference", 0);
  const CoordinateRef coordinate = sdf_coordinate(owner.name, owner.axes, which, dynamics.at());
  const auto add = [&](std::string_view what, const auto& element) {
    const std::string name = names.add("forces", "force", fmt::format("{}_{}", owner.name, what));
    forces.push_back({NameRef(name, dynamics.at()), element, dynamics.at()});
  };
  if (damping.value != 0 && !options.ignore_damping) add("damping", JointDampingSpec{coordinate, damping});
  if (stiffness.value != 0 && !options.ignore_springs) {
    add("spring", TorsionSpringSpec{coordinate, stiffness, Number(0), reference});
  }
  if (friction.value != 0 && !options.ignore_damping) {
    dynamics.warning("F601", fmt::format("the constant friction of '{}' is not read", owner.name));
  }
}

}  // namespace

CoordinateRef sdf_coordinate(const std::string& joint, int axes, int which, SourceRange at) {
  CoordinateRef coordinate;
  coordinate.joint = NameRef(joint, at);
  if (axes == 2) coordinate.coordinate = which == 0 ? "angle_1" : "angle_2";
  return coordinate;
}

void read_sdf_axis_data(const SdfElement& joint_element, const SdfAxisOwner& owner, const ImportOptions& options,
                        NameMap& names, JointSpec& joint, std::vector<ForceSpec>& forces) {
  for (int which = 0; which < owner.axes; ++which) {
    const SdfElement axis = joint_element.child(which == 0 ? "axis" : "axis2");
    if (!axis) continue;
    read_limits(axis, owner, joint);
    read_dynamics(axis, owner, which, options, names, forces);
  }
}

}  // namespace ferrers
