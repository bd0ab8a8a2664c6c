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

void motion(const JointConstants&, const double* q, Pose& X_FM) {
  X_FM.R = quaternion_matrix(q + 3);
  X_FM.p = Eigen::Vector3d(q[0], q[1], q[2]);
}

void subspace(const JointConstants&, const double*, const double*, Twist* S, Twist& S_dot_v) {
  for (int i = 0; i < 6; ++i) S[i] = Twist::Unit(i);
  S_dot_v.setZero();
}

void rows(const JointConstants&, const RelativeMotion&, const double*, Jet*) {}

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
                                  .motion = motion,
                                  .subspace = subspace,
                                  .rows = rows};

}  // namespace ferrers
