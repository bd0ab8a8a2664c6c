#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ferrers/formats/formats.h"

/// Models written in any format that can be written.
namespace ferrers {

struct WrittenFile {
  std::string name;  ///< Path; empty where none was asked for.
  std::string text;
};

/// The formats that can be written, and their words on a command line ("native", "urdf", "mjcf").
std::vector<ModelFormat> written_formats();
std::vector<std::string> written_format_words();
std::string format_word(ModelFormat format);

/// Writes a specification that builds. What the format cannot say is told with F607: as a warning where the written
/// mechanism is another one without it, as a notice else. `path`: of the model's file, by which a second file beside it
/// (the closures of a URDF) is named. `visuals`: looks of the bodies. Cost: linear.
std::vector<WrittenFile> write_any_model(const ModelSpec& spec, ModelFormat format, const std::filesystem::path& path,
                                         std::span<const VisualShape> visuals, Diagnostics& diagnostics);

}  // namespace ferrers
