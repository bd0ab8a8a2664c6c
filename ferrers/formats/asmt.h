#pragma once

#include <string_view>

#include "ferrers/formats/imported_model.h"

namespace ferrers {

/// Reads ASMT, the text format of OndselSolver, which FreeCAD's Assembly workbench exports.
///
/// Lengths are in millimetres where the first line is 'OndselSolver', in metres where it is that of askoh's freeCAD;
/// masses in kg, angles in rad. docs/formats/asmt.md says what is read and as what. Never throws for what a file holds.
/// Cost: linear in the file, times the logarithm of its number of names.
ImportedModel read_asmt(std::string_view text, const ImportContext& context);

}  // namespace ferrers
