#include <algorithm>
#include <cmath>

#include "ferrers/core/checks.h"
#include "ferrers/dynamics/holding.h"
#include "ferrers/io/json_values.h"
#include "ferrers/io/run_folder.h"

namespace ferrers {
namespace {

template <class T>
OrderedJson value_or_null(const std::optional<T>& value) {
  return value ? OrderedJson(*value) : OrderedJson();
}

OrderedJson decision_value(const DecisionRecord& decision) {
  OrderedJson value;
  value["t"] = decision.t;
  value["rank"] = decision.rank;
  value["mobility"] = decision.mobility;
  value["excluded_rows"] = decision.excluded_rows;
  value["independent_coordinates"] = decision.independent_coordinates;
  value["reason"] = decision.reason;
  return value;
}

std::string_view load_status(const JointPeak& peak) {
  if (!peak.force && !peak.moment) return "undetermined";
  if (!peak.force_determined || !peak.moment_determined) return "partly";
  return peak.force_distributed || peak.moment_distributed ? "distributed" : "determined";
}

OrderedJson joint_value(const std::string& name, const JointPeak& peak) {
  OrderedJson value;
  value["joint"] = name;
  value["max_force_N"] = value_or_null(peak.force);
  value["max_force_t"] = peak.force ? OrderedJson(peak.force_t) : OrderedJson();
  value["max_moment_Nm"] = value_or_null(peak.moment);
  value["max_moment_t"] = peak.moment ? OrderedJson(peak.moment_t) : OrderedJson();
  value["status"] = load_status(peak);
  return value;
}

OrderedJson joint_values(const RunDocument& document) {
  if (!document.with_reactions || document.summary->peaks.empty()) return nullptr;
  require_size(static_cast<long>(document.joints.size()), static_cast<long>(document.summary->peaks.size()),
               "write_summary_json: joints");
  OrderedJson all = OrderedJson::array();
  for (std::size_t i = 0; i < document.joints.size(); ++i) {
    all.push_back(joint_value(document.joints[i], document.summary->peaks[i]));
  }
  return all;
}

// "distributed": more drives act than the motion needs, and the effort is the share of the least weighted effort.
OrderedJson effort_status(const RunDocument& document, std::size_t drive) {
  if (!document.drives[drive].effort) return nullptr;
  const std::vector<bool>& shared = document.summary->effort_is_shared;
  return drive < shared.size() && shared[drive] ? "distributed" : "unique";
}

OrderedJson drive_values(const RunDocument& document) {
  OrderedJson all = OrderedJson::array();
  for (std::size_t i = 0; i < document.drives.size(); ++i) {
    const DrivePeak& one = document.drives[i];
    OrderedJson value;
    value["drive"] = one.drive;
    value["max_effort"] = value_or_null(one.effort);
    value["max_effort_t"] = one.effort ? OrderedJson(one.t) : OrderedJson();
    value["unit"] = one.unit;
    value["status"] = effort_status(document, i);
    all.push_back(std::move(value));
  }
  return all;
}

OrderedJson distribution_value(const DistributionSummary& distribution) {
  if (!distribution.used) return nullptr;
  const bool equal = distribution.by == DistributionBy::kEqualStiffness;
  OrderedJson value;
  value["by"] = equal ? "equal stiffness" : "joint stiffness";
  value["length_m"] = equal ? OrderedJson(distribution.length_m) : OrderedJson();
  value["stiffness_range"] = nullptr;
  value["bounds"] = nullptr;
  if (distribution.range) {
    value["stiffness_range"] = {distribution.range->low, distribution.range->high};
    value["bounds"] = to_string(distribution.bounds);
  }
  return value;
}

OrderedJson vector_value(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

OrderedJson balance_value(const RunSummary& summary) {
  if (!summary.work || !summary.has_energy) return nullptr;
  return {{"work_of_drives_J", summary.work->drives},
          {"work_of_other_forces_J", summary.work->others},
          {"error_J", summary.balance_error}};
}

OrderedJson momentum_value(const std::optional<MomentumSummary>& momentum) {
  if (!momentum) return nullptr;
  const auto part = [](const Vector3d& start, const Vector3d& end, const Vector3d& change) -> OrderedJson {
    return {{"start", vector_value(start)}, {"end", vector_value(end)}, {"largest_change", vector_value(change)}};
  };
  return {{"linear_kgmps", part(momentum->linear_start, momentum->linear_end, momentum->linear_change)},
          {"angular_kgm2ps", part(momentum->angular_start, momentum->angular_end, momentum->angular_change)}};
}

std::string_view action_name(EventSpec::Action action) {
  switch (action) {
    case EventSpec::Action::kStop:
      return "stop";
    case EventSpec::Action::kRecord:
      return "record";
    case EventSpec::Action::kSwitch:
      break;
  }
  return "switch";
}

OrderedJson event_values(const RunSummary& summary) {
  OrderedJson all = OrderedJson::array();
  for (const EventRecord& one : summary.events) {
    all.push_back({{"event", one.name},
                   {"t", one.t},
                   {"do", action_name(one.action)},
                   {"message", one.message.empty() ? OrderedJson() : OrderedJson(one.message)}});
  }
  return all;
}

OrderedJson limit_values(const RunSummary& summary) {
  OrderedJson all = OrderedJson::array();
  for (const LimitCrossing& one : summary.limits) {
    all.push_back({{"joint", one.joint},
                   {"side", one.upper ? "high" : "low"},
                   {"limit", one.limit},
                   {"t", one.t},
                   {"times", one.times},
                   {"largest_excess", one.excess},
                   {"largest_excess_t", one.excess_t}});
  }
  return all;
}

void add_summary(const RunDocument& document, OrderedJson& out) {
  const RunSummary& summary = *document.summary;
  out["status"] = run_status_name(summary.status, document.interrupted);
  out["message"] = summary.message.empty() ? OrderedJson() : OrderedJson(summary.message);
  out["method"] = summary.method;
  out["t_reached"] = summary.t_reached;
  out["steps"] = summary.steps;
  out["rejected"] = summary.rejected_steps;
  out["evaluations"] = summary.evaluations;
  out["smallest_step_s"] = summary.smallest_step > 0 ? OrderedJson(summary.smallest_step) : OrderedJson();
  out["largest_step_s"] = summary.largest_step > 0 ? OrderedJson(summary.largest_step) : OrderedJson();
  out["wall_time_s"] = summary.wall_time_s;
  out["max_constraint_residual_m"] = summary.max_constraint_residual;
  out["energy"] = nullptr;
  if (summary.has_energy) {
    out["energy"] = {{"start", summary.energy_start},
                     {"end", summary.energy_end},
                     {"min", summary.energy_min},
                     {"max", summary.energy_max},
                     {"drift", summary.energy_end - summary.energy_start}};
  }
  out["balance"] = balance_value(summary);
  out["momentum"] = momentum_value(summary.momentum);
  out["error_estimate"] = value_or_null(summary.error_estimate);
  out["events"] = event_values(summary);
  out["drives_off"] = summary.drives_off;
  out["joint_limits"] = limit_values(summary);
  OrderedJson decisions = OrderedJson::array();
  for (const DecisionRecord& decision : summary.decisions) decisions.push_back(decision_value(decision));
  out["decisions"] = std::move(decisions);
  OrderedJson poses = OrderedJson::array();
  for (const SingularPose& pose : summary.singular_poses) {
    poses.push_back({{"t", pose.t},
                     {"rank", pose.all_rank},
                     {"rank_around", pose.all_rank_around},
                     {"closure_rank", pose.rank},
                     {"closure_rank_around", pose.rank_around},
                     {"mobility", pose.mobility},
                     {"redundant", pose.redundant}});
  }
  out["singular_poses"] = std::move(poses);
  out["notices"] = summary.notices;
  for (const std::string& notice : summary.distribution.notices) out["notices"].push_back(notice);
  out["distribution"] = distribution_value(summary.distribution);
  out["drives"] = drive_values(document);
  out["joints"] = joint_values(document);
}

}  // namespace

DrivePeaks::DrivePeaks(const DynamicsModel& model) {
  const std::vector<std::string> columns = run_columns(model);
  for (const DriveComponent& drive : model.drives) {
    if (!drive.acts) continue;
    const auto found = std::find(columns.begin(), columns.end(), drive.name + ".effort");
    require(found != columns.end(), "DrivePeaks: a drive without a column");
    columns_.push_back(static_cast<std::size_t>(found - columns.begin()));
    peaks_.push_back({drive.name, std::string(effort_unit(drive)), std::nullopt, 0});
  }
}

void DrivePeaks::add(const RunSample& sample) {
  for (std::size_t i = 0; i < peaks_.size(); ++i) {
    const double effort = sample.values.at(columns_[i]);
    DrivePeak& peak = peaks_[i];
    if (!std::isfinite(effort) || (peak.effort && std::abs(effort) <= std::abs(*peak.effort))) continue;
    peak.effort = effort;
    peak.t = sample.t;
  }
}

std::string_view run_status_name(RunStatus status, bool interrupted) {
  switch (status) {
    case RunStatus::kFinished:
      return "finished";
    case RunStatus::kStopped:
      return interrupted ? "interrupted" : "stopped";
    case RunStatus::kStoppedByEvent:
      return "stopped";
    case RunStatus::kNotAssembled:
      return "not_assembled";
    case RunStatus::kInconsistentVelocities:
      return "inconsistent_velocities";
    case RunStatus::kSingularMass:
      return "singular_mass";
    case RunStatus::kStepTooSmall:
      return "step_too_small";
    case RunStatus::kRedundancyEnded:
      return "redundancy_ended";
    case RunStatus::kBadMotion:
      return "bad_motion";
    case RunStatus::kUnsupported:
      return "unsupported";
  }
  return "unknown";
}

std::string write_summary_json(const RunDocument& document) {
  const bool errors = document.diagnostics != nullptr && document.diagnostics->has_errors();
  const bool ran = document.summary != nullptr && (document.summary->status == RunStatus::kFinished ||
                                                   document.summary->status == RunStatus::kStopped ||
                                                   document.summary->status == RunStatus::kStoppedByEvent);
  OrderedJson out;
  out["schema"] = "ferrers.run/1";
  out["verb"] = document.verb;
  out["model"] = document.model.empty() ? OrderedJson() : OrderedJson(document.model);
  out["ok"] = ran && !document.interrupted && !errors;
  if (document.summary != nullptr) {
    add_summary(document, out);
  } else {
    for (const char* key : {"status",
                            "message",
                            "method",
                            "t_reached",
                            "steps",
                            "rejected",
                            "evaluations",
                            "smallest_step_s",
                            "largest_step_s",
                            "wall_time_s",
                            "max_constraint_residual_m",
                            "energy",
                            "balance",
                            "momentum",
                            "error_estimate",
                            "events",
                            "drives_off",
                            "joint_limits",
                            "decisions",
                            "singular_poses",
                            "notices",
                            "distribution",
                            "drives",
                            "joints"}) {
      out[key] = nullptr;
    }
  }
  out["folder"] = value_or_null(document.folder);
  out["diagnostics"] =
      document.diagnostics != nullptr ? diagnostics_value(*document.diagnostics) : OrderedJson::array();
  return json_text(out);
}

}  // namespace ferrers
