#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ferrers/formats/imported_model.h"
#include "ferrers/io/model_reader.h"

/// Model files of every kind that is understood: the native format, URDF, MJCF, SDF and ASMT.
namespace ferrers {

enum class ModelFormat { kNative, kUrdf, kMjcf, kSdf, kAsmt };

std::string_view format_name(ModelFormat format);  ///< "native", "URDF", ...

/// What numbers of such files are good to, relative to the model's size and in rad: 0 for the native format, where they
/// mean what they say; 1e-6 for what CAD writes; 1e-5 for formats in which people type angles such as 1.5708.
double usual_geometric_tolerance(ModelFormat format);

/// By the name's ending (.urdf, .mjcf, .sdf, .world, .asmt); of other files by what they begin with: the root element
/// of XML, the first line of ASMT, else the native format.
ModelFormat format_of(const std::filesystem::path& path, std::string_view text);

struct ModelFile {
  ModelReadResult read;  ///< The model, its specification, diagnostics with places in the file, the text.
  ModelFormat format = ModelFormat::kNative;
  std::vector<RenamedThing> renamed;
  std::vector<VisualShape> visuals;
};

/// Reads a model file of any format. Parameters and edits of `options` act on a foreign file as on the native file that
/// `write_model` makes of it. All errors at once; nothing throws. Cost: linear in its size.
ModelFile read_any_model_file(const std::filesystem::path& path, const ReadModelOptions& options = {},
                              const ImportOptions& import = {});

/// The same from a text; `load` gives further files that it names.
ModelFile read_any_model_text(std::string text, std::string name, ModelFormat format, const FileLoader& load,
                              const ReadModelOptions& options = {}, const ImportOptions& import = {});

}  // namespace ferrers
