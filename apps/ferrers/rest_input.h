#pragma once

#include <memory>

#include "ferrers/dynamics/initial_state.h"
#include "model_input.h"

/// The part that equilibrium and linearize share: a model with masses, assembled.
struct RestStart {
  LoadedModel loaded;
  std::shared_ptr<const ferrers::DynamicsModel> dynamics;
  ferrers::State state;
  int exit_code = 0;  ///< Other than kExitDone: what is wrong was reported, `state` is not valid.
};
RestStart load_at_rest(const ModelOptions& options, double t = 0);
