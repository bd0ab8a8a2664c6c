#pragma once

#include <string>
#include <vector>

#include "ferrers/core/diagnostics.h"
#include "ferrers/redundancy/consistent_geometry.h"
#include "ferrers/redundancy/mechanism_analysis.h"

namespace ferrers {

/// What `ferrers.analyze/1` tells of one model. What is not known is null in the object, never invented.
struct AnalysisDocument {
  std::string model;                            ///< Empty: not known, the file could not be read.
  const MechanismAnalysis* analysis = nullptr;  ///< Null: the model could not be read.
  const std::vector<Body>* bodies = nullptr;    ///< Of the model: for its rigid groups.
  const Diagnostics* diagnostics = nullptr;
  const ConsistentGeometry* geometry = nullptr;  ///< What was done about numbers good to a tolerance; null: nothing.
};

/// The JSON object of schema `ferrers.analyze/1`, two-space indentation, one newline at the end.
///
/// `ok` is true when the mechanism was assembled and no diagnostic is an error. Entries of self-stresses that are zero
/// beside the largest of their column are left out. Reactions that nothing determines have no value: null. Numbers keep
/// all their digits. Cost: linear in the report.
std::string write_analysis_json(const AnalysisDocument& document);

/// The JSON array of diagnostics on its own: objects {code, severity, line, column, message, hint}; line and column are
/// null where there is no place, a hint is null where there is none.
std::string write_diagnostics_json(const Diagnostics& diagnostics);

}  // namespace ferrers
