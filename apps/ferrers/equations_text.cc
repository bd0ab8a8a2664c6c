#include "equations_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ferrers/dynamics/holding.h"

using namespace ferrers;  // NOLINT(google-build-using-namespace)

namespace {

constexpr double kNothing = 1e-12;       // of the largest of its kind: shown as zero
constexpr std::size_t kPageWidth = 100;  // characters
constexpr long kLargestMatrix = 60;      // rows or columns that still are for reading

using Names = std::vector<std::string>;
using Rows = std::vector<Names>;

std::string line(std::string_view label, std::string_view text) { return fmt::format("  {:<15}{}\n", label, text); }

std::string heading(std::string_view text, const Style& style) { return "\n" + style.bold(text) + "\n"; }

double largest_of(const MatrixXd& values) { return values.size() > 0 ? values.cwiseAbs().maxCoeff() : 0; }

// Zeros as dots, so that the others are seen.
std::string entry(double value, double largest) { return std::abs(value) <= kNothing * largest ? "." : number(value); }

Names chosen(const Names& names, const std::vector<int>& which) {
  Names out;
  for (const int i : which) out.push_back(names[static_cast<std::size_t>(i)]);
  return out;
}

std::string list(std::string_view label, const Names& names) {
  const std::string indent(17, ' ');
  return wrapped_list(fmt::format("  {:<15}", label), names.empty() ? Names{"none"} : names, indent);
}

bool contains(const std::vector<int>& all, int one) { return std::find(all.begin(), all.end(), one) != all.end(); }

// A matrix with its rows and columns named; as many columns side by side as fit the page.
std::string matrix_text(std::string_view symbol, const MatrixXd& M, const Names& rows, const Names& columns,
                        const Style& style) {
  if (M.rows() == 0 || M.cols() == 0) return "";
  if (std::max(M.rows(), M.cols()) > kLargestMatrix) {
    return fmt::format("  {} is {} × {}: --json prints it.\n", symbol, M.rows(), M.cols());
  }
  const double largest = largest_of(M);
  std::size_t lead = symbol.size();
  for (const std::string& name : rows) lead = std::max(lead, name.size());
  std::string text;
  for (long first = 0; first < M.cols();) {
    Rows cells(1, Names{std::string(symbol)});
    for (const std::string& name : rows) cells.push_back({name});
    std::size_t width = 2 + lead;
    long k = first;
    for (; k < M.cols(); ++k) {
      std::size_t widest = columns[static_cast<std::size_t>(k)].size();
      for (long i = 0; i < M.rows(); ++i) widest = std::max(widest, entry(M(i, k), largest).size());
      if (k > first && width + 2 + widest > kPageWidth) break;
      width += 2 + widest;
      cells[0].push_back(columns[static_cast<std::size_t>(k)]);
      for (long i = 0; i < M.rows(); ++i) cells[static_cast<std::size_t>(i) + 1].push_back(entry(M(i, k), largest));
    }
    text += "\n" + table(cells, "  ", style);
    first = k;
  }
  return text;
}

std::string certainty_text(const EquationsReport& report, const Style& style) {
  if (report.m == 0) return line("certainty", "there is no closed loop, so nothing can be redundant");
  const RankDecision& decision = report.decision;
  const auto& values = decision.singular_values;
  const int rank = decision.rank, count = static_cast<int>(values.size());
  std::string text = decision.confident ? style.green("certain") : style.red("doubtful");
  const char* what = report.exact_values ? "singular value" : "value of orthogonal elimination";
  if (rank > 0) text += fmt::format(": smallest {} kept {}", what, rough(values[rank - 1]));
  if (rank < count) text += fmt::format("{} largest dropped {}", rank > 0 ? "," : ":", rough(values[rank]));
  if (rank > 0 && rank < count) text += fmt::format(", gap {}", rough(decision.gap));
  if (!decision.confident) text += fmt::format("; read the other way the rank is {}", decision.other_rank);
  return line("certainty", text);
}

std::string decision_text(const EquationsReport& report, const Style& style) {
  const Selection& s = report.selection;
  std::string text = line("size", fmt::format("n = {}, m = {}, rank r = {}, mobility w = n - r = {}; 3r + n = {}",
                                              counted(report.n, "coordinate"), counted(report.m, "constraint"),
                                              report.r, report.w, counted(report.equation_count(), "equation")));
  text += certainty_text(report, style);
  text += list("independent", chosen(report.coordinate_names, s.independent));
  text += list("dependent", chosen(report.coordinate_names, s.dependent));
  if (report.m > 0) {
    text += list("rows kept", chosen(report.row_names, s.rows));
    text += list("rows excluded", chosen(report.row_names, report.excluded_rows));
  }
  for (const std::string& notice : report.notices) {
    text += wrapped_text("  note           ", notice, std::string(17, ' '));
  }
  return text;
}

std::string state_text(const EquationsReport& report, const Style& style) {
  std::string text = heading("State: positions q, velocities v", style);
  const Names& names = report.coordinate_names;
  const State& state = report.state;
  const bool alike = state.q.size() == state.v.size();
  Rows rows = {alike ? Names{"coordinate", "", "unit", "q", "v"} : Names{"coordinate", "", "unit", "v"}};
  for (int i = 0; i < report.n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    rows.push_back({names[k], contains(report.selection.independent, i) ? "independent" : "dependent",
                    report.coordinate_units[k]});
    if (alike) rows.back().push_back(entry(state.q[i], 1));
    rows.back().push_back(entry(state.v[i], 1));
  }
  if (!alike) {
    Rows positions = {{"position", "q"}};
    for (long i = 0; i < state.q.size(); ++i) {
      positions.push_back({report.position_names[static_cast<std::size_t>(i)], entry(state.q[i], 1)});
    }
    text += table(positions, "  ", style) + "\n";
  }
  return text + table(rows, "  ", style);
}

std::string constraints_text(const EquationsReport& report, const Style& style) {
  std::string text = heading("(6) phi(q) = 0, (7) G v = nu, (8) G vdot = gamma: the constraints", style);
  if (report.m == 0) return text + "  None: no loop is closed.\n";
  const ConstraintKinematics& c = report.equations.constraints;
  Rows rows = {{"row", "", "unit", "phi", "nu", "gamma"}};
  for (int i = 0; i < report.m; ++i) {
    const auto k = static_cast<std::size_t>(i);
    rows.push_back({report.row_names[k], contains(report.excluded_rows, i) ? "excluded" : "kept", report.row_units[k],
                    entry(c.phi[i], report.characteristic_length_m), entry(c.nu[i], largest_of(c.nu)),
                    entry(c.gamma[i], largest_of(c.gamma))});
  }
  return text + table(rows, "  ", style) + matrix_text("G", c.G, report.row_names, report.coordinate_names, style);
}

Names drive_names(const DynamicsModel& model) {
  Names names;
  for (const int i : acting_drives(model)) names.push_back(model.drives[static_cast<std::size_t>(i)].name);
  return names;
}

std::string drives_text(const EquationsDocument& document, const Style& style) {
  const DynamicsModel& model = *document.dynamics;
  const EquationsReport& report = *document.report;
  const std::vector<int> acting = acting_drives(model);
  if (acting.empty()) return "";
  Rows rows = {{"drive", "unit", "u", ""}};
  for (const int i : acting) {
    const DriveComponent& drive = model.drives[static_cast<std::size_t>(i)];
    const std::string_view from = effort_source(model, report, i);
    const char* remark = from == "law"     ? "by its law"
                         : from == "none"  ? "has no effort law: 0"
                         : from == "found" ? "found: the motion needs it"
                                           : "found, one choice of many: the least";
    const bool known = report.solved() || report.problem == EquationsProblem::kForward;
    rows.push_back({drive.name, std::string(effort_unit(drive)), known ? number(report.u[i]) : "?", remark});
  }
  return "\n" + table(rows, "  ", style);
}

std::string motion_text(const EquationsDocument& document, const Style& style) {
  const EquationsReport& report = *document.report;
  const Equations& eq = report.equations;
  const Names& names = report.coordinate_names;
  std::string text = heading("(9) M vdot + h = tau + B u + G^T lambda: the motion", style);
  if (report.n == 0) return text + "  None: there is no coordinate.\n";
  text += matrix_text("M", eq.M, names, names, style).substr(1);
  Rows rows = {{"coordinate", "h", "tau"}};
  for (int i = 0; i < report.n; ++i) {
    rows.push_back(
        {names[static_cast<std::size_t>(i)], entry(eq.h[i], largest_of(eq.h)), entry(eq.tau[i], largest_of(eq.tau))});
  }
  text += "\n" + table(rows, "  ", style);
  text += matrix_text("B", eq.B_transposed(acting_drives(*document.dynamics), Eigen::all).transpose(), names,
                      drive_names(*document.dynamics), style);
  return text + drives_text(document, style);
}

std::string multipliers_text(const EquationsReport& report, const Style& style) {
  if (report.m == 0) return "";
  Rows rows = {{"row", "lambda", "", "lambda of the kept rows, the excluded ones zero"}};
  bool open = false, shared = false;
  const double largest = largest_of(report.lambda_of_kept_rows);
  for (int i = 0; i < report.m; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const ReactionStatus status = report.lambda_status[k];
    const std::string value = entry(report.lambda_of_kept_rows[i], largest);
    open = open || status == ReactionStatus::kUndetermined;
    shared = shared || status == ReactionStatus::kDistributed;
    rows.push_back({report.row_names[k], status == ReactionStatus::kUndetermined ? "?" : value,
                    std::string(to_string(status)), value});
  }
  std::string text = "\n" + table(rows, "  ", style);
  if (open) {
    text +=
        style.dim(
            "  ?: undetermined. Rigid bodies do not tell how redundant constraints share the load; the last column is\n"
            "  one choice of many.") +
        "\n";
  }
  if (shared) text += style.dim("  distributed: as the drives share the load by the least effort.") + "\n";
  return text;
}

std::string solution_text(const EquationsReport& report, const Style& style) {
  if (!report.solved()) return heading("No solution", style) + "  " + report.message + "\n";
  std::string text = heading(report.problem == EquationsProblem::kForward
                                 ? "Solution of (8) and (9): accelerations, multipliers"
                                 : "Solution of (8) and (9): accelerations by the laws, multipliers, efforts u above",
                             style);
  Rows rows = {{"coordinate", "vdot"}};
  for (int i = 0; i < report.n; ++i) {
    rows.push_back(
        {report.coordinate_names[static_cast<std::size_t>(i)], entry(report.vdot[i], largest_of(report.vdot))});
  }
  if (report.n > 0) text += table(rows, "  ", style);
  return text + multipliers_text(report, style);
}

std::string residuals_text(const EquationsReport& report, const Style& style) {
  std::string text = heading("Residuals, with all rows, the excluded ones too", style);
  Rows rows = {{"", "equation", "largest", "size of its terms", "at"}};
  for (const EquationResidual& one : report.residuals) {
    rows.push_back({fmt::format("({})", one.equation), std::string(equation_text(one.equation)),
                    fmt::format("{} {}", rough(one.largest), one.unit), fmt::format("{} {}", rough(one.size), one.unit),
                    one.largest > 0 ? one.at : ""});
  }
  return text + table(rows, "  ", style) +
         style.dim("  Angles and moments by the characteristic length; (6) beside that length itself.") + "\n";
}

}  // namespace

std::string equations_text(const EquationsDocument& document, const Style& style) {
  const EquationsReport& report = *document.report;
  std::string text = fmt::format(
      "{}: the equations (6)-(9) of the {} problem at t = {} s\n\n", style.bold(document.model),
      report.problem == EquationsProblem::kForward ? "forward (the paper's inverse)" : "inverse (the paper's direct)",
      number(report.state.t));
  text += decision_text(report, style);
  if (!report.has_equations) return text;
  text += state_text(report, style) + constraints_text(report, style) + motion_text(document, style);
  text += solution_text(report, style) + residuals_text(report, style);
  return text + style.dim("  '.' is zero, or below 1e-12 of the largest of its kind.") + "\n";
}
