#include "ferrers/model/mass_properties.h"

#include <Eigen/Eigenvalues>

namespace ferrers {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {
constexpr double kRounding = 1e-6;  // of the trace: what a number with six or seven digits may be off
}

Matrix3d rod_inertia(double mass_kg, const Vector3d& span_m) {
  return mass_kg / 12.0 * (span_m.squaredNorm() * Matrix3d::Identity() - span_m * span_m.transpose());
}

Matrix3d box_inertia(double mass_kg, const Vector3d& size_m) {
  const Vector3d squares = size_m.cwiseAbs2();
  return (mass_kg / 12.0 * (squares.sum() * Vector3d::Ones() - squares)).asDiagonal();
}

Matrix3d cylinder_inertia(double mass_kg, const Vector3d& span_m, double radius_m) {
  const double r2 = radius_m * radius_m;
  const Matrix3d along = span_m.normalized() * span_m.normalized().transpose();
  return rod_inertia(mass_kg, span_m) + mass_kg * r2 * (0.25 * (Matrix3d::Identity() - along) + 0.5 * along);
}

Matrix3d sphere_inertia(double mass_kg, double radius_m) {
  return 0.4 * mass_kg * radius_m * radius_m * Matrix3d::Identity();
}

Matrix3d inertia_tensor(const Vector3d& moments_kgm2, const Vector3d& products_kgm2) {
  Matrix3d tensor = moments_kgm2.asDiagonal();
  tensor(0, 1) = tensor(1, 0) = products_kgm2.x();
  tensor(0, 2) = tensor(2, 0) = products_kgm2.y();
  tensor(1, 2) = tensor(2, 1) = products_kgm2.z();
  return tensor;
}

Matrix3d rotate_inertia(const Matrix3d& inertia_kgm2, const Matrix3d& R) {
  const Matrix3d turned = R * inertia_kgm2 * R.transpose();
  return 0.5 * (turned + turned.transpose());
}

InertiaVerdict check_inertia(const Matrix3d& inertia_kgm2) {
  if (!inertia_kgm2.allFinite()) return InertiaVerdict::kPhysical;
  const double scale = inertia_kgm2.cwiseAbs().maxCoeff();
  if (scale == 0) return InertiaVerdict::kPhysical;
  const Matrix3d scaled = inertia_kgm2 / scale;
  const Vector3d principal = Eigen::SelfAdjointEigenSolver<Matrix3d>(scaled, Eigen::EigenvaluesOnly).eigenvalues();
  const double slack = kRounding * principal.cwiseAbs().sum();
  if (principal(0) < -slack) return InertiaVerdict::kNegative;
  if (principal(2) > principal(0) + principal(1) + slack) return InertiaVerdict::kTriangle;
  return InertiaVerdict::kPhysical;
}

}  // namespace ferrers
