#pragma once

#include "ferrers/formats/sdf_joints.h"

namespace ferrers {

/// Ties what no joint connects with the ground to it: by free joints, or the models' base links by welds where the
/// options ask for a fixed base. A joint for each group of links that hang together, at the canonical link of the
/// outermost model in it where there is one.
void add_sdf_bases(SdfTree& tree, const SdfBodies& bodies, const std::vector<SdfMadeJoint>& made,
                   const ImportOptions& options, NameMap& names, ModelSpec& spec);

}  // namespace ferrers
