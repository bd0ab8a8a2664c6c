#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ferrers/formats/imported_model.h"
#include "ferrers/formats/name_map.h"
#include "ferrers/formats/sdf_file.h"

namespace ferrers {

struct SdfAxisOwner {
  std::string_view type;  ///< As written.
  std::string name;       ///< Of the joint in the specification.
  int axes = 0;
};

/// The coordinate that an <axis> (0) or <axis2> (1) of a joint with so many axes stands for.
CoordinateRef sdf_coordinate(const std::string& joint, int axes, int which, SourceRange at);

/// <limit> and <dynamics> of a joint's axes: limits go to `joint`, springs and damping to `forces`.
void read_sdf_axis_data(const SdfElement& joint_element, const SdfAxisOwner& owner, const ImportOptions& options,
                        NameMap& names, JointSpec& joint, std::vector<ForceSpec>& forces);

}  // namespace ferrers
