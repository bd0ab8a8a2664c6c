#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "ferrers/model/build_internal.h"

namespace ferrers {
namespace {

constexpr double kPerpendicular = 1e-6;  // cosine that axes drawn perpendicular may have
constexpr double kParallel = 1e-9;

/// z along the second body's axis, x the first body's x turned perpendicular to it, so that the frames coincide where
/// the axes do.
Matrix3d frame_on_second(const Matrix3d& R_WF, const Vector3d& z) {
  const Vector3d x = R_WF.col(0).cross(z).norm() > kParallel ? Vector3d(R_WF.col(0)) : Vector3d(R_WF.col(1).cross(z));
  return frame_from_zx(z, x);
}

/// x along the second axis, z the first axis made perpendicular to it.
Matrix3d frame_on_second_axis(const Vector3d& first_axis, const Vector3d& second_axis) {
  Matrix3d R;
  R.col(0) = second_axis;
  R.col(2) = (first_axis - second_axis * second_axis.dot(first_axis)).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return R;
}

bool belongs_to_first_only(JointType type) {
  return type == JointType::kPointOnLine || type == JointType::kPointOnPlane;
}

}  // namespace

void ModelAssembler::build_joints() {
  joint_is_placed_.assign(spec_->joints.size(), false);
  for (const JointSpec& spec : spec_->joints) {
    Joint joint;
    joint.name = spec.name.name;
    joint.type = spec.type;
    build_joint(spec, joint);
    model_.joints_.push_back(std::move(joint));
  }
}

void ModelAssembler::build_joint(const JointSpec& spec, Joint& joint) {
  if (const std::optional<BodyPair> pair = find_pair(spec.bodies, spec.name)) {
    joint.first = pair->bodies[0];
    joint.second = pair->bodies[1];
    place_joint(spec, *pair, joint);
  } else {
    joint.first = joint.second = kGround;
  }
  build_joint_extras(spec, joint);
}

void ModelAssembler::place_joint(const JointSpec& spec, const BodyPair& pair, Joint& joint) {
  if (spec.frames) return place_by_frames(spec, joint);
  switch (joint_type_info(spec.type).placement) {
    case PlacementRule::kPoint:
      return place_at_point(spec, pair, joint);
    case PlacementRule::kPointAxis:
      return place_on_axis(spec, pair, "axis", joint);
    case PlacementRule::kPointNormal:
      return place_on_axis(spec, pair, "normal", joint);
    case PlacementRule::kPointTwoAxes:
      return place_on_two_axes(spec, pair, joint);
    case PlacementRule::kTwoPoints:
      return place_between_points(spec, pair, joint);
    case PlacementRule::kNone:
      return place_free(spec, pair, joint);
    case PlacementRule::kMesh:
      return;  // needs the other joints: build_meshes
  }
}

/// Fixes F and M, given in the world as drawn, to their bodies.
void ModelAssembler::set_frames(Joint& joint, const Pose& X_WF, const Pose& X_WM) const {
  joint.X_1F = body(joint.first).X_WB.inverse() * X_WF;
  joint.X_2M = body(joint.second).X_WB.inverse() * X_WM;
}

/// The frames as they are given. What lines and planes belong to is the first; a universal joint's second axis is x of
/// the second.
void ModelAssembler::place_by_frames(const JointSpec& spec, Joint& joint) {
  const PlacementRule rule = joint_type_info(spec.type).placement;
  if (spec.place.given() || spec.axis.given() || spec.axis2.given() || spec.x || rule == PlacementRule::kTwoPoints ||
      rule == PlacementRule::kMesh) {
    diagnostics_.error(
        "F211", place_or((*spec.frames)[0].at, spec.name),
        fmt::format("'{}' has 'frames' beside what they stand for, or cannot have them", spec.name.name));
    return;
  }
  if (spec.type == JointType::kScrew) read_lead(spec, joint);
  joint.drawn = false;
  joint.by_frames = true;
  joint.X_1F = pose((*spec.frames)[0], spec.name);
  joint.X_2M = pose((*spec.frames)[1], spec.name);
  const auto is_finite = [](const Pose& X) { return X.R.allFinite() && X.p.allFinite(); };
  joint_is_placed_[model_.joints_.size()] = is_finite(joint.X_1F) && is_finite(joint.X_2M);
}

void ModelAssembler::read_lead(const JointSpec& spec, Joint& joint) {
  joint.constants.lead_m = number(spec.lead, kLength, {"lead", spec.name});
  if (joint.constants.lead_m != 0) return;
  diagnostics_.error("F322", place_of(spec.lead, {"lead", spec.name}),
                     fmt::format("the screw '{}' needs a 'lead' that is not zero", spec.name.name),
                     "the lead is the advance per turn; negative for a left-handed thread");
}

void ModelAssembler::place_at_point(const JointSpec& spec, const BodyPair& pair, Joint& joint) {
  const std::optional<OnBoth> points = points_on_both(spec.place, {"at", spec.name}, pair);
  if (!points) return;
  joint.drawn = spec.place.drawn.has_value();
  set_frames(joint, {Matrix3d::Identity(), (*points)[0]}, {Matrix3d::Identity(), (*points)[1]});
  joint_is_placed_[model_.joints_.size()] = true;
}

void ModelAssembler::place_on_axis(const JointSpec& spec, const BodyPair& pair, std::string_view key, Joint& joint) {
  const std::optional<OnBoth> points = points_on_both(spec.place, {"at", spec.name}, pair);
  std::optional<OnBoth> axes;
  if (belongs_to_first_only(spec.type)) {
    if (spec.axis.given() && !spec.axis.drawn) on_bodies(spec.axis, {key, spec.name}, pair, {true, false});
    const std::optional<Vector3d> axis = direction_on(0, spec.axis, {key, spec.name}, pair);
    if (axis) axes = OnBoth{*axis, *axis};
  } else {
    axes = directions_on_both(spec.axis, {key, spec.name}, pair);
  }
  if (spec.type == JointType::kScrew) read_lead(spec, joint);
  if (!points || !axes) return;
  const std::optional<Matrix3d> R_WF = frame_on_first((*axes)[0], spec.x, spec.name);
  if (!R_WF) return;
  const bool same_axis = spec.axis.drawn || belongs_to_first_only(spec.type);
  const Matrix3d R_WM = same_axis ? *R_WF : frame_on_second(*R_WF, (*axes)[1]);
  joint.drawn = spec.place.drawn && spec.axis.drawn;
  set_frames(joint, {*R_WF, (*points)[0]}, {R_WM, (*points)[1]});
  joint_is_placed_[model_.joints_.size()] = true;
}

void ModelAssembler::place_on_two_axes(const JointSpec& spec, const BodyPair& pair, Joint& joint) {
  const Field field{"axes", spec.name};
  const std::optional<OnBoth> points = points_on_both(spec.place, {"at", spec.name}, pair);
  if (!spec.axis.drawn && spec.axis.given()) on_bodies(spec.axis, field, pair, {true, false});
  if (!spec.axis2.drawn && spec.axis2.given()) on_bodies(spec.axis2, field, pair, {false, true});
  const std::optional<Vector3d> first = direction_on(0, spec.axis, field, pair);
  const std::optional<Vector3d> second = direction_on(1, spec.axis2, field, pair);
  if (!points || !first || !second) return;
  joint.drawn = spec.place.drawn && spec.axis.drawn && spec.axis2.drawn;
  const double cosine = first->dot(*second);
  const bool axes_drawn = spec.axis.drawn && spec.axis2.drawn;
  if (axes_drawn ? std::abs(cosine) > kPerpendicular : first->cross(*second).norm() < kParallel) {
    diagnostics_.error("F319", place_or(spec.axis.at, spec.name),
                       fmt::format("the axes of the universal joint '{}' are {}", spec.name.name,
                                   axes_drawn ? "not perpendicular" : "parallel as the bodies are drawn"),
                       "the first axis belongs to the first body, the second to the second");
    return;
  }
  const Pose X_WF(frame_from_zx(*first, *second), (*points)[0]);
  set_frames(joint, X_WF, {frame_on_second_axis(*first, *second), (*points)[1]});
  joint_is_placed_[model_.joints_.size()] = true;
}

void ModelAssembler::place_between_points(const JointSpec& spec, const BodyPair& pair, Joint& joint) {
  const Field field{"points", spec.name};
  if (spec.length) {
    joint.constants.length_m = number(*spec.length, kLength, {"length", spec.name});
    if (joint.constants.length_m <= 0) {
      diagnostics_.error("F321", place_of(*spec.length, {"length", spec.name}),
                         fmt::format("the length of '{}' must be positive", spec.name.name));
    }
  }
  if (!spec.points) {
    diagnostics_.error("F317", spec.name.at, fmt::format("'{}' needs 'points'", spec.name.name), "one on each body");
    return;
  }
  OnBoth points;
  for (std::size_t i = 0; i < 2; ++i) {
    points[i] = vector((*spec.points)[i], kLength, field);
    if (spec.points_on_bodies) points[i] = body(pair.bodies[i]).X_WB * points[i];
  }
  const Vector3d rod = points[1] - points[0];
  if (!rod.allFinite()) return;
  const double drawn_length = rod.norm();
  if (drawn_length == 0 && !spec.length) {
    diagnostics_.error("F321", place_of((*spec.points)[1][0], field),
                       fmt::format("the two points of '{}' coincide", spec.name.name),
                       "give them apart, or say the 'length' to be reached");
    return;
  }
  if (!spec.length) joint.constants.length_m = drawn_length;
  const Vector3d z = drawn_length > 0 ? Vector3d(rod / drawn_length) : Vector3d::UnitZ();
  const std::optional<Matrix3d> R = frame_on_first(z, spec.x, spec.name);
  if (!R) return;
  joint.drawn = !spec.points_on_bodies && !spec.length;
  set_frames(joint, {*R, points[0]}, {*R, points[1]});
  joint_is_placed_[model_.joints_.size()] = true;
}

/// A free joint sits where it is said, else at the second body's mass centre, else at the origin of that body's pose.
void ModelAssembler::place_free(const JointSpec& spec, const BodyPair& pair, Joint& joint) {
  if (spec.place.given()) return place_at_point(spec, pair, joint);
  const Body& second = body(pair.bodies[1]);
  const bool at_mass_centre = has_mass_centre_[static_cast<std::size_t>(pair.bodies[1].index())];
  const Vector3d point = at_mass_centre ? second.X_WB * second.com_m : second.X_WB.p;
  set_frames(joint, {Matrix3d::Identity(), point}, {Matrix3d::Identity(), point});
  joint_is_placed_[model_.joints_.size()] = point.allFinite();
}

void ModelAssembler::build_joint_extras(const JointSpec& spec, Joint& joint) {
  if (spec.stiffness) joint.stiffness = stiffness(*spec.stiffness, spec.name);
  if (spec.misalignment) {
    Vector6d displacement = Vector6d::Zero();
    const MisalignmentSpec& given = *spec.misalignment;
    if (given.translation) displacement.head<3>() = vector(*given.translation, kLength, {"translation", spec.name});
    if (given.rotation) displacement.tail<3>() = vector(*given.rotation, kPureNumber, {"rotation", spec.name});
    joint.misalignment = displacement;
  }
  if (spec.limits) build_limits(spec, joint);
  if (spec.friction) joint.friction = friction(*spec.friction, joint, spec.name);
}

/// Force then moment stiffness; a part that is not given is rigid (infinite), and so may single entries be.
Vector6d ModelAssembler::stiffness(const StiffnessSpec& spec, const NameRef& owner) {
  Vector6d values = Vector6d::Constant(std::numeric_limits<double>::infinity());
  const auto fill = [&](const std::optional<Number3>& part, int at, Dimension wanted, std::string_view key) {
    for (std::size_t i = 0; part && i < 3; ++i) {
      const Number& given = (*part)[i];
      const bool rigid = !given.expression && given.value == std::numeric_limits<double>::infinity();
      const double k = rigid ? given.value : number(given, wanted, {key, owner});
      values[at + static_cast<int>(i)] = k;
      if (k > 0 || std::isnan(k)) continue;
      diagnostics_.error("F325", place_of((*part)[i], {key, owner}),
                         fmt::format("the '{}' stiffness of '{}' must be positive", key, owner.name),
                         "leave out the part that is rigid");
    }
  };
  fill(spec.force, 0, kStiffness, "force");
  fill(spec.moment, 3, kTorque, "moment");
  return values;
}

void ModelAssembler::build_limits(const JointSpec& spec, Joint& joint) {
  const JointTypeInfo& info = joint_type_info(spec.type);
  const Field field{"limits", spec.name};
  if (info.coordinates.size() != 1) {
    diagnostics_.error("F326", place_of((*spec.limits)[0], field),
                       fmt::format("'{}' cannot have limits: a {} joint has {} coordinates, not one", spec.name.name,
                                   info.name, info.coordinates.size()));
    return;
  }
  const Dimension wanted = info.coordinates[0].kind == CoordinateKind::kAngle ? kPureNumber : kLength;
  joint.limits = {number((*spec.limits)[0], wanted, field), number((*spec.limits)[1], wanted, field)};
  if ((*joint.limits)[0] >= (*joint.limits)[1]) {
    diagnostics_.error("F326", place_of((*spec.limits)[1], field),
                       fmt::format("the upper limit of '{}' is not above the lower one", spec.name.name),
                       "limits are [low, high]");
  }
}

Friction ModelAssembler::friction(const FrictionSpec& spec, const Joint& joint, const NameRef& owner) {
  const JointTypeInfo& info = joint_type_info(joint.type);
  std::optional<Dimension> viscous;
  if (info.coordinates.size() == 1) {
    viscous = info.coordinates[0].kind == CoordinateKind::kAngle ? kTorsionDamping : kDamping;
  }
  Friction friction;
  if (spec.viscous) friction.viscous = number_at_least_zero(*spec.viscous, viscous, {"viscous", owner});
  const bool slides_unknown = info.placement == PlacementRule::kTwoPoints || info.placement == PlacementRule::kMesh;
  if (friction.viscous > 0 && slides_unknown) {
    diagnostics_.error(
        "F335", place_of(*spec.viscous, {"viscous", owner}),
        fmt::format("'{}' cannot have viscous friction: where the parts of a {} joint slide is not known", owner.name,
                    info.name),
        "a 'spring' between two points with 'damping' alone damps their distance; 'joint_damping' and "
        "'friction' damp the joints that carry the bodies");
  }
  if (spec.coulomb) friction.coulomb = number_at_least_zero(*spec.coulomb, kPureNumber, {"coulomb", owner});
  if (spec.radius) friction.radius_m = number_at_least_zero(*spec.radius, kLength, {"radius", owner});
  return friction;
}

}  // namespace ferrers
