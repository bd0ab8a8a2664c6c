#include "ferrers/io/json_report.h"

#include <algorithm>
#include <vector>

#include "ferrers/io/json_values.h"

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

OrderedJson certainty_value(const RedundancyReport& report) {
  const RankDecision& decision = report.decision;
  OrderedJson values = OrderedJson::array();
  for (const double value : decision.singular_values) values.push_back(value);
  OrderedJson certainty;
  certainty["singular_values"] = std::move(values);
  certainty["gap"] = decision.full ? OrderedJson() : OrderedJson(std::min(decision.gap, 1e16));
  certainty["confident"] = decision.confident;
  certainty["characteristic_length_m"] = report.characteristic_length_m;
  return certainty;
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
  value["participates"] = reaction.participates;
  return value;
}

OrderedJson self_stress_values(const RedundancyReport& report) {
  OrderedJson all = OrderedJson::array();
  for (int k = 0; k < report.self_stresses.cols(); ++k) {
    const VectorXd column = report.self_stresses.col(k);
    const double largest = column.size() > 0 ? column.cwiseAbs().maxCoeff() : 0.0;
    OrderedJson rows = OrderedJson::object();
    for (int row = 0; row < column.size(); ++row) {
      if (!is_negligible(column[row], largest)) rows[report.rows.names[row]] = column[row];
    }
    all.push_back(OrderedJson{{"rows", std::move(rows)}});
  }
  return all;
}

OrderedJson permanence_value(const PermanenceReport* permanence) {
  if (!permanence) return nullptr;
  const auto number = [](const std::optional<int>& value) { return value ? OrderedJson(*value) : OrderedJson(); };
  OrderedJson out;
  out["kind"] = to_string(permanence->kind);
  out["generic_mobility"] = number(permanence->generic_mobility);
  out["generic_redundant"] = number(permanence->generic_redundant);
  out["configurations"] = permanence->configurations;
  out["finite_mobility"] = number(permanence->finite_mobility);
  out["confident"] = permanence->confident;
  return out;
}

void add_report(const RedundancyReport& report, const PermanenceReport* permanence, OrderedJson& out) {
  out["bodies"] = report.bodies;
  out["joints"] = report.joints;
  out["constraint_rows"] = report.constraint_rows;
  out["rank"] = report.rank;
  out["mobility"] = report.mobility;
  out["redundant"] = report.redundant;
  out["grubler"] = report.grubler;
  out["closure"] = {
      {"coordinates", report.closure_coordinates}, {"rows", report.closure_rows}, {"rank", report.closure_rank}};
  out["certainty"] = certainty_value(report);
  out["permanence"] = permanence_value(permanence);
  out["consistent"] = true;  // a report exists for assembled poses only: every row vanishes
  out["inconsistency"] = report.inconsistency;
  out["excluded_rows"] = report.excluded_row_names;
  out["independent_coordinates"] = report.independent_coordinate_names;
  OrderedJson reactions = OrderedJson::array();
  for (std::size_t i = 0; i < report.reactions.size(); ++i) reactions.push_back(reaction_value(report, i));
  out["reactions"] = std::move(reactions);
  out["releases"] = nullptr;
  out["idle_freedoms"] = nullptr;
  out["self_stresses"] = self_stress_values(report);
  out["unique_resultants"] = nullptr;
  out["singular_poses"] = nullptr;
}

void add_unknown_report(OrderedJson& out) {
  for (const char* key : {"bodies",
                          "joints",
                          "constraint_rows",
                          "rank",
                          "mobility",
                          "redundant",
                          "grubler",
                          "closure",
                          "certainty",
                          "permanence",
                          "consistent",
                          "inconsistency",
                          "excluded_rows",
                          "independent_coordinates",
                          "reactions",
                          "releases",
                          "idle_freedoms",
                          "self_stresses",
                          "unique_resultants",
                          "singular_poses"}) {
    out[key] = nullptr;
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

std::string write_analysis_json(const AnalysisDocument& document) {
  const bool ok =
      document.report != nullptr && (document.diagnostics == nullptr || !document.diagnostics->has_errors());
  OrderedJson out;
  out["schema"] = "ferrers.analyze/1";
  out["model"] = document.model.empty() ? OrderedJson() : OrderedJson(document.model);
  out["ok"] = ok;
  if (document.report != nullptr) {
    add_report(*document.report, document.permanence, out);
  } else {
    add_unknown_report(out);
  }
  out["diagnostics"] =
      document.diagnostics != nullptr ? diagnostics_value(*document.diagnostics) : OrderedJson::array();
  return json_text(out);
}

std::string write_diagnostics_json(const Diagnostics& diagnostics) { return json_text(diagnostics_value(diagnostics)); }

}  // namespace ferrers
