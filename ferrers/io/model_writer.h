#pragma once

#include <string>

#include "ferrers/model/spec.h"

namespace ferrers {

/// The model file of a specification, in YAML: formulas stay formulas, numbers keep all their digits, and reading it
/// gives the same specification (places aside). A gear coupling becomes the linear coupling that it is.
/// Needs: sampled laws name their file (`LawSpec::file`), since only its name is written; the file lies beside the
/// model. Cost: linear.
std::string write_model(const ModelSpec& spec);

}  // namespace ferrers
