#pragma once

#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "ferrers/formats/asmt_assembly.h"

namespace ferrers {

/// A joint of the file that became a joint of the specification.
struct AsmtJoint {
  int index = 0;  ///< In `spec.joints`.
  AsmtMarker first, second;
  /// As stored: the second's frame in the first's.
  Pose X_12;
  double angle() const { return std::atan2(X_12.R(1, 0), X_12.R(0, 0)); }
  double displacement() const { return X_12.p.z(); }
};

struct AsmtJoints {
  std::vector<AsmtJoint> all;
  /// By "/assembly/joint" as motions and limits refer to them; -1 where several have one name.
  std::unordered_map<std::string, int> by_path;
  /// By "marker I\nmarker J".
  std::unordered_map<std::string, int> by_markers;
};

/// Reads `Joints`: those with a counterpart become joints, the directions that others compare become constraints by
/// formulas, and rack and pinion, screws and gears become relations of coordinates. Errors: F602 for what cannot be
/// said, F202 to F208 for values.
AsmtJoints read_asmt_joints(const AsmtRecord& constraint_sets, AsmtImport& import);

}  // namespace ferrers
