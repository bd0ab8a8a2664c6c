#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ferrers/model/build_internal.h"

namespace ferrers {

void ModelAssembler::build_records() {
  for (const RecordSpec& spec : spec_->records) {
    if (spec.formula) continue;
    RecordedPoint point;
    point.name = spec.name.name;
    point.point_m = vector(spec.place, kLength, {"at", spec.name});
    point.body = find_body(spec.body, {"body", spec.name}).value_or(kGround);
    model_.records_.push_back(std::move(point));
  }
}

void ModelAssembler::build_recorded_formulas() {
  for (const RecordSpec& spec : spec_->records) {
    if (!spec.formula) continue;
    std::optional<Law> law = formula(*spec.formula, LawScope::kOfState, std::nullopt, {"record", spec.name});
    if (law) model_.recorded_formulas_.push_back({spec.name.name, std::move(*law)});
  }
}

void ModelAssembler::build_drives() {
  for (const DriveSpec& spec : spec_->drives) build_drive(spec);
}

void ModelAssembler::build_drive(const DriveSpec& spec) {
  Drive drive;
  drive.name = spec.name.name;
  if (place_drive(spec, drive)) {
    const bool on_joint = drive.kind == Drive::Kind::kCoordinate;
    std::optional<Dimension> motion = kLength, effort = kForce;
    if (on_joint) {
      motion = position_dimension(drive.coordinate);
      effort = effort_dimension(drive.coordinate);
    } else if (drive.kind == Drive::Kind::kFormula) {
      motion = effort = std::nullopt;  // what a formula measures is not asked
    }
    drive.motion = drive_laws(spec.motion, LawScope::kOfTime, motion, drive, {"motion", spec.name});
    drive.effort = drive_laws(spec.effort, LawScope::kOfState, effort, drive, {"effort", spec.name});
  }
  if (spec.weight) {
    drive.weight = number(*spec.weight, kPureNumber, {"weight", spec.name});
    if (!(drive.weight > 0) && !std::isnan(drive.weight)) {
      diagnostics_.error("F334", place_of(*spec.weight, {"weight", spec.name}),
                         fmt::format("the weight of the drive '{}' must be above zero", spec.name.name),
                         "the reciprocal of the largest effort that the drive can give is a good weight");
    }
  }
  model_.drives_.push_back(std::move(drive));
}

bool ModelAssembler::place_drive(const DriveSpec& spec, Drive& drive) {
  const int targets = (spec.coordinate ? 1 : 0) + (spec.bodies || spec.points ? 1 : 0) + (spec.point ? 1 : 0) +
                      (spec.quantity ? 1 : 0) + (spec.map.empty() ? 0 : 1);
  if (targets != 1) {
    diagnostics_.error("F329", place_or(spec.at, spec.name),
                       fmt::format("the drive '{}' must have exactly one target, not {}", spec.name.name, targets),
                       "a joint or coordinate, the distance of two points, a recorded point, a quantity or a map");
    return false;
  }
  if (spec.coordinate) {
    const std::optional<JointCoordinate> found = find_coordinate(*spec.coordinate, {"joint", spec.name});
    if (found) drive.coordinate = *found;
    return found.has_value();
  }
  if (spec.quantity || !spec.map.empty()) return place_drive_by_formula(spec, drive);
  if (!spec.point) return place_drive_between_points(spec, drive);
  const std::optional<int> record = find(record_index_, *spec.point, "recorded point", {"point", spec.name}, "F306");
  if (!record) return false;
  const RecordedPoint& point = model_.records_[static_cast<std::size_t>(*record)];
  drive.kind = Drive::Kind::kPoint;
  drive.first = kGround;
  drive.second = point.body;
  drive.point_2_m = point.point_m;
  return true;
}

bool ModelAssembler::place_drive_between_points(const DriveSpec& spec, Drive& drive) {
  if (!spec.bodies || !spec.points) {
    diagnostics_.error("F329", place_or(spec.at, spec.name),
                       fmt::format("the drive '{}' on a distance needs both 'bodies' and 'points'", spec.name.name));
    return false;
  }
  const std::optional<BodyPair> pair = find_pair(*spec.bodies, spec.name);
  if (!pair) return false;
  drive.kind = Drive::Kind::kDistance;
  drive.first = pair->bodies[0];
  drive.second = pair->bodies[1];
  drive.point_1_m = vector((*spec.points)[0], kLength, {"points", spec.name});
  drive.point_2_m = vector((*spec.points)[1], kLength, {"points", spec.name});
  const Vector3d apart = body(drive.second).X_WB * drive.point_2_m - body(drive.first).X_WB * drive.point_1_m;
  if (apart.norm() != 0) return true;
  diagnostics_.error("F321", place_of((*spec.points)[1][0], {"points", spec.name}),
                     fmt::format("the two points of the drive '{}' coincide", spec.name.name),
                     "a distance of zero has no direction to push in");
  return false;
}

std::vector<Law> ModelAssembler::drive_laws(const std::vector<LawSpec>& specs, LawScope scope,
                                            std::optional<Dimension> wanted, const Drive& drive, Field field) {
  std::vector<Law> laws;
  if (specs.empty()) return laws;
  if (specs.size() != static_cast<std::size_t>(drive.components())) {
    diagnostics_.error("F329", place_or(specs.front().at, field.owner),
                       fmt::format("'{}' of the drive '{}' has {} laws, wanted {}", field.key, drive.name, specs.size(),
                                   drive.components()),
                       drive.components() == 3 ? "one for each of x, y, z" : "");
    return laws;
  }
  for (const LawSpec& spec : specs) laws.push_back(law(spec, scope, wanted, field).value_or(Law()));
  return laws;
}

void ModelAssembler::build_initial() {
  std::vector<std::pair<JointCoordinate, bool>> given;
  for (const InitialSpec& spec : spec_->initial) build_initial_value(spec);
  for (const InitialValue& value : model_.initial_) {
    const auto clashes = [&](const auto& other) {
      const bool overlaps = other.second || value.whole_joint || other.first.index == value.coordinate.index;
      return other.first.joint == value.coordinate.joint && overlaps;
    };
    if (std::any_of(given.begin(), given.end(), clashes)) {
      const std::string& name = joint(value.coordinate.joint).name;
      diagnostics_.error("F331", value.at, fmt::format("the initial values of '{}' are given twice", name));
    }
    given.emplace_back(value.coordinate, value.whole_joint);
  }
  for (const InitialValue& guess : coordinate_guesses_) {  // where `initial` says nothing else
    const bool known = std::any_of(model_.initial_.begin(), model_.initial_.end(), [&](const InitialValue& value) {
      return value.coordinate.joint == guess.coordinate.joint && !value.position.empty();
    });
    if (!known) model_.initial_.push_back(guess);
  }
}

void ModelAssembler::build_initial_value(const InitialSpec& spec) {
  const Field field{"initial", spec.joint};
  const std::optional<JointId> id = find_joint(spec.joint, field);
  if (!id) return;
  const JointTypeInfo& info = joint_type_info(joint(*id).type);
  const SourceRange at = place_or(spec.at, spec.joint);
  InitialValue value;
  value.coordinate.joint = *id;
  value.guess = spec.guess;
  value.at = at;
  if (info.coordinates.empty() || (spec.position.empty() && spec.velocity.empty())) {
    diagnostics_.error("F331", at,
                       info.coordinates.empty() ? fmt::format("the {} joint '{}' has no coordinates to start from",
                                                              info.name, spec.joint.name)
                                                : fmt::format("the initial values of '{}' are empty", spec.joint.name),
                       "give a 'position', a 'velocity' or both");
    return;
  }
  std::size_t positions = static_cast<std::size_t>(info.nq), velocities = static_cast<std::size_t>(info.nv);
  if (!spec.coordinate.empty()) {
    const auto found = find_coordinate({spec.joint, spec.coordinate}, field);
    if (!found) return;
    value.coordinate = *found;
    positions = velocities = 1;
  } else {
    value.whole_joint = info.coordinates.size() > 1;
  }
  value.position = initial_numbers(spec.position, positions, {"position", spec.joint});
  value.velocity = initial_numbers(spec.velocity, velocities, {"velocity", spec.joint});
  if (value.whole_joint && info.quaternion_at >= 0 && value.position.size() == positions) {
    Eigen::Map<Eigen::Vector4d> quaternion(value.position.data() + info.quaternion_at);
    constexpr double kRounding = 1e-3;
    if (std::abs(quaternion.norm() - 1.0) > kRounding) {
      diagnostics_.error(
          "F327", at,
          fmt::format("the initial quaternion of '{}' has the length {}, not 1", spec.joint.name, quaternion.norm()),
          fmt::format("the position is [{}]", fmt::join(info.position_names, ", ")));
    }
    quaternion.normalize();
  }
  model_.initial_.push_back(std::move(value));
}

std::vector<double> ModelAssembler::initial_numbers(const std::vector<Number>& numbers, std::size_t wanted,
                                                    Field field) {
  std::vector<double> values;
  for (const Number& n : numbers) values.push_back(number(n, std::nullopt, field));
  if (numbers.empty() || numbers.size() == wanted) return values;
  diagnostics_.error("F331", place_of(numbers.front(), field),
                     fmt::format("the initial {} of '{}' has {} numbers, wanted {}", field.key, field.owner.name,
                                 numbers.size(), wanted),
                     wanted > 1 ? "or name one 'coordinate'" : "");
  return values;
}

void ModelAssembler::build_events() {
  for (const EventSpec& spec : spec_->events) {
    Event event;
    event.name = spec.name.name;
    event.action = spec.action;
    event.when = formula(spec.when, LawScope::kOfState, std::nullopt, {"when", spec.name}).value_or(Law());
    const bool switches = spec.action == EventSpec::Action::kSwitch;
    if (switches != spec.drive.has_value()) {
      diagnostics_.error("F332", place_or(spec.at, spec.name),
                         switches ? fmt::format("the event '{}' must say which drive it switches", spec.name.name)
                                  : fmt::format("the event '{}' names a drive but does not switch", spec.name.name),
                         "'do: switch' and 'drive' go together");
    } else if (spec.drive) {
      const std::optional<int> drive = find(drive_index_, *spec.drive, "drive", {"drive", spec.name}, "F306");
      if (drive) event.drive = DriveId(*drive);
    }
    model_.events_.push_back(std::move(event));
  }
}

}  // namespace ferrers
