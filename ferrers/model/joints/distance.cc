#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

constexpr std::array<int, 1> kRows = {2};

template <class T>
void rows(const JointConstants& constants, const BasicRelativeMotion<T>& m, const T*, BasicJet<T>* out) {
  BasicJet<T> sum;
  for (int i = 0; i < 3; ++i) sum = sum + square(along_first(m, m.R_F.col(i)));
  out[0] = sqrt(sum) + (-constants.length_m);
}

}  // namespace

/// A massless rod: |p_M − p_F| = length. Row: the force along the rod (z as drawn), tension negative.
const JointTypeInfo kDistanceJoint = {.type = JointType::kDistance,
                                      .name = "distance",
                                      .placement = PlacementRule::kTwoPoints,
                                      .row_components = kRows,
                                      .rows = {rows<double>, rows<Traced>}};

}  // namespace ferrers
