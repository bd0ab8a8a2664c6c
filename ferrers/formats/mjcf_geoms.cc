#include <fmt/format.h>

#include <algorithm>

#include "ferrers/formats/mjcf_tree.h"

namespace ferrers::mjcf {
namespace {

constexpr std::string_view kShapes[] = {"plane",    "hfield", "sphere", "capsule", "ellipsoid",
                                        "cylinder", "box",    "mesh",   "sdf"};

/// How many sizes a shape needs, and how many where its length is between two points.
std::size_t sizes_of(Shape shape, bool spanned) {
  switch (shape) {
    case Shape::kSphere:
      return 1;
    case Shape::kCapsule:
    case Shape::kCylinder:
      return spanned ? 1 : 2;
    case Shape::kEllipsoid:
    case Shape::kBox:
      return spanned ? 1 : 3;
    default:
      return 0;
  }
}

/// The frame in the middle between two points, z from the first to the second; returns half their distance.
double place_between(const std::vector<double>& points, const Attributes& attributes, Pose& X) {
  const Vector3d from(points.data()), to(points.data() + 3);
  X.p = 0.5 * from + 0.5 * to;
  if ((to - from).stableNorm() > 1e-14) {
    X.R = rotation_to(to - from);
  } else {
    const Element source = attributes.source("fromto");
    source.diagnostics().error("F321", source.attribute_at("fromto"), "the two points of 'fromto' coincide");
  }
  return 0.5 * (to - from).stableNorm();
}

void read_size(const Attributes& attributes, std::optional<double> half_length, Geom& geom) {
  const std::size_t needed = sizes_of(geom.shape, half_length.has_value());
  if (needed == 0 || !geom.sized) return;
  const std::vector<double> size = attributes.layered("size", 3);
  const Element from = attributes.source("size");
  if (!from) {
    geom.element.diagnostics().error(
        "F202", geom.element.at(),
        fmt::format("the {} <geom> has no 'size'", kShapes[static_cast<std::size_t>(geom.shape)]));
  }
  if (size.empty()) return;
  if (size.size() < needed) {
    from.diagnostics().error("F208", from.attribute_at("size"),
                             fmt::format("'size' of a {} has {} numbers, not {}",
                                         kShapes[static_cast<std::size_t>(geom.shape)], size.size(), needed));
    return;
  }
  if (std::any_of(size.begin(), size.begin() + static_cast<std::ptrdiff_t>(needed), [](double s) { return s <= 0; })) {
    from.diagnostics().error("F311", from.attribute_at("size"), "a size of a <geom> is not positive");
    return;
  }
  std::copy(size.begin(), size.end(), geom.size.begin());
  if (!half_length) return;
  const bool round = geom.shape == Shape::kCapsule || geom.shape == Shape::kCylinder;
  if (!round) geom.size[1] = geom.size[0];
  geom.size[round ? 1 : 2] = *half_length;
}

bool can_span(Shape shape) {
  return shape == Shape::kCapsule || shape == Shape::kCylinder || shape == Shape::kEllipsoid || shape == Shape::kBox;
}

}  // namespace

Geom read_geom(const Attributes& attributes, const Settings& settings) {
  Geom geom;
  geom.element = attributes.element();
  geom.shape = static_cast<Shape>(attributes.choice("type", kShapes, static_cast<int>(Shape::kSphere)));
  geom.mesh = attributes.text("mesh").value_or("");
  geom.sized = geom.mesh.empty() && geom.shape != Shape::kMesh && geom.shape != Shape::kSdf;
  geom.X_BG = read_pose(attributes, settings);
  std::optional<double> half_length;
  const auto points = attributes.numbers("fromto", 6, 6);
  if (points && can_span(geom.shape)) half_length = place_between(*points, attributes, geom.X_BG);
  read_size(attributes, half_length, geom);
  if (attributes.has("mass")) geom.mass = attributes.number("mass", 0);
  geom.density = attributes.number("density", 1000);
  geom.shell = attributes.truth("shellinertia", false);
  geom.group = attributes.number("group", 0);
  if (geom.mass.value_or(0) < 0 || geom.density < 0) {
    const Element from = attributes.source(geom.mass ? "mass" : "density");
    from.diagnostics().error("F311", from.attribute_at(geom.mass ? "mass" : "density"),
                             "the mass of a <geom> is negative");
  }
  if (const auto rgba = attributes.numbers("rgba", 4, 4)) {
    geom.rgba = {(*rgba)[0], (*rgba)[1], (*rgba)[2], (*rgba)[3]};
  }
  return geom;
}

MassProperties read_inertial(const Element& element, const Settings& settings) {
  const Attributes attributes(element);
  MassProperties mass;
  for (const char* needed : {"pos", "mass"}) {
    if (attributes.has(needed)) continue;
    element.diagnostics().error("F202", element.at(), fmt::format("<inertial> has no '{}'", needed));
  }
  mass.mass = attributes.number("mass", 0);
  if (mass.mass < 0) {
    element.diagnostics().error("F311", element.attribute_at("mass"), "the mass of a body is negative");
  }
  const Pose X = read_pose(attributes, settings);
  mass.com = X.p;
  const auto diagonal = attributes.numbers("diaginertia", 3, 3);
  const auto full = attributes.numbers("fullinertia", 6, 6);
  if (attributes.has("diaginertia") && attributes.has("fullinertia")) {
    element.diagnostics().error("F211", element.attribute_at("fullinertia"),
                                "<inertial> has both 'diaginertia' and 'fullinertia'", "keep one of them");
  } else if (diagonal) {
    mass.inertia = X.R * Vector3d(diagonal->data()).asDiagonal() * X.R.transpose();
  } else if (full) {
    const std::vector<double>& f = *full;
    mass.inertia << f[0], f[3], f[4], f[3], f[1], f[5], f[4], f[5], f[2];
    if (!X.R.isIdentity(0)) {
      element.diagnostics().error("F211", element.attribute_at("fullinertia"),
                                  "<inertial> has both 'fullinertia' and an orientation",
                                  "'fullinertia' is in the body's axes; MuJoCo refuses this too");
    }
  } else if (!attributes.has("diaginertia") && !attributes.has("fullinertia")) {
    element.diagnostics().notice("F603", element.at(), "an <inertial> without moments is a point mass");
  }
  return mass;
}

}  // namespace ferrers::mjcf
