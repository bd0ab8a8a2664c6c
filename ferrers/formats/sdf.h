#pragma once

#include <string_view>

#include "ferrers/formats/imported_model.h"

namespace ferrers {

/// Reads SDF.
ImportedModel read_sdf(std::string_view text, const ImportContext& context);

}  // namespace ferrers
