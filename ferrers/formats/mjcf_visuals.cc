#include <map>

#include "ferrers/formats/mjcf_import.h"

namespace ferrers::mjcf {
namespace {

struct MeshAsset {
  std::string file;
  std::array<double, 3> scale = {1, 1, 1};
};

std::string stem_of(const std::string& file) {
  const std::size_t slash = file.find_last_of("/\\");
  const std::string name = slash == std::string::npos ? file : file.substr(slash + 1);
  return name.substr(0, name.find_last_of('.'));
}

std::map<std::string, MeshAsset> read_meshes(const Import& import) {
  std::map<std::string, MeshAsset> meshes;
  for (const Element& section : import.root.children("asset")) {
    for (const Element& element : section.children("mesh")) {
      MeshAsset mesh;
      mesh.file = element.text_of("file");
      const std::string name = element.text_of("name");
      const Vector3d scale = Attributes(element).vector("scale", Vector3d::Ones());
      mesh.scale = {scale.x(), scale.y(), scale.z()};
      const std::string folder = import.settings.mesh_folder;
      const std::string key = name.empty() ? stem_of(mesh.file) : name;
      if (!folder.empty() && !mesh.file.empty()) {
        mesh.file = folder + (folder.back() == '/' ? "" : "/") + mesh.file;
      }
      meshes.emplace(key, mesh);
    }
  }
  return meshes;
}

/// Nothing for planes, height fields and signed distances.
std::optional<VisualShape> shape_of(const Geom& geom, const std::map<std::string, MeshAsset>& meshes) {
  using Kind = VisualShape::Kind;
  VisualShape shape;
  shape.X_BS = geom.X_BG;
  shape.rgba = geom.rgba;
  const auto [a, b, c] = geom.size;
  if (!geom.sized) {
    const auto found = meshes.find(geom.mesh);
    if (geom.shape == Shape::kSdf || found == meshes.end() || found->second.file.empty()) return std::nullopt;
    shape.kind = Kind::kMesh;
    shape.mesh = found->second.file;
    shape.size = found->second.scale;
    return shape;
  }
  switch (geom.shape) {
    case Shape::kSphere:
      shape.kind = Kind::kSphere, shape.size = {a, a, a};
      return shape;
    case Shape::kCapsule:
      shape.kind = Kind::kCapsule, shape.size = {a, 2 * b, 0};
      return shape;
    case Shape::kCylinder:
      shape.kind = Kind::kCylinder, shape.size = {a, 2 * b, 0};
      return shape;
    case Shape::kEllipsoid:
      shape.kind = Kind::kEllipsoid, shape.size = {a, b, c};
      return shape;
    case Shape::kBox:
      shape.kind = Kind::kBox, shape.size = {2 * a, 2 * b, 2 * c};
      return shape;
    case Shape::kPlane:
    case Shape::kHeightField:
    case Shape::kMesh:
    case Shape::kSdf:
      break;
  }
  return std::nullopt;
}

}  // namespace

void add_visuals(Import& import) {
  const std::map<std::string, MeshAsset> meshes = read_meshes(import);
  for (const TreeBody& body : import.tree.bodies) {
    for (const Geom& geom : body.geoms) {
      std::optional<VisualShape> shape = shape_of(geom, meshes);
      if (!shape) continue;
      shape->body = body.name;
      import.result.visuals.push_back(std::move(*shape));
    }
  }
}

}  // namespace ferrers::mjcf
