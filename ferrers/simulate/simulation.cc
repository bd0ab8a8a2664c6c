#include "ferrers/simulate/simulation.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <utility>

#include "ferrers/core/checks.h"
#include "ferrers/simulate/singular_poses.h"
#include "ferrers/simulate/step_control.h"
#include "ferrers/simulate/stepper.h"

namespace ferrers {
namespace {

constexpr double kDefaultTolerance = 3e-11;

constexpr std::array<std::pair<Integrator, std::string_view>, 2> kIntegrators = {
    {{Integrator::kRungeKutta4, "runge-kutta-4"}, {Integrator::kConstantAcceleration, "constant-acceleration"}}};

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

// One run: the loop "step, watch, output", with its bookkeeping.
class Run {
 public:
  Run(std::shared_ptr<const DynamicsModel> model, const SimulationOptions& options, const RunControl& control)
      : model_(std::move(model)),
        options_(options),
        control_(control),
        evaluator_(model_, options.formulation),
        recorder_(model_, options.axes, options.distribution),
        control_steps_(options.tolerance.value_or(kDefaultTolerance),
                       std::max(options.grid.t_end, options.grid.every)) {}

  RunSummary go() {
    const auto begin = std::chrono::steady_clock::now();
    if (start()) march();
    summary_.evaluations = evaluator_.evaluations();
    summary_.peaks = recorder_.peaks();
    summary_.distribution = recorder_.distribution();
    summary_.wall_time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return std::move(summary_);
  }

 private:
  bool fail(RunStatus status, std::string message) {
    summary_.status = status;
    summary_.message = std::move(message);
    return false;
  }

  bool start() {
    const InitialStateResult initial = make_initial_state(*model_);
    if (initial.status == InitialStateStatus::kNotAssembled) return fail(RunStatus::kNotAssembled, initial.message);
    if (initial.status == InitialStateStatus::kInconsistentVelocities) {
      return fail(RunStatus::kInconsistentVelocities, initial.message);
    }
    state_ = initial.state;
    next_ = sample_state_ = state_;
    sample_vdot_ = VectorXd::Zero(system().nv);
    choose_method();
    for (const DriveComponent& drive : model_->drives) {
      if (!drive.effort) summary_.notices.push_back("drive '" + drive.name + "' has no effort law: it does not act");
    }
    evaluator_.decide(state_, "start", summary_);
    if (!evaluate(state_) || !emit()) return false;
    summary_.energy_start = summary_.energy_min = summary_.energy_max = energy_;
    return true;
  }

  void choose_method() {
    summary_.method = std::string(to_string(options_.integrator));
    adaptive_ = options_.integrator == Integrator::kRungeKutta4 && !options_.step;
    if (options_.integrator == Integrator::kConstantAcceleration) {
      stepper_ = make_constant_acceleration(evaluator_);
    } else {
      stepper_ = adaptive_ ? make_runge_kutta_doubling(evaluator_) : make_runge_kutta_4(evaluator_);
    }
    if (adaptive_) {
      summary_.method += ", step doubling, tolerance " + number(options_.tolerance.value_or(kDefaultTolerance));
    } else {
      step_ = options_.step.value_or(options_.grid.every / 10);
      summary_.method += ", fixed step " + number(step_) + " s";
    }
    summary_.method += ", " + std::string(to_string(options_.formulation));
  }

  bool evaluate(const State& state) { return solved(evaluator_.evaluate(state)); }

  bool solved(ForwardStatus status) {
    switch (status) {
      case ForwardStatus::kSolved:
        return true;
      case ForwardStatus::kSingularMass:
        return fail(RunStatus::kSingularMass,
                    "the mass matrix is singular on the admissible motions at t = " + number(state_.t) +
                        " s: some motion moves no mass; give the bodies that it moves a mass or an inertia");
      case ForwardStatus::kWornSelection:
        break;
    }
    return fail(RunStatus::kStepTooSmall, "accelerations cannot be computed at t = " + number(state_.t) + " s");
  }

  bool emit() { return record(state_, evaluator_.result().vdot, true); }

  // `solved`: the last evaluation was at this state and gave multipliers.
  bool record(const State& state, const VectorXd& vdot, bool solved) {
    const RunSample& sample =
        recorder_.record(state, evaluator_.equations(), evaluator_.selection(), vdot, evaluator_.result().lambda,
                         evaluator_.equations().u, options_.with_reactions && solved);
    if (const std::string reason = refused_range(recorder_.distribution()); !reason.empty()) {
      return fail(RunStatus::kUnsupported, reason);
    }
    energy_ = sample.energy;
    summary_.energy_end = energy_;
    summary_.energy_min = std::min(summary_.energy_min, energy_);
    summary_.energy_max = std::max(summary_.energy_max, energy_);
    summary_.max_constraint_residual = std::max(summary_.max_constraint_residual, sample.constraint_residual);
    summary_.t_reached = state.t;
    if (control_.on_sample) control_.on_sample(sample);
    return true;
  }

  void march() {
    const std::vector<double> times = options_.grid.times();
    std::size_t due = 1;  // next output
    while (due < times.size()) {
      if (!(adaptive_ ? take_adaptive_step(times) : take_fixed_steps(times[due]))) return;
      for (; due < times.size() && times[due] <= state_.t; ++due) {
        if (!emit_at(times[due])) return;
      }
      if (control_.on_progress) control_.on_progress(state_.t);
      if (control_.stop && control_.stop->load(std::memory_order_relaxed)) {
        fail(RunStatus::kStopped, "interrupted at t = " + number(summary_.t_reached) + " s");
        return;
      }
    }
  }

  // Outputs between steps are interpolated, so that the steps need not know the grid.
  bool emit_at(double t) {
    if (t >= state_.t) return emit();
    between_.evaluate(system(), t, sample_state_, sample_vdot_);
    const bool solved_there = evaluator_.evaluate(sample_state_) == ForwardStatus::kSolved;
    return record(sample_state_, control_crossing_ ? sample_vdot_ : evaluator_.result().vdot, solved_there) &&
           evaluate(state_);
  }

  // Steps of equal length that land on `t`.
  bool take_fixed_steps(double t) {
    const double from = state_.t;
    const long count = std::max(1L, std::lround(std::ceil((t - from) / step_ * (1 - 1e-9))));
    for (long i = 1; i <= count; ++i) {
      const double end = i == count ? t : from + (t - from) * static_cast<double>(i) / static_cast<double>(count);
      if (!stepper_->step(evaluator_, state_, end - state_.t, next_).finite) return stuck();
      next_.t = end;
      if (!accept()) return false;
    }
    return true;
  }

  bool take_adaptive_step(const std::vector<double>& times) {
    between_.from = state_;
    between_.from_vdot = evaluator_.result().vdot;
    if (!control_steps_.step(evaluator_, *stepper_, state_, times.back(), summary_, next_)) return stuck();
    control_crossing_ = control_steps_.crossing();
    if (times.back() - next_.t < 1e-13 * std::abs(times.back()) && next_.t < times.back()) next_.t = times.back();
    if (!accept()) return false;
    between_.to = state_;
    between_.to_vdot = evaluator_.result().vdot;
    if (control_crossing_) note_singular_pose();
    return true;
  }

  void note_singular_pose() {
    const int rank = static_cast<int>(evaluator_.selection().rows.size());
    const auto pose = find_singular_pose(system(), evaluator_.scaling(), between_, rank);
    if (pose) summary_.singular_poses.push_back(*pose);
  }

  bool stuck() {
    return fail(RunStatus::kStepTooSmall, "no step keeps the error at t = " + number(state_.t) +
                                              " s: a singular pose, or forces that are not smooth");
  }

  bool accept() {
    const double h = next_.t - state_.t;
    ++summary_.steps;
    summary_.largest_step = std::max(summary_.largest_step, h);
    summary_.smallest_step = summary_.smallest_step > 0 ? std::min(summary_.smallest_step, h) : h;
    std::swap(state_, next_);
    if (!evaluate(state_)) return false;
    accept_winding(system(), evaluator_.equations().pos, state_);
    if (evaluator_.left_out_residual() > 1e4 * closed_tolerance(evaluator_.scaling())) {
      return fail(RunStatus::kRedundancyEnded,
                  "at t = " + number(state_.t) + " s constraints that were left out as dependent no longer hold (by " +
                      number(evaluator_.left_out_residual()) +
                      " m): the redundancy seen at the last decision held only at that pose");
    }
    if (evaluator_.is_worn()) return solved(evaluator_.choose_again(state_, summary_));
    return true;
  }

  const System& system() const { return *model_->system; }

  std::shared_ptr<const DynamicsModel> model_;
  const SimulationOptions& options_;
  const RunControl& control_;
  Evaluator evaluator_;
  Recorder recorder_;
  std::unique_ptr<Stepper> stepper_;
  RunSummary summary_;
  State state_, next_;
  bool adaptive_ = false;
  double energy_ = 0;
  double step_ = 0;  // fixed steps
  StepControl control_steps_;
  bool control_crossing_ = false;
  Hermite between_;
  State sample_state_;
  VectorXd sample_vdot_;
};

}  // namespace

std::string_view to_string(Integrator integrator) {
  for (const auto& [value, name] : kIntegrators) {
    if (value == integrator) return name;
  }
  return "";
}

std::optional<Integrator> find_integrator(std::string_view name) {
  for (const auto& [value, text] : kIntegrators) {
    if (text == name) return value;
  }
  return std::nullopt;
}

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

RunSummary simulate(std::shared_ptr<const DynamicsModel> model, const SimulationOptions& options,
                    const RunControl& control) {
  require(model != nullptr, "simulate: no model");
  require(!options.step || *options.step > 0, "simulate: the step must be positive");
  require(!options.tolerance || *options.tolerance > 0, "simulate: the tolerance must be positive");
  std::vector<std::string> refused = model->unsupported;
  for (const std::string& body : model->massless_bodies) refused.push_back("no mass for body '" + body + "'");
  if (!model->system->model->events().empty()) refused.emplace_back("events");
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
  return Run(std::move(model), options, control).go();
}

std::vector<std::string> run_columns(const DynamicsModel& model) {
  return Recorder(std::make_shared<DynamicsModel>(model)).columns();
}

}  // namespace ferrers
