#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

constexpr std::array<int, 1> kRows = {2};

template <class T>
void rows(const JointConstants&, const BasicRelativeMotion<T>& m, const T*, BasicJet<T>* out) {
  out[0] = along_first(m, m.R_F.col(2));
}

}  // namespace

/// The second body's point stays in the first body's plane with normal z. Row: the force along the normal.
const JointTypeInfo kPointOnPlaneJoint = {.type = JointType::kPointOnPlane,
                                          .name = "point_on_plane",
                                          .placement = PlacementRule::kPointNormal,
                                          .row_components = kRows,
                                          .rows = {rows<double>, rows<Traced>}};

}  // namespace ferrers
