#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ferrers/math/expression.h"

namespace ferrers {

struct LawInput;

/// A scalar law: of time, or of time and joint coordinates; with exact time derivatives for prescribed motions.
///
/// Inputs are numbered by `inputs()` (defined in model.h); the evaluator passes their values in that order.
class Law {
 public:
  Law();  ///< The constant 0.
  /// `input_names[i]` is how the expression names `inputs[i]`; "t" is time.
  Law(const Expression& expression, std::vector<std::string> input_names, std::vector<LawInput> inputs);
  /// A natural cubic spline through samples with increasing times (at least 2); constant slope outside.
  static Law sampled(std::vector<double> times, std::vector<double> values);

  const std::vector<LawInput>& inputs() const;
  bool only_time() const;  ///< No joint coordinate is read.

  double value(const double* inputs) const;

  struct Motion {
    double value = 0, rate = 0, acceleration = 0;
  };
  /// Value and its first two time derivatives, for a law of time only.
  Motion motion(double t) const;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

}  // namespace ferrers
