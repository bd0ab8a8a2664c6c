#include "ferrers/formats/sdf_couplings.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "ferrers/formats/sdf_axis_data.h"

namespace ferrers {
namespace {

constexpr double kParallel = 1e-6;  // 1 - cosine of the angle between a gearbox's axis and that of its joint

class CouplingReader {
 public:
  CouplingReader(SdfTree& tree, const SdfBodies& bodies, const std::vector<SdfMadeJoint>& made, NameMap& names,
                 ModelSpec& spec)
      : tree_(tree), bodies_(bodies), made_(made), names_(names), spec_(spec) {
    for (std::size_t i = 0; i < tree.joints.size(); ++i) joint_of_frame_.emplace(tree.joints[i].frame, i);
    for (std::size_t i = 0; i < made.size(); ++i) {
      if (!made[i].turns) continue;
      joints_between_.emplace(std::pair(made[i].bodies[0], made[i].bodies[1]), i);
      joints_between_.emplace(std::pair(made[i].bodies[1], made[i].bodies[0]), i);
    }
  }

  void read_mimic(std::size_t follower, int which, const SdfElement& mimic);
  void read_gearbox(const SdfJoint& joint);

 private:
  std::optional<CoordinateRef> leader_of(const SdfJoint& follower, const SdfElement& mimic) const;
  void add_formula(const CoordinateRef& follower, const CoordinateRef& leader, double multiplier, double offset,
                   const SdfElement& mimic);
  std::optional<std::pair<CoordinateRef, double>> wheel(const SdfJoint& gearbox, const SdfElement& axis,
                                                        const std::string& reference, const std::string& body) const;
  std::string formula_name(const CoordinateRef& coordinate) const;

  SdfTree& tree_;
  const SdfBodies& bodies_;
  const std::vector<SdfMadeJoint>& made_;
  NameMap& names_;
  ModelSpec& spec_;
  std::map<int, std::size_t> joint_of_frame_;
  std::multimap<std::pair<std::string, std::string>, std::size_t> joints_between_;
};

// ---- mimic ---------------------------------------------------------------------------------------------------------

std::optional<CoordinateRef> CouplingReader::leader_of(const SdfJoint& follower, const SdfElement& mimic) const {
  const std::string name = mimic.attribute("joint");
  const std::optional<int> frame = tree_.frames.find(follower.scope, name);
  const auto found = frame ? joint_of_frame_.find(*frame) : joint_of_frame_.end();
  if (name.empty() || found == joint_of_frame_.end()) {
    mimic.attribute_error("joint", "F604", fmt::format("there is no joint '{}' to mimic", name));
    return std::nullopt;
  }
  const SdfMadeJoint& leader = made_[found->second];
  const std::string axis = mimic.attribute("axis");
  const int which = axis == "axis2" ? 1 : 0;
  if (!axis.empty() && axis != "axis" && axis != "axis2") {
    mimic.attribute_error("axis", "F209", fmt::format("'{}' is no axis", axis), "known are 'axis' and 'axis2'");
    return std::nullopt;
  }
  if (leader.name.empty() || which >= leader.coordinates || leader.coordinates > 2) {
    mimic.attribute_error("joint", "F604", fmt::format("the joint '{}' has no such axis to mimic", name));
    return std::nullopt;
  }
  return sdf_coordinate(leader.name, leader.coordinates, which, mimic.attribute_at("joint"));
}

/// In metres per metre and radians alike: lengths count in metres.
std::string CouplingReader::formula_name(const CoordinateRef& coordinate) const {
  for (const JointSpec& one : spec_.joints) {
    if (one.name.name != coordinate.joint.name) continue;
    if (one.type == JointType::kPrismatic) return coordinate.joint.name + ".position / 1 m";
    break;
  }
  return coordinate.joint.name + "." + (coordinate.coordinate.empty() ? "position" : coordinate.coordinate);
}

void CouplingReader::add_formula(const CoordinateRef& follower, const CoordinateRef& leader, double multiplier,
                                 double offset, const SdfElement& mimic) {
  const std::string text = fmt::format("{} - ({:.17g}) * ({}) - ({:.17g})", formula_name(follower), multiplier,
                                       formula_name(leader), offset);
  Diagnostics own;
  const std::optional<Expression> formula = Expression::parse(text, mimic.at(), own);
  if (!formula) return mimic.error("F336", "the numbers of this <mimic> make no formula");
  ConstraintSpec constraint;
  constraint.name = NameRef(names_.add("joints", "constraint", follower.joint.name + "_mimics"), mimic.at());
  constraint.formula = *formula;
  constraint.at = mimic.at();
  spec_.constraints.push_back(std::move(constraint));
}

void CouplingReader::read_mimic(std::size_t follower, int which, const SdfElement& mimic) {
  const SdfJoint& joint = tree_.joints[follower];
  const SdfMadeJoint& own = made_[follower];
  const std::optional<CoordinateRef> leader = leader_of(joint, mimic);
  const Number multiplier = mimic.number("multiplier", 1);
  const double offset = mimic.number("offset", 0).value - multiplier.value * mimic.number("reference", 0).value;
  if (!leader || own.name.empty()) return;
  const CoordinateRef coordinate = sdf_coordinate(own.name, own.coordinates, which, mimic.at());
  if (!std::isfinite(offset)) return mimic.error("F309", "the numbers of this <mimic> are too large");
  if (offset != 0) return add_formula(coordinate, *leader, multiplier.value, offset, mimic);
  CouplingSpec coupling;
  coupling.name = NameRef(names_.add("joints", "coupling", own.name + "_mimics"), mimic.at());
  coupling.coordinates = {*leader, coordinate};
  coupling.coefficients = {Number(-multiplier.value), Number(1)};
  coupling.at = mimic.at();
  spec_.couplings.push_back(std::move(coupling));
}

// ---- gearbox -------------------------------------------------------------------------------------------------------

/// The joint by which a gearbox's body turns on the reference body, and the sign of its coordinate as the angle from
/// the reference body to `body` about the gearbox's axis.
std::optional<std::pair<CoordinateRef, double>> CouplingReader::wheel(const SdfJoint& gearbox, const SdfElement& axis,
                                                                      const std::string& reference,
                                                                      const std::string& body) const {
  const auto [begin, end] = joints_between_.equal_range({reference, body});
  const Eigen::Vector3d wanted = tree_.frames.pose_in_world(gearbox.frame).R * read_sdf_axis(tree_, gearbox, axis);
  for (auto one = begin; one != end; ++one) {
    const SdfMadeJoint& joint = made_[one->second];
    const double cosine = joint.axis.dot(wanted);
    if (!(std::abs(cosine) > 1 - kParallel)) continue;
    const double sign = (joint.bodies[0] == reference ? 1 : -1) * (cosine > 0 ? 1 : -1);
    return std::pair(sdf_coordinate(joint.name, 1, 0, axis.at()), sign);
  }
  axis.error("F602",
             fmt::format("the gearbox '{}' needs a revolute joint about this axis between '{}' and '{}'",
                         tree_.shown(gearbox.path), reference, body),
             "a gearbox ties the angles of two such joints, it carries nothing itself");
  return std::nullopt;
}

void CouplingReader::read_gearbox(const SdfJoint& joint) {
  const SdfElement& element = joint.element;
  const SdfElement axis = element.child("axis"), axis2 = element.child("axis2");
  const SdfElement reference = element.child("gearbox_reference_body");
  const SdfElement parent = element.child("parent"), child = element.child("child");
  const std::string name = tree_.shown(joint.path);
  if (!axis || !reference || !parent || !child) {
    return element.error("F202", fmt::format("the gearbox '{}' needs <parent>, <child>, <axis> and "
                                             "<gearbox_reference_body>",
                                             name));
  }
  std::array<std::string, 3> on;
  const std::array<SdfElement, 3> named = {reference, parent, child};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto frame = tree_.frames.find_or_tell(joint.scope, {named[i].text(), named[i]}, "the gearbox");
    if (!frame) return;
    on[i] = bodies_.of(tree_.frames.body_of(*frame));
  }
  const Number ratio = element.number("gearbox_ratio", 1);
  const auto first = wheel(joint, axis, on[0], on[1]);
  const auto second = wheel(joint, axis2 ? axis2 : axis, on[0], on[2]);
  if (!first || !second) return;
  CouplingSpec coupling;  // angle 2 = -ratio * angle 1
  coupling.name = NameRef(names_.add("joints", "coupling", name), element.attribute_at("name"));
  coupling.coordinates = {first->first, second->first};
  coupling.coefficients = {Number(ratio.value * first->second), Number(second->second)};
  coupling.at = element.at();
  spec_.couplings.push_back(std::move(coupling));
}

}  // namespace

void read_sdf_couplings(SdfTree& tree, const SdfBodies& bodies, const std::vector<SdfMadeJoint>& made, NameMap& names,
                        ModelSpec& spec) {
  CouplingReader reader(tree, bodies, made, names, spec);
  for (std::size_t i = 0; i < tree.joints.size(); ++i) {
    const SdfElement& element = tree.joints[i].element;
    if (element.attribute("type") == "gearbox") {
      reader.read_gearbox(tree.joints[i]);
      continue;
    }
    for (const int which : {0, 1}) {
      const SdfElement axis = element.child(which == 0 ? "axis" : "axis2");
      const SdfElement mimic = axis ? axis.child("mimic") : SdfElement();
      if (!mimic) continue;
      if (which < made[i].coordinates || made[i].name.empty()) reader.read_mimic(i, which, mimic);
    }
  }
}

}  // namespace ferrers
