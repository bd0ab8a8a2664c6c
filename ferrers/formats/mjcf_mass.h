#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "ferrers/formats/mjcf_values.h"

/// Masses and inertias as MuJoCo's compiler finds them.
namespace ferrers::mjcf {

enum class Shape { kPlane, kHeightField, kSphere, kCapsule, kEllipsoid, kCylinder, kBox, kMesh, kSdf };

/// A geom in its body's frame.
struct Geom {
  Shape shape = Shape::kSphere;
  std::array<double, 3> size = {0, 0, 0};  ///< Radius or half lengths, as MJCF has them.
  Pose X_BG;
  std::optional<double> mass;
  double density = 1000;
  bool shell = false;  ///< The mass sits on the surface.
  double group = 0;
  bool sized = true;  ///< False: its size is that of a mesh, which is not loaded.
  std::string mesh;
  std::optional<std::array<double, 4>> rgba;
  Element element;
};

struct MassProperties {
  double mass = 0;
  Vector3d com = Vector3d::Zero();      ///< In the body's frame.
  Matrix3d inertia = Matrix3d::Zero();  ///< About the mass centre, body axes.
};

/// Volume, or area where the mass sits on the surface; 0 for what has no mass. The area of an ellipsoid is Thomsen's
/// approximation, as in MuJoCo.
double extent_of(const Geom& geom);

/// Moments of a uniform shape of unit mass about its own axes.
Vector3d unit_moments(const Geom& geom);

/// Of all geoms together; each with its own mass, else by density. Cost: O(geoms).
MassProperties mass_of(const std::vector<Geom>& geoms);

/// Whether the mass of a geom depends on a mesh.
bool is_unknown(const Geom& geom);

/// Lower bounds and balancing as <compiler> asks for.
void apply_bounds(const Settings& settings, MassProperties& mass);

}  // namespace ferrers::mjcf
