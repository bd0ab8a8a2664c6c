#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "ferrers/formats/mjcf_tree.h"
#include "ferrers/kinematics/system.h"

/// A model's tree as MuJoCo wants it: bodies with hinges, slides, balls and free joints.
namespace ferrers::mjcf {

struct WrittenJoint {
  std::string name;
  JointKind kind = JointKind::kHinge;
  Vector3d pos = Vector3d::Zero(), axis = Vector3d::UnitZ();  ///< In the body's frame, as drawn.
  double ref = 0;                                             ///< Its coordinate as drawn.
  std::optional<std::array<double, 2>> limits;
  double stiffness = 0, springref = 0;
  int position = -1;  ///< Of a hinge or slide: its place in a state's positions, which `scale` makes its own.
  double scale = 1;
  std::vector<double> damping, armature;  ///< Per velocity.
};

struct WrittenBody {
  BodyId body;
  std::string name;
  int parent = 0;  ///< Index among the written ones.
  Pose X_PB, X_WB;
  std::vector<WrittenJoint> joints;
};

struct WrittenTree {
  std::vector<WrittenBody> bodies;  ///< [0] is the world; parents first.
  std::map<BodyId, int> index;      ///< Bodies that were dissolved into joints are missing.
  /// Body and joint that a coordinate belongs to, and which of its velocities it is.
  struct Place {
    int body = 0, joint = 0, velocity = 0;
  };
  std::map<JointCoordinate, Place> coordinates;
  /// A screw's hinge and slide, which are still to be coupled.
  struct Screw {
    JointId joint;
    std::string hinge, slide;
  };
  std::vector<Screw> screws;
};

/// Massless bodies between two tree joints, which nothing else touches, are dissolved.
WrittenTree make_written_tree(const System& system);

}  // namespace ferrers::mjcf
