#pragma once

#include <string_view>
#include <vector>

/// Explicit Runge-Kutta pairs as tables [hairer1993].
///
///   k_i = f(t + c_i h, y + h Σ_j a_ij k_j),   y' = y + h Σ_i b_i k_i,   errors h Σ_i e_i k_i
///
/// Zero weights are left out. The last stage of a step is f at its result, the first of the next step.
namespace ferrers {

struct Weight {
  int stage;
  double value;
};
using Weights = std::vector<Weight>;

struct ExplicitRule {
  std::string_view name;
  int order = 0;
  std::vector<double> c;
  std::vector<Weights> a;  ///< Of stages 1, 2, …; stage 0 is f(t, y).
  Weights b;
  /// Estimates of the error: one, or two of orders 5 and 3 that are combined to order 7 [hairer1993, II.10].
  Weights error, error_3;
  /// Dense output: further stages (after the one at the result, which has number a.size() + 1) and the weights of the
  /// higher terms of the interpolant; empty: the quintic through both ends.
  std::vector<double> dense_c;
  std::vector<Weights> dense_a, dense;
  /// Where a singular pose does least harm in a step: in the middle of the widest gaps between stages, the best first.
  std::vector<double> gaps;

  int stages() const { return static_cast<int>(a.size()) + 1; }
  int all_stages() const { return stages() + 1 + static_cast<int>(dense_a.size()); }
};

/// Order 5 with an error estimate of order 4 [dormand1980].
const ExplicitRule& dormand_prince_5();
/// Order 8 with error estimates of orders 5 and 3 and a dense output of order 7 [hairer1993, II.5, II.6, II.10].
const ExplicitRule& dormand_prince_8();

}  // namespace ferrers
