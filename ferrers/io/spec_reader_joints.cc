#include <fmt/format.h>

#include "ferrers/io/spec_reader.h"
#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

using Kind = DocumentNode::Kind;

Dimension position_dimension(std::string_view name) {
  const bool is_length = name == "x" || name == "y" || name == "z" || name.rfind("displacement", 0) == 0;
  return is_length ? kLength : kPureNumber;
}

Dimension rate_dimension(CoordinateKind kind) {
  return kind == CoordinateKind::kAngle || kind == CoordinateKind::kRotationRate ? kAngularVelocity : kVelocity;
}

Expression negated(const Expression& formula) {
  Diagnostics none;
  return Expression::parse("-x", {}, none)->substitute([&](std::string_view) { return std::optional(formula); });
}

}  // namespace

void SpecReader::read_joint(const DocumentNode& node, const NameRef& name) {
  JointSpec joint;
  joint.name = name;
  ObjectReader object(values_, node, Family::kJoint, name);
  if (!object.usable()) {
    read_joint_without_type(node, joint);
  } else {
    joint.type = find_joint_type(object.tag())->type;
    object.set_coordinates(dimensions_of(joint));
    if (const auto bodies = object.name_pair("bodies"))
      joint.bodies = *bodies;
    else
      faults_.joint_without_bodies = true;
    read_placement(object, joint);
    read_joint_extras(object, joint);
  }
  joint_index_.emplace(name.name, spec_.joints.size());
  spec_.joints.push_back(std::move(joint));
}

/// What is known of a joint whose type is not: its bodies have a joint, and others may name it.
void SpecReader::read_joint_without_type(const DocumentNode& node, JointSpec& joint) {
  faults_.joints_without_type.insert(joint.name.name);
  joint.type = JointType::kFree;
  const DocumentNode* bodies = node.find("bodies");
  if (bodies == nullptr || bodies->items.size() != 2 || !bodies->items[0].is_scalar() ||
      !bodies->items[1].is_scalar()) {
    faults_.joint_without_bodies = true;
    return;
  }
  for (std::size_t i = 0; i < 2; ++i) joint.bodies[i] = NameRef(bodies->items[i].text, bodies->items[i].at);
}

void SpecReader::read_placement(ObjectReader& object, JointSpec& joint) {
  const PlacementRule rule = joint_type_info(joint.type).placement;
  if (object.type().find("frames") != nullptr) {
    if (const DocumentNode* frames = object.object("frames")) joint.frames = read_frames(*frames);
  }
  if (rule == PlacementRule::kTwoPoints) {
    joint.points = object.points("points", joint.bodies, joint.points_on_bodies);
    joint.length = object.number("length");
  } else {
    joint.place = object.place_spec("at");
  }
  if (rule == PlacementRule::kPointAxis || rule == PlacementRule::kMesh) joint.axis = object.place_spec("axis");
  if (rule == PlacementRule::kPointNormal) joint.axis = object.place_spec("normal");
  if (rule == PlacementRule::kPointTwoAxes) {
    if (const auto axes = object.axis_pair("axes", joint.bodies)) {
      joint.axis = (*axes)[0];
      joint.axis2 = (*axes)[1];
    }
  }
  if (rule == PlacementRule::kMesh) {
    joint.line_of_action = object.direction("line_of_action");
    joint.centers = object.point_pair("centers");
  }
  if (object.type().find("x") != nullptr) joint.x = object.direction("x");
  if (object.type().find("lead") != nullptr) joint.lead = object.number("lead").value_or(Number());
}

std::optional<std::array<PoseSpec, 2>> SpecReader::read_frames(const DocumentNode& node) {
  ObjectReader object(values_, node, Family::kJointFrames, {"frames", node.at});
  if (!object.usable()) return std::nullopt;
  const DocumentNode* first = object.object("first");
  const DocumentNode* second = object.object("second");
  if (first == nullptr || second == nullptr) return std::nullopt;
  return std::array{read_pose(*first), read_pose(*second)};
}

void SpecReader::read_joint_extras(ObjectReader& object, JointSpec& joint) {
  if (const DocumentNode* node = object.object("stiffness")) {
    ObjectReader inner(values_, *node, Family::kJointStiffness, {"stiffness", node->at});
    if (inner.usable()) joint.stiffness = StiffnessSpec{inner.vector3("force"), inner.vector3("moment"), node->at};
  }
  if (const DocumentNode* node = object.object("misalignment")) {
    ObjectReader inner(values_, *node, Family::kMisalignment, {"misalignment", node->at});
    if (inner.usable()) {
      joint.misalignment = MisalignmentSpec{inner.vector3("translation"), inner.vector3("rotation"), node->at};
    }
  }
  if (object.type().find("merge") != nullptr) joint.merge = object.boolean("merge").value_or(false);
  if (object.type().find("limits") != nullptr) joint.limits = object.number_pair("limits");
  if (object.type().find("friction") == nullptr) return;
  if (const DocumentNode* node = object.object("friction")) {
    ObjectReader inner(values_, *node, Family::kFriction, {"friction", node->at});
    inner.set_coordinates(dimensions_of(joint));
    if (inner.usable()) {
      joint.friction = FrictionSpec{inner.number("viscous"), inner.number("coulomb"), inner.number("radius"), node->at};
    }
  }
}

void SpecReader::read_coupling(const DocumentNode& node, const NameRef& name) {
  CouplingSpec coupling;
  coupling.name = name;
  coupling.at = node.at;
  ObjectReader object(values_, node, Family::kCoupling, name);
  if (!object.usable()) return;
  coupling.coordinates = object.coordinates("joints");
  if (object.tag() == "gear") {
    const std::size_t count = coupling.coordinates.size();
    if (count != 0 && count != 2) {
      values_.error("F208", object.place("joints"), fmt::format("a gear coupling joins 2 joints, not {}", count),
                    "couple more of them with 'type: linear'");
    }
    const auto ratio = object.number("ratio");
    if (!ratio || count != 2) return;
    Number negative = *ratio;
    if (ratio->expression) negative.expression = negated(*ratio->expression);
    negative.value = -ratio->value;
    coupling.coefficients = {negative, Number(1)};
  } else {
    coupling.coefficients = object.numbers("coefficients");
    const std::size_t count = coupling.coefficients.size();
    if (!coupling.coordinates.empty() && object.has("coefficients") && count != coupling.coordinates.size() &&
        count > 0) {
      values_.error("F208", object.place("coefficients"),
                    fmt::format("'coefficients' has {} numbers for {} joints", count, coupling.coordinates.size()));
      return;
    }
  }
  if (!coupling.coordinates.empty() && !coupling.coefficients.empty()) spec_.couplings.push_back(std::move(coupling));
}

CoordinateDimensions SpecReader::dimensions_of(const JointSpec& joint) const {
  CoordinateDimensions dimensions;
  const JointTypeInfo& info = joint_type_info(joint.type);
  for (const std::string_view name : info.position_names) dimensions.position.push_back(position_dimension(name));
  for (const CoordinateInfo& coordinate : info.coordinates) {
    dimensions.rate.push_back(rate_dimension(coordinate.kind));
  }
  return dimensions;
}

/// Of the one coordinate that is meant; empty where it cannot be told.
CoordinateDimensions SpecReader::dimensions_of(const CoordinateRef& ref) const {
  const auto found = joint_index_.find(ref.joint.name);
  if (found == joint_index_.end() || faults_.joints_without_type.count(ref.joint.name) > 0) return {};
  const JointSpec& joint = spec_.joints[found->second];
  const CoordinateDimensions all = dimensions_of(joint);
  if (ref.coordinate.empty()) return all;
  const JointTypeInfo& info = joint_type_info(joint.type);
  for (std::size_t i = 0; i < info.coordinates.size(); ++i) {
    if (info.coordinates[i].name == ref.coordinate) return {{position_dimension(ref.coordinate)}, {all.rate[i]}};
  }
  return {};
}

}  // namespace ferrers
