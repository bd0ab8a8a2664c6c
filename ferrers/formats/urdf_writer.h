#pragma once

#include <span>
#include <string>

#include "ferrers/core/diagnostics.h"
#include "ferrers/formats/imported_model.h"
#include "ferrers/model/model.h"

namespace ferrers {

struct UrdfText {
  std::string urdf;
  std::string closures;  ///< YAML, for the file `NAME.closures.yaml` beside `NAME.urdf`; empty where no loop is closed.
};

/// The mechanism as a URDF tree from a root link `world`, which is the ground, and a file of closures for its loops.
///
/// Link frames are the bodies' frames, moved to the point of the joint that carries the link. A joint that closes a
/// loop carries a link that weighs nothing, whose frame the file of closures sets on the other body (`6d`); a spherical
/// one joins points (`3d`). A revolute joint without limits is written as continuous; universal, cylindrical and
/// spherical joints of the tree as rows of joints with massless links between. Told as F607: what URDF does not say and
/// what is left out or written otherwise. Cost: O(n log n).
UrdfText write_urdf(const Model& model, std::span<const VisualShape> visuals, Diagnostics& diagnostics);

}  // namespace ferrers
