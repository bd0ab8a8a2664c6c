#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

constexpr std::array<CoordinateInfo, 1> kCoordinates = {{{"angle", CoordinateKind::kAngle}}};
constexpr std::array<std::string_view, 1> kPositions = {"angle"};
constexpr std::array<int, 5> kRows = {0, 1, 2, 3, 4};

void motion(const JointConstants&, const double* q, Pose& X_FM) {
  const double c = std::cos(q[0]), s = std::sin(q[0]);
  X_FM.R << c, -s, 0, s, c, 0, 0, 0, 1;
  X_FM.p.setZero();
}

void subspace(const JointConstants&, const double*, const double*, Twist* S, Twist& S_dot_v) {
  S[0] << 0, 0, 1, 0, 0, 0;
  S_dot_v.setZero();
}

void rows(const JointConstants&, const RelativeMotion& m, const double*, Jet* out) {
  for (int i = 0; i < 3; ++i) out[i] = along_first(m, m.R_F.col(i));
  out[3] = moment_x_row(m);
  out[4] = moment_y_row(m);
}

void coordinates(const JointConstants&, const RelativeMotion& m, Jet* out) { out[0] = angle_about_z(m); }

}  // namespace

/// A hinge: rotation by `angle` about z. Rows: three forces, moments about x and y.
const JointTypeInfo kRevoluteJoint = {.type = JointType::kRevolute,
                                      .name = "revolute",
                                      .placement = PlacementRule::kPointAxis,
                                      .nq = 1,
                                      .nv = 1,
                                      .coordinates = kCoordinates,
                                      .position_names = kPositions,
                                      .row_components = kRows,
                                      .can_be_tree = true,
                                      .winding_count = 1,
                                      .motion = motion,
                                      .subspace = subspace,
                                      .rows = rows,
                                      .coordinate_jets = coordinates,
                                      .angles = coordinates};

}  // namespace ferrers
