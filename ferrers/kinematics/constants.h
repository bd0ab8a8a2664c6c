#pragma once

#include <Eigen/Core>
#include <cmath>

#include "ferrers/math/traced.h"

namespace ferrers {

/// What is fixed in a body, as numbers of type T. Traced, entries that only rounding keeps from 0 or ±1 are these, so
/// that what they would add is left out of the code.
template <class T, int kRows, int kColumns>
Eigen::Matrix<T, kRows, kColumns> as_constants(const Eigen::Matrix<double, kRows, kColumns>& X) {
  if constexpr (std::is_same_v<T, double>) {
    return X;
  } else {
    constexpr double kRounding = 4e-16;
    const double largest = X.cwiseAbs().maxCoeff();
    const auto cleaned = [largest](double x) {
      if (std::abs(x) <= kRounding * largest) return 0.0;
      return std::abs(std::abs(x) - 1) <= kRounding ? std::copysign(1.0, x) : x;
    };
    return X.unaryExpr(cleaned).template cast<T>();
  }
}

/// R X, for a frame X that is fixed in its body: most are drawn along the body's axes, where this is R itself.
template <class T>
Eigen::Matrix<T, 3, 3> turned(const Eigen::Matrix<T, 3, 3>& R, const Eigen::Matrix3d& X) {
  const double* x = X.data();
  const bool as_drawn =
      x[0] == 1 && x[4] == 1 && x[8] == 1 && x[1] == 0 && x[2] == 0 && x[3] == 0 && x[5] == 0 && x[6] == 0 && x[7] == 0;
  if (as_drawn) return R;
  return R * as_constants<T>(X);
}

}  // namespace ferrers
