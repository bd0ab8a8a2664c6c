#pragma once

#include <string>
#include <vector>

#include "ferrers/math/expression.h"

/// Andrews' squeezer in its seven angles [hairer1996, sec. VII.7], once as formulas and once by hand.
namespace ferrers::witness {

constexpr int kAndrewsCoordinates = 7, kAndrewsRows = 6;
/// M (upper triangle, row by row), f, phi, G (row by row), gamma of M q'' = f + Gᵀ lambda, G q'' = gamma.
constexpr int kAndrewsOutputs = 28 + 7 + 6 + 42 + 6;

/// How the kinetic energy is written down.
enum class AndrewsEnergy {
  kAngles,   ///< Multiplied out in the angles.
  kCentres,  ///< By the velocities of the mass centres, which are differentiated as formulas.
};

/// The names of the angles, then those of their rates.
std::vector<std::string> andrews_inputs();

/// The outputs by differentiating T, V and phi.
std::vector<Expression> andrews_formulas(AndrewsEnergy energy);

/// The same numbers as somebody writes them who has done the derivatives on paper.
void compute_andrews_by_hand(const double* inputs, double* outputs);

}  // namespace ferrers::witness
