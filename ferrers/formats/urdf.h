#pragma once

#include <string_view>

#include "ferrers/formats/imported_model.h"

namespace ferrers {

/// Reads URDF.
ImportedModel read_urdf(std::string_view text, const ImportContext& context);

}  // namespace ferrers
