#pragma once

#include <string>

#include "ferrers/study/sweep_summary.h"
#include "terminal.h"

/// What a sweep tells the reader. `files`: the names of what it wrote.
std::string sweep_text(const ferrers::SweepDocument& document, const std::string& files, const Style& style);
