#pragma once

#include <cmath>

#include "ferrers/math/rotation.h"

/// Motions that are known without the engine.
namespace ferrers::witness {

/// Tip of the first crank of `make_n_four_bar(n, 0, 1)` on the parallelogram branch [gonzalez2006]:
///   θ'' = (G/I) sin θ from upright with θ' = 1, I = (n+1)/3 + n, G = ((n+1)/2 + n) g,
/// by the classical rule of order four in extended precision (error below 1e-14 for t_end up to 20 s).
inline Eigen::Vector3d parallelogram_tip(int n, double t_end) {
  const long double ratio = ((n + 1) / 2.0L + n) * 9.81L / ((n + 1) / 3.0L + n);
  const long steps = 200000;
  const long double h = static_cast<long double>(t_end) / steps;
  long double a = 0, w = 1;
  for (long i = 0; i < steps; ++i) {
    const long double a1 = w, w1 = ratio * std::sin(a), a2 = w + h / 2 * w1, w2 = ratio * std::sin(a + h / 2 * a1);
    const long double a3 = w + h / 2 * w2, w3 = ratio * std::sin(a + h / 2 * a2);
    const long double a4 = w + h * w3, w4 = ratio * std::sin(a + h * a3);
    a += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    w += h / 6 * (w1 + 2 * w2 + 2 * w3 + w4);
  }
  return {static_cast<double>(std::sin(a)), static_cast<double>(std::cos(a)), 0};
}

}  // namespace ferrers::witness
