#pragma once

#include <vector>

#include "ferrers/formats/sdf_joints.h"

namespace ferrers {

/// What ties coordinates of joints to each other: <mimic> of axes, and joints of type gearbox. `made` is by the order
/// of `tree.joints`.
void read_sdf_couplings(SdfTree& tree, const SdfBodies& bodies, const std::vector<SdfMadeJoint>& made, NameMap& names,
                        ModelSpec& spec);

}  // namespace ferrers
