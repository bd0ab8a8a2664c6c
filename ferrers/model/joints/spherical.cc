#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

constexpr std::array<CoordinateInfo, 3> kCoordinates = {{{"omega_x", CoordinateKind::kRotationRate},
                                                         {"omega_y", CoordinateKind::kRotationRate},
                                                         {"omega_z", CoordinateKind::kRotationRate}}};
constexpr std::array<std::string_view, 4> kPositions = {"qw", "qx", "qy", "qz"};
constexpr std::array<int, 3> kRows = {0, 1, 2};

void motion(const JointConstants&, const double* q, Pose& X_FM) {
  X_FM.R = quaternion_matrix(q);
  X_FM.p.setZero();
}

void subspace(const JointConstants&, const double*, const double*, Twist* S, Twist& S_dot_v) {
  for (int i = 0; i < 3; ++i) S[i] = Twist::Unit(i);
  S_dot_v.setZero();
}

void rows(const JointConstants&, const RelativeMotion& m, const double*, Jet* out) {
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
                                       .motion = motion,
                                       .subspace = subspace,
                                       .rows = rows};

}  // namespace ferrers
