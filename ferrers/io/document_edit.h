#pragma once

#include <string>
#include <vector>

#include "ferrers/core/diagnostics.h"
#include "ferrers/io/document.h"

namespace ferrers {

/// Changes values of a document: each edit is 'path=value' with a path like `bodies.crank.mass` or
/// `bodies.crank.com[0]` (list entries count from 0) and a value in YAML. All of the path must exist but for the last
/// key of a map that is not a map of names (`bodies`, `joints`, ...). Errors are F217 without a place.
///
/// Edited values have no place in the file: their `at` has line 0 and column −(number of the edit, from 1), from which
/// `name_edits` finds the edit that a message is about.
void edit_document(DocumentNode& root, const std::vector<std::string>& edits, Diagnostics& diagnostics);

/// Says in messages about edited values which edit they come from.
Diagnostics name_edits(const Diagnostics& diagnostics, const std::vector<std::string>& edits);

}  // namespace ferrers
