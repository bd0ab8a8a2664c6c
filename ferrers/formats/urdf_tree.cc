#include "ferrers/formats/urdf_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "ferrers/core/closest_name.h"
#include "ferrers/formats/urdf_values.h"

namespace ferrers {
namespace {

using NameIndex = std::map<std::string, int, std::less<>>;

constexpr std::array<std::string_view, 6> kTypes = {"revolute", "continuous", "prismatic",
                                                    "fixed",    "floating",   "planar"};

std::optional<int> find(const NameIndex& index, std::string_view name) {
  const auto found = index.find(name);
  return found == index.end() ? std::nullopt : std::optional(found->second);
}

std::optional<int> named(const NameIndex& index, std::string_view kind, const XmlElement& element,
                         std::string_view attribute, Diagnostics& diagnostics) {
  const std::optional<std::string_view> name = required_attribute(element, attribute, diagnostics);
  if (!name) return std::nullopt;
  const std::optional<int> found = find(index, *name);
  if (found) return found;
  std::vector<std::string_view> known;
  for (const auto& [other, position] : index) known.push_back(other);
  diagnostics.error("F604", element.attribute_at(attribute), fmt::format("there is no {} '{}'", kind, *name),
                    did_you_mean(*name, known));
  return std::nullopt;
}

/// Reads what stands in the file, then looks whether it is a tree.
class TreeReader {
 public:
  TreeReader(const XmlElement& robot, Diagnostics& diagnostics) : robot_(robot), diagnostics_(diagnostics) {}

  std::optional<UrdfTree> read() {
    for (const XmlElement& element : robot_.children("link")) add_link(element);
    if (tree_.links.empty()) diagnostics_.error("F605", robot_.at(), "the robot has no <link>");
    for (const XmlElement& element : robot_.children("joint")) add_joint(element);
    if (diagnostics_.has_errors()) return std::nullopt;
    connect();
    check_roots();
    if (diagnostics_.has_errors()) return std::nullopt;
    place_links();
    if (diagnostics_.has_errors()) return std::nullopt;
    return std::move(tree_);
  }

 private:
  bool add_name(NameIndex& index, const XmlElement& element, std::string_view kind, std::size_t position) {
    const std::optional<std::string_view> name = required_attribute(element, "name", diagnostics_);
    if (!name) return false;
    if (index.emplace(*name, static_cast<int>(position)).second) return true;
    diagnostics_.error("F302", element.attribute_at("name"), fmt::format("the {} '{}' is given twice", kind, *name),
                       "every name stands for one thing");
    return false;
  }

  void add_link(const XmlElement& element) {
    if (!add_name(tree_.link_index, element, "link", tree_.links.size())) return;
    UrdfLink link;
    link.name = *element.attribute("name");
    link.element = element;
    tree_.links.push_back(std::move(link));
  }

  void add_joint(const XmlElement& element) {
    if (!add_name(tree_.joint_index, element, "joint", tree_.joints.size())) return;
    UrdfJoint joint;
    joint.name = *element.attribute("name");
    joint.element = element;
    joint.type = read_type(element);
    const XmlElement parent = required_child(element, "parent", diagnostics_);
    const XmlElement child = required_child(element, "child", diagnostics_);
    if (parent) joint.parent = named_link(tree_, parent, "link", diagnostics_).value_or(0);
    if (child) joint.child = named_link(tree_, child, "link", diagnostics_).value_or(0);
    joint.X_PJ = read_origin(element, diagnostics_);
    if (joint.has_one_coordinate() || joint.type == "planar") {
      joint.axis = read_axis(element, diagnostics_);
    } else if (const XmlElement axis = element.child("axis")) {
      axis.mark_read_with_all();  // means nothing for a joint of this type, and is often written as zero
    }
    tree_.joints.push_back(std::move(joint));
  }

  std::string read_type(const XmlElement& element) {
    const std::optional<std::string_view> type = required_attribute(element, "type", diagnostics_);
    if (!type || std::find(kTypes.begin(), kTypes.end(), *type) != kTypes.end()) return std::string(type.value_or(""));
    std::string hint = did_you_mean(*type, std::span<const std::string_view>(kTypes));
    if (hint.empty()) hint = "URDF has revolute, continuous, prismatic, fixed, floating and planar joints";
    diagnostics_.error("F209", element.attribute_at("type"), fmt::format("'{}' is no type of joint of URDF", *type),
                       hint);
    return std::string(*type);
  }

  void connect() {
    for (std::size_t i = 0; i < tree_.joints.size(); ++i) {
      const UrdfJoint& joint = tree_.joints[i];
      UrdfLink& child = tree_.links[static_cast<std::size_t>(joint.child)];
      const SourceRange at = joint.element.child("child").attribute_at("link");
      if (joint.parent == joint.child) {
        diagnostics_.error("F605", at,
                           fmt::format("the joint '{}' joins the link '{}' to itself", joint.name, child.name));
      } else if (child.parent_joint >= 0) {
        const UrdfJoint& other = tree_.joints[static_cast<std::size_t>(child.parent_joint)];
        diagnostics_.error("F605", at,
                           fmt::format("the link '{}' has two parents, by the joints '{}' and '{}'", child.name,
                                       other.name, joint.name),
                           "the links of a URDF file form a tree; a loop is closed by <loop> or in a file of closures");
      } else {
        child.parent_joint = static_cast<int>(i);
        tree_.links[static_cast<std::size_t>(joint.parent)].child_joints.push_back(static_cast<int>(i));
      }
    }
  }

  void check_roots() {
    std::vector<int> roots;
    for (std::size_t i = 0; i < tree_.links.size(); ++i) {
      if (tree_.links[i].parent_joint < 0) roots.push_back(static_cast<int>(i));
    }
    if (roots.empty()) {
      diagnostics_.error("F605", robot_.at(), "there is no root link: every link is the child of a joint",
                         "the links of a URDF file form a tree");
      return;
    }
    tree_.root = roots.front();
    const UrdfLink& root = tree_.links[static_cast<std::size_t>(tree_.root)];
    for (std::size_t i = 1; i < roots.size(); ++i) {
      const UrdfLink& other = tree_.links[static_cast<std::size_t>(roots[i])];
      diagnostics_.error("F605", other.element.attribute_at("name"),
                         fmt::format("the link '{}' is the child of no joint, and so is '{}': a file has one root link",
                                     other.name, root.name),
                         "join it to another link, by a fixed joint if need be");
    }
  }

  /// Outwards from the root; what is not reached hangs on a cycle.
  void place_links() {
    std::vector<bool> reached(tree_.links.size(), false);
    std::vector<int> order = {tree_.root};
    reached[static_cast<std::size_t>(tree_.root)] = true;
    for (std::size_t next = 0; next < order.size(); ++next) {
      const UrdfLink& link = tree_.links[static_cast<std::size_t>(order[next])];
      for (const int index : link.child_joints) {
        const UrdfJoint& joint = tree_.joints[static_cast<std::size_t>(index)];
        tree_.links[static_cast<std::size_t>(joint.child)].X_WL = link.X_WL * joint.X_PJ;
        reached[static_cast<std::size_t>(joint.child)] = true;
        order.push_back(joint.child);
      }
    }
    const auto lost = std::find(reached.begin(), reached.end(), false);
    if (lost == reached.end()) return;
    const UrdfLink& link = tree_.links[static_cast<std::size_t>(lost - reached.begin())];
    diagnostics_.error("F605", link.element.attribute_at("name"),
                       fmt::format("the link '{}' is not reached from the root link '{}': its parents form a cycle",
                                   link.name, tree_.links[static_cast<std::size_t>(tree_.root)].name),
                       "the links of a URDF file form a tree");
  }

  XmlElement robot_;
  Diagnostics& diagnostics_;
  UrdfTree tree_;
};

}  // namespace

std::optional<int> UrdfTree::find_link(std::string_view name) const { return find(link_index, name); }
std::optional<int> UrdfTree::find_joint(std::string_view name) const { return find(joint_index, name); }

std::optional<UrdfTree> read_urdf_tree(const XmlElement& robot, Diagnostics& diagnostics) {
  return TreeReader(robot, diagnostics).read();
}

std::optional<int> named_link(const UrdfTree& tree, const XmlElement& element, std::string_view attribute,
                              Diagnostics& diagnostics) {
  return named(tree.link_index, "link", element, attribute, diagnostics);
}

std::optional<int> named_joint(const UrdfTree& tree, const XmlElement& element, std::string_view attribute,
                               Diagnostics& diagnostics) {
  return named(tree.joint_index, "joint", element, attribute, diagnostics);
}

}  // namespace ferrers
