#pragma once

#include <string_view>

#include "ferrers/formats/imported_model.h"

namespace ferrers {

/// Reads MJCF.
ImportedModel read_mjcf(std::string_view text, const ImportContext& context);

}  // namespace ferrers
