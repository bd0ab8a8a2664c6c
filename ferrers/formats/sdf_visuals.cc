#include "ferrers/formats/sdf_visuals.h"

#include <optional>
#include <sstream>

namespace ferrers {
namespace {

using Kind = VisualShape::Kind;

/// Nothing for shapes that viewers here do not draw; these stay unread and are told with the others.
std::optional<VisualShape> read_shape(const SdfElement& geometry) {
  VisualShape shape;
  if (const SdfElement box = geometry.child("box")) {
    shape.kind = Kind::kBox;
    const Eigen::Vector3d size = box.vector("size").value_or(Eigen::Vector3d::Ones());
    shape.size = {size.x(), size.y(), size.z()};
  } else if (const SdfElement sphere = geometry.child("sphere")) {
    shape.kind = Kind::kSphere;
    shape.size = {sphere.number("radius", 1).value, 0, 0};
  } else if (const SdfElement cylinder = geometry.child("cylinder")) {
    shape.kind = Kind::kCylinder;
    shape.size = {cylinder.number("radius", 1).value, cylinder.number("length", 1).value, 0};
  } else if (const SdfElement capsule = geometry.child("capsule")) {
    shape.kind = Kind::kCapsule;
    shape.size = {capsule.number("radius", 0.5).value, capsule.number("length", 1).value, 0};
  } else if (const SdfElement ellipsoid = geometry.child("ellipsoid")) {
    shape.kind = Kind::kEllipsoid;
    const Eigen::Vector3d radii = ellipsoid.vector("radii").value_or(Eigen::Vector3d::Ones());
    shape.size = {radii.x(), radii.y(), radii.z()};
  } else if (const SdfElement mesh = geometry.child("mesh")) {
    shape.kind = Kind::kMesh;
    const Eigen::Vector3d scale = mesh.vector("scale").value_or(Eigen::Vector3d::Ones());
    shape.size = {scale.x(), scale.y(), scale.z()};
    const SdfElement uri = mesh.child("uri");
    if (!uri) return std::nullopt;
    shape.mesh = uri.text();
  } else {
    return std::nullopt;
  }
  return shape;
}

/// A colour of the drawing only: one that cannot be read is left out.
std::optional<std::array<double, 4>> read_colour(const SdfElement& visual) {
  const SdfElement material = visual.child("material");
  if (!material) return std::nullopt;
  material.xml().mark_read_with_all();
  const SdfElement diffuse = material.child("diffuse");
  if (!diffuse) return std::nullopt;
  Diagnostics ignored;
  const auto numbers = read_numbers(diffuse.xml().text(), {}, "", 0, ignored);
  if (!numbers || numbers->size() < 3) return std::nullopt;
  return std::array<double, 4>{(*numbers)[0], (*numbers)[1], (*numbers)[2], numbers->size() > 3 ? (*numbers)[3] : 1};
}

}  // namespace

void read_sdf_visuals(SdfTree& tree, const SdfLink& link, const std::string& body, const Pose& X_BL,
                      std::vector<VisualShape>& visuals) {
  for (const SdfElement& visual : link.element.children("visual")) {
    const SdfElement geometry = visual.child("geometry");
    std::optional<VisualShape> shape = geometry ? read_shape(geometry) : std::nullopt;
    if (!shape) continue;
    shape->body = body;
    shape->X_BS = X_BL;
    if (const SdfElement pose = visual.child("pose")) {
      const SdfReference base{pose.attribute("relative_to"), pose};
      const int scope = tree.frames[link.frame].scope;
      const std::optional<int> frame =
          base.name.empty() ? link.frame : tree.frames.find_or_tell(scope, base, "'relative_to'");
      const Pose X_LF =
          tree.frames.pose_in_world(link.frame).inverse() * tree.frames.pose_in_world(frame.value_or(link.frame));
      shape->X_BS = X_BL * X_LF * pose.pose();
    }
    shape->rgba = read_colour(visual);
    visuals.push_back(std::move(*shape));
  }
}

}  // namespace ferrers
