#include "ferrers/math/rotation.h"

#include "ferrers/core/checks.h"

namespace ferrers {
namespace {

Eigen::Matrix3d frame_of_unit_axes(const Eigen::Vector3d& z, const Eigen::Vector3d& x) {
  Eigen::Matrix3d R;
  R.col(0) = x;
  R.col(1) = z.cross(x);
  R.col(2) = z;
  return R;
}

}  // namespace

Eigen::Matrix3d frame_from_z(const Eigen::Vector3d& z) {
  require(std::abs(z.squaredNorm() - 1.0) < 1e-6, "frame_from_z: z must be a unit vector");
  // A component is "less aligned" only by more than rounding: an axis drawn as (1, 1, 0)/√2 is a tie on every machine.
  constexpr double kTie = 1e-9;
  int least = 0;
  for (int i = 1; i < 3; ++i) {
    if (std::abs(z[i]) < std::abs(z[least]) - kTie) least = i;
  }
  const Eigen::Vector3d axis = Eigen::Vector3d::Unit(least);
  return frame_of_unit_axes(z, (axis - z * z.dot(axis)).normalized());
}

Eigen::Matrix3d frame_from_zx(const Eigen::Vector3d& z, const Eigen::Vector3d& x) {
  require(z.allFinite() && x.allFinite(), "frame_from_zx: z and x must be finite");
  // Scaled by the largest entry first, so that neither very long nor very short vectors overflow their square.
  const double z_scale = z.cwiseAbs().maxCoeff();
  const double x_scale = x.cwiseAbs().maxCoeff();
  require(z_scale > 0 && x_scale > 0, "frame_from_zx: z and x must be nonzero");
  const Eigen::Vector3d unit_z = (z / z_scale).normalized();
  const Eigen::Vector3d unit_x = (x / x_scale).normalized();
  Eigen::Vector3d across = unit_x - unit_z * unit_z.dot(unit_x);
  require(across.norm() > 1e-12, "frame_from_zx: z and x must not be parallel");
  across.normalize();
  // A second pass removes what cancellation left along z when x is nearly parallel to it.
  across = (across - unit_z * unit_z.dot(across)).normalized();
  return frame_of_unit_axes(unit_z, across);
}

}  // namespace ferrers
