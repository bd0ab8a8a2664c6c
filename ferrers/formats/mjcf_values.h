#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ferrers/formats/mjcf_document.h"
#include "ferrers/math/rotation.h"

namespace ferrers::mjcf {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// The attributes of an element: its own, then those of its default class and of the classes around that.
class Attributes {
 public:
  explicit Attributes(Element own, std::vector<Element> defaults = {});

  const Element& element() const { return sources_.front(); }
  /// Where the attribute comes from: the element itself, a default, or nothing.
  Element source(std::string_view name) const;
  bool has(std::string_view name) const { return source(name).exists(); }
  std::optional<std::string> text(std::string_view name) const;

  /// Between `least` and `most` numbers. Errors: F206, F208.
  std::optional<std::vector<double>> numbers(std::string_view name, std::size_t least, std::size_t most) const;
  /// At most `most` numbers; where the element gives fewer than its defaults, the last ones of these stay, as in
  /// MuJoCo.
  std::vector<double> layered(std::string_view name, std::size_t most) const;
  double number(std::string_view name, double otherwise) const;
  Vector3d vector(std::string_view name, const Vector3d& otherwise) const;
  /// One of `choices`, by its index. Error: F209.
  int choice(std::string_view name, std::span<const std::string_view> choices, int otherwise) const;
  bool truth(std::string_view name, bool otherwise) const;  ///< "true" or "false".

  const std::vector<Element>& sources() const { return sources_; }

 private:
  std::vector<Element> sources_;
};

/// What <compiler> and <option> say, as far as it matters here.
struct Settings {
  enum class InertiaFromGeom { kNever, kAlways, kAuto };
  double angle_unit = 3.14159265358979323846 / 180;  ///< In rad.
  std::string eulerseq = "xyz";
  bool autolimits = true;
  InertiaFromGeom inertia_from_geom = InertiaFromGeom::kAuto;
  double bound_mass = 0, bound_inertia = 0, total_mass = -1;
  bool balance_inertia = false;
  double lowest_group = 0, highest_group = 5;
  std::string mesh_folder;
  Vector3d gravity = Vector3d(0, 0, -9.81);
  bool equality = true, springs = true, damping = true, limits = true;
};

Settings read_settings(const Element& root);

/// The rotation that `quat`, `axisangle`, `xyaxes`, `zaxis` or `euler` says; the identity where none of them stands.
/// The element's own form counts before that of a default. Errors: F211 for two forms, F318 for directions of no
/// length, F206, F208.
Matrix3d read_rotation(const Attributes& attributes, const Settings& settings);

/// `pos` and the rotation.
Pose read_pose(const Attributes& attributes, const Settings& settings);

/// The smallest rotation that turns z into `direction` (not zero).
Matrix3d rotation_to(const Vector3d& direction);

/// Rotations about x, y, z (moving axes) and X, Y, Z (fixed axes) in the order of `sequence`.
Matrix3d euler_rotation(const std::string& sequence, const Vector3d& angles_rad);

}  // namespace ferrers::mjcf
