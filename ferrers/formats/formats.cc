#include "ferrers/formats/formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <set>
#include <string>
#include <utility>

#include "ferrers/formats/asmt.h"
#include "ferrers/formats/mjcf.h"
#include "ferrers/formats/sdf.h"
#include "ferrers/formats/urdf.h"
#include "ferrers/io/model_writer.h"
#include "ferrers/io/text_file.h"

namespace ferrers {
namespace {

namespace fs = std::filesystem;

struct FormatEntry {
  ModelFormat format;
  std::string_view name;
  std::vector<std::string_view> endings;
  std::string_view root;  ///< Of its XML.
  ImportedModel (*read)(std::string_view, const ImportContext&);
};

const std::vector<FormatEntry>& entries() {
  static const std::vector<FormatEntry> all = {
      {ModelFormat::kNative, "native", {}, "", nullptr},
      {ModelFormat::kUrdf, "URDF", {".urdf"}, "<robot", &read_urdf},
      {ModelFormat::kMjcf, "MJCF", {".mjcf"}, "<mujoco", &read_mjcf},
      {ModelFormat::kSdf, "SDF", {".sdf", ".world"}, "<sdf", &read_sdf},
      {ModelFormat::kAsmt, "ASMT", {".asmt"}, "", &read_asmt},
  };
  return all;
}

const FormatEntry& entry(ModelFormat format) { return entries()[static_cast<std::size_t>(format)]; }

/// Further files are looked for beside the model and below, and nowhere else, but for one that the user named.
FileLoader loader_beside(const fs::path& model, const std::optional<fs::path>& named) {
  return [folder = model.parent_path(), named](const std::string& path) -> std::optional<std::string> {
    Diagnostics ignored;
    if (named && path == named->string()) return load_text_file(*named, ignored);
    const fs::path asked = fs::path(path).lexically_normal();
    if (asked.is_absolute() || (!asked.empty() && *asked.begin() == "..")) return std::nullopt;
    return load_text_file(folder / asked, ignored);
  };
}

/// The file of closures of a URDF file: as it is written beside it, or of the same name, else `robot.yaml` where that
/// is no other file's.
std::optional<fs::path> closures_beside(const fs::path& model) {
  std::error_code ignored;
  for (const char* ending : {".closures.yaml", ".yaml"}) {
    fs::path beside = model;
    beside.replace_extension(ending);
    if (fs::exists(beside, ignored)) return beside;
  }
  const fs::path folder = model.parent_path();
  if (fs::exists(folder / "robot.yaml", ignored) && !fs::exists(folder / "robot.urdf", ignored)) {
    return folder / "robot.yaml";
  }
  return std::nullopt;
}

ReadModelOptions with_welds(ReadModelOptions options, const ImportOptions& import) {
  options.keep_welds = options.keep_welds || import.keep_welds;
  return options;
}

/// Whether the file of a shape is there: beside the model, or in a package that holds the model.
bool mesh_is_there(const fs::path& folder, std::string mesh) {
  bool in_package = false;
  for (const std::string_view scheme : {"file://", "package://", "model://"}) {
    if (mesh.rfind(scheme, 0) != 0) continue;
    mesh.erase(0, scheme.size());
    in_package = scheme != "file://";
  }
  std::error_code ignored;
  if (!in_package) return fs::exists(folder / mesh, ignored);
  const std::size_t slash = mesh.find('/');
  const std::string inside = slash == std::string::npos ? mesh : mesh.substr(slash + 1);
  for (fs::path up = fs::absolute(folder / ".", ignored).lexically_normal(); up.has_relative_path();
       up = up.parent_path()) {
    if (fs::exists(up / mesh, ignored) || fs::exists(up / inside, ignored)) return true;
  }
  return false;
}

void tell_missing_meshes(const fs::path& folder, ModelFile& file) {
  std::set<std::string> missing;
  for (const VisualShape& shape : file.visuals) {
    if (shape.kind != VisualShape::Kind::kMesh || mesh_is_there(folder, shape.mesh)) continue;
    missing.insert(shape.mesh);
  }
  if (missing.empty()) return;
  file.read.diagnostics.notice(
      "F606", {},
      fmt::format("{} of shapes cannot be found, '{}' first: they are not needed for anything but looks",
                  missing.size() == 1 ? "a file" : fmt::format("{} files", missing.size()), *missing.begin()));
}

void append_sorted(Diagnostics& to, const Diagnostics& more) {
  to.append(more);
  to.sort_by_place();
}

}  // namespace

std::string_view format_name(ModelFormat format) { return entry(format).name; }

double usual_geometric_tolerance(ModelFormat format) {
  if (format == ModelFormat::kNative) return 0;
  return format == ModelFormat::kAsmt ? 1e-6 : 1e-5;
}

ModelFormat format_of(const fs::path& path, std::string_view text) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  for (const FormatEntry& one : entries()) {
    if (std::find(one.endings.begin(), one.endings.end(), ending) != one.endings.end()) return one.format;
  }
  const std::size_t begins = text.find_first_not_of("\xEF\xBB\xBF \t\r\n");
  const std::string_view contents = begins == std::string_view::npos ? "" : text.substr(begins);
  if (contents.rfind("OndselSolver", 0) == 0 || contents.rfind("freeCAD:", 0) == 0) return ModelFormat::kAsmt;
  if (ending != ".xml" && contents.rfind('<', 0) != 0) return ModelFormat::kNative;
  std::size_t first = std::string_view::npos;
  ModelFormat found = ModelFormat::kMjcf;
  for (const FormatEntry& one : entries()) {
    const std::size_t at = one.root.empty() ? std::string_view::npos : text.find(one.root);
    if (at < first) first = at, found = one.format;
  }
  return found;
}

ModelFile read_any_model_text(std::string text, std::string name, ModelFormat format, const FileLoader& load,
                              const ReadModelOptions& options, const ImportOptions& import) {
  ModelFile file;
  file.format = format;
  if (format == ModelFormat::kNative) {
    file.read = read_model_text(std::move(text), std::move(name), with_welds(options, import));
    return file;
  }
  file.read.source = std::move(text);
  file.read.diagnostics.set_file(name);
  ImportedModel imported = entry(format).read(file.read.source, {import, load, file.read.diagnostics});
  if (imported.spec.name.empty()) imported.spec.name = fs::path(name).stem().string();
  file.renamed = std::move(imported.renamed);
  file.visuals = std::move(imported.visuals);
  file.read.spec = std::move(imported.spec);
  if (import.keep_welds) keep_welds(file.read.spec);
  file.read.diagnostics.sort_by_place();
  if (file.read.diagnostics.has_errors()) return file;
  if (!options.edits.empty() || !options.parameter_texts.empty() || !options.parameters.empty()) {
    const Diagnostics told = file.read.diagnostics;
    file.read = read_model_text(write_model(file.read.spec), name + " in the native format", options);
    if (!file.read.diagnostics.has_errors()) file.read.diagnostics = told;
    return file;
  }
  ModelBuildResult built = build_model(file.read.spec);
  append_sorted(file.read.diagnostics, built.diagnostics);
  if (!file.read.diagnostics.has_errors()) file.read.model = std::move(built.model);
  return file;
}

ModelFile read_any_model_file(const fs::path& path, const ReadModelOptions& options, const ImportOptions& import) {
  Diagnostics diagnostics(path.string());
  std::optional<std::string> text = load_text_file(path, diagnostics);
  if (!text) {
    ModelFile failed;
    failed.read.diagnostics = std::move(diagnostics);
    return failed;
  }
  const ModelFormat format = format_of(path, *text);
  if (format == ModelFormat::kNative) {
    ModelFile file;
    file.read = read_model_file(path, with_welds(options, import));
    return file;
  }
  ImportOptions own = import;
  if (format == ModelFormat::kUrdf && !own.closures) {
    own.closures = closures_beside(path);
    own.closures_may_be_another_file = true;
  }
  ModelFile file =
      read_any_model_text(std::move(*text), path.string(), format, loader_beside(path, own.closures), options, own);
  tell_missing_meshes(path.parent_path(), file);
  return file;
}

}  // namespace ferrers
