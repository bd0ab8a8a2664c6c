#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ferrers/math/expression.h"
#include "ferrers/model/coordinate.h"

namespace ferrers {

/// A scalar law f(t), or f(t, q, v) of time and joint coordinates; laws of time have exact time derivatives.
///
/// The law says with `inputs()` what it reads; the evaluator passes those values in the same order. Two kinds:
/// - a formula: value, df/dt and d²f/dt² are compiled once from the exact derivatives of the formula;
/// - samples (t_k, f_k): the natural cubic spline s(t) through them, twice continuously differentiable, with
///   s''(t_0) = s''(t_n) = 0, continued outside by its end tangents.
/// Evaluation allocates nothing. Cost: linear in the size of the formula; O(log n) in the samples.
/// Immutable, cheap to copy (shared).
class Law {
 public:
  struct Motion {
    double value = 0, rate = 0, acceleration = 0;  ///< f, df/dt, d²f/dt².
  };

  Law();  ///< The constant 0.

  /// `input_names[i]` is how the expression names `inputs[i]`. Throws `std::invalid_argument` when the two differ in
  /// size, or when the expression uses a name that is no input.
  Law(const Expression& expression, std::vector<std::string> input_names, std::vector<LawInput> inputs);

  /// The natural cubic spline through samples. Throws `std::invalid_argument` unless there are at least two samples,
  /// as many values as times, times strictly increasing, all finite.
  static Law sampled(std::vector<double> times, std::vector<double> values);

  const std::vector<LawInput>& inputs() const;
  bool only_time() const;  ///< No joint coordinate is read.

  /// The value for the inputs in the order of `inputs()`; `inputs` may be null when there are none.
  double value(const double* inputs) const;

  /// Value and first two time derivatives. Throws `std::invalid_argument` unless `only_time()`.
  Motion motion(double t) const;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

}  // namespace ferrers
