#pragma once

#include <string>
#include <string_view>

#include "ferrers/core/diagnostics.h"
#include "ferrers/dynamics/equations_report.h"

namespace ferrers {

/// What `ferrers equations` tells of one model at one state. What is not known is null in the object, `?` in LaTeX,
/// never invented: a multiplier that is not unique has no value.
struct EquationsDocument {
  std::string model;                         ///< Empty: not known, the file could not be read.
  const DynamicsModel* dynamics = nullptr;   ///< Null with `report`.
  const EquationsReport* report = nullptr;   ///< Null: there is none.
  const Diagnostics* diagnostics = nullptr;  ///< Null: none.
};

/// "solved", "singular_mass" and so on.
std::string_view equations_status_name(EquationsStatus status);

/// Where a drive's effort comes from: "found" (as the motion needs it), "shared" (found, one choice of many), "law", or
/// "none" (zero, for want of a law).
std::string_view effort_source(const DynamicsModel& model, const EquationsReport& report, int drive);

/// What a group of the system is in the paper: "phi(q) = 0" for 6, and so on to 9 [stepanyan, eqs. (6)-(9)].
std::string_view equation_text(int equation);

/// The JSON object of schema `ferrers.equations/1` (schemas/equations.schema.json); matrices as lists of rows.
/// `ok`: solved, and no diagnostic is an error. Cost: linear in the entries.
std::string write_equations_json(const EquationsDocument& document);

/// The equations with their numbers as LaTeX: a document that compiles by itself with amsmath, or only its body.
/// Numbers have six significant digits; wide matrices are split into groups of columns. `document.report` must not be
/// null.
std::string write_equations_latex(const EquationsDocument& document, bool standalone = true);

}  // namespace ferrers
