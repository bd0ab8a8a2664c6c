#pragma once

#include <string>

#include "ferrers/model/model.h"

namespace ferrers {

/// What a model gives by formulas, in LaTeX with the names of its parameters: T, V, R, phi, and what the engine derives
/// of them, M, h, tau, G, gamma [stepanyan, eqs. (1), (3)-(5), (9)]; entries that are zero are left out. Empty where
/// nothing is given by formulas, or more than twelve coordinates are. Cost: the size of all derivatives.
std::string symbolic_equations_latex(const Model& model);

}  // namespace ferrers
