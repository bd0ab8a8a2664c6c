#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

constexpr std::array<int, 6> kRows = {0, 1, 2, 3, 4, 5};

void motion(const JointConstants&, const double*, Pose& X_FM) { X_FM = Pose(); }

void subspace(const JointConstants&, const double*, const double*, Twist*, Twist& S_dot_v) { S_dot_v.setZero(); }

void rows(const JointConstants&, const RelativeMotion& m, const double*, Jet* out) {
  for (int i = 0; i < 3; ++i) out[i] = along_first(m, m.R_F.col(i));
  out[3] = moment_x_row(m);
  out[4] = moment_y_row(m);
  out[5] = moment_z_row(m);
}

}  // namespace

/// No freedom: the frames coincide.
const JointTypeInfo kWeldJoint = {.type = JointType::kWeld,
                                  .name = "weld",
                                  .placement = PlacementRule::kPoint,
                                  .row_components = kRows,
                                  .can_be_tree = true,
                                  .motion = motion,
                                  .subspace = subspace,
                                  .rows = rows};

}  // namespace ferrers
