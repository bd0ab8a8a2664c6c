#include <numbers>

#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

constexpr std::array<CoordinateInfo, 1> kCoordinates = {{{"angle", CoordinateKind::kAngle}}};
constexpr std::array<std::string_view, 1> kPositions = {"angle"};
constexpr std::array<int, 5> kRows = {0, 1, 2, 3, 4};

double pitch(const JointConstants& c) { return c.lead_m / (2 * std::numbers::pi); }  // m per rad

template <class T>
void motion(const JointConstants& constants, const T* q, BasicPose<T>& X_FM) {
  using std::cos, std::sin;
  const T c = cos(q[0]), s = sin(q[0]);
  X_FM.R << c, -s, 0, s, c, 0, 0, 0, 1;
  X_FM.p = Eigen::Matrix<T, 3, 1>(0, 0, pitch(constants) * q[0]);
}

template <class T>
void subspace(const JointConstants& constants, const T*, const T*, Eigen::Matrix<T, 6, 1>* S,
              Eigen::Matrix<T, 6, 1>& S_dot_v) {
  S[0] << 0, 0, 1, 0, 0, pitch(constants);
  S_dot_v.setZero();
}

template <class T>
void rows(const JointConstants& constants, const BasicRelativeMotion<T>& m, const T* winding, BasicJet<T>* out) {
  const BasicJet<T> angle = continued(angle_about_z(m), winding[0]);
  out[0] = along_first(m, m.R_F.col(0));
  out[1] = along_first(m, m.R_F.col(1));
  out[2] = along_first(m, m.R_F.col(2)) - pitch(constants) * angle;
  out[3] = moment_x_row(m);
  out[4] = moment_y_row(m);
}

void coordinates(const JointConstants&, const RelativeMotion& m, Jet* out) { out[0] = angle_about_z(m); }

}  // namespace

/// A screw: rotation by `angle` about z with displacement lead·angle/2π along it. Row force_z couples the two.
const JointTypeInfo kScrewJoint = {.type = JointType::kScrew,
                                   .name = "screw",
                                   .placement = PlacementRule::kPointAxis,
                                   .nq = 1,
                                   .nv = 1,
                                   .coordinates = kCoordinates,
                                   .position_names = kPositions,
                                   .row_components = kRows,
                                   .can_be_tree = true,
                                   .winding_count = 1,
                                   .motion = {motion<double>, motion<Traced>},
                                   .subspace = {subspace<double>, subspace<Traced>},
                                   .rows = {rows<double>, rows<Traced>},
                                   .coordinate_jets = coordinates,
                                   .angles = coordinates};

}  // namespace ferrers
