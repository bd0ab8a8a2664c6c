#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

/// Derivatives by central differences, for comparing with the analytic ones of the library.
///
/// Sixth order: with step h the truncation error is about h⁶ f⁽⁷⁾/140 and the rounding error about ε f/h, so that for
/// smooth functions of order-one scale and the default step both stay near 1e-12.
namespace ferrers::witness {

inline constexpr double kDifferenceStep = 1e-2;

/// df/dx of a scalar argument; `f` returns a double or an Eigen vector or matrix. Six evaluations.
template <class Function>
auto differentiate(const Function& f, double x, double step = kDifferenceStep) {
  using Result = std::decay_t<decltype(f(x))>;
  const double h = step;
  const Result d1 = f(x + h) - f(x - h);
  const Result d2 = f(x + 2 * h) - f(x - 2 * h);
  const Result d3 = f(x + 3 * h) - f(x - 3 * h);
  return Result((45.0 * d1 - 9.0 * d2 + d3) / (60.0 * h));
}

/// Derivative of `f` at x along the direction d.
template <class Function>
auto differentiate_along(const Function& f, const Eigen::VectorXd& x, const Eigen::VectorXd& d,
                         double step = kDifferenceStep) {
  return differentiate([&](double s) { return f(Eigen::VectorXd(x + s * d)); }, 0.0, step);
}

/// Jacobian of `f` (vector to vector). 6·size(x) evaluations.
template <class Function>
Eigen::MatrixXd difference_jacobian(const Function& f, const Eigen::VectorXd& x, double step = kDifferenceStep) {
  Eigen::MatrixXd J;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const Eigen::VectorXd column = differentiate_along(f, x, Eigen::VectorXd::Unit(x.size(), i), step);
    if (i == 0) J.resize(column.size(), x.size());
    J.col(i) = column;
  }
  return J;
}

/// Observed order of convergence from the errors at step h and h/2.
inline double observed_order(double error_at_h, double error_at_half_h) {
  return std::log2(std::max(error_at_h, 1e-300) / std::max(error_at_half_h, 1e-300));
}

}  // namespace ferrers::witness
