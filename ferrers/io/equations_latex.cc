#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ferrers/dynamics/holding.h"
#include "ferrers/io/equations_document.h"
#include "ferrers/io/equations_symbolic.h"

namespace ferrers {
namespace {

constexpr double kNothing = 1e-12;  // of the largest of its kind: shown as zero
constexpr int kWidestMatrix = 10;   // columns: what amsmath takes, and a page

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') {
      out += "\\textbackslash{}";
    } else if (c == '^' || c == '~') {
      out += fmt::format("\\{}{{}}", c);
    } else {
      if (std::string_view("#$%&_{}").find(c) != std::string_view::npos) out += '\\';
      out += c;
    }
  }
  return out;
}

std::string code(std::string_view text) { return "\\texttt{" + escaped(text) + "}"; }

std::string list(const std::vector<std::string>& names, const std::vector<int>& which) {
  std::string out;
  for (const int i : which) out += (out.empty() ? "" : ", ") + code(names[static_cast<std::size_t>(i)]);
  return out.empty() ? "none" : out;
}

// 1.5e-07 is 1.5 · 10⁻⁷.
std::string number_text(double value, double largest) {
  if (std::abs(value) <= kNothing * largest) return "0";
  if (!std::isfinite(value)) return "\\text{?}";
  const std::string text = fmt::format("{:.6g}", value);
  const std::size_t e = text.find('e');
  if (e == std::string::npos) return text;
  return fmt::format("{} \\cdot 10^{{{}}}", text.substr(0, e), std::stoi(text.substr(e + 1)));
}

double largest_of(const MatrixXd& M) { return M.size() > 0 ? M.cwiseAbs().maxCoeff() : 0; }

std::string matrix_rows(const MatrixXd& M, long first, long count) {
  const double largest = largest_of(M);
  std::string out = "\\begin{bmatrix}\n";
  for (long i = 0; i < M.rows(); ++i) {
    for (long k = first; k < first + count; ++k) out += (k > first ? " & " : "  ") + number_text(M(i, k), largest);
    out += i + 1 < M.rows() ? " \\\\\n" : "\n";
  }
  return out + "\\end{bmatrix}";
}

// Wide ones in groups: M_{1..10}, M_{11..20}, ...
std::string matrix_block(std::string_view symbol, const MatrixXd& M) {
  if (M.rows() == 0 || M.cols() == 0) return "";
  std::string out;
  for (long first = 0; first < M.cols(); first += kWidestMatrix) {
    const long count = std::min<long>(kWidestMatrix, M.cols() - first);
    const std::string name = M.cols() <= kWidestMatrix
                                 ? std::string(symbol)
                                 : fmt::format("{}_{{\\cdot,\\,{}\\ldots{}}}", symbol, first + 1, first + count);
    out += fmt::format("\\[ {} = {} \\]\n", name, matrix_rows(M, first, count));
  }
  return out;
}

// Several vectors of one length side by side, with names in front.
std::string vectors_block(std::string_view head, const std::vector<std::string>& names,
                          const std::vector<std::string>& symbols,
                          const std::vector<std::vector<std::string>>& columns) {
  if (names.empty()) return "";
  std::string out = fmt::format("\\begin{{longtable}}{{l{}}}\n{}", std::string(symbols.size(), 'r'), head);
  for (const std::string& symbol : symbols) out += fmt::format(" & ${}$", symbol);
  out += " \\\\ \\hline\n";
  for (std::size_t i = 0; i < names.size(); ++i) {
    out += code(names[i]);
    for (const auto& column : columns) out += fmt::format(" & ${}$", column[i]);
    out += " \\\\\n";
  }
  return out + "\\end{longtable}\n";
}

std::vector<std::string> cells(const VectorXd& values) {
  std::vector<std::string> out;
  for (const double value : values) out.push_back(number_text(value, largest_of(values)));
  return out;
}

std::string decision_text(const EquationsDocument& document) {
  const EquationsReport& report = *document.report;
  std::string out = fmt::format(
      "\\section*{{{}: the equations (6)--(9) at $t = {}$\\,s}}\n\n"
      "$n = {}$ coordinates, $m = {}$ constraints of rank $r = {}$, mobility $w = n - r = {}$: $3r + n = {}$ "
      "equations.\n\n",
      escaped(document.model), number_text(report.state.t, 0), report.n, report.m, report.r, report.w,
      report.equation_count());
  const auto& s = report.selection;
  out += "Independent coordinates: " + list(report.coordinate_names, s.independent) + ".\n";
  out += "Dependent ones: " + list(report.coordinate_names, s.dependent) + ".\n";
  out += "Independent rows: " + list(report.row_names, s.rows) + ".\n";
  out += "Rows left out: " + list(report.row_names, report.excluded_rows) + ".\n";
  if (!report.decision.confident) {
    out += fmt::format("The rank is in doubt: read the other way it is {}.\n", report.decision.other_rank);
  }
  return out + "\n";
}

std::string constraints_text(const EquationsReport& report) {
  const ConstraintKinematics& c = report.equations.constraints;
  std::string out = "\\subsection*{(6)--(8) Constraints: $\\varphi(q) = 0$, $G v = \\nu$, $G \\dot v = \\gamma$}\n";
  if (report.m == 0) return out + "There are none.\n\n";
  out += vectors_block("row", report.row_names, {"\\varphi", "\\nu", "\\gamma"},
                       {cells(c.phi), cells(c.nu), cells(c.gamma)});
  return out + matrix_block("G", c.G);
}

std::string motion_text(const EquationsDocument& document) {
  const EquationsReport& report = *document.report;
  const Equations& eq = report.equations;
  std::string out = "\\subsection*{(9) Motion: $M \\dot v + h = \\tau + B u + G^{\\mathsf T} \\lambda$}\n";
  out += matrix_block("M", eq.M);
  out += vectors_block("coordinate", report.coordinate_names, {"h", "\\tau"}, {cells(eq.h), cells(eq.tau)});
  out += matrix_block("B", eq.B_transposed(acting_drives(*document.dynamics), Eigen::all).transpose());
  std::vector<std::string> names, efforts;
  for (const int i : acting_drives(*document.dynamics)) {
    const DriveComponent& drive = document.dynamics->drives[static_cast<std::size_t>(i)];
    const bool known = report.solved() || report.problem == EquationsProblem::kForward;
    names.push_back(drive.has_unit ? fmt::format("{} ({})", drive.name, drive.rotary ? "N m" : "N") : drive.name);
    efforts.push_back(known ? number_text(report.u[i], largest_of(report.u)) : "\\text{?}");
  }
  return out + vectors_block("drive", names, {"u"}, {efforts});
}

std::string solution_text(const EquationsReport& report) {
  if (!report.solved()) return fmt::format("\\subsection*{{No solution}}\n{}\n\n", escaped(report.message));
  std::string out = "\\subsection*{Solution}\n";
  out += vectors_block("coordinate", report.coordinate_names, {"\\dot v"}, {cells(report.vdot)});
  std::vector<std::string> unique = cells(report.lambda_of_kept_rows);
  bool open = false;
  for (std::size_t i = 0; i < unique.size(); ++i) {
    if (report.lambda_status[i] == ReactionStatus::kUndetermined) unique[i] = "\\text{?}", open = true;
  }
  out +=
      vectors_block("row", report.row_names, {"\\lambda", "\\lambda^{0}"}, {unique, cells(report.lambda_of_kept_rows)});
  if (open) {
    out +=
        "A multiplier marked ? is not determined by rigid bodies. $\\lambda^{0}$ is one choice of many: the "
        "multipliers of the independent rows with those of the rows left out zero.\n\n";
  }
  return out;
}

std::string residuals_text(const EquationsReport& report) {
  std::string out =
      "\\subsection*{Residuals}\nAll rows, those left out included; angles and moments by the characteristic length.\n"
      "\\begin{longtable}{lrr}\n & largest & of \\\\ \\hline\n";
  for (const EquationResidual& one : report.residuals) {
    const std::string unit = one.unit == "m/s²" ? "m/s$^2$" : one.unit;
    out += fmt::format("({}) & ${}$ {} & ${}$ {} \\\\\n", one.equation, number_text(one.largest, 0), unit,
                       number_text(one.size, 0), unit);
  }
  return out + "\\end{longtable}\n";
}

std::string body(const EquationsDocument& document) {
  const EquationsReport& report = *document.report;
  std::string out = decision_text(document) + symbolic_equations_latex(*document.dynamics->system->model);
  if (!report.has_equations) return out + escaped(report.message) + "\n";
  out += "\\subsection*{State}\n" + vectors_block("position", report.position_names, {"q"}, {cells(report.state.q)});
  out += vectors_block("coordinate", report.coordinate_names, {"v"}, {cells(report.state.v)});
  return out + constraints_text(report) + motion_text(document) + solution_text(report) + residuals_text(report);
}

}  // namespace

std::string write_equations_latex(const EquationsDocument& document, bool standalone) {
  if (!standalone) return body(document);
  return "\\documentclass[a4paper]{article}\n"
         "\\usepackage[T1]{fontenc}\n"
         "\\usepackage{amsmath,longtable}\n"
         "\\usepackage[margin=20mm]{geometry}\n"
         "\\allowdisplaybreaks\n"
         "\\begin{document}\n" +
         body(document) + "\\end{document}\n";
}

}  // namespace ferrers
