#include "analysis_text.h"

#include <fmt/format.h>

#include "ferrers/model/joints/joint_type.h"

using namespace ferrers;  // NOLINT(google-build-using-namespace)

namespace {

std::string heading(int number, std::string_view question, const Style& style) {
  return "\n" + style.bold(fmt::format("{}  {}", number, question)) + "\n";
}

std::string certainty_text(const RedundancyReport& report, const Style& style) {
  const RankDecision& decision = report.decision;
  const auto& values = decision.singular_values;
  if (report.closure_rows == 0) return "   There is no closed loop, so nothing can be redundant.\n";
  std::string text;
  const std::string size = fmt::format("of the loops' {} for {}", counted(report.closure_rows, "equation"),
                                       counted(report.closure_coordinates, "coordinate"));
  if (decision.full) {
    text = fmt::format("all singular values {} are away from zero", size);
    if (values.size() > 0) text += fmt::format(", the smallest is {}", rough(values[values.size() - 1]));
  } else {
    text = fmt::format("{}, rank {}:\n   ", size, decision.rank);
    if (decision.rank > 0) text += fmt::format("smallest singular value kept {}, ", rough(values[decision.rank - 1]));
    if (decision.rank < values.size()) text += fmt::format("largest dropped {}", rough(values[decision.rank]));
    if (decision.rank > 0 && decision.rank < values.size()) text += fmt::format(", gap {}", rough(decision.gap));
  }
  if (decision.confident) return fmt::format("   {}: {}.\n", style.green("Certain"), text);
  const int other = report.closure_rows - decision.other_rank;
  return fmt::format(
      "   {}: {}.\n   Read the other way, {} would be redundant. Nearly special dimensions do this: check them.\n",
      style.red("Doubtful"), text, counted(other, "constraint"));
}

std::string counts_text(const RedundancyReport& report, const Style& style) {
  std::string text = heading(1, "How can it move, and how many constraints are redundant?", style);
  text += fmt::format("   mobility   {:>4}   independent {}\n", report.mobility,
                      report.mobility == 1 ? "motion" : "motions");
  text += fmt::format("   redundant  {:>4}   of {}, which have rank {}\n", report.redundant,
                      counted(report.constraint_rows, "constraint"), report.rank);
  text += fmt::format("   counting   {:>4}   is what Grübler's formula would give for the mobility\n", report.grubler);
  return text + certainty_text(report, style);
}

std::string sharing_text(const RedundancyReport& report, const Style& style) {
  std::string text = heading(2, "Which joints share them?", style);
  std::vector<std::string> sharing;
  for (const ReactionUniqueness& one : report.reactions) {
    if (one.participates) sharing.push_back(one.joint);
  }
  if (report.redundant == 0) {
    text += "   None: no constraint is redundant.\n";
  } else {
    text += wrapped_list(
        fmt::format("   {} of {}:", sharing.size(), counted(static_cast<long>(report.reactions.size()), "joint")),
        sharing, "      ");
    text += wrapped_list("   Could be left out, as one choice of several:", report.excluded_row_names, "      ");
  }
  if (report.independent_coordinate_names.empty()) return text + "   No coordinate is free.\n";
  return text + wrapped_list("   The motion is told by:", report.independent_coordinate_names, "      ");
}

std::string permanence_text(const RedundancyReport& report, const PermanenceReport& permanence, const Style& style) {
  std::string text = heading(3, "Only in this pose, or always?", style);
  switch (permanence.kind) {
    case Permanence::kNone:
      text += "   Nothing is redundant in this pose.\n";
      break;
    case Permanence::kPermanent:
      text += "   Permanent: the same redundancy";
      break;
    case Permanence::kConfiguration:
      text += "   In this pose only: no redundancy";
      break;
    case Permanence::kMixed:
      text += fmt::format("   Mixed: {} here, but only {}", report.redundant, *permanence.generic_redundant);
      break;
    case Permanence::kUnknown:
      text += "   Not known: no other configuration could be reached.\n";
      break;
  }
  const bool compared = permanence.kind != Permanence::kNone && permanence.kind != Permanence::kUnknown;
  if (compared && permanence.configurations > 0) {
    text += fmt::format(" at {}{}.\n", counted(permanence.configurations, "other configuration"),
                        permanence.confident ? "" : ", some with a rank in doubt");
  } else if (compared) {
    text += " wherever it is: nothing moves.\n";
  }
  if (permanence.generic_mobility && *permanence.generic_mobility != report.mobility) {
    text += fmt::format("   The mobility is {} here and {} at generic configurations: a singular pose.\n",
                        report.mobility, *permanence.generic_mobility);
  }
  if (report.mobility > 0 && !permanence.finite_mobility) {
    text += "   That the mechanism really moves from this pose is not established.\n";
  }
  return text;
}

std::string unique_names(const RedundancyReport& report, std::size_t index) {
  const ReactionUniqueness& one = report.reactions[index];
  if (one.unique_dimension == one.rows) return "all";
  std::string names;
  for (int row = 0; row < one.rows; ++row) {
    if (!one.unique[row]) continue;
    std::string name = report.rows.names[report.rows.first[index] + row];
    if (const std::size_t slash = name.rfind('/'); slash != std::string::npos) name.erase(0, slash + 1);
    names += (names.empty() ? "" : " ") + name;
  }
  return names.empty() ? "none" : names;
}

std::string reactions_text(const Model& model, const RedundancyReport& report, const Style& style) {
  std::string text = heading(4, "Which joint reactions do rigid bodies determine?", style);
  if (report.redundant == 0) return text + "   All of them.\n";
  std::vector<std::vector<std::string>> rows = {{"joint", "type", "unique", "components that are unique"}};
  for (std::size_t i = 0; i < report.reactions.size(); ++i) {
    const ReactionUniqueness& one = report.reactions[i];
    const bool joint = i < model.joints().size();
    rows.push_back({one.joint, std::string(joint ? joint_type_info(model.joints()[i].type).name : "coupling"),
                    fmt::format("{} of {}", one.unique_dimension, one.rows), unique_names(report, i)});
  }
  text += table(rows, "   ", style);
  text += style.dim(
      "   Components are along the joint's own axes; 'unique' counts dimensions whatever the axes. The others depend\n"
      "   on elasticity, play and assembly, so that no value is given for them.\n");
  return text;
}

std::string releases_text(const RedundancyReport& report, const Style& style) {
  std::string text = heading(5, "Which joints would have to change to remove the redundancy?", style);
  return text + (report.redundant == 0 ? "   None.\n" : "   Not analysed by this version.\n");
}

}  // namespace

std::string analysis_text(const Model& model, const RedundancyReport& report, const PermanenceReport& permanence,
                          const Style& style) {
  std::string text = fmt::format("{}: {}, {}", style.bold(model.name()), counted(report.bodies, "body"),
                                 counted(report.joints, "joint"));
  if (!model.couplings().empty()) text += ", " + counted(static_cast<long>(model.couplings().size()), "coupling");
  text += "\n";
  text += counts_text(report, style);
  text += sharing_text(report, style);
  text += permanence_text(report, permanence, style);
  text += reactions_text(model, report, style);
  text += releases_text(report, style);
  return text;
}
