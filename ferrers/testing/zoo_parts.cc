#include "ferrers/testing/zoo_parts.h"

#include <stdexcept>

namespace ferrers::witness {
namespace {

BodySpec body_with(const std::string& name, double mass_kg, InertiaSpec::Kind kind) {
  BodySpec body;
  body.name = name;
  body.mass = Number(mass_kg);
  body.inertia.kind = kind;
  return body;
}

PlaceSpec place(const Point& p) {
  PlaceSpec spec;
  spec.drawn = numbers(p);
  return spec;
}

JointSpec bare_joint(JointType type, const std::string& name, const std::string& first, const std::string& second) {
  JointSpec spec;
  spec.name = name;
  spec.type = type;
  spec.bodies = {NameRef(first), NameRef(second)};
  return spec;
}

bool has_axis(JointType type) {
  switch (type) {
    case JointType::kRevolute:
    case JointType::kPrismatic:
    case JointType::kScrew:
    case JointType::kCylindrical:
    case JointType::kPlanar:
    case JointType::kPointOnLine:
    case JointType::kPointOnPlane:
      return true;
    default:
      return false;
  }
}

}  // namespace

Number3 numbers(const Point& p) { return number3(p.x(), p.y(), p.z()); }

Point values(const Number3& n) { return {n[0].value, n[1].value, n[2].value}; }

BodySpec rod_body(const std::string& name, const Point& from, const Point& to, double mass_kg) {
  BodySpec body = body_with(name, mass_kg, InertiaSpec::Kind::kRod);
  body.com = numbers(0.5 * (from + to));
  body.inertia.from = numbers(from);
  body.inertia.to = numbers(to);
  return body;
}

BodySpec bar_body(const std::string& name, const Point& from, const Point& to, double mass_kg, double radius_m) {
  BodySpec body = body_with(name, mass_kg, InertiaSpec::Kind::kCylinder);
  body.com = numbers(0.5 * (from + to));
  body.inertia.from = numbers(from);
  body.inertia.to = numbers(to);
  body.inertia.radius = Number(radius_m);
  return body;
}

BodySpec box_body(const std::string& name, const Point& centre, const Point& size_m, double mass_kg) {
  BodySpec body = body_with(name, mass_kg, InertiaSpec::Kind::kBox);
  body.com = numbers(centre);
  body.inertia.size = numbers(size_m);
  return body;
}

BodySpec tensor_body(const std::string& name, const Point& centre, const Eigen::Matrix3d& I, double mass_kg) {
  BodySpec body = body_with(name, mass_kg, InertiaSpec::Kind::kTensor);
  body.com = numbers(centre);
  body.inertia.moments = number3(I(0, 0), I(1, 1), I(2, 2));
  body.inertia.products = number3(I(0, 1), I(0, 2), I(1, 2));
  return body;
}

JointSpec joint(JointType type, const std::string& name, const std::string& first, const std::string& second,
                const Point& at, const Point& axis) {
  JointSpec spec = bare_joint(type, name, first, second);
  if (type != JointType::kFree) spec.place = place(at);
  if (has_axis(type)) spec.axis = place(axis);
  return spec;
}

JointSpec universal_joint(const std::string& name, const std::string& first, const std::string& second, const Point& at,
                          const Point& first_axis, const Point& second_axis) {
  JointSpec spec = bare_joint(JointType::kUniversal, name, first, second);
  spec.place = place(at);
  spec.axis = place(first_axis);
  spec.axis2 = place(second_axis);
  return spec;
}

JointSpec distance_joint(const std::string& name, const std::string& first, const std::string& second,
                         const Point& on_first, const Point& on_second) {
  JointSpec spec = bare_joint(JointType::kDistance, name, first, second);
  spec.points = std::array<Number3, 2>{numbers(on_first), numbers(on_second)};
  return spec;
}

JointSpec mesh_joint(const std::string& name, const std::string& first, const std::string& second,
                     const Point& pitch_point, const Point& line_of_action, const Point& axis, const Point& centre_1,
                     const Point& centre_2) {
  JointSpec spec = bare_joint(JointType::kGearMesh, name, first, second);
  spec.place = place(pitch_point);
  spec.axis = place(axis);
  spec.line_of_action = numbers(line_of_action);
  spec.centers = std::array<Number3, 2>{numbers(centre_1), numbers(centre_2)};
  return spec;
}

LawSpec law(const std::string& expression) {
  Diagnostics diagnostics;
  LawSpec spec;
  spec.expression = Expression::parse(expression, {}, diagnostics);
  if (!spec.expression) throw std::invalid_argument("law: cannot read '" + expression + "'");
  return spec;
}

DriveSpec coordinate_drive(const std::string& name, const std::string& on_joint, const std::string& motion,
                           const std::string& effort) {
  DriveSpec drive;
  drive.name = name;
  drive.coordinate = CoordinateRef{NameRef(on_joint), ""};
  if (!motion.empty()) drive.motion.push_back(law(motion));
  if (!effort.empty()) drive.effort.push_back(law(effort));
  return drive;
}

InitialSpec initial_velocity(const std::string& of_joint, double velocity) {
  InitialSpec initial;
  initial.joint = of_joint;
  initial.velocity = {Number(velocity)};
  return initial;
}

RecordSpec record(const std::string& name, const std::string& body, const Point& at) {
  RecordSpec spec;
  spec.name = name;
  spec.body = body;
  spec.place = numbers(at);
  return spec;
}

std::string numbered(const std::string& stem, int number) { return stem + std::to_string(number); }

}  // namespace ferrers::witness
