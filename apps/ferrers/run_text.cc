#include "run_text.h"

#include <fmt/format.h>

using namespace ferrers;  // NOLINT(google-build-using-namespace)

namespace {

constexpr std::size_t kMostDecisions = 8, kMostJoints = 60;

std::string line(std::string_view label, std::string_view text) { return fmt::format("  {:<15}{}\n", label, text); }

std::string verb_done(const RunDocument& document) {
  const bool ended = document.summary->status == RunStatus::kFinished;
  const std::string what = document.verb == "simulate"  ? "simulated"
                           : document.verb == "inverse" ? "forces for the prescribed motion"
                                                        : "the prescribed motion";
  return fmt::format(
      "{} to t = {} s{}", what, number(document.summary->t_reached),
      ended ? "" : fmt::format(" ({})", run_status_name(document.summary->status, document.interrupted)));
}

std::string load(const std::optional<double>& value, double t, bool determined, bool distributed, std::string_view unit,
                 const Style& style) {
  if (!value) return style.yellow("undetermined");
  const std::string remark = !determined   ? style.yellow(" (undetermined at times)")
                             : distributed ? " (distributed)"
                                           : "";
  return fmt::format("{} {} at {} s{}", number(*value), unit, number(t), remark);
}

std::string drives_text(const RunDocument& document, const Style& style) {
  if (document.drives.empty() || !document.with_reactions) return "";
  std::vector<std::vector<std::string>> rows = {{"drive", "largest effort"}};
  for (const DrivePeak& one : document.drives) {
    const auto i = static_cast<std::size_t>(&one - document.drives.data());
    const std::vector<bool>& shared = document.summary->effort_is_shared;
    const char* mark = i < shared.size() && shared[i] ? " (distributed)" : "";
    rows.push_back({one.drive, one.effort
                                   ? fmt::format("{} {} at {} s{}", number(*one.effort), one.unit, number(one.t), mark)
                                   : "not known"});
  }
  return "\n" + table(rows, "  ", style);
}

std::string loads_text(const RunDocument& document, const Style& style) {
  const auto& peaks = document.summary->peaks;
  if (!document.with_reactions || peaks.empty() || peaks.size() != document.joints.size()) return "";
  std::vector<std::vector<std::string>> rows = {{"joint", "largest force", "largest moment"}};
  bool all = true;
  for (std::size_t i = 0; i < peaks.size(); ++i) {
    const JointPeak& peak = peaks[i];
    all = all && peak.force && peak.moment && peak.force_determined && peak.moment_determined;
    if (i >= kMostJoints) continue;
    rows.push_back({document.joints[i],
                    load(peak.force, peak.force_t, peak.force_determined, peak.force_distributed, "N", style),
                    load(peak.moment, peak.moment_t, peak.moment_determined, peak.moment_distributed, "N·m", style)});
  }
  std::string text = "\n" + table(rows, "  ", style);
  if (peaks.size() > kMostJoints) {
    text += style.dim(fmt::format("  and {} more (summary.json lists all)\n", peaks.size() - kMostJoints));
  }
  if (!all) {
    text += style.dim(
        "  Undetermined: rigid bodies do not tell how redundant constraints share the load. Single components that\n"
        "  are unique all the same stand in reactions.csv. To divide the rest give joints a 'stiffness', or say\n"
        "  --distribute equal.\n");
  }
  return text;
}

std::string decisions_text(const RunSummary& summary) {
  if (summary.decisions.empty()) return "";
  std::string text;
  const std::size_t shown = std::min(summary.decisions.size(), kMostDecisions);
  for (std::size_t i = 0; i < shown; ++i) {
    const DecisionRecord& one = summary.decisions[i];
    std::string what = fmt::format("t = {} s: rank {}, mobility {}", number(one.t), one.rank, one.mobility);
    if (!one.reason.empty()) what += ": " + one.reason;
    text += line(i == 0 ? "decisions" : "", what);
  }
  if (shown < summary.decisions.size()) {
    text += line("", fmt::format("and {} more, in summary.json", summary.decisions.size() - shown));
  }
  return text;
}

std::string singular_text(const RunSummary& summary) {
  std::string text;
  const std::size_t shown = std::min(summary.singular_poses.size(), kMostDecisions);
  for (std::size_t i = 0; i < shown; ++i) {
    const SingularPose& one = summary.singular_poses[i];
    text += line(i == 0 ? "singular" : "",
                 fmt::format("t = {:.9g} s: rank {} instead of {}, mobility {}, {} redundant", one.t, one.all_rank,
                             one.all_rank_around, one.mobility, one.redundant));
  }
  if (shown < summary.singular_poses.size()) {
    text += line("", fmt::format("and {} more, in summary.json", summary.singular_poses.size() - shown));
  }
  return text;
}

std::string distribution_text(const DistributionSummary& distribution) {
  std::string text;
  if (distribution.used) {
    std::string what = "loads that rigid bodies leave open are shared out by the joints' stiffness";
    if (distribution.by == DistributionBy::kEqualStiffness) {
      what = fmt::format(
          "loads that rigid bodies leave open are shared out by equal stiffness of all joints, moments over {} m",
          number(distribution.length_m));
    }
    text += line("distribution", what);
    if (distribution.range) {
      const bool exact = distribution.bounds == BoundsMethod::kExact;
      text += line("ranges", fmt::format("for every stiffness times {} to {}: {}", number(distribution.range->low),
                                         number(distribution.range->high),
                                         exact ? "exact" : "found by search, the true ones may be wider"));
    }
  }
  for (const std::string& notice : distribution.notices) text += line("note", notice);
  return text;
}

// What should not change, and by how much it did.
std::string conserved(std::string_view what, std::string_view unit, const Vector3d& start, const Vector3d& change,
                      double scale) {
  constexpr double kConstant = 1e-9;
  std::string text;
  for (int i = 0; i < 3; ++i) {
    if (!(scale > 0) || change[i] > kConstant * scale || std::abs(start[i]) <= kConstant * scale) continue;
    text += fmt::format("{}{} {} {} {}, changed by at most {}", text.empty() ? "" : "; ", what, "xyz"[i],
                        number(start[i]), unit, rough(change[i]));
  }
  return text;
}

std::string witnesses_text(const RunSummary& summary) {
  std::string text;
  if (summary.error_estimate) {
    text += line("accuracy", fmt::format("positions differ by {} (rad, or characteristic lengths) from a run with ten "
                                         "times the tolerance",
                                         rough(*summary.error_estimate)));
  }
  if (summary.work && (summary.work->drives != 0 || summary.work->others != 0)) {
    text += line("work",
                 fmt::format("of drives {} J, of dampers, friction and loads {} J; the balance of energy is off "
                             "by {} J",
                             number(summary.work->drives), number(summary.work->others), rough(summary.balance_error)));
  }
  if (summary.momentum) {
    const MomentumSummary& m = *summary.momentum;
    const std::string linear = conserved("momentum", "kg·m/s", m.linear_start, m.linear_change, m.linear_scale);
    const std::string angular =
        conserved("angular momentum", "kg·m²/s", m.angular_start, m.angular_change, m.angular_scale);
    if (!linear.empty()) text += line("constant", linear);
    if (!angular.empty()) text += line("constant", angular);
  }
  return text;
}

std::string events_text(const RunSummary& summary) {
  std::string text;
  const std::size_t shown = std::min(summary.events.size(), kMostDecisions);
  for (std::size_t i = 0; i < shown; ++i) {
    const EventRecord& one = summary.events[i];
    const std::string what = !one.message.empty()                     ? one.message
                             : one.action == EventSpec::Action::kStop ? "the run ends"
                                                                      : "a row of its own";
    text += line(i == 0 ? "events" : "", fmt::format("t = {:.9g} s: '{}': {}", one.t, one.name, what));
  }
  if (shown < summary.events.size()) {
    text += line("", fmt::format("and {} more, in summary.json", summary.events.size() - shown));
  }
  return text;
}

}  // namespace

std::string run_text(const RunDocument& document, long rows, const std::string& files, const Style& style) {
  const RunSummary& summary = *document.summary;
  std::string text = fmt::format("{}: {}\n\n", style.bold(document.model), verb_done(document));
  text += line("method", summary.method);
  std::string steps = fmt::format("{}", summary.steps);
  if (summary.rejected_steps > 0) steps += fmt::format(" and {} rejected", summary.rejected_steps);
  if (summary.evaluations > 0) steps += fmt::format(", {}", counted(summary.evaluations, "evaluation"));
  text += line("steps", fmt::format("{}, {} s of computing", steps, rough(summary.wall_time_s)));
  text += line("closure error", fmt::format("at most {} m", rough(summary.max_constraint_residual)));
  if (document.verb == "simulate") {
    text += line("energy", fmt::format("{} J at the start, changed by {} J at the end; between {} and {} J",
                                       number(summary.energy_start), rough(summary.energy_end - summary.energy_start),
                                       number(summary.energy_min), number(summary.energy_max)));
  }
  if (document.verb == "simulate") text += witnesses_text(summary);
  text += decisions_text(summary) + singular_text(summary) + events_text(summary);
  for (const std::string& notice : summary.notices) text += line("note", notice);
  if (document.with_reactions) text += distribution_text(summary.distribution);
  text += drives_text(document, style);
  text += loads_text(document, style);
  if (document.folder)
    text += fmt::format("\n  {} in {}\n    {}\n", counted(rows, "row"), style.bold(*document.folder), files);
  return text;
}
