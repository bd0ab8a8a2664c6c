#include "ferrers/io/model_writer.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

std::string text_of(const PlaceSpec&);
std::string text_of(const CoordinateRef&);
std::string text_of(const LawSpec&);
std::string text_of(const RotationSpec&);
std::string text_of(const PoseSpec&);
std::string text_of(const StiffnessSpec&);
std::string text_of(const MisalignmentSpec&);
std::string text_of(const FrictionSpec&);
std::string text_of(const Number&);
std::string text_of(const std::array<Number, 2>&);
std::string text_of(const std::array<Number3, 2>&);
std::string text_of(const std::array<NameRef, 2>&);

/// A text in double quotes, escaped as JSON does, which YAML reads the same.
std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string formula(const Expression& expression) { return quoted("= " + expression.to_string()); }

std::string text_of(const Expression& expression) { return formula(expression); }

std::string text_of(const Number& number) {
  if (number.expression) return formula(*number.expression);
  return std::isinf(number.value) ? std::string("rigid") : fmt::format("{}", number.value);
}

template <class List>
std::string list_of(const List& list) {
  std::string text;
  for (const auto& entry : list) text += (text.empty() ? "" : ", ") + text_of(entry);
  return "[" + text + "]";
}

std::string text_of(const Number3& vector) { return list_of(vector); }

std::string text_of(const std::array<Number3, 2>& points) {
  return fmt::format("[{}, {}]", text_of(points[0]), text_of(points[1]));
}

std::string text_of(const PlaceSpec& place) {
  if (place.drawn) return text_of(*place.drawn);
  std::string text;
  for (const auto& [body, point] : place.on_body) {
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", body.name, text_of(point));
  }
  return "{" + text + "}";
}

std::string text_of(const std::array<NameRef, 2>& names) {
  return fmt::format("[{}, {}]", names[0].name, names[1].name);
}

std::string text_of(const CoordinateRef& ref) {
  return ref.coordinate.empty() ? ref.joint.name : ref.joint.name + "." + ref.coordinate;
}

std::string text_of(const LawSpec& law) {
  if (law.expression) return formula(*law.expression);
  return fmt::format("{{file: {}, column: {}}}", quoted(law.file), law.column);
}

/// A map in one line: {key: value, key: value}.
class FlowMap {
 public:
  FlowMap& add(std::string_view key, std::string_view value) {
    text_ += fmt::format("{}{}: {}", text_.empty() ? "" : ", ", key, value);
    return *this;
  }
  template <class T>
  FlowMap& add_if(std::string_view key, const std::optional<T>& value) {
    return value ? add(key, text_of(*value)) : *this;
  }
  FlowMap& add_place(std::string_view key, const PlaceSpec& place) {
    return place.given() ? add(key, text_of(place)) : *this;
  }
  FlowMap& add_laws(std::string_view key, const std::vector<LawSpec>& laws) {
    if (laws.size() == 1) return add(key, text_of(laws[0]));
    return laws.empty() ? *this : add(key, list_of(laws));
  }
  std::string text() const { return "{" + text_ + "}"; }

 private:
  std::string text_;
};

std::string text_of(const RotationSpec& rotation) {
  FlowMap map;
  if (rotation.axis_angle) {
    map.add("axis", text_of(rotation.axis_angle->first)).add("angle", text_of(rotation.axis_angle->second));
  } else if (rotation.quaternion) {
    map.add("quaternion", list_of(*rotation.quaternion));
  }
  return map.text();
}

std::string text_of(const PoseSpec& pose) {
  FlowMap map;
  map.add("position", text_of(pose.position));
  if (pose.rotation && (pose.rotation->axis_angle || pose.rotation->quaternion)) map.add_if("rotation", pose.rotation);
  return map.text();
}

std::string text_of(const InertiaSpec& inertia) {
  FlowMap map;
  switch (inertia.kind) {
    case InertiaSpec::Kind::kPoint:
      return "{shape: point}";
    case InertiaSpec::Kind::kTensor:
      map.add("moments", text_of(inertia.moments)).add("products", text_of(inertia.products));
      if (inertia.unphysical) map.add("unphysical", "true");
      break;
    case InertiaSpec::Kind::kRod:
      map.add("shape", "rod").add_if("from", inertia.from).add_if("to", inertia.to);
      break;
    case InertiaSpec::Kind::kBox:
      map.add("shape", "box").add("size", text_of(inertia.size));
      break;
    case InertiaSpec::Kind::kCylinder:
      map.add("shape", "cylinder").add_if("from", inertia.from).add_if("to", inertia.to);
      map.add("radius", text_of(inertia.radius));
      break;
    case InertiaSpec::Kind::kSphere:
      map.add("shape", "sphere").add("radius", text_of(inertia.radius));
      break;
  }
  return map.add_if("rotation", inertia.rotation).text();
}

std::string text_of(const StiffnessSpec& stiffness) {
  return FlowMap().add_if("force", stiffness.force).add_if("moment", stiffness.moment).text();
}

std::string text_of(const MisalignmentSpec& misalignment) {
  return FlowMap().add_if("translation", misalignment.translation).add_if("rotation", misalignment.rotation).text();
}

std::string text_of(const FrictionSpec& friction) {
  FlowMap map;
  return map.add_if("viscous", friction.viscous)
      .add_if("coulomb", friction.coulomb)
      .add_if("radius", friction.radius)
      .text();
}

std::string text_of(const std::array<Number, 2>& pair) { return list_of(pair); }

std::string with_unit(const Number& number, const std::optional<Dimension>& dimension) {
  if (!dimension || number.expression) return text_of(number);
  const std::string unit = *dimension == kPureNumber ? "rad" : to_string(*dimension);
  return fmt::format("{} {}", text_of(number), unit);
}

std::string text_of(const ParameterSpec& parameter) {
  const bool plain = !parameter.min && !parameter.max && !parameter.tolerance && parameter.doc.empty();
  if (plain) return with_unit(parameter.value, parameter.dimension);
  FlowMap map;
  map.add("value", with_unit(parameter.value, parameter.dimension));
  map.add_if("min", parameter.min).add_if("max", parameter.max).add_if("tolerance", parameter.tolerance);
  if (!parameter.doc.empty()) map.add("doc", quoted(parameter.doc));
  return map.text();
}

std::string text_of(const BodySpec& body) {
  FlowMap map;
  map.add_if("mass", body.mass).add_if("com", body.com);
  if (body.inertia.kind != InertiaSpec::Kind::kPoint) map.add("inertia", text_of(body.inertia));
  return map.add_if("pose", body.pose).text();
}

std::string text_of(const JointSpec& joint) {
  const JointTypeInfo& info = joint_type_info(joint.type);
  FlowMap map;
  map.add("type", info.name).add("bodies", text_of(joint.bodies)).add_place("at", joint.place);
  if (joint.points && joint.points_on_bodies) {
    FlowMap points;
    for (std::size_t i = 0; i < 2; ++i) points.add(joint.bodies[i].name, text_of((*joint.points)[i]));
    map.add("points", points.text());
  } else {
    map.add_if("points", joint.points);
  }
  map.add_if("length", joint.length);
  if (joint.merge) map.add("merge", "true");
  if (joint.frames) {
    map.add("frames",
            fmt::format("{{first: {}, second: {}}}", text_of((*joint.frames)[0]), text_of((*joint.frames)[1])));
  } else if (info.placement == PlacementRule::kPointTwoAxes) {
    map.add("axes", fmt::format("[{}, {}]", text_of(joint.axis), text_of(joint.axis2)));
  } else {
    map.add_place(info.placement == PlacementRule::kPointNormal ? "normal" : "axis", joint.axis);
  }
  map.add_if("line_of_action", joint.line_of_action).add_if("centers", joint.centers).add_if("x", joint.x);
  if (joint.type == JointType::kScrew) map.add("lead", text_of(joint.lead));
  map.add_if("stiffness", joint.stiffness).add_if("misalignment", joint.misalignment);
  return map.add_if("limits", joint.limits).add_if("friction", joint.friction).text();
}

std::string text_of(const CouplingSpec& coupling) {
  FlowMap map;
  return map.add("type", "linear")
      .add("joints", list_of(coupling.coordinates))
      .add("coefficients", list_of(coupling.coefficients))
      .text();
}

/// One force element, by its type.
struct ForceWriter {
  std::string operator()(const SpringSpec& spring) const {
    FlowMap map;
    map.add("type", "spring").add("bodies", text_of(spring.bodies)).add("points", text_of(spring.points));
    map.add("stiffness", text_of(spring.stiffness)).add("damping", text_of(spring.damping));
    return map.add_if("free_length", spring.free_length).text();
  }
  std::string operator()(const TorsionSpringSpec& spring) const {
    FlowMap map;
    map.add("type", "torsion_spring").add("joint", text_of(spring.coordinate));
    map.add("stiffness", text_of(spring.stiffness)).add("damping", text_of(spring.damping));
    return map.add("free_angle", text_of(spring.free_angle)).text();
  }
  std::string operator()(const JointDampingSpec& damping) const {
    FlowMap map;
    map.add("type", "joint_damping").add("joint", text_of(damping.coordinate));
    return map.add("damping", text_of(damping.damping)).text();
  }
  std::string operator()(const BushingSpec& bushing) const {
    const auto six = [](const Number3& force, const Number3& moment) {
      return FlowMap().add("force", text_of(force)).add("moment", text_of(moment)).text();
    };
    FlowMap map;
    map.add("type", "bushing").add("bodies", text_of(bushing.bodies));
    map.add_place("at", bushing.place).add_place("axis", bushing.axis).add_if("x", bushing.x);
    map.add("stiffness", six(bushing.force_stiffness, bushing.moment_stiffness));
    return map.add("damping", six(bushing.force_damping, bushing.moment_damping)).text();
  }
  std::string operator()(const LoadSpec& load) const {
    FlowMap map;
    map.add("type", load.is_torque ? "torque" : "force").add("body", load.body.name).add_if("at", load.place);
    map.add(load.is_torque ? "torque" : "force", list_of(load.components));
    return map.add("axes", load.in_body_axes ? "body" : "world").text();
  }
};

std::string text_of(const ForceSpec& force) { return std::visit(ForceWriter(), force.element); }

template <class Value>
std::string by_coordinate(const std::vector<std::pair<CoordinateRef, Value>>& entries) {
  FlowMap map;
  for (const auto& [ref, value] : entries) map.add(text_of(ref), text_of(value));
  return map.text();
}

std::string text_of(const ConstraintSpec& constraint) {
  return FlowMap().add(constraint.on_velocities ? "velocity" : "position", formula(constraint.formula)).text();
}

std::string text_of(const GeneralCoordinateSpec& coordinate) {
  const std::string unit = coordinate.dimension == kPureNumber ? "1" : to_string(coordinate.dimension);
  return FlowMap()
      .add("unit", quoted(unit))
      .add_if("guess", coordinate.guess)
      .add_if("limits", coordinate.limits)
      .text();
}

std::string text_of(const DriveSpec& drive) {
  FlowMap map;
  map.add_if("joint", drive.coordinate).add_if("bodies", drive.bodies).add_if("points", drive.points);
  if (drive.point) map.add("point", drive.point->name);
  if (drive.quantity) map.add("quantity", formula(*drive.quantity));
  if (!drive.map.empty()) map.add("map", by_coordinate(drive.map));
  return map.add_laws("motion", drive.motion).add_laws("effort", drive.effort).add_if("weight", drive.weight).text();
}

std::string text_of(const InitialSpec& initial) {
  FlowMap map;
  const auto add = [&](std::string_view key, const std::vector<Number>& numbers) {
    if (numbers.size() == 1) map.add(key, text_of(numbers[0]));
    if (numbers.size() > 1) map.add(key, list_of(numbers));
  };
  if (!initial.coordinate.empty()) map.add("coordinate", initial.coordinate);
  add("position", initial.position);
  add("velocity", initial.velocity);
  if (initial.guess) map.add("guess", "true");
  return map.text();
}

std::string text_of(const RecordSpec& record) {
  if (record.formula) return FlowMap().add("formula", formula(*record.formula)).text();
  return FlowMap().add("body", record.body.name).add("at", text_of(record.place)).text();
}

std::string text_of(const EventSpec& event) {
  FlowMap map;
  map.add("when", formula(event.when));
  map.add("do", event.action == EventSpec::Action::kStop     ? "stop"
                : event.action == EventSpec::Action::kRecord ? "record"
                                                             : "switch");
  if (event.drive) map.add("drive", event.drive->name);
  return map.text();
}

template <class Spec>
void write_section(std::string& out, std::string_view key, const std::vector<Spec>& specs) {
  if (specs.empty()) return;
  out += fmt::format("\n{}:\n", key);
  for (const Spec& spec : specs) out += fmt::format("  {}: {}\n", spec.name.name, text_of(spec));
}

/// One entry per joint, a list where a joint has several.
void write_initial(std::string& out, const std::vector<InitialSpec>& all) {
  if (all.empty()) return;
  std::vector<std::pair<std::string, std::vector<std::string>>> by_joint;
  std::map<std::string, std::size_t> index;
  for (const InitialSpec& initial : all) {
    const auto [found, is_new] = index.emplace(initial.joint.name, by_joint.size());
    if (is_new) by_joint.push_back({initial.joint.name, {}});
    by_joint[found->second].second.push_back(text_of(initial));
  }
  out += "\ninitial:\n";
  for (const auto& [joint, texts] : by_joint) {
    const std::string list = fmt::format("[{}]", fmt::join(texts, ", "));
    out += fmt::format("  {}: {}\n", joint, texts.size() == 1 ? texts[0] : list);
  }
}

/// Constraints are written with those of the model, which is the same.
void write_lagrangian(std::string& out, const LagrangianSpec& spec) {
  if (!spec.given()) return;
  out += "\nlagrangian:\n";
  const auto add = [&out](std::string_view key, const std::string& text) {
    out += fmt::format("  {}: {}\n", key, text);
  };
  FlowMap coordinates;
  for (const GeneralCoordinateSpec& one : spec.coordinates) coordinates.add(one.name.name, text_of(one));
  if (!spec.coordinates.empty()) add("coordinates", coordinates.text());
  if (spec.kinetic_energy) add("kinetic_energy", formula(*spec.kinetic_energy));
  if (!spec.mass_matrix.empty()) {
    std::string rows;
    for (const auto& row : spec.mass_matrix) rows += (rows.empty() ? "" : ", ") + list_of(row);
    add("mass_matrix", "[" + rows + "]");
  }
  if (spec.potential_energy) add("potential_energy", formula(*spec.potential_energy));
  if (spec.dissipation) add("dissipation", formula(*spec.dissipation));
  if (!spec.forces.empty()) add("forces", by_coordinate(spec.forces));
}

}  // namespace

std::string write_model(const ModelSpec& spec) {
  std::string out = "ferrers: 1\n";
  if (!spec.name.empty()) out += fmt::format("name: {}\n", quoted(spec.name));
  if (!spec.doc.empty()) out += fmt::format("doc: {}\n", quoted(spec.doc));
  out += fmt::format("gravity: {}\n", text_of(spec.gravity));
  write_section(out, "parameters", spec.parameters);
  write_section(out, "bodies", spec.bodies);
  if (spec.bodies.empty() && !spec.lagrangian.given()) out += "\nbodies: {}\n";
  write_section(out, "joints", spec.joints);
  write_section(out, "couplings", spec.couplings);
  write_section(out, "constraints", spec.constraints);
  write_lagrangian(out, spec.lagrangian);
  write_section(out, "forces", spec.forces);
  write_section(out, "drives", spec.drives);
  if (!spec.motions.empty()) out += fmt::format("\nmotions: {}\n", by_coordinate(spec.motions));
  write_initial(out, spec.initial);
  write_section(out, "record", spec.records);
  write_section(out, "events", spec.events);
  return out;
}

}  // namespace ferrers
