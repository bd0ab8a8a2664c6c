#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace ferrers {

/// Pose of a frame B in a frame A: rotation `R` (columns are B's axes in A) and position `p` of B's origin, in A axes.
template <class T>
struct BasicPose {
  using Vector = Eigen::Matrix<T, 3, 1>;
  using Matrix = Eigen::Matrix<T, 3, 3>;
  Matrix R = Matrix::Identity();
  Vector p = Vector::Zero();

  BasicPose() = default;
  BasicPose(const Matrix& rotation, const Vector& position) : R(rotation), p(position) {}

  /// X_AC = X_AB · X_BC.
  BasicPose operator*(const BasicPose& o) const { return {R * o.R, p + R * o.p}; }
  Vector operator*(const Vector& point) const { return p + R * point; }
  BasicPose inverse() const { return {R.transpose(), -(R.transpose() * p)}; }
};
using Pose = BasicPose<double>;

/// [a]× with [a]× b = a × b.
inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

/// Rotation matrix of a unit quaternion stored as (w, x, y, z).
template <class T>
Eigen::Matrix<T, 3, 3> quaternion_matrix(const T* wxyz) {
  return Eigen::Quaternion<T>(wxyz[0], wxyz[1], wxyz[2], wxyz[3]).toRotationMatrix();
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
