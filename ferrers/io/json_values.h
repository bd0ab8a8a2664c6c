#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "ferrers/core/diagnostics.h"

/// JSON values that several writers share. Internal to the writers: the public headers return text.
namespace ferrers {

using OrderedJson = nlohmann::ordered_json;

OrderedJson diagnostics_value(const Diagnostics& diagnostics);

/// The text of an object as every file and command writes it: two-space indentation, one newline at the end, broken
/// UTF-8 replaced, numbers that are not finite as null.
std::string json_text(const OrderedJson& value);

}  // namespace ferrers
