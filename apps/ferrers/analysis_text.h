#pragma once

#include <string>

#include "ferrers/redundancy/consistent_geometry.h"
#include "ferrers/redundancy/mechanism_analysis.h"
#include "terminal.h"

/// The report of `analyze` for readers: the answers to five questions about an assembled mechanism. Long lists are cut,
/// with a word on what is missing; JSON has all. `geometry`: what was done about numbers that are good to a tolerance
/// only, or null.
std::string analysis_text(const ferrers::Model& model, const ferrers::MechanismAnalysis& analysis,
                          const ferrers::ConsistentGeometry* geometry, const Style& style);
