#include "ferrers/formats/mjcf_mass.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace ferrers::mjcf {
namespace {

constexpr double kPi = 3.14159265358979323846;

double ellipsoid_area(double a, double b, double c) {
  constexpr double kThomsen = 1.6075;
  const double ap = std::pow(a, kThomsen), bp = std::pow(b, kThomsen), cp = std::pow(c, kThomsen);
  return 4 * kPi * std::pow((ap * bp + ap * cp + bp * cp) / 3, 1 / kThomsen);
}

/// Of the layer between an ellipsoid and one whose half axes are all longer by the same little: the quotient of the
/// derivatives of (4/15)π abc (b² + c²) and (4/3)π abc along (1, 1, 1).
Vector3d ellipsoid_shell_moments(const Vector3d& s) {
  const double volume_rate = s.y() * s.z() + s.x() * s.z() + s.x() * s.y();
  const double product = s.prod();
  Vector3d moments;
  for (int i = 0; i < 3; ++i) {
    const double b = s[(i + 1) % 3], c = s[(i + 2) % 3];
    moments[i] = (volume_rate * (b * b + c * c) + 2 * product * (b + c)) / (5 * volume_rate);
  }
  return moments;
}

/// Masses of the parts of a capsule: caps together, and the cylinder between them.
Vector3d capsule_moments(double r, double length) {
  const double caps = 4 * r / (4 * r + 3 * length);
  const double tube = 1 - caps;
  const double across =
      tube * (3 * r * r + length * length) / 12 + caps * 0.4 * r * r + caps * length * (3 * r + 2 * length) / 8;
  return {across, across, tube * r * r / 2 + caps * 0.4 * r * r};
}

Vector3d capsule_shell_moments(double r, double length) {
  const double caps = 2 * r / (2 * r + length);
  const double tube = 1 - caps;
  // Half a sphere's shell has its centre at half its radius.
  const double across =
      tube * (6 * r * r + length * length) / 12 + caps * 2.0 / 3.0 * r * r + caps * length * (length + 2 * r) / 4;
  return {across, across, tube * r * r + caps * 2.0 / 3.0 * r * r};
}

Vector3d cylinder_shell_moments(double r, double h) {
  const double ends = r / (r + 2 * h);  // both; the side has the rest, h is half the height
  const double side = 1 - ends;
  const double across = side * (r * r / 2 + h * h / 3) + ends * (r * r / 4 + h * h);
  return {across, across, side * r * r + ends * r * r / 2};
}

/// Faces across x, y, z by their areas.
Vector3d box_shell_moments(const Vector3d& s) {
  const Vector3d areas(s.y() * s.z(), s.x() * s.z(), s.x() * s.y());
  Vector3d squares = Vector3d::Zero();  // mean of x², y², z² over the surface
  for (int face = 0; face < 3; ++face) {
    for (int k = 0; k < 3; ++k) squares[k] += areas[face] / areas.sum() * s[k] * s[k] * (k == face ? 1.0 : 1.0 / 3.0);
  }
  return squares.sum() * Vector3d::Ones() - squares;
}

bool has_extent(Shape shape) { return shape != Shape::kPlane && shape != Shape::kHeightField; }

double mass_of(const Geom& geom) {
  if (!has_extent(geom.shape)) return 0;
  return geom.mass ? *geom.mass : geom.sized ? geom.density * extent_of(geom) : 0;
}

}  // namespace

double extent_of(const Geom& geom) {
  const auto [a, b, c] = geom.size;
  switch (geom.shape) {
    case Shape::kSphere:
      return geom.shell ? 4 * kPi * a * a : 4 * kPi / 3 * a * a * a;
    case Shape::kCapsule:
      return geom.shell ? 4 * kPi * a * (a + b) : kPi * a * a * (4 * a / 3 + 2 * b);
    case Shape::kCylinder:
      return geom.shell ? 2 * kPi * a * (a + 2 * b) : kPi * a * a * 2 * b;
    case Shape::kEllipsoid:
      return geom.shell ? ellipsoid_area(a, b, c) : 4 * kPi / 3 * a * b * c;
    case Shape::kBox:
      return geom.shell ? 8 * (a * b + b * c + a * c) : 8 * a * b * c;
    case Shape::kPlane:
    case Shape::kHeightField:
    case Shape::kMesh:
    case Shape::kSdf:
      break;
  }
  return 0;
}

Vector3d unit_moments(const Geom& geom) {
  const Vector3d s(geom.size[0], geom.size[1], geom.size[2]);
  const double r = s[0], h = s[1];
  switch (geom.shape) {
    case Shape::kSphere:
      return (geom.shell ? 2.0 / 3.0 : 0.4) * r * r * Vector3d::Ones();
    case Shape::kCapsule:
      return geom.shell ? capsule_shell_moments(r, 2 * h) : capsule_moments(r, 2 * h);
    case Shape::kCylinder:
      if (geom.shell) return cylinder_shell_moments(r, h);
      return {(3 * r * r + 4 * h * h) / 12, (3 * r * r + 4 * h * h) / 12, r * r / 2};
    case Shape::kEllipsoid:
      if (geom.shell) return ellipsoid_shell_moments(s);
      return (s.squaredNorm() * Vector3d::Ones() - s.cwiseAbs2()) / 5;
    case Shape::kBox:
      if (geom.shell) return box_shell_moments(s);
      return (s.squaredNorm() * Vector3d::Ones() - s.cwiseAbs2()) / 3;
    case Shape::kPlane:
    case Shape::kHeightField:
    case Shape::kMesh:
    case Shape::kSdf:
      break;
  }
  return Vector3d::Zero();
}

bool is_unknown(const Geom& geom) {
  if (geom.sized || !has_extent(geom.shape)) return false;
  return geom.mass ? *geom.mass != 0 : geom.density != 0;
}

MassProperties mass_of(const std::vector<Geom>& geoms) {
  MassProperties all;
  for (const Geom& geom : geoms) {
    all.mass += mass_of(geom);
    all.com += mass_of(geom) * geom.X_BG.p;
  }
  if (all.mass <= 0) return {};
  all.com /= all.mass;
  for (const Geom& geom : geoms) {
    const double mass = mass_of(geom);
    if (mass == 0) continue;
    const Vector3d way = geom.X_BG.p - all.com;
    const Vector3d moments = mass * unit_moments(geom);
    all.inertia += geom.X_BG.R * moments.asDiagonal() * geom.X_BG.R.transpose() +
                   mass * (way.squaredNorm() * Matrix3d::Identity() - way * way.transpose());
  }
  return all;
}

void apply_bounds(const Settings& settings, MassProperties& mass) {
  mass.mass = std::max(mass.mass, settings.bound_mass);
  if (settings.bound_inertia <= 0 && !settings.balance_inertia) return;
  if (!mass.inertia.allFinite()) return;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(mass.inertia);
  Vector3d moments = solver.eigenvalues();
  if (moments[0] < settings.bound_inertia) moments = moments.cwiseMax(settings.bound_inertia);
  if (settings.balance_inertia && moments[0] + moments[1] < moments[2]) moments.setConstant(moments.mean());
  if (moments == solver.eigenvalues()) return;
  mass.inertia = solver.eigenvectors() * moments.asDiagonal() * solver.eigenvectors().transpose();
}

}  // namespace ferrers::mjcf
