#pragma once

#include <Eigen/Core>
#include <cmath>

namespace ferrers {

/// The larger of two numbers, NaN where either is: `std::max` drops one of two NaN, and a residual that cannot be
/// computed would count as small.
inline double max_keeping_nan(double a, double b) { return std::isnan(a) || a >= b ? a : b; }

/// The largest magnitude, NaN where any entry is; 0 of nothing.
template <class Derived>
double largest_magnitude(const Eigen::MatrixBase<Derived>& v) {
  double largest = 0;
  for (Eigen::Index i = 0; i < v.size(); ++i) largest = max_keeping_nan(largest, std::abs(v.coeff(i)));
  return largest;
}

}  // namespace ferrers
