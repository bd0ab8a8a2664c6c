#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

constexpr std::array<int, 6> kRows = {0, 1, 2, 3, 4, 5};

template <class T>
void motion(const JointConstants&, const T*, BasicPose<T>& X_FM) {
  X_FM = BasicPose<T>();
}

template <class T>
void subspace(const JointConstants&, const T*, const T*, Eigen::Matrix<T, 6, 1>*, Eigen::Matrix<T, 6, 1>& S_dot_v) {
  S_dot_v.setZero();
}

template <class T>
void rows(const JointConstants&, const BasicRelativeMotion<T>& m, const T*, BasicJet<T>* out) {
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
                                  .motion = {motion<double>, motion<Traced>},
                                  .subspace = {subspace<double>, subspace<Traced>},
                                  .rows = {rows<double>, rows<Traced>}};

}  // namespace ferrers
