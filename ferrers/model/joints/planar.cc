#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

constexpr std::array<CoordinateInfo, 3> kCoordinates = {{{"displacement_1", CoordinateKind::kDisplacement},
                                                         {"displacement_2", CoordinateKind::kDisplacement},
                                                         {"angle", CoordinateKind::kAngle}}};
constexpr std::array<std::string_view, 3> kPositions = {"displacement_1", "displacement_2", "angle"};
constexpr std::array<int, 3> kRows = {2, 3, 4};

template <class T>
void motion(const JointConstants&, const T* q, BasicPose<T>& X_FM) {
  using std::cos, std::sin;
  const T c = cos(q[2]), s = sin(q[2]);
  X_FM.R << c, -s, 0, s, c, 0, 0, 0, 1;
  X_FM.p = Eigen::Matrix<T, 3, 1>(q[0], q[1], 0);
}

template <class T>
void subspace(const JointConstants&, const T*, const T*, Eigen::Matrix<T, 6, 1>* S, Eigen::Matrix<T, 6, 1>& S_dot_v) {
  S[0] << 0, 0, 0, 1, 0, 0;
  S[1] << 0, 0, 0, 0, 1, 0;
  S[2] << 0, 0, 1, 0, 0, 0;
  S_dot_v.setZero();
}

template <class T>
void rows(const JointConstants&, const BasicRelativeMotion<T>& m, const T*, BasicJet<T>* out) {
  out[0] = along_first(m, m.R_F.col(2));
  out[1] = moment_x_row(m);
  out[2] = moment_y_row(m);
}

void angles(const JointConstants&, const RelativeMotion& m, Jet* out) { out[0] = angle_about_z(m); }

void coordinates(const JointConstants&, const RelativeMotion& m, Jet* out) {
  out[0] = along_first(m, m.R_F.col(0));
  out[1] = along_first(m, m.R_F.col(1));
  out[2] = angle_about_z(m);
}

}  // namespace

/// A plate on a table with normal z: displacements along x and y of F, then an angle. Rows: force along z, moments x,
/// y.
const JointTypeInfo kPlanarJoint = {.type = JointType::kPlanar,
                                    .name = "planar",
                                    .placement = PlacementRule::kPointNormal,
                                    .nq = 3,
                                    .nv = 3,
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
