#pragma once

#include <CLI/App.hpp>
#include <string>

#include "ferrers/simulate/simulation.h"

/// How a motion is simulated: --integrator, --step, --tolerance, --formulation, --driven.
void add_method_options(CLI::App& verb, ferrers::SimulationOptions& options);

/// What is wrong with them together, or an empty text.
std::string find_fault(const ferrers::SimulationOptions& options);
