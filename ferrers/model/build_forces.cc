#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ferrers/model/build_internal.h"

namespace ferrers {

const CoordinateInfo& ModelAssembler::coordinate_info(JointCoordinate coordinate) const {
  return joint_type_info(joint(coordinate.joint).type).coordinates[static_cast<std::size_t>(coordinate.index)];
}

Dimension ModelAssembler::effort_dimension(JointCoordinate coordinate) const {
  return kTorque / position_dimension(coordinate);  // work = effort × displacement
}

Dimension ModelAssembler::position_dimension(JointCoordinate coordinate) const {
  if (!joint_type_info(joint(coordinate.joint).type).carries_body) return joint(coordinate.joint).dimension;
  return coordinate_info(coordinate).is_angular() ? kPureNumber : kLength;
}

void ModelAssembler::build_couplings() {
  for (const CouplingSpec& spec : spec_->couplings) {
    Coupling coupling;
    coupling.name = spec.name.name;
    for (const CoordinateRef& ref : spec.coordinates) {
      const std::optional<JointCoordinate> found = find_coordinate(ref, {"joints", spec.name});
      const auto is_same = [&](const StateScalar& scalar) { return scalar.coordinate == *found; };
      if (found && std::any_of(coupling.scalars.begin(), coupling.scalars.end(), is_same)) {
        diagnostics_.error("F328", place_or(ref.joint.at, spec.name),
                           fmt::format("the coupling '{}' names the same coordinate twice", spec.name.name));
      }
      if (found) coupling.scalars.push_back({*found});
    }
    for (const Number& c : spec.coefficients) {
      coupling.coefficients.push_back(number(c, std::nullopt, {"coefficients", spec.name}));
    }
    const auto is_zero = [](double c) { return c == 0; };
    if (spec.coordinates.empty() || spec.coefficients.size() != spec.coordinates.size()) {
      diagnostics_.error("F328", place_or(spec.at, spec.name),
                         fmt::format("the coupling '{}' has {} joints and {} coefficients", spec.name.name,
                                     spec.coordinates.size(), spec.coefficients.size()),
                         "give one coefficient for each joint");
    } else if (std::all_of(coupling.coefficients.begin(), coupling.coefficients.end(), is_zero)) {
      diagnostics_.error("F328", place_or(spec.at, spec.name),
                         fmt::format("the coupling '{}' couples nothing: its coefficients are zero", spec.name.name));
    }
    model_.couplings_.push_back(std::move(coupling));
  }
}

void ModelAssembler::build_forces() {
  for (const ForceSpec& force : spec_->forces) {
    std::visit([&](const auto& element) { build_element(force, element); }, force.element);
  }
}

void ModelAssembler::build_element(const ForceSpec& force, const SpringSpec& spec) {
  Spring spring;
  spring.stiffness = number_at_least_zero(spec.stiffness, kStiffness, {"stiffness", force.name});
  spring.damping = number_at_least_zero(spec.damping, kDamping, {"damping", force.name});
  spring.point_1_m = vector(spec.points[0], kLength, {"points", force.name});
  spring.point_2_m = vector(spec.points[1], kLength, {"points", force.name});
  if (spec.free_length) {
    spring.free_length_m = number_at_least_zero(*spec.free_length, kLength, {"free_length", force.name});
  }
  const std::optional<BodyPair> pair = find_pair(spec.bodies, force.name);
  if (!pair) return;
  spring.first = pair->bodies[0];
  spring.second = pair->bodies[1];
  if (!spec.free_length) {
    spring.free_length_m =
        (body(spring.second).X_WB * spring.point_2_m - body(spring.first).X_WB * spring.point_1_m).norm();
  }
  model_.forces_.push_back({force.name.name, spring});
}

void ModelAssembler::build_element(const ForceSpec& force, const TorsionSpringSpec& spec) {
  const std::optional<JointCoordinate> found = find_coordinate(spec.coordinate, {"joint", force.name});
  std::optional<Dimension> stiffness, damping, free;
  if (found) {
    free = position_dimension(*found);
    stiffness = effort_dimension(*found) / *free;
    damping = *stiffness * kTime;
  }
  TorsionSpring spring;
  spring.stiffness = number_at_least_zero(spec.stiffness, stiffness, {"stiffness", force.name});
  spring.damping = number_at_least_zero(spec.damping, damping, {"damping", force.name});
  spring.free_angle = number(spec.free_angle, free, {"free_angle", force.name});
  if (!found) return;
  spring.coordinate = *found;
  model_.forces_.push_back({force.name.name, spring});
}

/// On one coordinate; or, where the joint has several of one kind and none is named, the same on each of them.
void ModelAssembler::build_element(const ForceSpec& force, const JointDampingSpec& spec) {
  const Field field{"joint", force.name};
  std::vector<JointCoordinate> targets;
  const auto known = joint_index_.find(spec.coordinate.joint.name);
  if (known != joint_index_.end() && spec.coordinate.coordinate.empty()) {
    const JointId id(known->second);
    const auto coordinates = joint_type_info(joint(id).type).coordinates;
    const bool alike = std::all_of(coordinates.begin(), coordinates.end(),
                                   [&](const CoordinateInfo& c) { return c.kind == coordinates.front().kind; });
    for (std::size_t i = 0; alike && i < coordinates.size(); ++i) targets.push_back({id, static_cast<int>(i)});
  }
  if (targets.empty()) {
    if (const auto found = find_coordinate(spec.coordinate, field)) targets.push_back(*found);
  }
  std::optional<Dimension> wanted;
  if (!targets.empty()) wanted = effort_dimension(targets[0]) * kTime / position_dimension(targets[0]);
  const double damping = number_at_least_zero(spec.damping, wanted, {"damping", force.name});
  for (const JointCoordinate target : targets)
    model_.forces_.push_back({force.name.name, JointDamping{target, damping}});
}

void ModelAssembler::build_element(const ForceSpec& force, const BushingSpec& spec) {
  Bushing bushing;
  const auto fill = [&](Vector6d& values, int at, const Number3& given, Dimension wanted, std::string_view key) {
    for (std::size_t i = 0; i < 3; ++i) {
      values[at + static_cast<int>(i)] = number_at_least_zero(given[i], wanted, {key, force.name});
    }
  };
  fill(bushing.stiffness, 0, spec.force_stiffness, kStiffness, "force stiffness");
  fill(bushing.stiffness, 3, spec.moment_stiffness, kTorque, "moment stiffness");
  fill(bushing.damping, 0, spec.force_damping, kDamping, "force damping");
  fill(bushing.damping, 3, spec.moment_damping, kTorsionDamping, "moment damping");
  const std::optional<BodyPair> pair = find_pair(spec.bodies, force.name);
  if (!pair) return;
  const std::optional<OnBoth> points = points_on_both(spec.place, {"at", force.name}, *pair);
  std::optional<Matrix3d> R = Matrix3d::Identity();
  if (spec.axis.given()) {
    const std::optional<OnBoth> axes = directions_on_both(spec.axis, {"axis", force.name}, *pair);
    R = axes ? frame_on_first((*axes)[0], spec.x, force.name) : std::nullopt;
  }
  if (!points || !R) return;
  bushing.first = pair->bodies[0];
  bushing.second = pair->bodies[1];
  bushing.X_1F = body(bushing.first).X_WB.inverse() * Pose(*R, (*points)[0]);
  bushing.X_2M = body(bushing.second).X_WB.inverse() * Pose(*R, (*points)[1]);
  model_.forces_.push_back({force.name.name, bushing});
}

void ModelAssembler::build_element(const ForceSpec& force, const LoadSpec& spec) {
  const std::string_view key = spec.is_torque ? "torque" : "force";
  Load load;
  load.is_torque = spec.is_torque;
  load.in_body_axes = spec.in_body_axes;
  bool usable = true;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::optional<Law> component =
        law(spec.components[i], LawScope::kOfState, spec.is_torque ? kTorque : kForce, {key, force.name});
    usable = usable && component;
    if (component) load.components[i] = *component;
  }
  const std::optional<BodyId> found = find_body(spec.body, {"body", force.name});
  if (!found) return;
  load.body = *found;
  if (spec.place) {
    load.point_m = vector(*spec.place, kLength, {"at", force.name});
  } else if (has_mass_centre_[static_cast<std::size_t>(found->index())]) {
    load.point_m = body(*found).com_m;
  } else if (!spec.is_torque) {
    diagnostics_.error("F317", force.name.at, fmt::format("the force '{}' needs 'at'", force.name.name),
                       "the point of the body where it acts");
  }
  if (usable) model_.forces_.push_back({force.name.name, load});
}

}  // namespace ferrers
