#pragma once

#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "ferrers/model/model.h"

/// Problem: a designer replaces a plain bearing by a self-aligning one. It is the same joint, at the same place,
/// between the same bodies, of another type; everything in the model that speaks of it must still mean the same.
///
/// Given: a specification and the changes. Wanted: the changed specification. Kept: name, bodies, place, axis where the
/// new type has one, `x`, stiffness and misalignment (turned where the joint's frame turns). References to a coordinate
/// that the new type has too follow it under its new name (`hinge` becomes `hinge.angle`); a reference to a coordinate
/// that is lost makes the change impossible, with the reason. What only the changed joint itself loses (limits and
/// friction of a coordinate, anisotropic stiffness in a frame that turned) is left out and noted. Gear meshes that took
/// their axis and centres from a changed hinge get them written out.
/// The result has been built: it has no errors. Cost: that of two `build_model`.
namespace ferrers {

struct JointChange {
  std::string joint;
  JointType to = JointType::kRevolute;
  /// What the new type needs and the old one does not tell: a unit vector in the joint's frame as drawn. The second
  /// axis (across z) for `universal`, the line or axis for types with an axis made of `spherical` or `weld`, the normal
  /// for `point_on_plane` made of `point_on_line`. Zero where nothing is needed; `point_on_line` made of a joint with
  /// an axis keeps that as its line unless another is given.
  Vector3d direction = Vector3d::Zero();
};

struct JointChangeResult {
  std::optional<ModelSpec> spec;
  std::string reason;              ///< Why there is none.
  std::vector<std::string> notes;  ///< What of the joints could not be kept.
};

JointChangeResult change_joints(const ModelSpec& spec, const std::vector<JointChange>& changes,
                                const std::map<std::string, double>& parameter_values = {});

/// Whether `change_joints` knows how to make a joint of one type into the other, and needs a direction for it.
enum class ChangeKind { kImpossible, kPlain, kDirected };
ChangeKind joint_change_kind(JointType from, JointType to);

/// The coordinate of the new type that is the old type's `coordinate`; empty where it is lost.
std::string_view kept_coordinate(JointType from, JointType to, std::string_view coordinate);

/// Who refers to which coordinates of which joints. Cost to make: linear in the specification.
class CoordinateUses {
 public:
  explicit CoordinateUses(const ModelSpec& spec);
  /// Why this joint cannot become a `to`; empty where it can.
  std::string obstacle(const std::string& joint, JointType to) const;
  bool any(const std::string& joint) const { return uses_.count(joint) != 0; }

 private:
  struct Use {
    std::string user;        ///< "the drive 'motor'".
    std::string coordinate;  ///< Empty: all of them.
  };
  void add(const std::string& joint, std::string_view coordinate, std::string user);
  void add_names(const Expression& expression, const std::string& user);
  std::unordered_map<std::string, JointType> types_;
  std::unordered_map<std::string, std::vector<Use>> uses_;
};

}  // namespace ferrers
