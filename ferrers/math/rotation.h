#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace ferrers {

/// Pose of a frame B in a frame A: rotation `R` (columns are B's axes in A) and position `p` of B's origin, in A axes.
struct Pose {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();

  Pose() = default;
  Pose(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& position) : R(rotation), p(position) {}

  /// X_AC = X_AB · X_BC.
  Pose operator*(const Pose& o) const { return {R * o.R, p + R * o.p}; }
  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const { return p + R * point; }
  Pose inverse() const { return {R.transpose(), -(R.transpose() * p)}; }
};

/// [a]× with [a]× b = a × b.
inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

/// Rotation matrix of a unit quaternion stored as (w, x, y, z).
inline Eigen::Matrix3d quaternion_matrix(const double* wxyz) {
  return Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]).toRotationMatrix();
}

/// Quaternion of a rotation vector (angle times axis), exact through angle 0.
inline Eigen::Quaterniond quaternion_exp(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  const double half = 0.5 * angle;
  const double s = angle > 1e-6 ? std::sin(half) / angle : 0.5 - angle * angle / 48.0;
  return {std::cos(half), s * rotation_vector.x(), s * rotation_vector.y(), s * rotation_vector.z()};
}

/// Rotation vector of a rotation, angle in [0, π]; exact through angle 0.
inline Eigen::Vector3d rotation_log(const Eigen::Matrix3d& R) {
  Eigen::Quaterniond q(R);
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double s = q.vec().norm();
  const double scale = s > 1e-8 ? 2.0 * std::atan2(s, q.w()) / s : 2.0;
  return scale * q.vec();
}

/// The field's default x axis for a z axis: the world axis least aligned with z (ties in the order x, y, z), made
/// perpendicular. Returns the frame's rotation (columns x, y, z). `z` must be a unit vector.
Eigen::Matrix3d frame_from_z(const Eigen::Vector3d& z);

/// The frame with z along `z` and x along the part of `x` perpendicular to z. Both nonzero and not parallel.
Eigen::Matrix3d frame_from_zx(const Eigen::Vector3d& z, const Eigen::Vector3d& x);

}  // namespace ferrers
