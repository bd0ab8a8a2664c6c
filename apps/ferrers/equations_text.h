#pragma once

#include <string>

#include "ferrers/io/equations_document.h"
#include "terminal.h"

/// The equations at one state for readers: every block under the number that the paper gives it, matrices with their
/// rows and columns named, in groups of columns that fit a page.
std::string equations_text(const ferrers::EquationsDocument& document, const Style& style);
