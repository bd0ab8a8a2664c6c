#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

constexpr std::array<CoordinateInfo, 2> kCoordinates = {
    {{"angle_1", CoordinateKind::kAngle}, {"angle_2", CoordinateKind::kAngle}}};
constexpr std::array<std::string_view, 2> kPositions = {"angle_1", "angle_2"};
constexpr std::array<int, 4> kRows = {0, 1, 2, 4};

// R_FM = Rz(angle_1) Rx(angle_2): z of F is the first axis, x of M the second.
void motion(const JointConstants&, const double* q, Pose& X_FM) {
  const double c1 = std::cos(q[0]), s1 = std::sin(q[0]), c2 = std::cos(q[1]), s2 = std::sin(q[1]);
  X_FM.R << c1, -s1 * c2, s1 * s2, s1, c1 * c2, -c1 * s2, 0, s2, c2;
  X_FM.p.setZero();
}

void subspace(const JointConstants&, const double* q, const double* v, Twist* S, Twist& S_dot_v) {
  const double c1 = std::cos(q[0]), s1 = std::sin(q[0]);
  S[0] << 0, 0, 1, 0, 0, 0;
  S[1] << c1, s1, 0, 0, 0, 0;
  S_dot_v << -s1 * v[0] * v[1], c1 * v[0] * v[1], 0, 0, 0, 0;
}

void rows(const JointConstants&, const RelativeMotion& m, const double*, Jet* out) {
  for (int i = 0; i < 3; ++i) out[i] = along_first(m, m.R_F.col(i));
  out[3] = -dot(m, m.R_F.col(2), m.R_M.col(0));
}

void coordinates(const JointConstants&, const RelativeMotion& m, Jet* out) {
  out[0] = angle_about_z(m);
  out[1] = atan2(dot(m, m.R_F.col(2), m.R_M.col(1)), dot(m, m.R_F.col(2), m.R_M.col(2)));
}

}  // namespace

/// A cross: `angle_1` about z of the first body, then `angle_2` about x of the second, which stay perpendicular.
/// Rows: three forces, and the moment about both axes' common perpendicular (along y as drawn).
const JointTypeInfo kUniversalJoint = {.type = JointType::kUniversal,
                                       .name = "universal",
                                       .placement = PlacementRule::kPointTwoAxes,
                                       .nq = 2,
                                       .nv = 2,
                                       .coordinates = kCoordinates,
                                       .position_names = kPositions,
                                       .row_components = kRows,
                                       .can_be_tree = true,
                                       .winding_count = 2,
                                       .motion = motion,
                                       .subspace = subspace,
                                       .constant_subspace = false,
                                       .rows = rows,
                                       .coordinate_jets = coordinates,
                                       .angles = coordinates};

}  // namespace ferrers
