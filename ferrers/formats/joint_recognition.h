#pragma once

#include <string>
#include <vector>

#include "ferrers/core/diagnostics.h"
#include "ferrers/model/spec.h"

/// Formats without spherical and universal joints write them as revolute joints in a row with nothing between them.
namespace ferrers {

/// A row of revolute joints that moves its ends like one joint.
struct RevoluteRow {
  JointType type = JointType::kUniversal;  ///< Or kSpherical.
  std::vector<std::string> joints;         ///< Two or three, from the first body to the last.
  std::vector<std::string> between;        ///< The bodies between them.
};

/// Finds rows of two (universal) or three (spherical) revolute joints, given by `frames`, whose axes meet in one point
/// at right angles, each to the next, within 1e-6 m and 1e-6 rad.
///
/// The bodies between them weigh nothing (at most 1e-6 of the median of all masses, inertia likewise), carry no other
/// joint, and nothing in the specification names one of these bodies or joints: no coupling, drive, force, formula,
/// initial value, record; no limits, friction, stiffness or misalignment. A row of three is not also given as a row of
/// two. Cost: linear in the size of the specification, up to logarithms.
std::vector<RevoluteRow> find_revolute_rows(const ModelSpec& spec);

/// Puts one joint, named after the first of its row, in the place of each row; the bodies between are gone. Its zero is
/// where all of the row were zero. What was done is told (F603). Rows are such as `find_revolute_rows` gives.
void merge_revolute_rows(ModelSpec& spec, const std::vector<RevoluteRow>& rows, Diagnostics& diagnostics);

}  // namespace ferrers
