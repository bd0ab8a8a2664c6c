#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "ferrers/formats/urdf_import.h"
#include "ferrers/formats/urdf_values.h"

namespace ferrers {
namespace {

struct RotorSum {
  std::map<int, double> inertia_of_joint;  ///< Seen from the joint, kg·m².
  SourceRange at;
};

/// The value of a child such as `<drake:rotor_inertia value="..."/>`.
double child_value(const XmlElement& element, std::string_view name, double otherwise, Diagnostics& diagnostics) {
  const XmlElement child = element.child(name);
  return child ? required_number(child, "value", diagnostics).value_or(Number(otherwise)).value : otherwise;
}

void read_reduction(UrdfImport& import, const XmlElement& element) {
  for (const XmlElement& reduction : element.children("mechanicalReduction")) {
    const auto ratio =
        read_numbers(reduction.text(), reduction.text_at(), "<mechanicalReduction>", 1, import.diagnostics());
    if (ratio && (*ratio)[0] != 1) import.reductions.add(reduction.text_at());
  }
}

void read_transmission(UrdfImport& import, const XmlElement& transmission, RotorSum& rotors) {
  Diagnostics& diagnostics = import.diagnostics();
  const std::vector<XmlElement> joints = transmission.children("joint");
  const std::vector<XmlElement> actuators = transmission.children("actuator");
  transmission.attribute("name");
  transmission.attribute("type");
  transmission.child("type");
  if (joints.size() != 1 || actuators.size() != 1) {
    transmission.mark_read_with_all();
    diagnostics.notice("F601", transmission.at(),
                       fmt::format("the transmission '{}' between {} joints and {} actuators is not read",
                                   transmission.attribute("name").value_or(""), joints.size(), actuators.size()),
                       "one joint and one actuator become a drive; <coupling> or <mimic> joins joints");
    return;
  }
  const auto name = required_attribute(joints[0], "name", diagnostics);
  if (!name) return;
  const std::optional<int> joint = import.tree.find_joint(*name);
  const SourceRange at = joints[0].attribute_at("name");
  if (!joint || !import.joint(*joint).has_one_coordinate()) {
    transmission.mark_read_with_all();
    diagnostics.warning("F604", at,
                        joint ? fmt::format("the joint '{}' has no single coordinate: its actuator is left out", *name)
                              : fmt::format("there is no joint '{}': its actuator is left out", *name));
    return;
  }
  for (const XmlElement& where : {transmission, joints[0], actuators[0]}) {
    read_reduction(import, where);
    for (const XmlElement& interface : where.children("hardwareInterface")) interface.mark_read_with_all();
  }
  import.add_drive(*joint, actuators[0].attribute("name").value_or(*name), at);
  const double inertia = child_value(actuators[0], "drake:rotor_inertia", 0, diagnostics);
  const double ratio = child_value(actuators[0], "drake:gear_ratio", 1, diagnostics);
  if (inertia == 0 || import.context.options.ignore_armature) return;
  rotors.inertia_of_joint[*joint] += inertia * ratio * ratio;
  if (!rotors.at.known()) rotors.at = actuators[0].child("drake:rotor_inertia").attribute_at("value");
}

/// Rotors turn with their joints: they add 1/2 I v^2 each and no weight.
void add_rotors(UrdfImport& import, const RotorSum& rotors) {
  std::vector<Expression> terms;
  for (const auto& [joint, inertia] : rotors.inertia_of_joint) {
    const double half = 0.5 * inertia;
    if (!std::isfinite(half)) {
      import.diagnostics().error("F206", rotors.at,
                                 "the inertia of a rotor by the square of its gear ratio is not finite");
      return;
    }
    const Expression rate = Expression::variable(import.joint(joint).joint + ".velocity");
    terms.push_back(Expression::constant(half) * rate * rate);
  }
  if (terms.empty()) return;
  import.spec().lagrangian.kinetic_energy = sum_of(terms);
  import.spec().lagrangian.at = rotors.at;
  import.diagnostics().notice(
      "F603", rotors.at,
      fmt::format("inertias of {} rotors, by the squares of their gear ratios, are in the kinetic energy",
                  terms.size()));
}

}  // namespace

void UrdfImport::add_drive(int index, std::string_view name, SourceRange at) {
  const std::string& driven = joint(index).joint;
  const bool has_one = std::any_of(spec().drives.begin(), spec().drives.end(), [&](const DriveSpec& drive) {
    return drive.coordinate && drive.coordinate->joint.name == driven;
  });
  if (has_one) return;
  DriveSpec drive;
  drive.name = {names.add("drives", "drive", name), at};
  drive.coordinate = CoordinateRef{NameRef(driven, at), ""};
  drive.at = at;
  spec().drives.push_back(std::move(drive));
}

void import_urdf_transmissions(UrdfImport& import) {
  RotorSum rotors;
  for (const XmlElement& one : import.robot.children("transmission")) read_transmission(import, one, rotors);
  add_rotors(import, rotors);
  if (import.reductions.count == 0) return;
  import.diagnostics().notice(
      "F603", import.reductions.first,
      fmt::format(
          "<mechanicalReduction> is not used, here{}: drives act at their joints",
          import.reductions.count > 1 ? fmt::format(" and in {} other places", import.reductions.count - 1) : ""));
}

}  // namespace ferrers
