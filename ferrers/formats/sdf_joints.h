#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "ferrers/formats/sdf_links.h"

namespace ferrers {

/// What became of one joint of the file.
struct SdfMadeJoint {
  std::string name;    ///< In the specification; empty where it became no joint.
  bool turns = false;  ///< Its only coordinate is an angle.
  std::array<std::string, 2> bodies;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< In the world as drawn.
  int coordinates = 0;
};

/// The joints, with limits, springs and damping; by the order of `tree.joints`. Gearboxes become none here.
std::vector<SdfMadeJoint> read_sdf_joints(SdfTree& tree, const SdfBodies& bodies, const ImportOptions& options,
                                          NameMap& names, ModelSpec& spec);

/// The unit vector of an <axis> or <axis2> in the joint's frame; z, told, where it has no length.
Eigen::Vector3d read_sdf_axis(SdfTree& tree, const SdfJoint& joint, const SdfElement& axis);

}  // namespace ferrers
