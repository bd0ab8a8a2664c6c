#include "analysis_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <map>

#include "ferrers/model/joints/joint_type.h"

using namespace ferrers;  // NOLINT(google-build-using-namespace)

namespace {

constexpr std::size_t kMostListed = 8;

std::string heading(int number, std::string_view question, const Style& style) {
  return "\n" + style.bold(fmt::format("{}  {}", number, question)) + "\n";
}

std::string listed(const std::vector<std::string>& names) {
  const std::size_t shown = std::min(names.size(), kMostListed);
  std::string text = fmt::format("{}", fmt::join(names.begin(), names.begin() + static_cast<long>(shown), ", "));
  return shown < names.size() ? text + fmt::format(" and {} more", names.size() - shown) : text;
}

// Bodies of the file that are one body of the model.
std::string groups_text(const Model& model) {
  std::string text;
  std::size_t shown = 0, groups = 0, parts = 0;
  for (const Body& body : model.bodies()) {
    if (body.parts.empty()) continue;
    ++groups;
    parts += body.parts.size();
    if (shown++ >= kMostListed) continue;
    std::vector<std::string> names;
    for (const Part& part : body.parts) names.push_back(part.name);
    text += wrapped_text("   " + body.name + "  ", fmt::format("{} parts: {}", names.size(), listed(names)), "     ");
  }
  if (groups == 0) return "";
  if (shown > kMostListed) text += fmt::format("   and {} more (--json lists all)\n", shown - kMostListed);
  return fmt::format("\n   {} parts are {}, held by welds that bear no reactions here ('--welds keep' gives them):\n",
                     parts, counted(static_cast<long>(groups), "rigid group")) +
         text;
}

std::string certainty_text(const RedundancyReport& report, const ContradictionReport& closure, const Style& style) {
  const RankDecision& decision = report.decision;
  const auto& values = decision.singular_values;
  if (report.closure_rows == 0) return "   There is no closed loop, so nothing can be redundant.\n";
  std::string text;
  std::string size = fmt::format("of the loops' {} for {}", counted(report.closure_rows, "equation"),
                                 counted(report.closure_coordinates, "coordinate"));
  if (!report.exact_values) size += " (by orthogonal elimination)";
  if (decision.full) {
    text = fmt::format("all singular values {} are away from zero", size);
    if (values.size() > 0) text += fmt::format(", the smallest is {}", rough(values[values.size() - 1]));
  } else {
    text = fmt::format("{}, rank {}:\n   ", size, decision.rank);
    if (decision.rank > 0) text += fmt::format("smallest singular value kept {}, ", rough(values[decision.rank - 1]));
    if (decision.rank < values.size()) text += fmt::format("largest dropped {}", rough(values[decision.rank]));
    if (decision.rank > 0 && decision.rank < values.size()) text += fmt::format(", gap {}", rough(decision.gap));
  }
  // Where joints give way on purpose, the misclosure blurs the rank; the verdict on closing counts.
  if (closure.verdict == ClosureVerdict::kElastic && closure.confident)
    return fmt::format("   At best fit: {}.\n", text);
  if (decision.confident) return fmt::format("   {}: {}.\n", style.green("Certain"), text);
  const int other = report.closure_rows - decision.other_rank;
  return fmt::format(
      "   {}: {}.\n   Read the other way, {} would be redundant. Nearly special dimensions do this: check them.\n",
      style.red("Doubtful"), text, counted(other, "constraint"));
}

std::string counts_text(const RedundancyReport& report, const ContradictionReport& closure, const Style& style) {
  std::string text = heading(1, "How can it move, and how many constraints are redundant?", style);
  text += fmt::format("   mobility   {:>4}   independent {}\n", report.mobility,
                      report.mobility == 1 ? "motion" : "motions");
  text += fmt::format("   redundant  {:>4}   of {}, which have rank {}\n", report.redundant,
                      counted(report.constraint_rows, "constraint"), report.rank);
  text += fmt::format("   counting   {:>4}   is what Grübler's formula would give for the mobility\n", report.grubler);
  return text + certainty_text(report, closure, style);
}

// What was done about numbers that are good to a tolerance only.
std::string geometry_text(const ConsistentGeometry& geometry, const Style& style) {
  if (geometry.text.empty()) return "";
  const bool found = geometry.verdict == GeometryVerdict::kFound;
  std::string first = geometry.text;
  first[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(first[0])));
  std::string text = "\n" + wrapped_text(found ? "" : style.yellow("Geometry") + ": ", first + ".", "");
  std::size_t shown = 0;
  for (const ParallelAxes& group : geometry.parallel) {
    if (shown++ == kMostListed) break;
    text += wrapped_text("",
                         fmt::format("The axes of {} are parallel to {}; treated as parallel.", listed(group.joints),
                                     angle_text(group.angle_rad)),
                         "");
  }
  return text;
}

std::string closure_text(const ContradictionReport& closure, const Style& style) {
  std::string text;
  if (closure.verdict == ClosureVerdict::kElastic) {
    text += wrapped_text("   " + style.yellow("Elastic") + ": ", closure.text, "   ");
  } else if (!closure.confident) {
    text += wrapped_text("   " + style.red("Doubtful") + ": ", closure.text, "   ");
  }
  return text;
}

// "force_x moment_z", without the joint's name before the slash.
std::string component_of(const std::string& row) {
  const std::size_t slash = row.rfind('/');
  return slash == std::string::npos ? std::string("effort") : row.substr(slash + 1);
}

// One self-stress: its joints, gathered by the components that it loads.
std::string stress_text(const RedundancyReport& report, int k) {
  std::map<int, std::string> loads;
  double largest = 0;
  for (SparseMatrixXd::InnerIterator it(report.self_stresses, k); it; ++it) {
    largest = std::max(largest, std::abs(it.value() / report.rows.scale[it.row()]));
  }
  for (const int joint : report.self_stress_places[k].joints) {
    for (int i = 0; i < report.rows.count[joint]; ++i) {
      const int row = report.rows.first[joint] + i;
      const double value = report.self_stresses.coeff(row, k) / report.rows.scale[row];
      if (is_negligible(value, largest)) continue;
      loads[joint] += (loads[joint].empty() ? "" : " ") + component_of(report.rows.names[row]);
    }
  }
  std::vector<std::pair<std::string, std::vector<std::string>>> gathered;
  for (const auto& load : loads) {
    const std::string& components = load.second;
    auto same = std::find_if(gathered.begin(), gathered.end(), [&](const auto& g) { return g.first == components; });
    if (same == gathered.end()) same = gathered.insert(same, {components, {}});
    same->second.push_back(report.reactions[load.first].joint);
  }
  std::string text;
  for (const auto& [components, joints] : gathered) {
    text += (text.empty() ? "" : "; ") + fmt::format("{}: {}", fmt::join(joints, ", "), components);
  }
  return text;
}

constexpr int kMostStresses = 10, kMostJoints = 40, kMostReleases = 5;

std::string sharing_text(const RedundancyReport& report, const Style& style) {
  std::string text = heading(
      2, report.joints > 0 || report.coordinates == 0 ? "Which joints share them?" : "Which constraints share them?",
      style);
  if (report.redundant == 0) return text + "   None: no constraint is redundant.\n";
  std::vector<std::string> sharing, clean;
  for (const ReactionUniqueness& one : report.reactions) {
    if (one.is_constraint) (one.participates ? sharing : clean).push_back(one.joint);
  }
  const auto some = [](std::vector<std::string> names) {
    const std::size_t count = names.size();
    if (count <= kMostJoints) return names;
    names.resize(kMostJoints);
    names.push_back(fmt::format("and {} more", count - kMostJoints));
    return names;
  };
  text += wrapped_list(fmt::format("   {} of {}:", sharing.size(),
                                   counted(static_cast<long>(sharing.size() + clean.size()),
                                           report.joints > 0 ? "joint" : "constraint")),
                       some(sharing), "      ");
  text += clean.empty() ? (report.joints > 0 ? "   No joint is clean of them.\n" : "   All share them.\n")
                        : wrapped_list("   Clean:", some(clean), "      ");
  text +=
      fmt::format("   {} can be held against each other with no load outside:\n",
                  report.redundant == 1 ? "One state of stress" : counted(report.redundant, "state") + " of stress");
  for (int k = 0; k < std::min(report.redundant, kMostStresses); ++k) {
    text += wrapped_text(fmt::format("   {:>3}  ", k + 1), stress_text(report, k), "        ");
  }
  if (report.redundant > kMostStresses) {
    text += style.dim(fmt::format("        and {} more (--json lists all)\n", report.redundant - kMostStresses));
  }
  return text +
         wrapped_list("   Could be left out, as one choice of several:", some(report.excluded_row_names), "      ");
}

std::string kind_text(const RedundancyReport& report, const PermanenceReport& permanence) {
  std::string text;
  switch (permanence.kind) {
    case Permanence::kNone:
      return "   Nothing is redundant in this pose.\n";
    case Permanence::kUnknown:
      return "   Not known: no other configuration could be reached.\n";
    case Permanence::kPermanent:
      text = "   Permanent: the same redundancy";
      break;
    case Permanence::kConfiguration:
      text = "   In this pose only: no redundancy";
      break;
    case Permanence::kMixed:
      text = fmt::format("   Mixed: {} here, but only {}", report.redundant, *permanence.generic_redundant);
      break;
  }
  if (permanence.configurations == 0) return text + " wherever it is: nothing moves.\n";
  return text + fmt::format(" at {}{}.\n", counted(permanence.configurations, "other configuration"),
                            permanence.confident ? "" : ", some with a rank in doubt");
}

std::string motion_text(const RedundancyReport& report, const PermanenceReport& permanence, const Style& style) {
  std::string text;
  if (permanence.is_shaky) {
    text +=
        "   " + style.yellow("Shaky") + ": some loops only seem to move. They are rigid, but with play they rattle.\n";
  }
  if (permanence.finite_mobility && *permanence.finite_mobility < report.mobility) {
    text += fmt::format("   Of the mobility {}, motions through this pose have {} at most ({}).\n", report.mobility,
                        counted(*permanence.finite_mobility, "dimension"), to_string(permanence.basis));
  } else if (!permanence.finite_mobility && report.mobility > 0) {
    text += "   That the mechanism really moves from this pose is not established.\n";
  }
  if (permanence.branches.size() > 1) {
    text += fmt::format("   {} branches of motion meet in this pose{}:\n", permanence.branches.size(),
                        permanence.all_branches ? "" : ", perhaps more");
    for (const BranchReport& branch : permanence.branches) {
      std::vector<std::string> moving;
      for (const auto& [name, rate] : branch.direction) moving.push_back(name);
      text += wrapped_list(fmt::format("      dimension {}, {} redundant; moves", branch.dimension, branch.redundant),
                           moving, "         ");
    }
  } else if (permanence.generic_mobility && *permanence.generic_mobility != report.mobility) {
    text += fmt::format("   The mobility is {} here and {} at generic configurations: a singular pose.\n",
                        report.mobility, *permanence.generic_mobility);
  }
  if (!report.independent_coordinate_names.empty() && report.independent_coordinate_names.size() <= kMostJoints) {
    text += wrapped_list("   The motion is told by:", report.independent_coordinate_names, "      ");
  }
  return text;
}

std::string unique_names(const RedundancyReport& report, std::size_t index) {
  const ReactionUniqueness& one = report.reactions[index];
  if (one.unique_dimension == one.rows) return "all";
  std::string names;
  for (int row = 0; row < one.rows; ++row) {
    if (!one.unique[row]) continue;
    names += (names.empty() ? "" : " ") + component_of(report.rows.names[report.rows.first[index] + row]);
  }
  return names.empty() ? (one.unique_dimension > 0 ? "combinations only" : "none") : names;
}

std::string resultants_text(const std::vector<UniqueResultant>& resultants) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(resultants.size(), 8); ++i) {
    const UniqueResultant& one = resultants[i];
    const std::string what =
        one.unique_dimension == 6 ? "exact" : fmt::format("exact in {} of 6", one.unique_dimension);
    text += wrapped_text(
        "   ", fmt::format("Together {} is what {} give to '{}'.", what, fmt::join(one.joints, " + "), one.on_body),
        "      ");
  }
  return text;
}

std::string preload_text(const PreloadReport& preload, double length_m, const Style& style) {
  if (preload.status == PreloadStatus::kNone) return "";
  if (preload.status == PreloadStatus::kTooLarge) {
    return "   Too many states of stress for assembly stresses to be told.\n";
  }
  if (preload.status == PreloadStatus::kContradictory) {
    return wrapped_list("   " + style.red("Contradictory") + ": misalignment that rigid joints cannot take up, in",
                        preload.contradictory, "      ");
  }
  double largest = 0;  // N, moments over L
  for (const JointPreload& joint : preload.joints) {
    for (int k = 0; k < 6; ++k) {
      if (joint.status[k] == ReactionStatus::kUndetermined) continue;
      largest = std::max(largest, std::abs(joint.value[k]) / component_unit(k, length_m));
    }
  }
  if (largest == 0) return "   Joint stiffness divides them; assembly alone loads nothing.\n";
  std::vector<std::vector<std::string>> rows = {
      {"joint", "force_x", "force_y", "force_z", "moment_x", "moment_y", "moment_z"}};
  for (const JointPreload& joint : preload.joints) {
    std::vector<std::string> row = {joint.joint};
    for (int k = 0; k < 6; ++k) {
      const bool zero = is_negligible(joint.value[k] / component_unit(k, length_m), largest);
      row.push_back(joint.status[k] == ReactionStatus::kUndetermined ? "?" : number(zero ? 0 : joint.value[k]));
    }
    if (static_cast<int>(rows.size()) <= kMostJoints) rows.push_back(std::move(row));
  }
  return "   Assembly alone, by joint stiffness, puts into the joints (N, N·m, along their own axes):\n" +
         table(rows, "   ", style);
}

std::string constraint_type(const Model& model, std::size_t i) {
  if (i < model.joints().size()) return std::string(joint_type_info(model.joints()[i].type).name);
  return model.couplings()[i - model.joints().size()].relation ? "constraint" : "coupling";
}

std::string reactions_text(const Model& model, const MechanismAnalysis& analysis, const Style& style) {
  const RedundancyReport& report = *analysis.redundancy;
  std::string text = heading(4, "Which reactions are exact, and how do the others divide?", style);
  if (report.redundant == 0) return text + "   All reactions are exact.\n";
  std::vector<std::vector<std::string>> rows = {{"joint", "type", "exact", "components that are exact"}};
  std::size_t left_out = 0;
  for (std::size_t i = 0; i < report.reactions.size(); ++i) {
    const ReactionUniqueness& one = report.reactions[i];
    if (!one.is_constraint) continue;
    if (rows.size() > kMostJoints) {
      ++left_out;
      continue;
    }
    rows.push_back({one.joint, constraint_type(model, i), fmt::format("{} of {}", one.unique_dimension, one.rows),
                    unique_names(report, i)});
  }
  text += table(rows, "   ", style);
  if (left_out > 0) text += style.dim(fmt::format("   and {} more (--json lists all)\n", left_out));
  text += resultants_text(analysis.resultants);
  if (report.joints == 0) {
    return text +
           style.dim(
               "   A constraint's reaction is its multiplier. The others are not told apart by the constraints\n"
               "   alone: no value is given for them. Leave dependent ones out, or make them elastic: put their\n"
               "   stiffness into the potential energy.\n");
  }
  text += style.dim("   Components are along the joint's own axes; 'exact' counts dimensions whatever the axes.\n");
  const bool has_springs = std::any_of(model.joints().begin(), model.joints().end(),
                                       [](const Joint& joint) { return joint.stiffness.has_value(); });
  if (analysis.preload && analysis.preload->status != PreloadStatus::kNone) {
    text += preload_text(*analysis.preload, report.characteristic_length_m, style);
  } else if (has_springs) {
    text += "   The others divide by the joints' stiffness; 'inverse' and 'simulate' give their values.\n";
  } else {
    text += style.dim(
        "   The others depend on elasticity, play and assembly: no value is given for them. Give the joints a\n"
        "   'stiffness' and they are divided by it, or ask for '--distribute equal'.\n");
  }
  return text;
}

std::string release_line(const Release& release) {
  std::string text = release.says;
  if (release.alternatives > 0) text += fmt::format(" (or {})", counted(release.alternatives, "other place"));
  std::vector<std::string> remarks = {fmt::format("conditioning {:.2f}", release.conditioning)};
  if (release.redundant_after > 0) remarks.push_back(fmt::format("leaves {} redundant", release.redundant_after));
  if (release.idle_freedoms > 0) remarks.push_back(counted(release.idle_freedoms, "idle spin"));
  if (!release.condition.empty()) remarks.push_back(release.condition);
  return text + fmt::format(" [{}]", fmt::join(remarks, "; "));
}

std::string releases_text(const RedundancyReport& report, const std::optional<ReleaseReport>& releases,
                          const Style& style) {
  const bool has_joints = report.joints > 0 || report.coordinates == 0;
  std::string text = heading(5, has_joints ? "Which joint changes remove the redundancy?" : "What removes it?", style);
  if (report.redundant == 0) return text + (has_joints ? "   None are needed.\n" : "   Nothing is redundant.\n");
  if (!has_joints) {
    return text + wrapped_text("   ",
                               fmt::format("Leaving out {}, as one choice of several, changes nothing in this pose.",
                                           fmt::join(report.excluded_row_names, ", ")),
                               "   ");
  }
  if (!releases) return text + "   Not analysed.\n";
  if (releases->releases.empty() && releases->note.empty()) text += "   No joint change was found.\n";
  if (std::string note = releases->note; !note.empty()) {
    note.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(note.front())));
    text += wrapped_text("   ", note + ".", "   ");
  }
  std::vector<std::string> told;  // what a kind of change costs and gains is said once
  for (std::size_t i = 0; i < std::min<std::size_t>(releases->releases.size(), kMostReleases); ++i) {
    const Release& release = releases->releases[i];
    text += wrapped_text(fmt::format("   {:>3}  ", i + 1), release_line(release), "        ");
    for (const ReleaseChange& change : release.changes) {
      const std::string says(change.says);
      if (std::find(told.begin(), told.end(), says) != told.end()) continue;
      told.push_back(says);
      text += style.dim(wrapped_text(
          fmt::format("        {} to {}: ", joint_type_info(change.from).name, joint_type_info(change.change.to).name),
          says, "           "));
    }
  }
  for (std::size_t i = 0; i < std::min<std::size_t>(releases->obstacles.size(), 3); ++i) {
    const ReleaseObstacle& one = releases->obstacles[i];
    text += style.dim(wrapped_text(
        "        ", fmt::format("not offered: {} to {}: {}", one.joint, joint_type_info(one.to).name, one.reason),
        "           "));
  }
  if (releases->releases.size() > kMostReleases) {
    text +=
        style.dim(fmt::format("        and {} more (--json lists all)\n", releases->releases.size() - kMostReleases));
  }
  if (!releases->releases.empty()) {
    text += style.dim("   The mobility stays. '--apply-release 1 --write-model FILE' writes the changed model.\n");
  }
  return text;
}

std::string idle_text(const std::optional<ReleaseReport>& releases) {
  if (!releases) return "";
  std::string text;
  for (const IdleFreedom& one : releases->idle_freedoms) {
    text += fmt::format("   One freedom is idle: '{}' can spin about itself between {}.\n", one.body,
                        fmt::join(one.joints, " and "));
  }
  return text;
}

}  // namespace

std::string analysis_text(const Model& model, const MechanismAnalysis& analysis, const ConsistentGeometry* geometry,
                          const Style& style) {
  const RedundancyReport& report = *analysis.redundancy;
  std::vector<std::string> parts;
  if (report.bodies > 0 || report.coordinates == 0) {
    parts = {counted(report.bodies, "body"), counted(report.joints, "joint")};
  }
  if (report.coordinates > 0) parts.push_back(counted(report.coordinates, "coordinate"));
  const auto relations = std::count_if(model.couplings().begin(), model.couplings().end(),
                                       [](const Coupling& coupling) { return coupling.relation != nullptr; });
  const auto linear = static_cast<long>(model.couplings().size()) - relations;
  if (linear > 0) parts.push_back(counted(linear, "coupling"));
  if (relations > 0) parts.push_back(counted(relations, "constraint"));
  std::string text = fmt::format("{}: {}", style.bold(model.name()), fmt::join(parts, ", "));
  text += "\n" + groups_text(model);
  if (geometry != nullptr) text += geometry_text(*geometry, style);
  text += counts_text(report, analysis.closure, style) + closure_text(analysis.closure, style) +
          idle_text(analysis.releases);
  text += sharing_text(report, style);
  text += heading(3, "Only in this pose, or always?", style);
  if (analysis.permanence) {
    text += kind_text(report, *analysis.permanence) + motion_text(report, *analysis.permanence, style);
  }
  text += reactions_text(model, analysis, style);
  text += releases_text(report, analysis.releases, style);
  return text;
}
