#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

constexpr std::array<CoordinateInfo, 6> kCoordinates = {{{"omega_x", CoordinateKind::kRotationRate},
                                                         {"omega_y", CoordinateKind::kRotationRate},
                                                         {"omega_z", CoordinateKind::kRotationRate},
                                                         {"v_x", CoordinateKind::kPointVelocity},
                                                         {"v_y", CoordinateKind::kPointVelocity},
                                                         {"v_z", CoordinateKind::kPointVelocity}}};
constexpr std::array<std::string_view, 7> kPositions = {"x", "y", "z", "qw", "qx", "qy", "qz"};

template <class T>
void motion(const JointConstants&, const T* q, BasicPose<T>& X_FM) {
  X_FM.R = quaternion_matrix(q + 3);
  X_FM.p = Eigen::Matrix<T, 3, 1>(q[0], q[1], q[2]);
}

template <class T>
void subspace(const JointConstants&, const T*, const T*, Eigen::Matrix<T, 6, 1>* S, Eigen::Matrix<T, 6, 1>& S_dot_v) {
  for (int i = 0; i < 6; ++i) S[i] = Eigen::Matrix<T, 6, 1>::Unit(i);
  S_dot_v.setZero();
}

template <class T>
void rows(const JointConstants&, const BasicRelativeMotion<T>&, const T*, BasicJet<T>*) {}

}  // namespace

/// No constraint: position of the joint's point in F, and rotation as a unit quaternion; ω and v in F axes.
const JointTypeInfo kFreeJoint = {.type = JointType::kFree,
                                  .name = "free",
                                  .placement = PlacementRule::kNone,
                                  .nq = 7,
                                  .nv = 6,
                                  .coordinates = kCoordinates,
                                  .position_names = kPositions,
                                  .can_be_tree = true,
                                  .quaternion_at = 3,
                                  .motion = {motion<double>, motion<Traced>},
                                  .subspace = {subspace<double>, subspace<Traced>},
                                  .rows = {rows<double>, rows<Traced>}};

}  // namespace ferrers
