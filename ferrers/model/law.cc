#include "ferrers/model/law.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "ferrers/core/checks.h"

namespace ferrers {
namespace {

/// The natural cubic spline of samples: second derivatives m_k at the knots, from the tridiagonal system
/// h_{k-1} m_{k-1} + 2 (h_{k-1} + h_k) m_k + h_k m_{k+1} = 6 (d_k − d_{k-1}), d_k the slope of interval k, m_0 = m_n =
/// 0.
struct Spline {
  std::vector<double> t, f, m;

  Law::Motion at(double time) const;
  Law::Motion tangent(std::size_t knot, double slope, double time) const {
    return {f[knot] + slope * (time - t[knot]), slope, 0.0};
  }
};

/// Solves the system above by elimination and back substitution; it is diagonally dominant, so no pivoting is needed.
std::vector<double> natural_second_derivatives(const std::vector<double>& t, const std::vector<double>& f) {
  const std::size_t n = t.size();
  std::vector<double> m(n, 0.0), above(n, 0.0);
  for (std::size_t k = 1; k + 1 < n; ++k) {
    const double left = t[k] - t[k - 1], right = t[k + 1] - t[k];
    const double wanted = 6.0 * ((f[k + 1] - f[k]) / right - (f[k] - f[k - 1]) / left);
    const double pivot = 2.0 * (left + right) - left * above[k - 1];
    above[k] = right / pivot;
    m[k] = (wanted - left * m[k - 1]) / pivot;
  }
  for (std::size_t k = n - 1; k-- > 1;) m[k] -= above[k] * m[k + 1];
  return m;
}

Law::Motion Spline::at(double time) const {
  const std::size_t last = t.size() - 1;
  const auto slope = [this](std::size_t k) { return (f[k + 1] - f[k]) / (t[k + 1] - t[k]); };
  if (time < t.front()) return tangent(0, slope(0) - (t[1] - t[0]) * m[1] / 6.0, time);
  if (time > t.back()) {
    return tangent(last, slope(last - 1) + (t[last] - t[last - 1]) * m[last - 1] / 6.0, time);
  }
  const auto after = std::upper_bound(t.begin() + 1, t.end() - 1, time);
  const std::size_t k = static_cast<std::size_t>(after - t.begin()) - 1;
  const double h = t[k + 1] - t[k], a = (t[k + 1] - time) / h, b = (time - t[k]) / h;
  return {a * f[k] + b * f[k + 1] + ((a * a * a - a) * m[k] + (b * b * b - b) * m[k + 1]) * h * h / 6.0,
          slope(k) + ((3.0 * b * b - 1.0) * m[k + 1] - (3.0 * a * a - 1.0) * m[k]) * h / 6.0, a * m[k] + b * m[k + 1]};
}

}  // namespace

struct Law::Data {
  std::vector<LawInput> inputs;
  bool only_time = true;
  ExpressionProgram value, rate, acceleration;  ///< The last two for laws of time only.
  Spline spline;                                ///< Used when it has samples.
};

Law::Law() : data_(std::make_shared<const Data>()) {}

Law::Law(const Expression& expression, std::vector<std::string> input_names, std::vector<LawInput> inputs) {
  require_size(static_cast<long>(inputs.size()), static_cast<long>(input_names.size()), "law: inputs and their names");
  auto data = std::make_shared<Data>();
  data->inputs = std::move(inputs);
  data->value = ExpressionProgram(expression, input_names);
  std::string time;
  for (std::size_t i = 0; i < data->inputs.size(); ++i) {
    if (data->inputs[i].kind == LawInput::Kind::kTime) {
      require(time.empty(), "law: time may be one input only");
      time = input_names[i];
    } else {
      data->only_time = false;
    }
  }
  if (data->only_time && !time.empty()) {
    const Expression rate = expression.derivative(time);
    data->rate = ExpressionProgram(rate, input_names);
    data->acceleration = ExpressionProgram(rate.derivative(time), input_names);
  }
  data_ = std::move(data);
}

Law Law::sampled(std::vector<double> times, std::vector<double> values) {
  require_size(static_cast<long>(values.size()), static_cast<long>(times.size()), "sampled law: values and times");
  require(times.size() >= 2, "sampled law: at least two samples are needed");
  for (std::size_t k = 0; k < times.size(); ++k) {
    require(std::isfinite(times[k]) && std::isfinite(values[k]), "sampled law: a sample is not finite");
    require(k == 0 || times[k] > times[k - 1], "sampled law: times must increase");
  }
  auto data = std::make_shared<Data>();
  data->inputs = {LawInput{}};
  data->spline.m = natural_second_derivatives(times, values);
  data->spline.t = std::move(times);
  data->spline.f = std::move(values);
  Law law;
  law.data_ = std::move(data);
  return law;
}

const std::vector<LawInput>& Law::inputs() const { return data_->inputs; }

bool Law::only_time() const { return data_->only_time; }

double Law::value(const double* inputs) const {
  if (!data_->spline.t.empty()) return data_->spline.at(*inputs).value;
  return data_->value.evaluate(inputs);
}

Law::Motion Law::motion(double t) const {
  require(data_->only_time, "law: only a law of time has time derivatives by itself");
  if (!data_->spline.t.empty()) return data_->spline.at(t);
  return {data_->value.evaluate(&t), data_->rate.evaluate(&t), data_->acceleration.evaluate(&t)};
}

}  // namespace ferrers
