#include <fmt/format.h>

#include <limits>

#include "ferrers/io/spec_reader.h"

namespace ferrers {
namespace {

using Kind = DocumentNode::Kind;

Number reported() { return Number(std::numeric_limits<double>::quiet_NaN()); }
Number3 reported3() { return {reported(), reported(), reported()}; }

}  // namespace

void SpecReader::read_force(const DocumentNode& node, const NameRef& name) {
  ForceSpec force;
  force.name = name;
  force.at = node.at;
  ObjectReader object(values_, node, Family::kForceElement, name);
  if (!object.usable()) return;
  bool complete = false;
  if (object.tag() == "spring")
    complete = read_spring(object, force);
  else if (object.tag() == "torsion_spring")
    complete = read_torsion_spring(object, force);
  else if (object.tag() == "joint_damping")
    complete = read_joint_damping(object, force);
  else if (object.tag() == "bushing")
    complete = read_bushing(object, force);
  else
    complete = read_load(object, force, object.tag());
  if (complete) spec_.forces.push_back(std::move(force));
}

bool SpecReader::read_spring(ObjectReader& object, ForceSpec& force) {
  SpringSpec spring;
  bool on_bodies = false;
  const auto bodies = object.name_pair("bodies");
  const auto points = object.points("points", bodies.value_or(std::array<NameRef, 2>()), on_bodies);
  spring.stiffness = object.number("stiffness").value_or(reported());
  spring.damping = object.number("damping").value_or(Number());
  spring.free_length = object.number("free_length");
  if (!bodies) return false;
  spring.bodies = *bodies;
  spring.points = points.value_or(std::array{reported3(), reported3()});
  force.element = std::move(spring);
  return true;
}

/// `joint` with `coordinate`, or 'joint.coordinate'.
std::optional<CoordinateRef> SpecReader::read_coordinate(ObjectReader& object) {
  std::optional<CoordinateRef> ref = object.coordinate("joint");
  const std::optional<NameRef> coordinate = object.name("coordinate");
  if (!ref || !coordinate) return ref;
  if (!ref->coordinate.empty()) {
    values_.error("F211", object.place("coordinate"), "the coordinate is given twice",
                  fmt::format("'{}.{}' says it already", ref->joint.name, ref->coordinate));
  } else {
    ref->coordinate = coordinate->name;
  }
  return ref;
}

bool SpecReader::read_torsion_spring(ObjectReader& object, ForceSpec& force) {
  TorsionSpringSpec spring;
  const auto coordinate = read_coordinate(object);
  spring.stiffness = object.number("stiffness").value_or(reported());
  spring.damping = object.number("damping").value_or(Number());
  spring.free_angle = object.number("free_angle").value_or(Number());
  if (!coordinate) return false;
  spring.coordinate = *coordinate;
  force.element = std::move(spring);
  return faults_.joints_without_type.count(coordinate->joint.name) == 0;
}

bool SpecReader::read_joint_damping(ObjectReader& object, ForceSpec& force) {
  JointDampingSpec damping;
  const auto coordinate = read_coordinate(object);
  if (coordinate) object.set_coordinates(dimensions_of(*coordinate));
  damping.damping = object.number("damping").value_or(reported());
  if (!coordinate) return false;
  damping.coordinate = *coordinate;
  force.element = std::move(damping);
  return faults_.joints_without_type.count(coordinate->joint.name) == 0;
}

bool SpecReader::read_bushing(ObjectReader& object, ForceSpec& force) {
  BushingSpec bushing;
  const auto bodies = object.name_pair("bodies");
  bushing.place = object.place_spec("at");
  bushing.axis = object.place_spec("axis");
  if (!object.has("axis")) bushing.axis.drawn = number3(0, 0, 1);
  bushing.x = object.direction("x");
  if (const DocumentNode* node = object.object("stiffness")) {
    ObjectReader inner(values_, *node, Family::kBushingStiffness, {"stiffness", node->at});
    if (inner.usable()) {
      bushing.force_stiffness = inner.vector3("force").value_or(Number3());
      bushing.moment_stiffness = inner.vector3("moment").value_or(Number3());
    }
  }
  if (const DocumentNode* node = object.object("damping")) {
    ObjectReader inner(values_, *node, Family::kBushingDamping, {"damping", node->at});
    if (inner.usable()) {
      bushing.force_damping = inner.vector3("force").value_or(Number3());
      bushing.moment_damping = inner.vector3("moment").value_or(Number3());
    }
  }
  if (!bodies) return false;
  bushing.bodies = *bodies;
  force.element = std::move(bushing);
  return true;
}

bool SpecReader::read_load(ObjectReader& object, ForceSpec& force, std::string_view law_key) {
  LoadSpec load;
  load.is_torque = law_key == "torque";
  const auto body = object.name("body");
  if (!load.is_torque) load.place = object.vector3("at");
  std::vector<LawSpec> laws = object.laws(law_key);
  load.in_body_axes = object.choice("axes").value_or("world") == "body";
  if (!body) return false;
  load.body = *body;
  for (std::size_t i = 0; i < laws.size(); ++i) load.components[i] = std::move(laws[i]);
  force.element = std::move(load);
  return true;
}

void SpecReader::read_drive(const DocumentNode& node, const NameRef& name) {
  DriveSpec drive;
  drive.name = name;
  drive.at = node.at;
  ObjectReader object(values_, node, Family::kDrive, name);
  if (object.usable()) {
    if (object.tag() == "joint") {
      drive.coordinate = read_coordinate(object);
      if (drive.coordinate) object.set_coordinates(dimensions_of(*drive.coordinate));
    } else if (object.tag() == "bodies") {
      bool on_bodies = false;
      drive.bodies = object.name_pair("bodies");
      drive.points = object.points("points", drive.bodies.value_or(std::array<NameRef, 2>()), on_bodies);
    } else if (object.tag() == "quantity") {
      drive.quantity = object.expression("quantity");
    } else if (object.tag() == "map") {
      drive.map = object.coordinate_formulas("map");
    } else {
      drive.point = object.name("point");
    }
    if (object.tag() != "map") drive.motion = object.laws("motion");
    drive.effort = object.laws("effort");
    drive.weight = object.number("weight");
  }
  if (drive.coordinate && faults_.joints_without_type.count(drive.coordinate->joint.name) > 0) return;
  spec_.drives.push_back(std::move(drive));
}

void SpecReader::read_initial(const DocumentNode& node, const NameRef& name) {
  if (faults_.joints_without_type.count(name.name) > 0) return;
  if (node.kind != Kind::kSequence) return read_initial_value(node, name);
  for (const DocumentNode& item : node.items) read_initial_value(item, name);
}

void SpecReader::read_initial_value(const DocumentNode& node, const NameRef& name) {
  InitialSpec initial;
  initial.joint = name;
  initial.at = node.at;
  ObjectReader object(values_, node, Family::kInitial, name);
  if (!object.usable()) return;
  if (const auto coordinate = object.name("coordinate")) initial.coordinate = coordinate->name;
  CoordinateRef ref;
  ref.joint = name;
  ref.coordinate = initial.coordinate;
  object.set_coordinates(dimensions_of(ref));
  initial.position = object.numbers("position");
  initial.velocity = object.numbers("velocity");
  initial.guess = object.boolean("guess").value_or(false);
  spec_.initial.push_back(std::move(initial));
}

void SpecReader::read_record(const DocumentNode& node, const NameRef& name) {
  RecordSpec record;
  record.name = name;
  record.at = node.at;
  record.place = reported3();
  ObjectReader object(values_, node, Family::kRecord, name);
  if (object.usable() && object.tag() == "formula") {
    record.formula = object.expression("formula");
    if (!record.formula) return;
  } else if (object.usable()) {
    if (const auto body = object.name("body")) record.body = *body;
    if (const auto place = object.vector3("at")) record.place = *place;
  }
  spec_.records.push_back(std::move(record));
}

void SpecReader::read_event(const DocumentNode& node, const NameRef& name) {
  EventSpec event;
  event.name = name;
  event.at = node.at;
  ObjectReader object(values_, node, Family::kEvent, name);
  if (!object.usable()) return;
  const auto when = object.expression("when");
  const auto action = object.choice("do");
  event.drive = object.name("drive");
  if (!action) return;
  if (when) event.when = *when;
  event.action = *action == "stop"     ? EventSpec::Action::kStop
                 : *action == "record" ? EventSpec::Action::kRecord
                                       : EventSpec::Action::kSwitch;
  spec_.events.push_back(std::move(event));
}

}  // namespace ferrers
