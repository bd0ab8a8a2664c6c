#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

constexpr std::array<CoordinateInfo, 2> kCoordinates = {
    {{"angle", CoordinateKind::kAngle}, {"displacement", CoordinateKind::kDisplacement}}};
constexpr std::array<std::string_view, 2> kPositions = {"angle", "displacement"};
constexpr std::array<int, 4> kRows = {0, 1, 3, 4};

template <class T>
void motion(const JointConstants&, const T* q, BasicPose<T>& X_FM) {
  using std::cos, std::sin;
  const T c = cos(q[0]), s = sin(q[0]);
  X_FM.R << c, -s, 0, s, c, 0, 0, 0, 1;
  X_FM.p = Eigen::Matrix<T, 3, 1>(0, 0, q[1]);
}

template <class T>
void subspace(const JointConstants&, const T*, const T*, Eigen::Matrix<T, 6, 1>* S, Eigen::Matrix<T, 6, 1>& S_dot_v) {
  S[0] << 0, 0, 1, 0, 0, 0;
  S[1] << 0, 0, 0, 0, 0, 1;
  S_dot_v.setZero();
}

template <class T>
void rows(const JointConstants&, const BasicRelativeMotion<T>& m, const T*, BasicJet<T>* out) {
  out[0] = along_first(m, m.R_F.col(0));
  out[1] = along_first(m, m.R_F.col(1));
  out[2] = moment_x_row(m);
  out[3] = moment_y_row(m);
}

void angles(const JointConstants&, const RelativeMotion& m, Jet* out) { out[0] = angle_about_z(m); }

void coordinates(const JointConstants&, const RelativeMotion& m, Jet* out) {
  out[0] = angle_about_z(m);
  out[1] = along_first(m, m.R_F.col(2));
}

}  // namespace

/// A rotating slider: `angle` about z and `displacement` along it. Rows: forces and moments about x and y.
const JointTypeInfo kCylindricalJoint = {.type = JointType::kCylindrical,
                                         .name = "cylindrical",
                                         .placement = PlacementRule::kPointAxis,
                                         .nq = 2,
                                         .nv = 2,
                                         .coordinates = kCoordinates,
                                         .position_names = kPositions,
                                         .row_components = kRows,
                                         .can_be_tree = true,
                                         .winding_count = 1,
                                         .motion = {motion<double>, motion<Traced>},
                                         .subspace = {subspace<double>, subspace<Traced>},
                                         .rows = {rows<double>, rows<Traced>},
                                         .coordinate_jets = coordinates,
                                         .angles = angles};

}  // namespace ferrers
