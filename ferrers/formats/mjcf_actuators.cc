#include <fmt/format.h>

#include <set>

#include "ferrers/formats/mjcf_import.h"

namespace ferrers::mjcf {
namespace {

class DriveReader {
 public:
  DriveReader(Import& import, const FixedTendons& tendons) : import_(import), tendons_(tendons) {}

  void read(const Element& element) {
    element.mark_read_with_all();
    const std::size_t before = import_.spec().drives.size();
    if (element.attribute("joint")) {
      add_on_joint(element, "joint");
    } else if (element.attribute("jointinparent")) {
      add_on_joint(element, "jointinparent");
    } else if (element.attribute("tendon") && tendons_.count(element.text_of("tendon")) != 0) {
      add_on_tendon(element, tendons_.find(element.text_of("tendon"))->second);
    } else {
      leave_out(element, "it acts neither on a joint nor on a fixed tendon");
    }
    if (import_.spec().drives.size() > before && !first_) first_ = element;
  }

  void finish() const {
    if (!first_) return;
    first_.diagnostics().notice(
        "F603", first_.at(),
        "actuators are drives without laws: efforts are those at the joint, behind the 'gear', and ranges and control "
        "laws are not read");
  }

 private:
  static void leave_out(const Element& element, std::string_view why) {
    element.diagnostics().notice(
        "F601", element.at(),
        fmt::format("the actuator <{}> '{}' is not read: {}", element.name(), element.text_of("name"), why));
  }

  DriveSpec make_drive(const Element& element, const std::string& otherwise) {
    const std::string own = element.text_of("name");
    DriveSpec drive;
    drive.at = element.main_at();
    drive.name = {import_.names.add("drives", "drive", own.empty() ? otherwise : own), drive.at};
    return drive;
  }

  void add_on_joint(const Element& element, std::string_view attribute) {
    const TreeJoint* joint = find_joint(import_, element, attribute, false);
    if (joint == nullptr) return;
    if (!joint->scalar()) return leave_out(element, "its joint is a ball or free joint");
    if (!driven_.insert(joint->name).second) return leave_out(element, "its joint has a drive already");
    DriveSpec drive = make_drive(element, joint->original + "_drive");
    drive.coordinate = CoordinateRef{{joint->name, drive.at}, ""};
    import_.spec().drives.push_back(std::move(drive));
  }

  void add_on_tendon(const Element& element, const FixedTendon& tendon) {
    const std::string name = element.text_of("tendon");
    if (tendon.terms.empty()) return leave_out(element, "its tendon has no joints");
    if (!driven_.insert(" " + name).second) return leave_out(element, "its tendon has a drive already");
    std::vector<Expression> parts;
    for (const auto& [place, coefficient] : tendon.terms) {
      const TreeJoint& joint = import_.body(place.first).joints[static_cast<std::size_t>(place.second)];
      parts.push_back(Expression::constant(coefficient) * position_of(joint));
    }
    DriveSpec drive = make_drive(element, name + "_drive");
    drive.quantity = sum_of(parts);
    import_.spec().drives.push_back(std::move(drive));
  }

  Import& import_;
  const FixedTendons& tendons_;
  std::set<std::string> driven_;  ///< Joints; tendons with a blank before the name.
  Element first_;
};

}  // namespace

void add_drives(Import& import, const FixedTendons& tendons) {
  DriveReader reader(import, tendons);
  for (const Element& section : import.root.children("actuator")) {
    for (const Element& one : section.children()) reader.read(one);
  }
  reader.finish();
}

}  // namespace ferrers::mjcf
