#pragma once

#include <string>

namespace ferrers {

/// The JSON Schema (draft 2020-12) of the model file, from the table of fields; two-space indentation, one newline at
/// the end. It says what a model file may look like; units, names and physics are checked by the reader only.
std::string model_schema_json();

}  // namespace ferrers
