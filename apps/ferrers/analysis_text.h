#pragma once

#include <string>

#include "ferrers/redundancy/permanence.h"
#include "terminal.h"

/// The report of `analyze` for readers: the answers to five questions about a mechanism.
std::string analysis_text(const ferrers::Model& model, const ferrers::RedundancyReport& report,
                          const ferrers::PermanenceReport& permanence, const Style& style);
