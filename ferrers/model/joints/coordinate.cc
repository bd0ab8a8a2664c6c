#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

constexpr std::array<CoordinateInfo, 1> kAngle = {{{"position", CoordinateKind::kAngle}}};
constexpr std::array<CoordinateInfo, 1> kLengthKind = {{{"position", CoordinateKind::kDisplacement}}};
constexpr std::array<CoordinateInfo, 1> kOther = {{{"position", CoordinateKind::kOther}}};
constexpr std::array<std::string_view, 1> kPositions = {"position"};

template <class T>
void motion(const JointConstants&, const T*, BasicPose<T>& X_FM) {
  X_FM = BasicPose<T>();
}

template <class T>
void subspace(const JointConstants&, const T*, const T*, Eigen::Matrix<T, 6, 1>* S, Eigen::Matrix<T, 6, 1>& S_dot_v) {
  S[0].setZero();
  S_dot_v.setZero();
}

template <class T>
void rows(const JointConstants&, const BasicRelativeMotion<T>&, const T*, BasicJet<T>*) {}

void coordinates(const JointConstants&, const RelativeMotion&, Jet* out) { out[0] = Jet(); }

constexpr JointTypeInfo make(JointType type, std::string_view name, std::span<const CoordinateInfo> info) {
  return {.type = type,
          .name = name,
          .placement = PlacementRule::kNone,
          .nq = 1,
          .nv = 1,
          .coordinates = info,
          .position_names = kPositions,
          .carries_body = false,
          .motion = {motion<double>, motion<Traced>},
          .subspace = {subspace<double>, subspace<Traced>},
          .rows = {rows<double>, rows<Traced>},
          .coordinate_jets = coordinates};
}

}  // namespace

/// Generalized coordinates of `lagrangian`, by what they measure: an entry of q and v that moves no body. They stand
/// among the joints so that whatever has a coordinate is named, driven, limited, started and recorded in one way.
const JointTypeInfo kAngleCoordinate = make(JointType::kAngleCoordinate, "angle coordinate", kAngle);
const JointTypeInfo kLengthCoordinate = make(JointType::kLengthCoordinate, "length coordinate", kLengthKind);
const JointTypeInfo kOtherCoordinate = make(JointType::kOtherCoordinate, "coordinate", kOther);

}  // namespace ferrers
