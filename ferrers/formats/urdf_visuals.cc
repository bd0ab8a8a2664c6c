#include <fmt/format.h>

#include <map>

#include "ferrers/formats/urdf_import.h"
#include "ferrers/formats/urdf_values.h"

namespace ferrers {
namespace {

using Colour = std::array<double, 4>;
using Colours = std::map<std::string, Colour, std::less<>>;

std::optional<Colour> read_colour(const XmlElement& material, Diagnostics& diagnostics) {
  const XmlElement colour = material.child("color");
  if (!colour) return std::nullopt;
  const auto rgba = required_attribute(colour, "rgba", diagnostics);
  if (!rgba) return std::nullopt;
  const auto four = read_numbers(*rgba, colour.attribute_at("rgba"), "'rgba' of <color>", 4, diagnostics);
  if (!four) return std::nullopt;
  return Colour{(*four)[0], (*four)[1], (*four)[2], (*four)[3]};
}

/// Colours have names: a material is defined once, beside the links or in the first visual that shows it.
Colours read_colours(const UrdfImport& import) {
  Colours colours;
  const auto add = [&](const XmlElement& material) {
    const auto name = material.attribute("name");
    const auto colour = read_colour(material, import.diagnostics());
    if (name && !name->empty() && colour) colours.emplace(*name, *colour);
  };
  for (const XmlElement& material : import.robot.children("material")) add(material);
  for (const UrdfLink& link : import.tree.links) {
    for (const XmlElement& visual : link.element.children("visual")) {
      if (const XmlElement material = visual.child("material")) add(material);
    }
  }
  return colours;
}

double size(const XmlElement& element, std::string_view name, Diagnostics& diagnostics) {
  return required_number(element, name, diagnostics).value_or(Number(1)).value;
}

/// What `<geometry>` holds; false where it is nothing that is known.
bool read_geometry(const XmlElement& geometry, VisualShape& shape, Diagnostics& diagnostics) {
  using Kind = VisualShape::Kind;
  const auto take = [&shape](const Eigen::Vector3d& v) { shape.size = {v.x(), v.y(), v.z()}; };
  if (const XmlElement box = geometry.child("box")) {
    shape.kind = Kind::kBox;
    if (required_attribute(box, "size", diagnostics)) {
      take(attribute_vector(box, "size", Eigen::Vector3d::Ones(), diagnostics));
    }
  } else if (const XmlElement sphere = geometry.child("sphere")) {
    shape.kind = Kind::kSphere;
    shape.size = {size(sphere, "radius", diagnostics), 0, 0};
  } else if (const XmlElement mesh = geometry.child("mesh")) {
    shape.kind = Kind::kMesh;
    shape.mesh = required_attribute(mesh, "filename", diagnostics).value_or("");
    take(attribute_vector(mesh, "scale", Eigen::Vector3d::Ones(), diagnostics));
  } else if (const XmlElement cylinder = geometry.child("cylinder")) {
    shape.kind = Kind::kCylinder;
    shape.size = {size(cylinder, "radius", diagnostics), size(cylinder, "length", diagnostics), 0};
  } else if (const XmlElement capsule = geometry.child("capsule")) {
    shape.kind = Kind::kCapsule;
    shape.size = {size(capsule, "radius", diagnostics), size(capsule, "length", diagnostics), 0};
  } else {
    return false;  // the element is told as unread
  }
  return true;
}

}  // namespace

void import_urdf_visuals(UrdfImport& import) {
  Diagnostics& diagnostics = import.diagnostics();
  const Colours colours = read_colours(import);
  UrdfTally meshes;
  for (const UrdfLink& link : import.tree.links) {
    for (const XmlElement& visual : link.element.children("visual")) {
      VisualShape shape;
      shape.body = link.body;
      shape.X_BS = read_origin(visual, diagnostics);
      visual.attribute("name");  // nothing refers to it
      const XmlElement geometry = required_child(visual, "geometry", diagnostics);
      if (!geometry || !read_geometry(geometry, shape, diagnostics)) continue;
      if (const XmlElement material = visual.child("material")) {
        shape.rgba = read_colour(material, diagnostics);
        const auto found = colours.find(material.attribute("name").value_or(""));
        if (!shape.rgba && found != colours.end()) shape.rgba = found->second;
      }
      if (shape.kind == VisualShape::Kind::kMesh) meshes.add(geometry.child("mesh").attribute_at("filename"));
      import.model.visuals.push_back(std::move(shape));
    }
  }
  if (meshes.count > 0) {
    diagnostics.notice("F603", meshes.first,
                       fmt::format("shapes of links are kept as names of {} mesh file{}, which are not opened",
                                   meshes.count, meshes.count == 1 ? "" : "s"));
  }
}

}  // namespace ferrers
