#include "ferrers/simulate/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "ferrers/dynamics/law_notices.h"

namespace ferrers {
namespace {

// Of the tolerance, for the local errors per unit of motion, such that the benchmarks end within the tolerance. A loose
// one is not taken quite at its word: errors of long steps are not proportional to their estimates.
double local_tolerance(const SimulationOptions& options) {
  constexpr double kLoosest = 3e-7;
  const double tolerance = options.tolerance.value_or(kDefaultTolerance);
  switch (integrator_of(options)) {
    case Integrator::kGeneralizedAlpha:
      return 0.05 * tolerance;
    case Integrator::kDormandPrince5:
    case Integrator::kRungeKutta4:
      return std::min(2e-3 * tolerance, 2 * kLoosest);
    default:
      return std::min((tolerance > 1e-7 ? 4e-4 : 1e-3) * tolerance, kLoosest);
  }
}

// An event on the output grid, but for rounding, is on the grid.
double on_grid(const std::vector<double>& times, double t) {
  const double slack = 1e-12 * std::abs(t);
  const auto next = std::lower_bound(times.begin(), times.end(), t - slack);
  return next != times.end() && *next - t <= slack ? *next : t;
}

// Making native code takes about as long as it saves in so many evaluations, whatever the mechanism
// (bench/evaluation_bench: compile and whole/sparse).
constexpr long kNativePays = 1500;
constexpr long kStepsToJudge = 5;  // the first ones are short

long first_native_evaluation(NativeCode code) {
  switch (code) {
    case NativeCode::kAlways:
      return 0;
    case NativeCode::kNever:
      return -1;
    default:
      return kNativePays;
  }
}

std::vector<int> drives_with_motion(const DynamicsModel& model) {
  std::vector<int> out;
  for (int i = 0; i < model.nu(); ++i) {
    if (model.drives[i].motion && model.drives[i].acts) out.push_back(i);
  }
  return out;
}

}  // namespace

Run::Run(std::shared_ptr<const DynamicsModel> model, const SimulationOptions& options, const RunControl& control,
         double looser)
    : model_(std::move(model)),
      options_(options),
      control_(control),
      formulation_(options.formulation.value_or(recommended_formulation())),
      evaluator_(model_, formulation_, options.driven ? drives_with_motion(*model_) : std::vector<int>(),
                 options.distribution),
      recorder_(model_, options.axes, options.distribution),
      events_(model_),
      limits_(model_),
      control_steps_(local_tolerance(options), std::max(options.grid.t_end, options.grid.every), looser),
      driven_(evaluator_.driven()),
      off_(model_->drives.size(), false) {
  evaluator_.use_native_code_from(first_native_evaluation(options.native_code));
  for (int i = 0; i < model_->nu(); ++i) {
    const std::string& name = system().model->drives()[model_->drives[i].drive.index()].name;
    const auto& off = options.drives_off;
    off_[static_cast<std::size_t>(i)] = std::find(off.begin(), off.end(), name) != off.end();
  }
  if (!options.drives_off.empty()) use_switches();
}

RunSummary Run::go() {
  const auto begin = std::chrono::steady_clock::now();
  if (start()) march();
  summary_.evaluations = evaluator_.evaluations();
  summary_.peaks = recorder_.peaks();
  summary_.distribution = recorder_.distribution();
  conclude();
  summary_.wall_time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return std::move(summary_);
}

// Notices and balances. Springs keep what they take: their part of the work shows in the energy.
void Run::conclude() {
  // Local errors of a thousandth of the tolerance keep it; those of rounding are what they are.
  const double attainable = 1e3 * StepControl::rounding(evaluator_);
  if (adaptive_ && attainable > options_.tolerance.value_or(kDefaultTolerance)) {
    summary_.notices.push_back(fmt::format(
        "the tolerance may not be reached: rounding allows about {:.0e} in a mechanism of this size", attainable));
  }
  if (control_steps_.lost() > 0.1 * options_.tolerance.value_or(kDefaultTolerance)) {
    summary_.notices.push_back(fmt::format(
        "rounding allows no better than {:.1e} in some steps (rad, or characteristic lengths): the tolerance "
        "asks for more than can be computed",
        control_steps_.lost()));
  }
  for (const LimitCrossing& crossing : limits_.crossings()) summary_.notices.push_back(describe(crossing));
  summary_.limits = limits_.crossings();
  for (const LawUse use : {LawUse::kMotion, LawUse::kEffort}) {
    if (use == LawUse::kMotion && !options_.driven) continue;
    for (std::string& notice : describe_sampled_laws(*system().model, use, begin_, options_.grid.t_end)) {
      summary_.notices.push_back(std::move(notice));
    }
  }
  summary_.drives_off = drives_off();
  if (state_.t > summary_.t_reached && state_.q.size() == system().nq && state_.q.allFinite()) {
    // It ended between two rows: the work is known to there, so the energy must be.
    PositionKinematics pos = make_position_kinematics(system());
    VelocityKinematics vel = make_velocity_kinematics(system());
    compute_positions(system(), state_.q, pos);
    compute_velocities(system(), pos, state_.q, state_.v, vel);
    const Energy energy = compute_energy(evaluator_.model(), state_, pos, vel);
    energy_ = energy.total();
    elastic_ = energy.elastic;
  }
  work_.others += elastic_ - elastic_start_;
  summary_.work = work_;
  summary_.balance_error = energy_ - summary_.energy_start - work_.drives - work_.others;
}

bool Run::fail(RunStatus status, std::string message) {
  summary_.status = status;
  summary_.message = std::move(message);
  return false;
}

// --- Start ---

bool Run::start() {
  if (options_.start) {
    state_ = *options_.start;
  } else {
    InitialStateResult initial = make_initial_state(*model_);
    if (initial.status == InitialStateStatus::kNotAssembled) return fail(RunStatus::kNotAssembled, initial.message);
    if (initial.status == InitialStateStatus::kInconsistentVelocities) {
      return fail(RunStatus::kInconsistentVelocities, initial.message);
    }
    state_ = std::move(initial.state);
  }
  next_ = sample_state_ = state_;
  begin_ = state_.t;
  sample_vdot_ = VectorXd::Zero(system().nv);
  for (int i = 0; i < model_->nu(); ++i) {
    const bool follows = std::find(driven_.begin(), driven_.end(), i) != driven_.end();
    if (!follows && !model_->drives[i].effort) {
      const char* why = model_->drives[i].acts ? "drive '{}' has no effort law: it does not act"
                                               : "'motions' of '{}' is not followed: it is for the inverse problem";
      summary_.notices.push_back(fmt::format(fmt::runtime(why), model_->drives[i].name));
    }
  }
  evaluator_.decide(state_, "start", summary_);
  if (!evaluator_.driven_conflict().empty()) {
    return fail(RunStatus::kBadMotion,
                "more motions are prescribed than the mechanism has; they depend on each other: " +
                    evaluator_.driven_conflict());
  }
  if (!evaluator_.implied_drives().empty()) {
    summary_.effort_is_shared.assign(model_->drives.size(), false);
    for (const int i : evaluator_.implied_drives()) summary_.effort_is_shared[static_cast<std::size_t>(i)] = true;
  }
  choose_method();
  if (!evaluator_.driven().empty() && !put_on_laws()) return false;
  if (!solved(evaluator_.evaluate(state_))) return false;
  if (!std::isfinite(evaluator_.settle(state_))) return stuck();
  events_.start(state_);
  for (std::size_t i = 0; i < system().model->events().size(); ++i) {
    const auto& acted = options_.events_acted;
    const std::string& name = system().model->events()[i].name;
    if (std::find(acted.begin(), acted.end(), name) != acted.end()) events_.acted(static_cast<int>(i));
  }
  if (!emit_here()) return false;
  summary_.energy_start = summary_.energy_min = summary_.energy_max = energy_;
  elastic_start_ = elastic_;
  return true;
}

void Run::choose_method() {
  const Integrator integrator = integrator_of(options_);
  stepper_ = make_stepper(integrator, evaluator_, options_.step.has_value());
  adaptive_ = !options_.step && stepper_->error_order() > 0;
  summary_.method = std::string(to_string(integrator));
  if (adaptive_) {
    // What a rank decision takes for zero is ten times as much (math/rank.cc).
    evaluator_.close_to(std::min(1e-4 * local_tolerance(options_), 1e-12) * evaluator_.scaling().length_m);
    summary_.method += fmt::format(", tolerance {:g}", options_.tolerance.value_or(kDefaultTolerance));
  } else {
    step_ = std::min(options_.step.value_or(options_.grid.every / 10), options_.grid.every);
    summary_.method += fmt::format(", fixed step {:g} s", step_);
    if (options_.tolerance) {
      summary_.notices.push_back(fmt::format("steps are fixed: the tolerance {:g} says nothing", *options_.tolerance));
    }
    if (options_.step && *options_.step > step_) {
      summary_.notices.push_back(fmt::format("no step is longer than the spacing of the rows, {:g} s", step_));
    }
  }
  summary_.method += ", " + std::string(to_string(formulation_));
}

// Prescribed coordinates start where their laws do: walked to in small pieces, then velocities follow.
bool Run::put_on_laws() {
  const auto k = static_cast<long>(evaluator_.driven().size());
  if (!solved(evaluator_.evaluate(state_))) return false;
  const VectorXd gap = evaluator_.equations().constraints.phi.tail(k);
  const double size = gap.cwiseProduct(evaluator_.row_scale().tail(k)).lpNorm<Eigen::Infinity>();
  const auto& given = system().model->initial();
  const bool exact =
      std::any_of(given.begin(), given.end(), [](const InitialValue& i) { return !i.guess && !i.position.empty(); });
  if (exact && size > 1e-6 * evaluator_.scaling().length_m) {
    summary_.notices.push_back(fmt::format(
        "the prescribed motions begin elsewhere than the model's initial pose (by {:.4g} m, angles times the "
        "characteristic length): the run starts where they begin",
        size));
  }
  const long pieces = std::lround(std::ceil(size / (0.1 * evaluator_.scaling().length_m)));
  VectorXd offset = VectorXd::Zero(evaluator_.row_scale().size());
  for (long i = 1; i <= pieces; ++i) {
    offset.tail(k) = (1 - static_cast<double>(i) / static_cast<double>(pieces)) * gap;
    if (!(evaluator_.settle(state_, &offset) <= 1e3 * closed_tolerance(evaluator_.scaling()))) {
      return fail(RunStatus::kBadMotion,
                  fmt::format("the prescribed positions cannot be reached at t = {:g} s", state_.t));
    }
    if (evaluator_.is_worn()) evaluator_.choose_again(state_, summary_);
  }
  return true;
}

bool Run::solved(ForwardStatus status) {
  if (status == ForwardStatus::kSolved) return true;
  if (!evaluator_.motion_problem().empty()) return fail(RunStatus::kBadMotion, evaluator_.motion_problem());
  if (status == ForwardStatus::kSingularMass) {
    return fail(RunStatus::kSingularMass,
                fmt::format("the mass matrix is singular on the admissible motions at t = {:g} s: some motion moves no "
                            "mass; give what it moves a mass or an inertia",
                            state_.t));
  }
  if (!evaluator_.friction_problem().empty()) {
    return fail(summary_.steps == 0 ? RunStatus::kUnsupported : RunStatus::kStepTooSmall,
                fmt::format("at t = {:g} s {}", state_.t, evaluator_.friction_problem()));
  }
  return fail(RunStatus::kStepTooSmall, fmt::format("accelerations cannot be computed at t = {:g} s", state_.t));
}

bool Run::stuck() {
  std::string motion_problem = evaluator_.motion_problem();  // one ahead too: the steps that met it were tried again
  const bool evaluated = evaluator_.evaluate(state_) == ForwardStatus::kSolved;
  if (!evaluator_.friction_problem().empty()) {
    return fail(RunStatus::kStepTooSmall, fmt::format("at t = {:g} s {}", state_.t, evaluator_.friction_problem()));
  }
  const double ratio = evaluated && evaluator_.best_pivot() > 0 ? evaluator_.pivot() / evaluator_.best_pivot() : 0;
  if (!motion_problem.empty() && !(evaluated && ratio < 0.05)) {
    return fail(RunStatus::kBadMotion, std::move(motion_problem));
  }
  if (ratio < 0.05) {
    std::string moving;
    for (const int v : evaluator_.selection().independent) {
      moving += fmt::format("{}'{}'", moving.empty() ? "" : ", ", system().coordinate_names[v]);
    }
    const std::string what = driven_.empty() ? "a dead point or lock" : "a dead point of the prescribed motion";
    return fail(RunStatus::kStepTooSmall,
                fmt::format("{} at t = {:g} s: the constraints lose rank there (smallest pivot {:.1e} of its healthy "
                            "value) and no step leads on with the accuracy asked; independent there: {}",
                            what, state_.t, ratio, moving.empty() ? "nothing" : moving));
  }
  return fail(RunStatus::kStepTooSmall,
              fmt::format("no step keeps the error at t = {:g} s: forces that are not smooth, "
                          "or an error that rounding does not allow",
                          state_.t));
}

// --- The loop ---

void Run::march() {
  const std::vector<double> times = options_.grid.times();
  if (limits_.any()) limits_.observe(state_, evaluator_.positions(), evaluator_.velocities());
  auto due = static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), state_.t) - times.begin());
  while (due < times.size()) {
    const long evaluations = evaluator_.evaluations();
    if (!take_step(times, due) || !finish_step(times, due)) return;
    if (summary_.steps == kStepsToJudge) judge_native_code(evaluator_.evaluations() - evaluations);
    if (control_.on_progress) control_.on_progress(state_.t);
    if (control_.stop && control_.stop->load(std::memory_order_relaxed)) {
      fail(RunStatus::kStopped, fmt::format("interrupted at t = {:g} s", summary_.t_reached));
      return;
    }
  }
}

// Whether what is left is worth native code, if it goes on in steps like the last one, which took so many evaluations.
void Run::judge_native_code(long evaluations) {
  if (options_.native_code != NativeCode::kWhenItPays) return;
  const double left = (options_.grid.t_end - state_.t) / (state_.t - between_.from.t);
  if (left * static_cast<double>(evaluations) > kNativePays) evaluator_.use_native_code_from(0);
}

bool Run::take_step(const std::vector<double>& times, std::size_t due) {
  work_before_ = work_;
  between_.from = state_;
  between_.from_vdot = evaluator_.result().vdot;
  if (adaptive_) {
    if (!control_steps_.step(evaluator_, *stepper_, state_, times.back(), summary_, next_)) return stuck();
    crossing_ = control_steps_.crossing();
    work_.drives += control_steps_.work().drives;
    work_.others += control_steps_.work().others;
    if (times.back() - next_.t < 1e-13 * std::abs(times.back()) && next_.t < times.back()) next_.t = times.back();
  } else {  // of equal length, landing on the next row
    const double left = times[due] - state_.t;
    const double longest = std::min(step_, evaluator_.longest_followed_turn());
    const double count = std::max(1.0, std::ceil(left / longest * (1 - 1e-9)));
    const Stepper::Outcome outcome = stepper_->step(evaluator_, state_, left / count, next_);
    if (!outcome.finite) return stuck();
    if (count < 1.5) next_.t = times[due];
    work_.drives += outcome.work.drives;
    work_.others += outcome.work.others;
  }
  if (!accept()) return false;
  between_.to = state_;
  between_.to_vdot = evaluator_.result().vdot;
  return true;
}

bool Run::accept() {
  const double h = next_.t - state_.t;
  ++summary_.steps;
  summary_.largest_step = std::max(summary_.largest_step, h);
  summary_.smallest_step = summary_.smallest_step > 0 ? std::min(summary_.smallest_step, h) : h;
  std::swap(state_, next_);
  if (system().winding_count > 0) accept_winding(system(), evaluator_.positions(), state_);
  if (evaluator_.left_out_residual() > 1e4 * closed_tolerance(evaluator_.scaling())) {
    return fail(RunStatus::kRedundancyEnded,
                fmt::format("at t = {:g} s constraints that were left out as dependent no longer hold (by {:g} m): the "
                            "redundancy seen at the last decision held only at that pose",
                            state_.t, evaluator_.left_out_residual()));
  }
  const bool may_choose = evaluator_.is_worn() && !(adaptive_ && control_steps_.near_crossing());
  return may_choose ? solved(evaluator_.choose_again(state_, summary_)) : true;
}

// Rows and events within the step taken; afterwards the evaluator is at the step's end again.
bool Run::finish_step(const std::vector<double>& times, std::size_t& due) {
  moved_ = false;
  double from = between_.from.t;
  const auto probe = [this](double t, State& state) { state_at(t, state, sample_vdot_); };
  while (events_.any()) {
    auto hit = events_.find(from, state_.t, probe);
    if (!events_.broken().empty()) return fail(RunStatus::kBadMotion, events_.broken());
    if (!hit) break;
    hit->t = on_grid(times, hit->t);
    if (!emit_until(hit->t, times, due)) return false;
    if (!act(*hit)) return false;
    if (switched_) return true;  // the rest of the step did not happen
    from = hit->t;
  }
  watch_limits(state_.t);
  if (crossing_ && options_.find_singular_poses) note_singular_pose();
  if (!emit_until(state_.t, times, due)) return false;
  return !moved_ || solved(evaluator_.evaluate(state_));
}

void Run::state_at(double t, State& state, VectorXd& vdot) {
  moved_ = true;
  if (!stepper_->interpolate(evaluator_, between_.from, between_.to, t, state, vdot)) {
    between_.evaluate(system(), t, state, vdot);
  }
}

bool Run::act(const EventWatch::Hit& hit) {
  const Event& event = system().model->events()[static_cast<std::size_t>(hit.event)];
  summary_.events.push_back({event.name, hit.t, event.action, ""});
  const bool has_row = summary_.t_reached == hit.t;
  switched_ = event.action == EventSpec::Action::kSwitch;
  if (event.action == EventSpec::Action::kRecord) return has_row || emit_between(hit.t);
  watch_limits(hit.t);
  if (!land_on(hit.t)) return false;
  if (event.action == EventSpec::Action::kStop) {
    if (!has_row && !emit_here()) return false;
    return fail(RunStatus::kStoppedByEvent, fmt::format("event '{}' at t = {:g} s", event.name, hit.t));
  }
  summary_.events.back().message = switch_drive(event.drive);
  evaluator_.decide(state_, fmt::format("event '{}'", event.name), summary_);
  if (!meets_laws(event)) return false;
  if (!solved(evaluator_.evaluate(state_))) return false;
  if (!std::isfinite(evaluator_.settle(state_))) return stuck();
  if (system().winding_count > 0) accept_winding(system(), evaluator_.positions(), state_);
  stepper_ = make_stepper(integrator_of(options_), evaluator_, !adaptive_);
  control_steps_.restart(state_.t);
  events_.acted(hit.event);
  return true;
}

// The step taken last again, but only to `t`: a run that ends there, or goes on otherwise, must know its work.
bool Run::land_on(double t) {
  const double h = t - between_.from.t;
  state_ = between_.from;
  work_ = work_before_;
  moved_ = false;
  if (!solved(evaluator_.evaluate(state_))) return false;
  if (h <= 0) return true;
  const Stepper::Outcome outcome = stepper_->step(evaluator_, between_.from, h, next_);
  if (!outcome.finite) return stuck();
  std::swap(state_, next_);
  state_.t = t;
  if (system().winding_count > 0) accept_winding(system(), evaluator_.positions(), state_);
  work_.drives += outcome.work.drives;
  work_.others += outcome.work.others;
  return true;
}

// Joints may leave their limits and come back within a step.
void Run::watch_limits(double until) {
  if (!limits_.any()) return;
  constexpr int kPieces = 4;
  const double from = std::max(between_.from.t, limits_.last_t());
  for (int i = 1; i <= kPieces && until > from; ++i) {
    between_.evaluate(system(), from + (until - from) * i / kPieces, sample_state_, sample_vdot_);
    limits_.observe(sample_state_);
  }
}

std::string Run::switch_drive(DriveId drive) {
  std::string told;
  for (int i = 0; i < model_->nu(); ++i) {
    if (model_->drives[i].drive != drive) continue;
    off_[static_cast<std::size_t>(i)] = !off_[static_cast<std::size_t>(i)];
    told = fmt::format("drive '{}' {}", model_->drives[i].name, off_[static_cast<std::size_t>(i)] ? "off" : "on");
  }
  use_switches();
  return told;
}

void Run::use_switches() {
  std::vector<int> driven;
  for (const int i : driven_) {
    if (!off_[static_cast<std::size_t>(i)]) driven.push_back(i);
  }
  evaluator_.set_drives(std::move(driven), off_);
}

// At the last row, which is where another run can go on: events after it happen again there.
std::vector<std::string> Run::drives_off() const {
  std::vector<std::string> off = options_.drives_off;
  for (const EventRecord& record : summary_.events) {
    if (record.action != EventSpec::Action::kSwitch || record.t > summary_.t_reached) continue;
    const auto& events = system().model->events();
    const auto event =
        std::find_if(events.begin(), events.end(), [&](const Event& e) { return e.name == record.name; });
    const std::string& name = system().model->drives()[event->drive.index()].name;
    const auto found = std::find(off.begin(), off.end(), name);
    if (found == off.end()) {
      off.push_back(name);
    } else {
      off.erase(found);
    }
  }
  return off;
}

// A prescribed motion that is switched on must find the mechanism where it begins.
bool Run::meets_laws(const Event& event) {
  if (!evaluator_.driven_conflict().empty()) {
    return fail(RunStatus::kBadMotion,
                fmt::format("event '{}' at t = {:g} s prescribes more motions than there are: {}", event.name, state_.t,
                            evaluator_.driven_conflict()));
  }
  if (evaluator_.driven().empty()) return true;
  const double off_by = evaluator_.left_out_residual();
  const auto refuse = [&](const char* what, double by, const char* unit) {
    return fail(
        RunStatus::kBadMotion,
        fmt::format("event '{}' switches a prescribed motion on at t = {:g} s, but the mechanism {} (by {:g} {}, "
                    "angles times the characteristic length)",
                    event.name, state_.t, what, by, unit));
  };
  const double L = evaluator_.scaling().length_m;
  if (off_by > 1e-6 * L) return refuse("is elsewhere", off_by, "m");
  const ConstraintKinematics& rows = evaluator_.equations().constraints;
  const long k = static_cast<long>(evaluator_.driven().size());
  const VectorXd scale = evaluator_.row_scale().tail(k);
  const double faster = (rows.rate - rows.nu).tail(k).cwiseProduct(scale).lpNorm<Eigen::Infinity>();
  const double speed = rows.nu.tail(k).cwiseProduct(scale).lpNorm<Eigen::Infinity>() + L;
  return faster <= 1e-6 * speed || refuse("moves at another speed", faster, "m/s");
}

void Run::note_singular_pose() {
  constexpr int kMostRows = 10000;  // each needs decisions just where most values are in doubt
  if (system().m > kMostRows) {
    if (!std::exchange(unlocated_told_, true)) {
      summary_.notices.push_back(
          fmt::format("a singular pose was crossed at t = {:g} s; where exactly, and further ones, are not looked for "
                      "in a mechanism "
                      "of more than {} closure rows",
                      state_.t, kMostRows));
    }
    return;
  }
  const auto probe = [this](double t, State& state) { state_at(t, state, sample_vdot_); };
  const auto pose = find_singular_pose(evaluator_, probe, between_.from.t, between_.to.t);
  if (pose) summary_.singular_poses.push_back(*pose);
}

// --- Output ---

bool Run::emit_until(double t, const std::vector<double>& times, std::size_t& due) {
  for (; due < times.size() && times[due] <= t; ++due) {
    if (!(times[due] >= state_.t ? emit_here() : emit_between(times[due]))) return false;
  }
  return true;
}

bool Run::emit_here() {
  if (std::exchange(moved_, false) && !solved(evaluator_.evaluate(state_))) return false;
  return record(state_, evaluator_.result().vdot, true);
}

// Outputs between steps are interpolated, so that the steps need not know the grid. Near a singular pose accelerations
// are those of the interpolant: rounding spoils the others.
bool Run::emit_between(double t) {
  state_at(t, sample_state_, sample_vdot_);
  const bool solved_there = crossing_ ? evaluator_.evaluate(sample_state_) == ForwardStatus::kSolved
                                      : std::isfinite(evaluator_.settle(sample_state_));
  return record(sample_state_, crossing_ || !solved_there ? sample_vdot_ : evaluator_.result().vdot, solved_there);
}

// `solved`: the last evaluation was at this state and gave multipliers. At a singular pose they are rounding divided by
// nearly nothing: no figures.
bool Run::record(const State& state, const VectorXd& vdot, bool solved) {
  constexpr double kSingular = 1e-6;
  solved = solved && !(evaluator_.pivot() < kSingular * evaluator_.best_pivot());
  const RunSample& sample = recorder_.record(state, evaluator_.equations(), evaluator_.joint_selection(), vdot,
                                             evaluator_.result().lambda.head(system().m), evaluator_.efforts(),
                                             options_.with_reactions && solved);
  if (const std::string reason = refused_range(recorder_.distribution()); !reason.empty()) {
    return fail(RunStatus::kUnsupported, reason);
  }
  if (!std::isfinite(sample.energy) && evaluator_.model().massless_bodies.empty()) {
    return fail(
        RunStatus::kStepTooSmall,
        fmt::format("the energy has no finite value at t = {:g} s: some formula of it is not defined there", state.t));
  }
  energy_ = sample.energy;
  elastic_ = sample.elastic_energy;
  summary_.energy_end = energy_;
  summary_.energy_min = std::min(summary_.energy_min, energy_);
  summary_.energy_max = std::max(summary_.energy_max, energy_);
  summary_.max_constraint_residual = std::max(summary_.max_constraint_residual, sample.constraint_residual);
  follow_momentum(!summary_.momentum);
  summary_.t_reached = state.t;
  if (control_.on_sample) control_.on_sample(sample);
  return true;
}

void Run::follow_momentum(bool first) {
  const Momentum now = compute_momentum(*model_, evaluator_.positions(), evaluator_.velocities());
  if (!summary_.momentum) summary_.momentum.emplace();
  MomentumSummary& m = *summary_.momentum;
  if (first) {
    m.linear_start = now.linear;
    m.angular_start = now.angular;
  }
  m.linear_end = now.linear;
  m.angular_end = now.angular;
  m.linear_change = m.linear_change.cwiseMax((now.linear - m.linear_start).cwiseAbs());
  m.angular_change = m.angular_change.cwiseMax((now.angular - m.angular_start).cwiseAbs());
  m.linear_scale = std::max(m.linear_scale, now.linear.lpNorm<Eigen::Infinity>());
  m.angular_scale = std::max(m.angular_scale, now.angular.lpNorm<Eigen::Infinity>());
}

}  // namespace ferrers
