#pragma once

#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ferrers/formats/mjcf_defaults.h"
#include "ferrers/formats/mjcf_mass.h"

namespace ferrers::mjcf {

enum class JointKind { kHinge, kSlide, kBall, kFree };

/// A force along a coordinate: linear, quadratic and cubic coefficient.
using Polynomial = std::array<double, 3>;

/// A joint of a body; SI, rad.
struct TreeJoint {
  std::string original;  ///< Empty where the file has no name.
  std::string name;      ///< In the specification.
  JointKind kind = JointKind::kHinge;
  Vector3d pos = Vector3d::Zero(), axis = Vector3d::UnitZ();  ///< In the body's frame; the axis has length 1.
  double ref = 0;                                             ///< Its coordinate as drawn.
  std::optional<std::array<double, 2>> range;
  Polynomial stiffness = {0, 0, 0}, damping = {0, 0, 0};
  double springref = 0, armature = 0;
  /// Time constant, s, and damping ratio, instead of stiffness and damping.
  std::optional<std::array<double, 2>> springdamper;
  bool replaced = false;              ///< A free joint that the options turned into a weld.
  bool added = false;                 ///< A free joint that the options added.
  std::array<std::string, 2> bodies;  ///< Between which it is in the specification.
  Element element;
  bool scalar() const { return kind == JointKind::kHinge || kind == JointKind::kSlide; }
};

struct TreeBody {
  std::string original;
  std::string name;
  int parent = -1;
  Pose X_PB, X_WB;  ///< As drawn: in the reference configuration.
  std::vector<TreeJoint> joints;
  std::vector<Geom> geoms;
  std::optional<MassProperties> inertial;  ///< What <inertial> says.
  std::optional<MassProperties> mass;      ///< As it counts; nothing: not known.
  double gravity_compensation = 0;
  bool mocap = false;
  bool moves = false;  ///< Some joint lies between it and ground.
  Element element;
};

struct TreeSite {
  int body = 0;
  Pose X_BS;
};

/// The kinematic tree: frames and copies worked out, every body in the order in which MuJoCo counts it.
struct Tree {
  std::vector<TreeBody> bodies;  ///< [0] is the world.
  std::map<std::string, int, std::less<>> body_index;
  std::map<std::string, std::pair<int, int>, std::less<>> joint_index;  ///< Body, joint.
  std::map<std::string, TreeSite, std::less<>> sites;
};

/// Reads every <worldbody>. Errors: F602 for what is not supported, F302 for names twice, F605 for joints where none
/// can be and for more than 20000 bodies or 500000 elements; those of values.
Tree read_tree(const Element& root, const Settings& settings, const Defaults& defaults);

/// A joint's own properties (mjcf_joints.cc).
TreeJoint read_joint(const Element& element, const Attributes& attributes, const Settings& settings);

/// A geom's shape and place (mjcf_geoms.cc).
Geom read_geom(const Attributes& attributes, const Settings& settings);

/// <inertial> (mjcf_geoms.cc).
MassProperties read_inertial(const Element& element, const Settings& settings);

}  // namespace ferrers::mjcf
