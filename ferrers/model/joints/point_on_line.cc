#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

constexpr std::array<int, 2> kRows = {0, 1};

template <class T>
void rows(const JointConstants&, const BasicRelativeMotion<T>& m, const T*, BasicJet<T>* out) {
  out[0] = along_first(m, m.R_F.col(0));
  out[1] = along_first(m, m.R_F.col(1));
}

}  // namespace

/// A sphere in a cylinder: the second body's point stays on the first body's line z. Rows: forces across it.
const JointTypeInfo kPointOnLineJoint = {.type = JointType::kPointOnLine,
                                         .name = "point_on_line",
                                         .placement = PlacementRule::kPointAxis,
                                         .row_components = kRows,
                                         .rows = {rows<double>, rows<Traced>}};

}  // namespace ferrers
