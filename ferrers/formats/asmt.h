#pragma once

#include <string_view>

#include "ferrers/formats/imported_model.h"

namespace ferrers {

/// Reads ASMT.
ImportedModel read_asmt(std::string_view text, const ImportContext& context);

}  // namespace ferrers
