#include <algorithm>
#include <chrono>

#include "ferrers/core/checks.h"
#include "ferrers/dynamics/inverse.h"
#include "ferrers/dynamics/joint_limits.h"
#include "ferrers/dynamics/law_notices.h"
#include "ferrers/simulate/simulation.h"

namespace ferrers {
namespace {

DecisionRecord describe(const System& system, const Selection& selection) {
  DecisionRecord record;
  record.rank = static_cast<int>(selection.rows.size());
  record.mobility = static_cast<int>(selection.independent.size());
  record.reason = "start";
  for (const int row : selection.excluded_rows(system.m)) record.excluded_rows.push_back(system.row_names[row]);
  for (const int v : selection.independent) record.independent_coordinates.push_back(system.coordinate_names[v]);
  return record;
}

RunStatus run_status(PrescribedStatus status) {
  switch (status) {
    case PrescribedStatus::kSolved:
      return RunStatus::kFinished;
    case PrescribedStatus::kUndriven:
    case PrescribedStatus::kContradictory:
    case PrescribedStatus::kUndefined:
      return RunStatus::kBadMotion;
    case PrescribedStatus::kNotReached:
    case PrescribedStatus::kSingular:
    case PrescribedStatus::kJammed:
      return RunStatus::kStepTooSmall;
    case PrescribedStatus::kUndeterminedFriction:
      break;
  }
  return RunStatus::kUnsupported;
}

std::string quoted(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "'" : ", '") + name + "'";
  return text;
}

// What the model asks for and a run of this kind cannot do; empty: nothing.
std::string obstacle(const DynamicsModel& model, bool with_efforts) {
  if (!with_efforts) return "";
  if (!model.unsupported.empty()) return "efforts cannot be computed: the model has " + model.unsupported.front();
  return "";
}

// One run: instants of the output grid, each continued from the one before.
class PrescribedRun {
 public:
  PrescribedRun(std::shared_ptr<const DynamicsModel> model, const PrescribedOptions& options, const RunControl& control)
      : model_(std::move(model)),
        options_(options),
        control_(control),
        recorder_(model_, options.axes, options.distribution),
        limits_(model_) {
    summary_.has_energy = model_->massless_bodies.empty();
  }

  RunSummary go() {
    const auto begin = std::chrono::steady_clock::now();
    summary_.method = options_.with_efforts ? "prescribed motion, inverse dynamics" : "prescribed motion, kinematics";
    march();
    tell();
    summary_.wall_time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return std::move(summary_);
  }

 private:
  void fail(RunStatus status, const std::string& message) {
    summary_.status = status;
    summary_.message = message;
  }

  void march() {
    if (const std::string reason = obstacle(*model_, options_.with_efforts); !reason.empty()) {
      return fail(RunStatus::kUnsupported, reason);
    }
    const AssemblyResult assembly = assemble(*model_->system);
    if (assembly.status != AssemblyStatus::kAssembled) return fail(RunStatus::kNotAssembled, assembly.message);
    PrescribedMotion motion(model_, assembly.state, options_.distribution);
    summary_.decisions.push_back(describe(*model_->system, motion.selection()));
    follow(motion);
    summary_.notices.insert(summary_.notices.begin(), motion.notices().begin(), motion.notices().end());
  }

  void follow(PrescribedMotion& motion) {
    PrescribedResult result = motion.check();
    if (result.status != PrescribedStatus::kSolved) return fail(run_status(result.status), result.message);
    shared_.assign(result.effort_is_shared.size(), false);
    for (const double t : options_.grid.times()) {
      result = motion.solve(t, options_.with_efforts);
      if (result.status != PrescribedStatus::kSolved) return fail(run_status(result.status), result.message);
      if (!take(t, result, motion)) return;
    }
  }

  // Records one instant; false: the run ends here.
  bool take(double t, const PrescribedResult& result, const PrescribedMotion& motion) {
    ++summary_.steps;
    const Equations& eq = motion.equations();
    limits_.observe(result.state, eq.pos, eq.vel);
    for (std::size_t i = 0; i < shared_.size(); ++i) shared_[i] = shared_[i] || result.effort_is_shared[i];
    const RunSample& sample = recorder_.record(result.state, eq, motion.selection(), result.vdot, result.lambda,
                                               result.u, options_.with_efforts);
    if (const std::string reason = refused_range(recorder_.distribution()); !reason.empty()) {
      fail(RunStatus::kUnsupported, reason);
      return false;
    }
    note_energy(sample);
    summary_.max_constraint_residual = std::max(summary_.max_constraint_residual, sample.constraint_residual);
    summary_.t_reached = t;
    if (control_.on_sample) control_.on_sample(sample);
    if (control_.on_progress) control_.on_progress(t);
    if (!control_.stop || !control_.stop->load(std::memory_order_relaxed)) return true;
    fail(RunStatus::kStopped, "interrupted");
    return false;
  }

  void note_energy(const RunSample& sample) {
    if (!summary_.has_energy) return;
    if (summary_.steps == 1) summary_.energy_start = summary_.energy_min = summary_.energy_max = sample.energy;
    summary_.energy_end = sample.energy;
    summary_.energy_min = std::min(summary_.energy_min, sample.energy);
    summary_.energy_max = std::max(summary_.energy_max, sample.energy);
  }

  void tell() {
    const Model& model = *model_->system->model;
    for (std::string& notice : describe_sampled_laws(model, LawUse::kMotion, 0, options_.grid.t_end)) {
      summary_.notices.push_back(std::move(notice));
    }
    if (!model.events().empty()) {
      summary_.notices.emplace_back("events act in simulations only: those of this model are not watched here");
    }
    if (options_.with_efforts) tell_sharing();
    for (const LimitCrossing& one : limits_.crossings()) summary_.notices.push_back(ferrers::describe(one));
    summary_.peaks = recorder_.peaks();
    summary_.distribution = recorder_.distribution();
  }

  void tell_sharing() {
    std::vector<std::string> helpers, sharing;
    for (std::size_t i = 0; i < shared_.size(); ++i) {
      const DriveComponent& drive = model_->drives[i];
      if (!drive.motion && drive.effort_is_sought()) helpers.push_back(drive.name);
      if (shared_[i]) sharing.push_back(drive.name);
    }
    const bool all_act = std::all_of(model_->drives.begin(), model_->drives.end(),
                                     [](const DriveComponent& drive) { return drive.acts; });
    if (!helpers.empty() && all_act) {  // else they are what brings the prescribed motions about
      summary_.notices.push_back("without a motion or an effort of their own, these drives help: " + quoted(helpers));
    }
    if (!sharing.empty()) {
      summary_.notices.push_back(
          "more drives act than the motion needs: the efforts of " + quoted(sharing) +
          " are not unique, those with the least sum of (weight · effort)², in N and N·m, are given; reactions that "
          "depend on that choice are marked distributed");
    }
    summary_.effort_is_shared = shared_;
  }

  std::shared_ptr<const DynamicsModel> model_;
  const PrescribedOptions& options_;
  const RunControl& control_;
  Recorder recorder_;
  LimitWatch limits_;
  RunSummary summary_;
  std::vector<bool> shared_;
};

}  // namespace

RunSummary run_prescribed(std::shared_ptr<const DynamicsModel> model, const PrescribedOptions& options,
                          const RunControl& control) {
  require(model != nullptr, "run_prescribed: no model");
  return PrescribedRun(std::move(model), options, control).go();
}

}  // namespace ferrers
