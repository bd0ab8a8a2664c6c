#pragma once

#include <string>
#include <vector>

#include "ferrers/kinematics/system.h"

namespace ferrers {

/// A body that no joint ties to ground floats on an implicit free joint: its coordinates are those of its node, and no
/// joint of the model tells them.
struct FloatingBody {
  int node = 0;  ///< Index into `System::nodes`; a free joint from ground, first coordinate `Node::q`.
  /// What its columns are named after: the body; where a joint or a recorded point has that name too, "body_" before
  /// it (as often as needed).
  std::string name;
};

/// All of them, in the order of the nodes. Cost: O(bodies · names) for the few that float.
std::vector<FloatingBody> find_floating_bodies(const System& system);

}  // namespace ferrers
