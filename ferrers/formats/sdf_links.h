#pragma once

#include <string>
#include <vector>

#include "ferrers/formats/imported_model.h"
#include "ferrers/formats/name_map.h"
#include "ferrers/formats/sdf_tree.h"

namespace ferrers {

/// What became of each link: a body, or a part of the ground.
struct SdfBodies {
  std::vector<std::string> name_of_frame;  ///< By frame: the body that a link's frame is; empty for other frames.
  const std::string& of(int link_or_world) const { return name_of_frame[static_cast<std::size_t>(link_or_world)]; }
};

inline constexpr std::string_view kGround = "ground";

Number3 numbers_of(const Eigen::Vector3d& v, SourceRange at);

/// Bodies of all links that are not static, forces where a link feels no gravity, and the shapes of all links.
/// `gravity` is that of the specification already.
SdfBodies read_sdf_links(SdfTree& tree, NameMap& names, ImportedModel& model);

}  // namespace ferrers
