#pragma once

#include <Eigen/Core>
#include <functional>

/// Problem: the derivative of a function that can only be evaluated, nearly as exact as the evaluations, with an error
/// estimate that can be trusted.
///
/// Given: f: R → Rⁿ, smooth near 0, and a first step h. Wanted: f'(0).
/// Method: central differences D(h), D(h/2), D(h/4) … have errors in even powers of the step; extrapolation takes them
/// away one after the other,
///
///   T(i, 0) = D(h/2ⁱ),   T(i, j) = (4ʲ T(i, j−1) − T(i−1, j−1)) / (4ʲ − 1).
///
/// Every entry of the derivative takes the T(i, j) that its two parents contradict least, and that contradiction is its
/// error estimate [ridders1982]. Halving goes on while it helps. It starts smaller where f cannot be
/// evaluated, and is begun again with a far smaller step where the errors stay large (f turns on a smaller scale).
/// Accuracy: some roundings of f over the step where f is smooth on the scale of h. Cost: 10 to 16 evaluations where
/// it is, up to 96.
namespace ferrers {

/// Fills the result (same size at every call) and returns true, or false where the function does not exist.
using CurveFunction = std::function<bool(double, Eigen::VectorXd&)>;

struct DifferenceResult {
  bool valid = false;     ///< False: f exists at no step, however small.
  Eigen::VectorXd value;  ///< f'(0).
  Eigen::VectorXd error;  ///< Estimate per entry, rounding included.
};

/// `step` > 0. `size`: n.
DifferenceResult compute_extrapolated_difference(const CurveFunction& f, long size, double step);

}  // namespace ferrers
