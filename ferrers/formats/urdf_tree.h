#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ferrers/formats/imported_model.h"
#include "ferrers/formats/xml_document.h"

/// The kinematic tree of a URDF file: links and joints with their frames, before they become bodies and joints.
namespace ferrers {

struct UrdfLink {
  std::string name;  ///< As in the file.
  XmlElement element;
  int parent_joint = -1;
  std::vector<int> child_joints;
  Pose X_WL;         ///< Link frame in the world, every joint at zero and the root link in the world frame.
  std::string body;  ///< In the specification.
};

struct UrdfJoint {
  std::string name;  ///< As in the file.
  std::string type;  ///< As in the file, or what the file of closures puts in its place.
  bool replaced = false;
  XmlElement element;
  int parent = 0, child = 0;                        ///< Links.
  Pose X_PJ;                                        ///< The joint's and the child link's frame in the parent link's.
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  ///< Unit vector in the joint's frame.
  std::string joint;                                ///< In the specification.
  bool has_one_coordinate() const { return type == "revolute" || type == "continuous" || type == "prismatic"; }
};

struct UrdfTree {
  std::vector<UrdfLink> links;
  std::vector<UrdfJoint> joints;
  std::map<std::string, int, std::less<>> link_index, joint_index;
  int root = 0;

  std::optional<int> find_link(std::string_view name) const;
  std::optional<int> find_joint(std::string_view name) const;
};

/// The links and joints of `<robot>`, and that they are one tree. Errors: F202, F206, F208, F209, F302, and F605 for
/// what is no tree (no root, several roots, a link with two parents, a cycle); then nothing is returned. Cost:
/// O(n log n).
std::optional<UrdfTree> read_urdf_tree(const XmlElement& robot, Diagnostics& diagnostics);

/// The link that `attribute` of `element` names; F202 and F604 where there is none.
std::optional<int> named_link(const UrdfTree& tree, const XmlElement& element, std::string_view attribute,
                              Diagnostics& diagnostics);
/// The joint that `attribute` of `element` names; F202 and F604 where there is none.
std::optional<int> named_joint(const UrdfTree& tree, const XmlElement& element, std::string_view attribute,
                               Diagnostics& diagnostics);

}  // namespace ferrers
