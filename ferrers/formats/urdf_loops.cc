#include <fmt/format.h>

#include "ferrers/formats/urdf_import.h"
#include "ferrers/formats/urdf_values.h"
#include "ferrers/model/pose_spec.h"

namespace ferrers {
namespace {

/// The links from `link` back to the root, itself first.
std::vector<int> way_to_root(const UrdfTree& tree, int link) {
  std::vector<int> way = {link};
  while (true) {
    const int joint = tree.links[static_cast<std::size_t>(way.back())].parent_joint;
    if (joint < 0) return way;
    way.push_back(tree.joints[static_cast<std::size_t>(joint)].parent);
  }
}

std::optional<JointType> loop_type(const XmlElement& loop, Diagnostics& diagnostics) {
  const std::optional<std::string_view> type = required_attribute(loop, "type", diagnostics);
  if (!type) return std::nullopt;
  if (*type == "revolute" || *type == "continuous") return JointType::kRevolute;
  if (*type == "prismatic") return JointType::kPrismatic;
  if (*type == "fixed") return JointType::kWeld;
  if (*type == "planar") return JointType::kPlanar;
  diagnostics.error("F209", loop.attribute_at("type"), fmt::format("'{}' is no type of <loop>", *type),
                    "there are revolute, continuous, prismatic, fixed and planar loops");
  return std::nullopt;
}

struct Ends {
  XmlElement predecessor, successor;
  int first = 0, second = 0;
};

std::optional<Ends> read_ends(UrdfImport& import, const XmlElement& element) {
  Diagnostics& diagnostics = import.diagnostics();
  Ends ends;
  ends.predecessor = required_child(element, "predecessor", diagnostics);
  ends.successor = required_child(element, "successor", diagnostics);
  if (!ends.predecessor || !ends.successor) return std::nullopt;
  const auto first = named_link(import.tree, ends.predecessor, "link", diagnostics);
  const auto second = named_link(import.tree, ends.successor, "link", diagnostics);
  if (!first || !second) return std::nullopt;
  ends.first = *first;
  ends.second = *second;
  if (ends.first != ends.second) return ends;
  diagnostics.error("F605", ends.successor.attribute_at("link"),
                    fmt::format("<{}> joins the link '{}' to itself", element.name(), import.link(*first).name));
  return std::nullopt;
}

void add_loop(UrdfImport& import, const XmlElement& loop) {
  Diagnostics& diagnostics = import.diagnostics();
  const std::optional<std::string_view> name = required_attribute(loop, "name", diagnostics);
  const std::optional<JointType> type = loop_type(loop, diagnostics);
  const std::optional<Ends> ends = read_ends(import, loop);
  if (!name || !type || !ends) return;
  const SourceRange at = loop.attribute_at("name");
  const Eigen::Vector3d axis = read_axis(loop, diagnostics);
  const auto frame = [&](const XmlElement& end) {
    const Pose origin = read_origin(end, diagnostics);
    return pose_spec(*type == JointType::kWeld ? origin : along_axis(origin, axis), at);
  };
  JointSpec joint;
  joint.name = {import.names.add("joints", "joint", *name), at};
  joint.type = *type;
  joint.bodies = {NameRef(import.link(ends->first).body, at), NameRef(import.link(ends->second).body, at)};
  joint.frames = {frame(ends->predecessor), frame(ends->successor)};
  import.spec().joints.push_back(std::move(joint));
}

/// ratio times the motion of the predecessor is the motion of the successor, both against the nearest link from which
/// they branch: the sums of the coordinates on the two ways.
void add_coupling(UrdfImport& import, const XmlElement& element) {
  Diagnostics& diagnostics = import.diagnostics();
  const std::optional<std::string_view> name = required_attribute(element, "name", diagnostics);
  const std::optional<Ends> ends = read_ends(import, element);
  const XmlElement ratio_element = required_child(element, "ratio", diagnostics);
  if (!name || !ends || !ratio_element) return;
  const std::optional<Number> ratio = required_number(ratio_element, "value", diagnostics);
  if (!ratio) return;
  CouplingSpec coupling;
  coupling.at = element.at();
  coupling.name = {import.names.add("joints", "coupling", *name), element.attribute_at("name")};
  std::vector<int> first = way_to_root(import.tree, ends->first), second = way_to_root(import.tree, ends->second);
  while (!first.empty() && !second.empty() && first.back() == second.back()) first.pop_back(), second.pop_back();
  const auto add_way = [&](const std::vector<int>& way, const XmlElement& end, double c) {
    for (const int link : way) {
      const UrdfJoint& joint = import.joint(import.link(link).parent_joint);
      if (joint.type == "fixed") continue;
      if (!joint.has_one_coordinate()) {
        diagnostics.error("F602", end.attribute_at("link"),
                          fmt::format("the coupling '{}' goes over the {} joint '{}', which has no single coordinate",
                                      *name, joint.type, joint.name));
        return false;
      }
      coupling.coordinates.push_back({NameRef(joint.joint, end.attribute_at("link")), ""});
      Number coefficient(c);
      coefficient.at = ratio->at;
      coupling.coefficients.push_back(coefficient);
    }
    return true;
  };
  if (!add_way(first, ends->predecessor, ratio->value)) return;
  if (!add_way(second, ends->successor, -1)) return;
  if (coupling.coordinates.empty()) {
    diagnostics.error("F605", element.at(),
                      fmt::format("the coupling '{}' couples links that do not move against each other", *name));
    return;
  }
  import.spec().couplings.push_back(std::move(coupling));
}

}  // namespace

void import_urdf_loops(UrdfImport& import) {
  for (const XmlElement& loop : import.robot.children("loop")) add_loop(import, loop);
  for (const XmlElement& coupling : import.robot.children("coupling")) add_coupling(import, coupling);
}

}  // namespace ferrers
