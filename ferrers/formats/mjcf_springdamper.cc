#include <fmt/format.h>

#include <algorithm>

#include "ferrers/formats/mjcf_import.h"

namespace ferrers::mjcf {
namespace {

/// Mass, mass centre and inertia about it, world axes, of a body with everything that hangs on it, as drawn.
MassProperties joined(const MassProperties& a, const MassProperties& b) {
  MassProperties sum;
  sum.mass = a.mass + b.mass;
  if (sum.mass <= 0) return {};
  sum.com = (a.mass * a.com + b.mass * b.com) / sum.mass;
  for (const MassProperties* part : {&a, &b}) {
    const Vector3d way = part->com - sum.com;
    sum.inertia += part->inertia + part->mass * (way.squaredNorm() * Matrix3d::Identity() - way * way.transpose());
  }
  return sum;
}

MassProperties in_world(const TreeBody& body) {
  MassProperties mass = body.mass.value_or(MassProperties());
  mass.com = body.X_WB * mass.com;
  mass.inertia = body.X_WB.R * mass.inertia * body.X_WB.R.transpose();
  return mass;
}

/// Mean of the diagonal of the mass matrix over the joint's coordinates.
double inertia_along(const TreeBody& body, const TreeJoint& joint, const MassProperties& beyond) {
  if (joint.kind == JointKind::kSlide) return beyond.mass + joint.armature;
  const Vector3d way = beyond.com - body.X_WB * joint.pos;
  const Matrix3d about =
      beyond.inertia + beyond.mass * (way.squaredNorm() * Matrix3d::Identity() - way * way.transpose());
  const Vector3d axis = body.X_WB.R * joint.axis;
  if (joint.kind == JointKind::kHinge) return axis.dot(about * axis) + joint.armature;
  if (joint.kind == JointKind::kBall) return about.trace() / 3 + joint.armature;
  return (about.trace() + 3 * beyond.mass) / 6 + joint.armature;
}

}  // namespace

void resolve_springdampers(Import& import) {
  std::vector<TreeBody>& bodies = import.tree.bodies;
  const auto asks = [](const TreeBody& body) {
    return std::any_of(body.joints.begin(), body.joints.end(), [](const TreeJoint& j) { return j.springdamper; });
  };
  if (std::none_of(bodies.begin(), bodies.end(), asks)) return;
  if (import.options.ignore_springs && import.options.ignore_damping) return;
  std::vector<MassProperties> beyond;
  std::vector<bool> known;
  for (const TreeBody& body : bodies) beyond.push_back(in_world(body)), known.push_back(body.mass.has_value());
  for (std::size_t i = bodies.size() - 1; i >= 1; --i) {
    const auto parent = static_cast<std::size_t>(bodies[i].parent);
    beyond[parent] = joined(beyond[parent], beyond[i]);
    known[parent] = known[parent] && known[i];
    for (TreeJoint& joint : bodies[i].joints) {
      if (!joint.springdamper) continue;
      if (!known[i]) {
        joint.element.diagnostics().error(
            "F602", joint.element.at(),
            fmt::format("the 'springdamper' of '{}' depends on a mass that is not known", joint.name),
            "--ignore springs,damping leaves such springs out");
        continue;
      }
      const auto [time, ratio] = *joint.springdamper;
      const double inertia = inertia_along(bodies[i], joint, beyond[i]);
      joint.stiffness = {inertia / (time * time * ratio * ratio), 0, 0};
      joint.damping = {2 * inertia / time, 0, 0};
    }
  }
}

}  // namespace ferrers::mjcf
