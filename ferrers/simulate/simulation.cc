#include "ferrers/simulate/simulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "ferrers/core/checks.h"
#include "ferrers/simulate/error_estimate.h"
#include "ferrers/simulate/run.h"

namespace ferrers {

std::vector<double> OutputGrid::times() const {
  require(t_end >= 0 && every > 0, "OutputGrid: the end must not be negative and the spacing must be positive");
  std::vector<double> times;
  const double ratio = t_end / every;
  const auto whole = static_cast<long>(std::floor(ratio + 1e-9));
  times.reserve(static_cast<std::size_t>(whole) + 2);
  for (long k = 0; k <= whole; ++k) times.push_back(static_cast<double>(k) * every);
  if (ratio - static_cast<double>(whole) > 1e-9) times.push_back(t_end);
  return times;
}

std::string refused_range(const DistributionSummary& distribution) {
  if (distribution.bounds != BoundsMethod::kTooLarge) return "";
  return "the ranges of reactions take too long: too many stiffnesses vary; give a stiffness to fewer joints, or leave "
         "the range out";
}

namespace {

RunSummary simulate_with_estimate(const std::shared_ptr<const DynamicsModel>& model, const SimulationOptions& options,
                                  const RunControl& control) {
  const auto begin = std::chrono::steady_clock::now();
  ErrorEstimate estimate(model, options);
  RunControl kept = control;
  kept.on_sample = [&](const RunSample& sample) {
    estimate.keep(sample);
    if (control.on_sample) control.on_sample(sample);
  };
  RunSummary summary = Run(model, options, kept).go();
  if (summary.status != RunStatus::kFinished && summary.status != RunStatus::kStoppedByEvent) return summary;
  summary.error_estimate = estimate.compute(summary.t_reached, control);
  const double tolerance = options.tolerance.value_or(kDefaultTolerance);
  if (summary.error_estimate && *summary.error_estimate > 10 * tolerance) {
    summary.notices.push_back(fmt::format(
        "the tolerance {:g} is not reached: a run with ten times the tolerance differs by {:.1e}; the motion amplifies "
        "errors, or rounding does not allow better",
        tolerance, *summary.error_estimate));
  } else if (!summary.error_estimate && summary.status == RunStatus::kFinished) {
    summary.notices.emplace_back(
        "the error could not be estimated: the run with ten times the tolerance did not finish");
  }
  summary.wall_time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return summary;
}

}  // namespace

RunSummary simulate(std::shared_ptr<const DynamicsModel> model, const SimulationOptions& options,
                    const RunControl& control) {
  require(model != nullptr, "simulate: no model");
  require(!options.step || *options.step > 0, "simulate: the step must be positive");
  require(!options.tolerance || *options.tolerance > 0, "simulate: the tolerance must be positive");
  std::vector<std::string> refused = model->unsupported;
  for (const std::string& body : model->massless_bodies) refused.push_back("no mass for body '" + body + "'");
  for (const Joint& joint : model->system->model->joints()) {
    if (joint.type == JointType::kGearMesh && joint.constants.mesh_holds_as_drawn_only) {
      refused.push_back("mesh '" + joint.name + "', which holds at the drawn pose only (give `axis` and `centers`)");
    }
  }
  if (!refused.empty()) {
    RunSummary summary;
    summary.status = RunStatus::kUnsupported;
    summary.message = "this model cannot be simulated: it has " + refused.front();
    return summary;
  }
  const Integrator integrator = integrator_of(options);
  const bool adaptive = !options.step && integrator != Integrator::kConstantAcceleration;
  if (options.start && options.grid.t_end <= options.start->t) {
    RunSummary summary;
    summary.status = RunStatus::kUnsupported;
    summary.message =
        fmt::format("the run to go on from ended at t = {:g} s already: the end must be later", options.start->t);
    return summary;
  }
  const bool has_error = adaptive && options.grid.t_end > 0;
  if (!options.estimate_error || !has_error) return Run(std::move(model), options, control).go();
  return simulate_with_estimate(model, options, control);
}

std::vector<std::string> run_columns(const DynamicsModel& model) {
  return Recorder(std::make_shared<DynamicsModel>(model)).columns();
}

}  // namespace ferrers
