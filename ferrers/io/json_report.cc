#include "ferrers/io/json_report.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "ferrers/io/json_values.h"
#include "ferrers/math/sparse_basis.h"
#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

std::string_view severity_name(Severity severity) {
  switch (severity) {
    case Severity::kWarning:
      return "warning";
    case Severity::kNotice:
      return "notice";
    case Severity::kError:
      break;
  }
  return "error";
}

template <typename T>
OrderedJson maybe(const std::optional<T>& value) {
  return value ? OrderedJson(*value) : OrderedJson();
}

OrderedJson certainty_value(const RedundancyReport& report) {
  const RankDecision& decision = report.decision;
  OrderedJson values = OrderedJson::array();
  if (report.exact_values) {
    for (const double value : decision.singular_values) values.push_back(value);
  }
  const int rank = decision.rank, count = static_cast<int>(decision.singular_values.size());
  const auto value_at = [&](int i) {
    return i >= 0 && i < count ? OrderedJson(decision.singular_values[i]) : OrderedJson();
  };
  OrderedJson certainty;
  certainty["singular_values"] = std::move(values);
  certainty["method"] = report.exact_values ? "singular values" : "orthogonal elimination";
  certainty["smallest_kept"] = value_at(rank - 1);
  certainty["largest_dropped"] = value_at(rank);
  certainty["gap"] = decision.full ? OrderedJson() : OrderedJson(std::min(decision.gap, 1e16));
  certainty["confident"] = decision.confident;
  certainty["other_redundant"] =
      decision.confident ? OrderedJson() : OrderedJson(report.closure_rows - decision.other_rank);
  certainty["characteristic_length_m"] = report.characteristic_length_m;
  return certainty;
}

// Combinations of a joint's multipliers (SI) that every solution shares: a basis, few entries each.
OrderedJson unique_basis(const RedundancyReport& report, std::size_t index) {
  const ReactionUniqueness& reaction = report.reactions[index];
  OrderedJson all = OrderedJson::array();
  const MatrixXd basis = make_sparse_basis(reaction.unique_basis);
  for (long k = 0; k < basis.cols(); ++k) {
    OrderedJson one = OrderedJson::object();
    for (int i = 0; i < reaction.rows; ++i) {
      const int row = report.rows.first[index] + i;
      if (basis(i, k) != 0) one[report.rows.names[row]] = basis(i, k) / report.rows.scale[row];
    }
    all.push_back(std::move(one));
  }
  return all;
}

OrderedJson reaction_value(const RedundancyReport& report, std::size_t index) {
  const ReactionUniqueness& reaction = report.reactions[index];
  OrderedJson unique = OrderedJson::array();
  for (int row = 0; row < reaction.rows; ++row) {
    if (reaction.unique[row]) unique.push_back(report.rows.names[report.rows.first[index] + row]);
  }
  OrderedJson value;
  value["joint"] = reaction.joint;
  value["rows"] = reaction.rows;
  value["unique_rows"] = std::move(unique);
  value["unique_dimension"] = reaction.unique_dimension;
  value["unique_basis"] = unique_basis(report, index);
  value["participates"] = reaction.participates;
  return value;
}

OrderedJson self_stress_values(const RedundancyReport& report) {
  OrderedJson all = OrderedJson::array();
  for (int k = 0; k < report.self_stresses.cols(); ++k) {
    double largest = 0;
    for (SparseMatrixXd::InnerIterator it(report.self_stresses, k); it; ++it) {
      largest = std::max(largest, std::abs(it.value()));
    }
    OrderedJson rows = OrderedJson::object(), joints = OrderedJson::array();
    for (SparseMatrixXd::InnerIterator it(report.self_stresses, k); it; ++it) {
      if (!is_negligible(it.value(), largest)) rows[report.rows.names[it.row()]] = it.value();
    }
    for (const int joint : report.self_stress_places[k].joints) joints.push_back(report.reactions[joint].joint);
    all.push_back(OrderedJson{{"joints", std::move(joints)},
                              {"loops", report.self_stress_places[k].closures.size()},
                              {"cluster", report.self_stress_places[k].cluster + 1},
                              {"rows", std::move(rows)}});
  }
  return all;
}

OrderedJson branch_values(const PermanenceReport& permanence) {
  OrderedJson branches = OrderedJson::array();
  for (const BranchReport& branch : permanence.branches) {
    OrderedJson direction = OrderedJson::object();
    for (const auto& [name, rate] : branch.direction) direction[name] = rate;
    branches.push_back(OrderedJson{{"dimension", branch.dimension},
                                   {"mobility", branch.mobility},
                                   {"redundant", branch.redundant},
                                   {"share", branch.share},
                                   {"direction", std::move(direction)}});
  }
  return branches;
}

OrderedJson permanence_value(const std::optional<PermanenceReport>& permanence) {
  if (!permanence) return nullptr;
  OrderedJson out;
  out["kind"] = to_string(permanence->kind);
  out["generic_mobility"] = maybe(permanence->generic_mobility);
  out["generic_redundant"] = maybe(permanence->generic_redundant);
  out["configurations"] = permanence->configurations;
  out["finite_mobility"] = maybe(permanence->finite_mobility);
  out["finite_mobility_by"] = to_string(permanence->basis);
  out["shaky"] = permanence->is_shaky;
  out["branches"] = branch_values(*permanence);
  out["all_branches"] = permanence->all_branches;
  out["confident"] = permanence->confident;
  return out;
}

OrderedJson preload_value(const std::optional<PreloadReport>& preload) {
  if (!preload || preload->status == PreloadStatus::kNone || preload->status == PreloadStatus::kTooLarge)
    return nullptr;
  OrderedJson out, joints = OrderedJson::array();
  for (const JointPreload& joint : preload->joints) {
    OrderedJson components = OrderedJson::object();
    for (int k = 0; k < 6; ++k) {
      const bool known = preload->status == PreloadStatus::kSolved && joint.status[k] != ReactionStatus::kUndetermined;
      components[std::string(kComponentNames[k])] = {{"value", known ? OrderedJson(joint.value[k]) : OrderedJson()},
                                                     {"status", to_string(joint.status[k])}};
    }
    joints.push_back(OrderedJson{{"joint", joint.joint}, {"components", std::move(components)}});
  }
  out["consistent"] = preload->status == PreloadStatus::kSolved;
  out["contradictory_joints"] = preload->contradictory;
  out["joints"] = std::move(joints);
  return out;
}

OrderedJson contradiction_values(const ContradictionReport& closure) {
  OrderedJson all = OrderedJson::array();
  for (const Contradiction& one : closure.contradictions) {
    OrderedJson joints = OrderedJson::array();
    for (const JointGap& gap : one.joints) {
      joints.push_back(OrderedJson{{"joint", gap.joint}, {"gap_m", gap.gap_m}, {"angle_rad", gap.angle_rad}});
    }
    all.push_back(OrderedJson{{"misclosure", one.misclosure},
                              {"unit", !one.has_joints ? ""
                                       : one.angular   ? "rad"
                                                       : "m"},
                              {"residual_m", one.residual_m},
                              {"joints", std::move(joints)}});
  }
  return all;
}

OrderedJson resultant_values(const std::vector<UniqueResultant>& resultants) {
  OrderedJson all = OrderedJson::array();
  for (const UniqueResultant& one : resultants) {
    all.push_back(OrderedJson{{"joints", one.joints},
                              {"on", one.on_body},
                              {"from", one.from_body.empty() ? OrderedJson() : OrderedJson(one.from_body)},
                              {"unique_dimension", one.unique_dimension}});
  }
  return all;
}

OrderedJson release_values(const ReleaseReport& report) {
  OrderedJson all = OrderedJson::array();
  for (const Release& release : report.releases) {
    OrderedJson changes = OrderedJson::array();
    for (const ReleaseChange& change : release.changes) {
      changes.push_back(OrderedJson{{"joint", change.change.joint},
                                    {"from", joint_type_info(change.from).name},
                                    {"to", joint_type_info(change.change.to).name},
                                    {"says", change.says}});
    }
    all.push_back(OrderedJson{{"changes", std::move(changes)},
                              {"redundant_after", release.redundant_after},
                              {"mobility_after", release.mobility_after},
                              {"idle_freedoms", release.idle_freedoms},
                              {"conditioning", release.conditioning},
                              {"alternatives", release.alternatives},
                              {"holds_generically", maybe(release.holds_generically)},
                              {"condition", release.condition.empty() ? OrderedJson() : OrderedJson(release.condition)},
                              {"notes", release.notes}});
  }
  return all;
}

OrderedJson idle_values(const ReleaseReport& report) {
  OrderedJson all = OrderedJson::array();
  for (const IdleFreedom& one : report.idle_freedoms) {
    all.push_back(
        OrderedJson{{"body", one.body}, {"joints", one.joints}, {"axis", {one.axis.x(), one.axis.y(), one.axis.z()}}});
  }
  return all;
}

// Every field is there from the start, null: what stays null is not known.
OrderedJson empty_document() {
  OrderedJson out;
  out["schema"] = "ferrers.analyze/1";
  out["model"] = nullptr;
  out["ok"] = false;
  for (const char* key : {"bodies",
                          "joints",
                          "coordinates",
                          "constraint_rows",
                          "rank",
                          "mobility",
                          "redundant",
                          "grubler",
                          "closure",
                          "certainty",
                          "permanence",
                          "assembly",
                          "consistent",
                          "inconsistency",
                          "contradictions",
                          "excluded_rows",
                          "independent_coordinates",
                          "reactions",
                          "releases",
                          "idle_freedoms",
                          "self_stresses",
                          "unique_resultants",
                          "preload",
                          "singular_poses"}) {
    out[key] = nullptr;
  }
  return out;
}

void add_redundancy(const RedundancyReport& report, OrderedJson& out) {
  out["bodies"] = report.bodies;
  out["joints"] = report.joints;
  out["coordinates"] = report.coordinates;
  out["constraint_rows"] = report.constraint_rows;
  out["rank"] = report.rank;
  out["mobility"] = report.mobility;
  out["redundant"] = report.redundant;
  out["grubler"] = report.grubler;
  out["closure"] = {
      {"coordinates", report.closure_coordinates}, {"rows", report.closure_rows}, {"rank", report.closure_rank}};
  out["certainty"] = certainty_value(report);
}

void add_details(const RedundancyReport& report, OrderedJson& out) {
  out["excluded_rows"] = report.excluded_row_names;
  out["independent_coordinates"] = report.independent_coordinate_names;
  OrderedJson reactions = OrderedJson::array();
  for (std::size_t i = 0; i < report.reactions.size(); ++i) {
    if (report.reactions[i].is_constraint) reactions.push_back(reaction_value(report, i));
  }
  out["reactions"] = std::move(reactions);
  out["self_stresses"] = self_stress_values(report);
}

void add_analysis(const MechanismAnalysis& analysis, OrderedJson& out) {
  out["assembly"] = to_string(analysis.closure.verdict);
  if (analysis.redundancy) {
    add_redundancy(*analysis.redundancy, out);
    const bool closes = analysis.closure.verdict == ClosureVerdict::kCloses;
    out["consistent"] = closes;
    out["inconsistency"] = closes ? analysis.redundancy->inconsistency : analysis.closure.residual_m;
    out["contradictions"] = contradiction_values(analysis.closure);
    // A misclosure that is sure blurs the rank beneath it: the verdict's own certainty counts.
    if (!closes || !analysis.closure.confident) {
      out["certainty"]["confident"] = analysis.closure.confident;
    }
  }
  if (!analysis.is_assembled() || !analysis.redundancy) return;
  add_details(*analysis.redundancy, out);
  out["permanence"] = permanence_value(analysis.permanence);
  out["preload"] = preload_value(analysis.preload);
  out["unique_resultants"] = resultant_values(analysis.resultants);
  if (analysis.releases) {
    out["releases"] = release_values(*analysis.releases);
    out["idle_freedoms"] = idle_values(*analysis.releases);
  }
}

}  // namespace

OrderedJson diagnostics_value(const Diagnostics& diagnostics) {
  OrderedJson all = OrderedJson::array();
  for (const Diagnostic& one : diagnostics.items()) {
    OrderedJson value;
    value["code"] = one.code;
    value["severity"] = severity_name(one.severity);
    value["line"] = one.at.known() ? OrderedJson(one.at.line) : OrderedJson();
    value["column"] = one.at.known() ? OrderedJson(std::max(one.at.column, 1)) : OrderedJson();
    value["message"] = one.message;
    value["hint"] = one.hint.empty() ? OrderedJson() : OrderedJson(one.hint);
    all.push_back(std::move(value));
  }
  return all;
}

std::string json_text(const OrderedJson& value) {
  return value.dump(2, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

namespace {

OrderedJson geometry_value(const ConsistentGeometry& geometry) {
  OrderedJson moves = OrderedJson::array(), parallel = OrderedJson::array();
  for (const SeatMove& one : geometry.moves) {
    moves.push_back({{"joint", one.joint}, {"distance_m", one.distance_m}, {"angle_rad", one.angle_rad}});
  }
  for (const ParallelAxes& one : geometry.parallel) {
    parallel.push_back({{"joints", one.joints}, {"angle_rad", one.angle_rad}});
  }
  return {{"verdict", to_string(geometry.verdict)},
          {"tolerance", geometry.tolerance},
          {"misclosure_m", geometry.misclosure_m},
          {"redundant", geometry.redundant},
          {"mobility", geometry.mobility},
          {"as_written",
           {{"redundant", geometry.redundant_as_written},
            {"mobility", geometry.mobility_as_written},
            {"confident", geometry.as_written.confident}}},
          {"moves", std::move(moves)},
          {"parallel_axes", std::move(parallel)},
          {"text", geometry.text}};
}

OrderedJson groups_value(const std::vector<Body>& bodies) {
  OrderedJson groups = OrderedJson::array();
  for (const Body& body : bodies) {
    if (body.parts.empty()) continue;
    OrderedJson parts = OrderedJson::array();
    for (const Part& part : body.parts) parts.push_back(part.name);
    groups.push_back({{"name", body.name}, {"parts", std::move(parts)}, {"welds", body.merged_welds}});
  }
  return groups;
}

}  // namespace

std::string write_analysis_json(const AnalysisDocument& document) {
  OrderedJson out = empty_document();
  if (!document.model.empty()) out["model"] = document.model;
  if (document.analysis != nullptr) add_analysis(*document.analysis, out);
  if (document.bodies != nullptr) {
    OrderedJson groups = groups_value(*document.bodies);
    if (!groups.empty()) out["rigid_groups"] = std::move(groups);
  }
  if (document.geometry != nullptr && document.geometry->verdict != GeometryVerdict::kExact) {
    out["geometry"] = geometry_value(*document.geometry);
  }
  out["ok"] = document.analysis != nullptr && document.analysis->is_assembled() &&
              (document.diagnostics == nullptr || !document.diagnostics->has_errors());
  out["diagnostics"] =
      document.diagnostics != nullptr ? diagnostics_value(*document.diagnostics) : OrderedJson::array();
  return json_text(out);
}

std::string write_diagnostics_json(const Diagnostics& diagnostics) { return json_text(diagnostics_value(diagnostics)); }

}  // namespace ferrers
