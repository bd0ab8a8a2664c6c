#include "ferrers/testing/absolute_rows.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace ferrers::witness {
namespace {

template <class T>
Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

template <class T>
T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class T>
Vec3<T> unit(const Vec3<T>& a) {
  using std::sqrt;
  const T length = sqrt(dot(a, a));
  return {a[0] / length, a[1] / length, a[2] / length};
}

template <class T>
Vec3<T> scaled_vector(const Vec3<T>& a, const T& s) {
  return {a[0] * s, a[1] * s, a[2] * s};
}

template <class T>
RowWrench<T> force_at(const Vec3<T>& direction, const Vec3<T>& point) {
  return {direction, point, Vec3<T>::Zero()};
}

template <class T>
RowWrench<T> couple(const Vec3<T>& axis) {
  return {Vec3<T>::Zero(), Vec3<T>::Zero(), axis};
}

/// Unit force of the teeth along the line of action. With e the unit vector between the centres (normal to z), D their
/// distance and n = s e + c (z × e), tangency to both base circles asks D c = ρ₁ − ρ₂; the side tells the sign of s.
template <class T>
RowWrench<T> mesh_row(const JointConstants& k, const JointFrames<T>& frames) {
  using std::sqrt;
  if (k.mesh_holds_as_drawn_only) {
    const Vec3<T> n = frames.F * k.line_of_action_F.template cast<T>();
    return force_at<T>(n, frames.pF + frames.F * k.pitch_point_F_m.template cast<T>());
  }
  const Vec3<T> z = frames.F.col(2);
  const Vec3<T> between = frames.pM - frames.pF;
  const Vec3<T> in_plane = between - scaled_vector<T>(z, dot<T>(between, z));
  const T distance = sqrt(dot(in_plane, in_plane));
  const Vec3<T> e = unit<T>(in_plane);
  const T c = T(k.base_radius_1_m - k.base_radius_2_m) / distance;
  const T s = T(k.mesh_side) * sqrt(T(1.0) - c * c);
  const Vec3<T> n = scaled_vector<T>(e, s) + scaled_vector<T>(cross<T>(z, e), c);
  const Vec3<T> tangency = frames.pF + scaled_vector<T>(cross<T>(n, z), T(k.base_radius_1_m)) +
                           scaled_vector<T>(z, T(k.pitch_point_F_m.z()));
  return force_at<T>(n, tangency);
}

template <class T>
RowWrench<T> row_of(const std::string& component, const Joint& joint, const JointFrames<T>& frames) {
  const Vec3<T> x = frames.F.col(0), y = frames.F.col(1), z = frames.F.col(2);
  if (joint.type == JointType::kDistance) return force_at<T>(unit<T>(frames.pM - frames.pF), frames.pM);
  if (joint.type == JointType::kGearMesh) return mesh_row(joint.constants, frames);
  if (joint.type == JointType::kUniversal && component == "moment_y") {
    const Vec3<T> second_axis = frames.M.col(0);
    return couple<T>(cross<T>(z, second_axis));
  }
  if (joint.type == JointType::kScrew && component == "force_z") {
    RowWrench<T> row = force_at<T>(z, frames.pM);
    row.m = scaled_vector<T>(z, T(-joint.constants.lead_m / (2 * std::numbers::pi)));
    return row;
  }
  const Vec3<T> axis = component.back() == 'x' ? x : component.back() == 'y' ? y : z;
  return component.front() == 'f' ? force_at<T>(axis, frames.pM) : couple<T>(axis);
}

}  // namespace

std::vector<const char*> row_components(JointType type) {
  switch (type) {
    case JointType::kWeld:
      return {"force_x", "force_y", "force_z", "moment_x", "moment_y", "moment_z"};
    case JointType::kRevolute:
      return {"force_x", "force_y", "force_z", "moment_x", "moment_y"};
    case JointType::kPrismatic:
      return {"force_x", "force_y", "moment_x", "moment_y", "moment_z"};
    case JointType::kScrew:
      return {"force_x", "force_y", "force_z", "moment_x", "moment_y"};
    case JointType::kCylindrical:
      return {"force_x", "force_y", "moment_x", "moment_y"};
    case JointType::kUniversal:
      return {"force_x", "force_y", "force_z", "moment_y"};
    case JointType::kSpherical:
      return {"force_x", "force_y", "force_z"};
    case JointType::kPlanar:
      return {"force_z", "moment_x", "moment_y"};
    case JointType::kPointOnLine:
      return {"force_x", "force_y"};
    case JointType::kPointOnPlane:
    case JointType::kDistance:
      return {"force_z"};
    case JointType::kGearMesh:
      return {"force_x"};
    case JointType::kFree:
    case JointType::kAngleCoordinate:
    case JointType::kLengthCoordinate:
    case JointType::kOtherCoordinate:
      return {};
  }
  throw std::invalid_argument("row_components: unknown joint type");
}

template <class T>
JointFrames<T> joint_frames(const Joint& joint, const Placement<T>& first, const Placement<T>& second) {
  JointFrames<T> frames;
  frames.F = first.R * joint.X_1F.R.template cast<T>();
  frames.M = second.R * joint.X_2M.R.template cast<T>();
  frames.pF = first.p + first.R * joint.X_1F.p.template cast<T>();
  frames.pM = second.p + second.R * joint.X_2M.p.template cast<T>();
  return frames;
}

template <class T>
std::vector<RowWrench<T>> joint_rows(const Joint& joint, const Placement<T>& first, const Placement<T>& second) {
  const JointFrames<T> frames = joint_frames(joint, first, second);
  std::vector<RowWrench<T>> rows;
  for (const char* component : row_components(joint.type)) rows.push_back(row_of<T>(component, joint, frames));
  return rows;
}

template <class T>
RowWrench<T> coordinate_row(const Joint& joint, int index, const Placement<T>& first, const Placement<T>& second) {
  const JointFrames<T> frames = joint_frames(joint, first, second);
  const Vec3<T> x = frames.F.col(0), y = frames.F.col(1), z = frames.F.col(2);
  switch (joint.type) {
    case JointType::kRevolute:
    case JointType::kScrew:
      if (index == 0) return couple<T>(z);
      break;
    case JointType::kPrismatic:
      if (index == 0) return force_at<T>(z, frames.pM);
      break;
    case JointType::kCylindrical:
      if (index == 0) return couple<T>(z);
      if (index == 1) return force_at<T>(z, frames.pM);
      break;
    case JointType::kUniversal:
      if (index == 0) return couple<T>(z);
      if (index == 1) return couple<T>(Vec3<T>(frames.M.col(0)));
      break;
    case JointType::kPlanar:
      if (index == 0) return force_at<T>(x, frames.pM);
      if (index == 1) return force_at<T>(y, frames.pM);
      if (index == 2) return couple<T>(z);
      break;
    case JointType::kSpherical:
    case JointType::kFree: {
      const int count = joint.type == JointType::kFree ? 6 : 3;
      if (index < 0 || index >= count) break;
      const Vec3<T> axis = frames.F.col(index % 3);
      return index < 3 ? couple<T>(axis) : force_at<T>(axis, frames.pM);
    }
    default:
      break;
  }
  throw std::invalid_argument("coordinate_row: joint '" + joint.name + "' has no scalar coordinate " +
                              std::to_string(index));
}

template JointFrames<double> joint_frames(const Joint&, const Placement<double>&, const Placement<double>&);
template JointFrames<Dual> joint_frames(const Joint&, const Placement<Dual>&, const Placement<Dual>&);
template std::vector<RowWrench<double>> joint_rows(const Joint&, const Placement<double>&, const Placement<double>&);
template std::vector<RowWrench<Dual>> joint_rows(const Joint&, const Placement<Dual>&, const Placement<Dual>&);
template RowWrench<double> coordinate_row(const Joint&, int, const Placement<double>&, const Placement<double>&);
template RowWrench<Dual> coordinate_row(const Joint&, int, const Placement<Dual>&, const Placement<Dual>&);

}  // namespace ferrers::witness
