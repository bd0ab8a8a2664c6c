#include "ferrers/simulate/error_estimate.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ferrers/simulate/run.h"

namespace ferrers {
namespace {

constexpr double kMostRows = 1000, kLooser = 10;

// Multiples of two spacings differ in the last digit.
bool same_time(double a, double b) { return std::abs(a - b) <= 1e-13 * std::max(1.0, std::abs(a)); }

// In the order of `Recorder::columns`.
std::vector<double> position_scales(const DynamicsModel& model) {
  const double length = characteristic_length(*model.system->model);
  std::vector<double> scales = {0.0};
  const auto add = [&](const JointTypeInfo& type) {
    for (int i = 0; i < type.nq; ++i) {
      const bool number = type.quaternion_at >= 0 && i >= type.quaternion_at;
      const bool angle = number || (i < type.nv && type.coordinates[i].is_angular());
      const bool other = i < type.nv && type.coordinates[i].kind == CoordinateKind::kOther;
      scales.push_back(angle || other ? 1 : 1 / length);
    }
    scales.insert(scales.end(), static_cast<std::size_t>(2 * type.nv), 0.0);
  };
  for (const Joint& joint : model.system->model->joints()) add(joint_type_info(joint.type));
  for (std::size_t i = 0; i < find_floating_bodies(*model.system).size(); ++i) add(kFreeJoint);
  return scales;
}

}  // namespace

ErrorEstimate::ErrorEstimate(std::shared_ptr<const DynamicsModel> model, const SimulationOptions& options)
    : model_(std::move(model)), looser_(options), scales_(position_scales(*model_)) {
  looser_.with_reactions = looser_.find_singular_poses = looser_.estimate_error = false;
  const double begin = options.start ? options.start->t : 0;
  looser_.grid.every *= std::max(1.0, std::ceil((options.grid.t_end - begin) / options.grid.every / kMostRows));
}

void ErrorEstimate::keep(const RunSample& sample) {
  const double last = rows_.empty() ? -INFINITY : rows_.back().t;
  const double multiple = std::round(sample.t / looser_.grid.every) * looser_.grid.every;
  if (!same_time(sample.t, multiple) || sample.t <= last) return;
  rows_.emplace_back();
  rows_.back().t = sample.t;
  rows_.back().values = sample.values;
}

std::optional<double> ErrorEstimate::compute(double t_reached, const RunControl& control) {
  if (rows_.size() < 2) return std::nullopt;
  looser_.grid.t_end = rows_.back().t;
  RunControl compared;
  compared.stop = control.stop;
  compared.on_sample = [this](const RunSample& sample) { compare(sample); };
  Run(model_, looser_, compared, kLooser).go();
  const bool to_the_end = next_ > 0 && rows_[next_ - 1].t >= 0.9 * t_reached;
  if (!to_the_end || !std::isfinite(largest_)) return std::nullopt;
  return largest_;
}

void ErrorEstimate::compare(const RunSample& sample) {
  while (next_ < rows_.size() && rows_[next_].t < sample.t && !same_time(rows_[next_].t, sample.t)) ++next_;
  if (next_ >= rows_.size() || !same_time(rows_[next_].t, sample.t)) return;
  for (std::size_t i = 0; i < scales_.size(); ++i) {
    if (scales_[i] == 0) continue;
    largest_ = std::max(largest_, scales_[i] * std::abs(sample.values[i] - rows_[next_].values[i]));
  }
  ++next_;
}

}  // namespace ferrers
