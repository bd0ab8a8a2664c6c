#pragma once

#include <string>
#include <vector>

#include "ferrers/formats/sdf_tree.h"

namespace ferrers {

/// The shapes of a link, for viewers, as shapes of `body`, in whose drawing frame the link's frame is `X_BL`.
void read_sdf_visuals(SdfTree& tree, const SdfLink& link, const std::string& body, const Pose& X_BL,
                      std::vector<VisualShape>& visuals);

}  // namespace ferrers
