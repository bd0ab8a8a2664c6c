#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

constexpr std::array<CoordinateInfo, 1> kCoordinates = {{{"displacement", CoordinateKind::kDisplacement}}};
constexpr std::array<std::string_view, 1> kPositions = {"displacement"};
constexpr std::array<int, 5> kRows = {0, 1, 3, 4, 5};

template <class T>
void motion(const JointConstants&, const T* q, BasicPose<T>& X_FM) {
  X_FM.R.setIdentity();
  X_FM.p = Eigen::Matrix<T, 3, 1>(0, 0, q[0]);
}

template <class T>
void subspace(const JointConstants&, const T*, const T*, Eigen::Matrix<T, 6, 1>* S, Eigen::Matrix<T, 6, 1>& S_dot_v) {
  S[0] << 0, 0, 0, 0, 0, 1;
  S_dot_v.setZero();
}

template <class T>
void rows(const JointConstants&, const BasicRelativeMotion<T>& m, const T*, BasicJet<T>* out) {
  out[0] = along_first(m, m.R_F.col(0));
  out[1] = along_first(m, m.R_F.col(1));
  out[2] = moment_x_row(m);
  out[3] = moment_y_row(m);
  out[4] = moment_z_row(m);
}

void coordinates(const JointConstants&, const RelativeMotion& m, Jet* out) { out[0] = along_first(m, m.R_F.col(2)); }

}  // namespace

/// A slider: translation by `displacement` along z. Rows: forces along x and y, three moments.
const JointTypeInfo kPrismaticJoint = {.type = JointType::kPrismatic,
                                       .name = "prismatic",
                                       .placement = PlacementRule::kPointAxis,
                                       .nq = 1,
                                       .nv = 1,
                                       .coordinates = kCoordinates,
                                       .position_names = kPositions,
                                       .row_components = kRows,
                                       .can_be_tree = true,
                                       .motion = {motion<double>, motion<Traced>},
                                       .subspace = {subspace<double>, subspace<Traced>},
                                       .rows = {rows<double>, rows<Traced>},
                                       .coordinate_jets = coordinates};

}  // namespace ferrers
