#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

constexpr std::array<CoordinateInfo, 3> kCoordinates = {{{"omega_x", CoordinateKind::kRotationRate},
                                                         {"omega_y", CoordinateKind::kRotationRate},
                                                         {"omega_z", CoordinateKind::kRotationRate}}};
constexpr std::array<std::string_view, 4> kPositions = {"qw", "qx", "qy", "qz"};
constexpr std::array<int, 3> kRows = {0, 1, 2};

template <class T>
void motion(const JointConstants&, const T* q, BasicPose<T>& X_FM) {
  X_FM.R = quaternion_matrix(q);
  X_FM.p.setZero();
}

template <class T>
void subspace(const JointConstants&, const T*, const T*, Eigen::Matrix<T, 6, 1>* S, Eigen::Matrix<T, 6, 1>& S_dot_v) {
  for (int i = 0; i < 3; ++i) S[i] = Eigen::Matrix<T, 6, 1>::Unit(i);
  S_dot_v.setZero();
}

template <class T>
void rows(const JointConstants&, const BasicRelativeMotion<T>& m, const T*, BasicJet<T>* out) {
  for (int i = 0; i < 3; ++i) out[i] = along_first(m, m.R_F.col(i));
}

}  // namespace

/// A ball: rotation as a unit quaternion, velocity ω of the second body against the first in F axes. Rows: forces.
const JointTypeInfo kSphericalJoint = {.type = JointType::kSpherical,
                                       .name = "spherical",
                                       .placement = PlacementRule::kPoint,
                                       .nq = 4,
                                       .nv = 3,
                                       .coordinates = kCoordinates,
                                       .position_names = kPositions,
                                       .row_components = kRows,
                                       .can_be_tree = true,
                                       .quaternion_at = 0,
                                       .motion = {motion<double>, motion<Traced>},
                                       .subspace = {subspace<double>, subspace<Traced>},
                                       .rows = {rows<double>, rows<Traced>}};

}  // namespace ferrers
