#pragma once

#include <string>
#include <vector>

#include "ferrers/io/run_folder.h"
#include "terminal.h"

/// The result of a run for readers.
std::string run_text(const ferrers::RunDocument& document, long rows, const std::string& files, const Style& style);
