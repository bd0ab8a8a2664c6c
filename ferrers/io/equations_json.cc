#include "ferrers/dynamics/holding.h"
#include "ferrers/io/equations_document.h"
#include "ferrers/io/json_matrices.h"

namespace ferrers {
namespace {

OrderedJson names_at(const std::vector<std::string>& names, const std::vector<int>& which) {
  OrderedJson out = OrderedJson::array();
  for (const int i : which) out.push_back(names[static_cast<std::size_t>(i)]);
  return out;
}

OrderedJson named(const std::vector<std::string>& names, const std::vector<std::string>& units,
                  const std::vector<int>& which, const char* flag) {
  OrderedJson out = OrderedJson::array();
  for (std::size_t i = 0; i < names.size(); ++i) {
    out.push_back({{"name", names[i]}, {"unit", text_or_null(units[i])}, {flag, false}});
  }
  for (const int i : which) out[static_cast<std::size_t>(i)][flag] = true;
  return out;
}

OrderedJson certainty_value(const EquationsReport& report) {
  const RankDecision& decision = report.decision;
  return {{"confident", decision.confident},
          {"rank", decision.rank},
          {"other_rank", decision.confident ? OrderedJson() : OrderedJson(decision.other_rank)},
          {"gap", decision.full ? OrderedJson() : OrderedJson(decision.gap)},
          {"method", report.exact_values ? "singular values" : "orthogonal elimination"},
          {"singular_values", vector_value(report.exact_values ? decision.singular_values : VectorXd())},
          {"characteristic_length_m", report.characteristic_length_m}};
}

void add_decision(const EquationsReport& report, OrderedJson& out) {
  out["n"] = report.n;
  out["m"] = report.m;
  out["r"] = report.r;
  out["w"] = report.w;
  out["equations"] = report.equation_count();
  out["certainty"] = certainty_value(report);
  out["independent_coordinates"] = names_at(report.coordinate_names, report.selection.independent);
  out["dependent_coordinates"] = names_at(report.coordinate_names, report.selection.dependent);
  out["independent_rows"] = names_at(report.row_names, report.selection.rows);
  out["excluded_rows"] = names_at(report.row_names, report.excluded_rows);
  out["positions"] = report.position_names;
  out["coordinates"] =
      named(report.coordinate_names, report.coordinate_units, report.selection.independent, "independent");
  out["rows"] = named(report.row_names, report.row_units, report.excluded_rows, "excluded");
}

OrderedJson drive_values(const DynamicsModel& model, const EquationsReport& report, bool known) {
  OrderedJson out = OrderedJson::array();
  for (const int i : acting_drives(model)) {
    const DriveComponent& drive = model.drives[static_cast<std::size_t>(i)];
    out.push_back({{"drive", drive.name},
                   {"unit", effort_unit(drive)},
                   {"effort", known ? OrderedJson(report.u[i]) : OrderedJson()},
                   {"from", effort_source(model, report, i)}});
  }
  return out;
}

void add_equations(const EquationsDocument& document, OrderedJson& out) {
  const EquationsReport& report = *document.report;
  const Equations& eq = report.equations;
  const bool efforts_known = report.solved() || report.problem == EquationsProblem::kForward;
  out["q"] = vector_value(report.state.q);
  out["v"] = vector_value(report.state.v);
  out["phi"] = vector_value(eq.constraints.phi);
  out["G"] = matrix_value(eq.constraints.G);
  out["nu"] = vector_value(eq.constraints.nu);
  out["gamma"] = vector_value(eq.constraints.gamma);
  out["M"] = matrix_value(eq.M);
  out["h"] = vector_value(eq.h);
  out["tau"] = vector_value(eq.tau);
  out["B"] = matrix_value(eq.B_transposed(acting_drives(*document.dynamics), Eigen::all).transpose());
  out["u"] = efforts_known ? vector_value(report.u) : OrderedJson();
  out["drives"] = drive_values(*document.dynamics, report, efforts_known);
}

OrderedJson multiplier_values(const EquationsReport& report) {
  OrderedJson out = OrderedJson::array();
  for (std::size_t i = 0; i < report.row_names.size(); ++i) {
    const bool known = report.solved() && report.lambda_status[i] != ReactionStatus::kUndetermined;
    out.push_back({{"row", report.row_names[i]},
                   {"value", known ? OrderedJson(report.lambda_of_kept_rows[static_cast<long>(i)]) : OrderedJson()},
                   {"status", to_string(report.lambda_status[i])}});
  }
  return out;
}

void add_solution(const EquationsReport& report, OrderedJson& out) {
  out["lambda"] = multiplier_values(report);
  if (report.solved()) {
    out["vdot"] = vector_value(report.vdot);
    out["lambda_of_independent_rows_with_excluded_zero"] = vector_value(report.lambda_of_kept_rows);
  }
  OrderedJson residuals = OrderedJson::array();
  for (const EquationResidual& one : report.residuals) {
    residuals.push_back({{"equation", one.equation},
                         {"says", equation_text(one.equation)},
                         {"largest", one.largest},
                         {"size", one.size},
                         {"unit", one.unit},
                         {"at", text_or_null(one.at)}});
  }
  out["residuals"] = std::move(residuals);
}

}  // namespace

std::string_view equations_status_name(EquationsStatus status) {
  switch (status) {
    case EquationsStatus::kSolved:
      return "solved";
    case EquationsStatus::kSingularMass:
      return "singular_mass";
    case EquationsStatus::kUndeterminedFriction:
      return "undetermined_friction";
    case EquationsStatus::kJammed:
      return "jammed";
    case EquationsStatus::kBadMotion:
      return "bad_motion";
    case EquationsStatus::kNotReached:
      return "not_reached";
    case EquationsStatus::kSingular:
      break;
  }
  return "singular_pose";
}

std::string_view effort_source(const DynamicsModel& model, const EquationsReport& report, int drive) {
  const auto i = static_cast<std::size_t>(drive);
  if (report.effort_is_shared[i]) return "shared";
  if (report.effort_is_found[i]) return "found";
  return model.drives[i].effort ? "law" : "none";
}

std::string_view equation_text(int equation) {
  switch (equation) {
    case 6:
      return "phi(q) = 0";
    case 7:
      return "G v = nu";
    case 8:
      return "G vdot = gamma";
    default:
      return "M vdot + h = tau + B u + G^T lambda";
  }
}

std::string write_equations_json(const EquationsDocument& document) {
  OrderedJson out;
  out["schema"] = "ferrers.equations/1";
  for (const char* key : {"model",
                          "ok",
                          "problem",
                          "status",
                          "message",
                          "t",
                          "n",
                          "m",
                          "r",
                          "w",
                          "equations",
                          "certainty",
                          "independent_coordinates",
                          "dependent_coordinates",
                          "independent_rows",
                          "excluded_rows",
                          "positions",
                          "coordinates",
                          "rows",
                          "drives",
                          "q",
                          "v",
                          "phi",
                          "G",
                          "nu",
                          "gamma",
                          "M",
                          "h",
                          "tau",
                          "B",
                          "u",
                          "vdot",
                          "lambda",
                          "lambda_of_independent_rows_with_excluded_zero",
                          "residuals",
                          "notices"}) {
    out[key] = nullptr;
  }
  bool done = false;
  if (const EquationsReport* report = document.report; report != nullptr) {
    out["problem"] = report->problem == EquationsProblem::kForward ? "forward" : "inverse";
    out["status"] = equations_status_name(report->status);
    out["message"] = text_or_null(report->message);
    out["t"] = report->state.t;
    out["notices"] = report->notices;
    add_decision(*report, out);
    if (report->has_equations) {
      add_equations(document, out);
      add_solution(*report, out);
    }
    done = report->solved();
  }
  out["model"] = text_or_null(document.model);
  out["ok"] = done && (document.diagnostics == nullptr || !document.diagnostics->has_errors());
  out["diagnostics"] =
      document.diagnostics != nullptr ? diagnostics_value(*document.diagnostics) : OrderedJson::array();
  return json_text(out);
}

}  // namespace ferrers
