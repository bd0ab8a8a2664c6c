#include "ferrers/io/spec_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <tuple>

namespace ferrers {
namespace {

using Kind = DocumentNode::Kind;

/// The last byte that belongs to a node, as far as its values tell.
void extend(const DocumentNode& node, FaultyEntry& entry) {
  const int column = node.at.column + std::max(node.at.length, 1);
  if (std::tie(node.at.line, column) > std::tie(entry.end_line, entry.end_column)) {
    entry.end_line = node.at.line;
    entry.end_column = column;
  }
  for (const DocumentNode& item : node.items) extend(item, entry);
  for (const DocumentEntry& inner : node.entries) extend(inner.value, entry);
}

}  // namespace

bool FaultyEntry::contains(SourceRange at) const {
  return at.known() && std::tie(at.line, at.column) >= std::tie(name_at.line, name_at.column) &&
         std::tie(at.line, at.column) < std::tie(end_line, end_column);
}

void SpecReader::mark_faulty(const DocumentEntry& entry) {
  FaultyEntry faulty;
  faulty.name_at = entry.key_at;
  faulty.end_line = entry.key_at.line;
  faulty.end_column = entry.key_at.column + std::max(entry.key_at.length, 1);
  extend(entry.value, faulty);
  faults_.entries.push_back(faulty);
}

void SpecReader::read_section(ObjectReader& model, std::string_view key, EntryReader read_entry) {
  const DocumentNode* section = model.object(key);
  if (section == nullptr || section->kind == Kind::kNull) return;  // `joints:` with nothing below is an empty map
  if (section->kind != Kind::kMap) {
    faults_.section_without_entries = true;
    if (section->kind == Kind::kBroken) return;
    values_.error("F203", section->at, fmt::format("'{}' wants a map from names to things", key),
                  fmt::format("{}: {{name: {{...}}}}; the names are yours", key));
    return;
  }
  for (const DocumentEntry& entry : section->entries) {
    const std::size_t before = values_.error_count();
    if (entry.value.kind == Kind::kBroken) mark_faulty(entry);
    (this->*read_entry)(entry.value, NameRef(entry.key, entry.key_at));
    if (values_.error_count() != before) mark_faulty(entry);
  }
}

ModelSpec SpecReader::read(const DocumentNode& root, const std::string& default_name) {
  spec_ = ModelSpec();
  spec_.name = default_name;
  ObjectReader model(values_, root, Family::kModel, {"", root.at});
  if (!model.usable()) {
    faults_.section_without_entries = true;
    return spec_;
  }
  model.version("ferrers");
  if (const auto name = model.text("name")) spec_.name = *name;
  if (const auto doc = model.text("doc")) spec_.doc = *doc;
  if (const auto gravity = model.vector3("gravity")) spec_.gravity = *gravity;
  read_section(model, "parameters", &SpecReader::read_parameter);
  if (!model.has("bodies") && !model.has("lagrangian")) {
    values_.error("F202", root.at, "a model needs 'bodies' or 'lagrangian'",
                  "bodies: {name: {...}}, or lagrangian: {coordinates: {...}, kinetic_energy: = ...}");
  }
  read_section(model, "bodies", &SpecReader::read_body);
  read_section(model, "joints", &SpecReader::read_joint);
  if (const DocumentNode* lagrangian = model.object("lagrangian")) read_lagrangian(*lagrangian);
  read_section(model, "couplings", &SpecReader::read_coupling);
  read_section(model, "constraints", &SpecReader::read_constraint);
  read_section(model, "forces", &SpecReader::read_force);
  read_section(model, "drives", &SpecReader::read_drive);
  spec_.motions = model.coordinate_laws("motions");
  read_section(model, "initial", &SpecReader::read_initial);
  read_section(model, "record", &SpecReader::read_record);
  read_section(model, "events", &SpecReader::read_event);
  return std::move(spec_);
}

void SpecReader::read_parameter(const DocumentNode& node, const NameRef& name) {
  ParameterSpec parameter;
  parameter.name = name;
  parameter.value = Number(std::numeric_limits<double>::quiet_NaN());
  parameter.value.at = node.at;
  ObjectReader object(values_, node, Family::kParameter, name);
  if (object.usable()) {
    if (const auto value = object.number("value", &parameter.dimension)) parameter.value = *value;
    parameter.min = object.number_of("min", parameter.dimension);
    parameter.max = object.number_of("max", parameter.dimension);
    parameter.tolerance = object.number_of("tolerance", parameter.dimension);
    parameter.doc = object.text("doc").value_or("");
  }
  spec_.parameters.push_back(std::move(parameter));
}

void SpecReader::read_body(const DocumentNode& node, const NameRef& name) {
  BodySpec body;
  body.name = name;
  ObjectReader object(values_, node, Family::kBody, name);
  if (object.usable()) {
    body.mass = object.number("mass");
    body.com = object.vector3("com");
    if (const DocumentNode* inertia = object.object("inertia")) body.inertia = read_inertia(*inertia);
    if (const DocumentNode* pose = object.object("pose")) body.pose = read_pose(*pose);
  }
  spec_.bodies.push_back(std::move(body));
}

InertiaSpec SpecReader::read_inertia(const DocumentNode& node) {
  using Shape = InertiaSpec::Kind;
  InertiaSpec inertia;
  inertia.at = node.at;
  ObjectReader object(values_, node, Family::kBodyInertia, {"inertia", node.at});
  if (!object.usable()) return inertia;
  const auto rotation = [&] {
    if (const DocumentNode* turn = object.object("rotation")) inertia.rotation = read_rotation(*turn);
  };
  if (object.tag().empty()) {
    inertia.kind = Shape::kTensor;
    if (const auto moments = object.vector3("moments")) inertia.moments = *moments;
    if (const auto products = object.vector3("products")) inertia.products = *products;
    inertia.unphysical = object.boolean("unphysical").value_or(false);
    rotation();
  } else if (object.tag() == "rod" || object.tag() == "cylinder") {
    inertia.kind = object.tag() == "rod" ? Shape::kRod : Shape::kCylinder;
    inertia.from = object.vector3("from");
    inertia.to = object.vector3("to");
    if (inertia.kind == Shape::kCylinder) inertia.radius = object.number("radius").value_or(Number());
  } else if (object.tag() == "box") {
    inertia.kind = Shape::kBox;
    if (const auto size = object.vector3("size")) inertia.size = *size;
    rotation();
  } else if (object.tag() == "sphere") {
    inertia.kind = Shape::kSphere;
    inertia.radius = object.number("radius").value_or(Number());
  }
  return inertia;
}

PoseSpec SpecReader::read_pose(const DocumentNode& node) {
  PoseSpec pose;
  pose.at = node.at;
  ObjectReader object(values_, node, Family::kPose, {"pose", node.at});
  if (!object.usable()) return pose;
  if (const auto position = object.vector3("position")) pose.position = *position;
  const DocumentNode* rotation = object.object("rotation");
  const auto quaternion = object.vector4("quaternion");
  if (rotation != nullptr && quaternion) {
    values_.error("F211", object.place("quaternion"), "'pose' has both 'rotation' and 'quaternion'",
                  "leave one of them out");
  } else if (rotation != nullptr) {
    pose.rotation = read_rotation(*rotation);
  } else if (quaternion) {
    pose.rotation = RotationSpec{{}, quaternion, object.place("quaternion")};
  }
  return pose;
}

std::optional<RotationSpec> SpecReader::read_rotation(const DocumentNode& node) {
  RotationSpec rotation;
  rotation.at = node.at;
  ObjectReader object(values_, node, Family::kRotation, {"rotation", node.at});
  if (!object.usable()) return std::nullopt;
  if (object.tag() == "axis") {
    const auto axis = object.direction("axis");
    const auto angle = object.number("angle");
    if (!axis || !angle) return std::nullopt;
    rotation.axis_angle = std::pair(*axis, *angle);
  } else {
    rotation.quaternion = object.vector4("quaternion");
  }
  return rotation;
}

}  // namespace ferrers
