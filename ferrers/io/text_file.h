#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "ferrers/core/diagnostics.h"

namespace ferrers {

/// The whole text of a model file. Errors: F101 where it cannot be read, F102 where it is larger than a model file may
/// be (`DocumentLimits::bytes`). Cost: linear in its size.
std::optional<std::string> load_text_file(const std::filesystem::path& path, Diagnostics& diagnostics);

}  // namespace ferrers
