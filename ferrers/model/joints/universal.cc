#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

constexpr std::array<CoordinateInfo, 2> kCoordinates = {
    {{"angle_1", CoordinateKind::kAngle}, {"angle_2", CoordinateKind::kAngle}}};
constexpr std::array<std::string_view, 2> kPositions = {"angle_1", "angle_2"};
constexpr std::array<int, 4> kRows = {0, 1, 2, 4};

// R_FM = Rz(angle_1) Rx(angle_2): z of F is the first axis, x of M the second.
template <class T>
void motion(const JointConstants&, const T* q, BasicPose<T>& X_FM) {
  using std::cos, std::sin;
  const T c1 = cos(q[0]), s1 = sin(q[0]), c2 = cos(q[1]), s2 = sin(q[1]);
  X_FM.R << c1, -s1 * c2, s1 * s2, s1, c1 * c2, -c1 * s2, 0, s2, c2;
  X_FM.p.setZero();
}

template <class T>
void subspace(const JointConstants&, const T* q, const T* v, Eigen::Matrix<T, 6, 1>* S,
              Eigen::Matrix<T, 6, 1>& S_dot_v) {
  using std::cos, std::sin;
  const T c1 = cos(q[0]), s1 = sin(q[0]);
  S[0] << 0, 0, 1, 0, 0, 0;
  S[1] << c1, s1, 0, 0, 0, 0;
  S_dot_v << -s1 * v[0] * v[1], c1 * v[0] * v[1], 0, 0, 0, 0;
}

template <class T>
void rows(const JointConstants&, const BasicRelativeMotion<T>& m, const T*, BasicJet<T>* out) {
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
                                       .motion = {motion<double>, motion<Traced>},
                                       .subspace = {subspace<double>, subspace<Traced>},
                                       .constant_subspace = false,
                                       .rows = {rows<double>, rows<Traced>},
                                       .coordinate_jets = coordinates,
                                       .angles = coordinates};

}  // namespace ferrers
