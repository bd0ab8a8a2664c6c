#include "ferrers/formats/writers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "ferrers/formats/drawn_zero.h"
#include "ferrers/formats/mjcf_writer.h"
#include "ferrers/formats/urdf_writer.h"
#include "ferrers/io/model_writer.h"
#include "ferrers/model/model.h"

namespace ferrers {
namespace {

std::vector<WrittenFile> urdf_files(const ModelSpec& spec, const std::filesystem::path& path,
                                    std::span<const VisualShape> visuals, Diagnostics& diagnostics) {
  ModelBuildResult built = build_model(spec);
  if (const auto zero = built.model ? move_zeros_to_drawing(*built.model) : std::nullopt) {
    diagnostics.notice("F607", {},
                       fmt::format("URDF starts with all coordinates at zero: those of {} are zero where the model is "
                                   "drawn, their limits moved along",
                                   fmt::join(zero->moved, ", ")));
    built = build_model(zero->spec);
  }
  if (!built.model) {
    diagnostics.append(built.diagnostics);
    return {};
  }
  const UrdfText text = write_urdf(*built.model, visuals, diagnostics);
  std::vector<WrittenFile> files = {{path.string(), text.urdf}};
  if (text.closures.empty()) return files;
  std::filesystem::path beside = path;
  if (!path.empty()) beside.replace_extension(".closures.yaml");
  files.push_back({beside.string(), text.closures});
  return files;
}

}  // namespace

std::vector<ModelFormat> written_formats() { return {ModelFormat::kNative, ModelFormat::kUrdf, ModelFormat::kMjcf}; }

std::string format_word(ModelFormat format) {
  std::string word(format_name(format));
  std::transform(word.begin(), word.end(), word.begin(), [](unsigned char c) { return std::tolower(c); });
  return word;
}

std::vector<std::string> written_format_words() {
  std::vector<std::string> words;
  for (const ModelFormat format : written_formats()) words.push_back(format_word(format));
  return words;
}

std::vector<WrittenFile> write_any_model(const ModelSpec& spec, ModelFormat format, const std::filesystem::path& path,
                                         std::span<const VisualShape> visuals, Diagnostics& diagnostics) {
  if (!visuals.empty() && format != ModelFormat::kUrdf) {
    diagnostics.notice("F607", {},
                       fmt::format("{} shapes of bodies, which are looks only, are not written", visuals.size()));
  }
  if (format == ModelFormat::kNative) return {{path.string(), write_model(spec)}};
  ModelSpec parts = spec;
  keep_welds(parts);
  if (format == ModelFormat::kUrdf) return urdf_files(parts, path, visuals, diagnostics);
  if (format == ModelFormat::kMjcf) return {{path.string(), write_mjcf(parts, diagnostics)}};
  diagnostics.error("F607", {}, std::string(format_name(format)) + " cannot be written", "it can be read only");
  return {};
}

}  // namespace ferrers
