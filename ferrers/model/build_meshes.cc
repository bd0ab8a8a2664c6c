#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ferrers/model/build_internal.h"

/// Gear meshes. Given the pitch point P and the unit line of action n, the mesh needs the gears' common axis z and
/// their centres c_1, c_2; with them the base radii ρ_i = z·((P − c_i) × n), signed, are constant. What a file leaves
/// out is taken from the joints that carry the gears.
namespace ferrers {
namespace {

constexpr double kAlign = 1e-6;  // sine or cosine, and relative distance, that drawn geometry may be off

bool is_parallel(const Vector3d& a, const Vector3d& b) { return a.cross(b).norm() < kAlign; }

/// The point of a line in the plane through P across the axis.
Vector3d centre_on(const Vector3d& point, const Vector3d& axis, const Vector3d& pitch_point) {
  return point + axis * axis.dot(pitch_point - point);
}

/// Joints that let one body turn about a line of the other.
bool turns_about_axis(JointType type) {
  return type == JointType::kRevolute || type == JointType::kCylindrical || type == JointType::kScrew;
}

}  // namespace

void ModelAssembler::build_meshes() {
  find_welded_bodies();
  for (std::size_t i = 0; i < spec_->joints.size(); ++i) {
    Joint& joint = model_.joints_[i];
    if (joint.type == JointType::kGearMesh && joint.first != joint.second) build_mesh(spec_->joints[i], joint);
  }
}

/// Bodies welded together turn as one: a gear on a shaft is carried by the shaft's bearings.
void ModelAssembler::find_welded_bodies() {
  welded_to_.resize(model_.bodies_.size());
  std::iota(welded_to_.begin(), welded_to_.end(), 0);
  for (std::size_t i = 0; i < groups_.size(); ++i) welded_to_[i] = groups_[i].first;
  const auto root = [this](int i) {
    while (welded_to_[static_cast<std::size_t>(i)] != i) {
      int& up = welded_to_[static_cast<std::size_t>(i)];
      up = welded_to_[static_cast<std::size_t>(up)];
      i = up;
    }
    return i;
  };
  for (const Joint& joint : model_.joints_) {
    if (joint.type != JointType::kWeld) continue;
    const int a = root(joint.first.index()), b = root(joint.second.index());
    welded_to_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  for (std::size_t i = 0; i < welded_to_.size(); ++i) welded_to_[i] = root(static_cast<int>(i));
}

void ModelAssembler::build_mesh(const JointSpec& spec, Joint& joint) {
  const BodyPair pair{spec.name, {joint.first, joint.second}, spec.bodies};
  Mesh mesh;
  const std::optional<OnBoth> points = points_on_both(spec.place, {"at", spec.name}, pair);
  std::optional<Vector3d> line;
  if (spec.line_of_action) {
    line = direction(*spec.line_of_action, {"line_of_action", spec.name});
  } else {
    diagnostics_.error("F317", spec.name.at, fmt::format("'{}' needs 'line_of_action'", spec.name.name),
                       "the direction of the force between the teeth");
  }
  if (spec.axis.given() && !spec.axis.drawn) on_bodies(spec.axis, {"axis", spec.name}, pair, {true, false});
  if (spec.axis.given()) mesh.axis = direction_on(0, spec.axis, {"axis", spec.name}, pair);
  for (std::size_t i = 0; spec.centers && i < 2; ++i) {
    mesh.centers[i] = vector((*spec.centers)[i], kLength, {"centers", spec.name});
    if (!mesh.centers[i]->allFinite()) return;
  }
  if (!points || !line || (spec.axis.given() && !mesh.axis)) return;
  mesh.pitch_point = (*points)[0];
  mesh.line_of_action = *line;
  derive_mesh(joint, mesh);
  joint_is_placed_[static_cast<std::size_t>(&joint - model_.joints_.data())] = true;
  if (mesh.axis && mesh.centers[0] && mesh.centers[1]) {
    if (mesh_is_regular(spec, mesh)) set_mesh(mesh, joint);
    return;
  }
  set_mesh_as_drawn(mesh, joint);
  diagnostics_.notice(
      "F324", spec.name.at,
      fmt::format("the gear mesh '{}' holds at the drawn pose only: its {} cannot be told from the joints",
                  spec.name.name, mesh.axis ? "centres" : "axis and centres"),
      "give 'axis' and 'centers' to let the gears move");
}

/// The lines about which a body (with what is welded to it) turns on other bodies.
std::vector<ModelAssembler::Line> ModelAssembler::lines_of(BodyId id) const {
  const auto group = [this](BodyId b) { return welded_to_[static_cast<std::size_t>(b.index())]; };
  std::vector<Line> lines;
  for (std::size_t i = 0; i < model_.joints_.size(); ++i) {
    const Joint& joint = model_.joints_[i];
    if (!joint_is_placed_[i] || !turns_about_axis(joint.type) || group(joint.first) == group(joint.second)) continue;
    if (group(joint.first) != group(id) && group(joint.second) != group(id)) continue;
    const Pose X_WF = body(joint.first).X_WB * joint.X_1F;
    lines.push_back({X_WF.p, X_WF.R.col(2), group(joint.first) == group(id) ? joint.second : joint.first});
  }
  return lines;
}

/// Lines that may be the axis of a meshed body, each once. Ground (a fixed ring) takes the line about which the carrier
/// of its partner turns on ground.
std::vector<ModelAssembler::Line> ModelAssembler::candidate_lines(BodyId id, BodyId partner, const Mesh& mesh) const {
  const auto is_fixed = [this](BodyId b) { return welded_to_[static_cast<std::size_t>(b.index())] == 0; };
  std::vector<Line> all;
  if (!is_fixed(id)) {
    all = lines_of(id);
  } else {
    for (const Line& planet : lines_of(partner)) {
      if (is_fixed(planet.other)) continue;
      for (const Line& carrier : lines_of(planet.other)) {
        if (is_fixed(carrier.other)) all.push_back(carrier);
      }
    }
  }
  std::vector<Line> distinct;
  for (const Line& line : all) {
    const bool across = std::abs(line.direction.dot(mesh.line_of_action)) < kAlign;
    if (!across || (mesh.axis && !is_parallel(line.direction, *mesh.axis))) continue;
    const auto same = [&](const Line& other) {
      const Vector3d apart = other.point - line.point;
      return is_parallel(other.direction, line.direction) &&
             apart.cross(line.direction).norm() <= kAlign * (line.point - mesh.pitch_point).norm();
    };
    if (std::none_of(distinct.begin(), distinct.end(), same)) distinct.push_back(line);
  }
  return distinct;
}

/// Fills in axis and centres where the joints leave exactly one choice.
void ModelAssembler::derive_mesh(const Joint& joint, Mesh& mesh) const {
  const std::array<BodyId, 2> bodies = {joint.first, joint.second};
  std::array<std::vector<Line>, 2> lines;
  for (std::size_t i = 0; i < 2; ++i) lines[i] = candidate_lines(bodies[i], bodies[1 - i], mesh);
  std::vector<std::array<Line, 2>> choices;
  for (const Line& a : lines[0]) {
    for (const Line& b : lines[1]) {
      if (is_parallel(a.direction, b.direction)) choices.push_back({a, b});
    }
  }
  if (!mesh.axis && choices.size() == 1) mesh.axis = choices[0][0].direction;
  if (!mesh.axis && mesh.centers[0] && mesh.centers[1]) {
    // Both centres lie in the gears' plane, and so does the line of action.
    const Vector3d across = (*mesh.centers[1] - *mesh.centers[0]).cross(mesh.line_of_action);
    if (across.norm() > kAlign * (*mesh.centers[1] - *mesh.centers[0]).norm()) mesh.axis = across.normalized();
  }
  if (!mesh.axis) return;
  for (std::size_t i = 0; i < 2; ++i) {
    if (!mesh.centers[i] && choices.size() == 1) mesh.centers[i] = choices[0][i].point;
    if (!mesh.centers[i] && lines[i].size() == 1 && is_parallel(lines[i][0].direction, *mesh.axis)) {
      mesh.centers[i] = lines[i][0].point;
    }
    if (mesh.centers[i]) mesh.centers[i] = centre_on(*mesh.centers[i], *mesh.axis, mesh.pitch_point);
  }
}

bool ModelAssembler::mesh_is_regular(const JointSpec& spec, const Mesh& mesh) {
  const SourceRange at =
      spec.line_of_action ? place_of((*spec.line_of_action)[0], {"line_of_action", spec.name}) : spec.name.at;
  const Vector3d& n = mesh.line_of_action;
  const Vector3d centres = *mesh.centers[1] - *mesh.centers[0];
  const double distance = centres.norm();
  std::string what, hint;
  if (std::abs(n.dot(*mesh.axis)) > kAlign) {
    what = "is not perpendicular to the gears' axis";
    hint = "the teeth of spur gears touch in the plane across the axis";
  } else if (distance <= kAlign * (mesh.pitch_point - *mesh.centers[0]).norm()) {
    what = "joins gears with one and the same centre";
    hint = "check 'centers', or which joints carry the gears";
  } else if (std::abs(n.dot(centres)) < kAlign * distance) {
    what = "is perpendicular to the line of centres (pressure angle zero)";
    hint = "the line of action of usual teeth leans 20 deg from the common tangent of the pitch circles";
  } else if (n.cross(centres).norm() < kAlign * distance) {
    what = "runs along the line of centres, so it turns no gear";
    hint = "the line of action of usual teeth leans 20 deg from the common tangent of the pitch circles";
  }
  if (what.empty()) return true;
  diagnostics_.error("F323", at, fmt::format("the line of action of '{}' {}", spec.name.name, what), hint);
  return false;
}

void ModelAssembler::set_mesh(const Mesh& mesh, Joint& joint) const {
  const Vector3d& z = *mesh.axis;
  const Vector3d& n = mesh.line_of_action;
  const Matrix3d R = frame_from_zx(z, n);
  set_frames(joint, {R, *mesh.centers[0]}, {R, *mesh.centers[1]});
  const auto base_radius = [&](const Vector3d& centre) { return z.dot((mesh.pitch_point - centre).cross(n)); };
  joint.constants.base_radius_1_m = base_radius(*mesh.centers[0]);
  joint.constants.base_radius_2_m = base_radius(*mesh.centers[1]);
  joint.constants.mesh_side = n.dot(*mesh.centers[1] - *mesh.centers[0]) > 0 ? 1.0 : -1.0;
  joint.constants.pitch_point_F_m = R.transpose() * (mesh.pitch_point - *mesh.centers[0]);
  joint.constants.line_of_action_F = R.transpose() * n;
}

/// Only the tangent of the mesh at the drawn pose: both frames at the pitch point, x along the line of action.
void ModelAssembler::set_mesh_as_drawn(const Mesh& mesh, Joint& joint) const {
  const bool has_axis = mesh.axis && std::abs(mesh.axis->dot(mesh.line_of_action)) < kAlign;
  const Vector3d z = has_axis ? *mesh.axis : Vector3d(frame_from_z(mesh.line_of_action).col(0));
  const Pose X_W(frame_from_zx(z, mesh.line_of_action), mesh.pitch_point);
  set_frames(joint, X_W, X_W);
  joint.constants.mesh_holds_as_drawn_only = true;
  joint.constants.line_of_action_F = Vector3d::UnitX();
}

}  // namespace ferrers
