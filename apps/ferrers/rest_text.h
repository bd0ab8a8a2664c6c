#pragma once

#include <string>

#include "ferrers/io/rest_report.h"
#include "terminal.h"

/// An equilibrium, a held pose, or a linear system for readers.
std::string rest_text(const ferrers::RestDocument& document, const Style& style);
std::string linearization_text(const ferrers::LinearizationDocument& document, const Style& style);
