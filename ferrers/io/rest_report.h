#pragma once

#include <string>
#include <vector>

#include "ferrers/core/diagnostics.h"
#include "ferrers/dynamics/equilibrium.h"
#include "ferrers/dynamics/holding.h"
#include "ferrers/dynamics/linearization.h"

namespace ferrers {

/// What `ferrers.equilibrium/1` tells: an equilibrium that was looked for, or the efforts that hold a pose. What is not
/// known is null in the object, never invented.
struct RestDocument {
  std::string model;                        ///< Empty: not known, the file could not be read.
  const DynamicsModel* dynamics = nullptr;  ///< Null with both results.
  const EquilibriumResult* equilibrium = nullptr;
  const HoldingResult* holding = nullptr;  ///< With `--hold`, in its place.
  const std::vector<JointReaction>* reactions = nullptr;
  const Diagnostics* diagnostics = nullptr;
};

/// The JSON object of schema `ferrers.equilibrium/1`. Reactions that nothing determines have no value: null.
/// `ok`: found, or held, and no diagnostic is an error.
std::string write_rest_json(const RestDocument& document);

/// What `ferrers.linearize/1` tells.
struct LinearizationDocument {
  std::string model;
  bool at_equilibrium = false;  ///< Asked for; else at the initial state.
  const DynamicsModel* dynamics = nullptr;
  const Linearization* linear = nullptr;  ///< Null: there is none.
  const Diagnostics* diagnostics = nullptr;
};

/// The JSON object of schema `ferrers.linearize/1`; matrices as lists of rows, complex numbers as {re, im}.
std::string write_linearization_json(const LinearizationDocument& document);

}  // namespace ferrers
