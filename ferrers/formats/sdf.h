#pragma once

#include <string_view>

#include "ferrers/formats/imported_model.h"

namespace ferrers {

/// Reads SDF, as Gazebo and Drake use it: versions 1.3 to 1.12. docs/formats/sdf.md tells what is read.
///
/// Errors: F1xx of XML, F2xx of values, F302, F316, F319, F322, F327, F602, F604 to F606. Cost: O(n log n) in its size.
ImportedModel read_sdf(std::string_view text, const ImportContext& context);

}  // namespace ferrers
