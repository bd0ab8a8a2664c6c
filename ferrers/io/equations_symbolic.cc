#include "ferrers/io/equations_symbolic.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

namespace ferrers {
namespace {

constexpr std::size_t kLongest = 4000;  // bytes of LaTeX of one formula: more is not to be read
constexpr std::size_t kMostCoordinates = 12;

constexpr std::array<std::string_view, 34> kGreek = {
    "alpha", "beta",  "gamma",  "delta", "epsilon", "zeta",  "eta",     "theta", "iota", "kappa", "lambda", "mu",
    "nu",    "xi",    "pi",     "rho",   "sigma",   "tau",   "upsilon", "phi",   "chi",  "psi",   "omega",  "Gamma",
    "Delta", "Theta", "Lambda", "Xi",    "Pi",      "Sigma", "Upsilon", "Phi",   "Psi",  "Omega"};

// theta_1 is θ₁, x2 is x₂, longer words stand upright.
std::string word_latex(std::string_view word) {
  const std::size_t split = word.find_first_of("_0123456789");
  std::string_view head = word.substr(0, split), tail = split == std::string_view::npos ? "" : word.substr(split);
  while (!tail.empty() && tail.front() == '_') tail.remove_prefix(1);
  std::string out = std::find(kGreek.begin(), kGreek.end(), head) != kGreek.end() ? "\\" + std::string(head)
                    : head.size() <= 1                                            ? std::string(head)
                                                                                  : fmt::format("\\mathrm{{{}}}", head);
  if (tail.empty()) return out;
  std::string below;
  for (const char c : tail) below += c == '_' ? std::string(",") : std::string(1, c);
  const bool is_number = below.find_first_not_of("0123456789,") == std::string::npos;
  return out + "_{" + (is_number ? below : "\\mathrm{" + below + "}") + "}";
}

std::string name_latex(std::string_view name) {
  constexpr std::string_view kRate = ".velocity", kValue = ".position";
  const auto ends = [&name](std::string_view end) {
    return name.size() > end.size() && name.substr(name.size() - end.size()) == end;
  };
  if (ends(kRate)) return "\\dot{" + name_latex(name.substr(0, name.size() - kRate.size())) + "}";
  if (ends(kValue)) return name_latex(name.substr(0, name.size() - kValue.size()));
  const std::size_t dot = name.find('.');
  if (dot == std::string_view::npos) return word_latex(name);
  return word_latex(name.substr(0, dot)) + "\\mathrm{." + std::string(name.substr(dot + 1)) + "}";
}

bool is_zero(const Expression& e) { return e.constant_value() == 0.0; }

// Lines "left = formula", those that are zero left out; too long ones are told without their formula.
class Lines {
 public:
  void add(const std::string& left, const Expression& formula, bool even_zero = false) {
    if (is_zero(formula) && !even_zero) return;
    std::string right = formula.to_latex(name_latex);
    if (right.size() > kLongest) right = "\\text{(too long to print)}";
    text_ += fmt::format("{}{} &= {}", text_.empty() ? "" : " \\\\\n", left, right);
  }
  std::string block() const { return text_.empty() ? "" : "\\begin{align*}\n" + text_ + "\n\\end{align*}\n"; }

 private:
  std::string text_;
};

std::string constraints(const Model& model) {
  Lines residuals, rows, biases;
  for (const Coupling& coupling : model.couplings()) {
    if (!coupling.relation || coupling.relation->system) continue;
    const Relation& given = *coupling.relation;
    const FormulaScalars scalars{coupling.scalars, given.values, given.rates};
    const std::string name = word_latex(coupling.name);
    Relation symbolic;
    if (given.on_velocities) {
      symbolic = make_velocity_relation(given.symbolic, scalars).value_or(given);
      residuals.add(fmt::format("0_{{{}}}", name), given.symbolic);
    } else {
      symbolic = make_relation(given.symbolic, scalars);
      residuals.add(fmt::format("\\varphi_{{{}}}", name), given.symbolic.simplified());
    }
    for (std::size_t k = 0; k < symbolic.gradient.size(); ++k) {
      rows.add(fmt::format("G_{{{},\\,{}}}", name, name_latex(symbolic.values[k])), symbolic.gradient[k]);
    }
    biases.add(fmt::format("\\gamma_{{{}}}", name), (-symbolic.bias).simplified());
  }
  return residuals.block() + rows.block() + biases.block();
}

std::string motion(const Model& model) {
  const Lagrangian& given = model.lagrangian();
  if (!given.any() || given.system) return "";
  const Lagrangian symbolic =
      make_lagrangian(given.kinetic, given.potential, given.dissipation, std::vector<Expression>(given.scalars.size()),
                      {given.scalars, given.values, given.rates});
  Lines energies, mass, bias;
  energies.add("T", given.kinetic);
  energies.add("V", given.potential);
  energies.add("R", given.dissipation);
  for (const Lagrangian::MassEntry& entry : symbolic.mass) {
    mass.add(fmt::format("M_{{{},\\,{}}}", name_latex(given.values[entry.row]), name_latex(given.values[entry.column])),
             entry.value);
  }
  for (std::size_t k = 0; k < symbolic.bias.size(); ++k) {
    bias.add(fmt::format("h_{{{}}}", name_latex(given.values[k])), symbolic.bias[k]);
  }
  for (std::size_t k = 0; k < symbolic.force.size(); ++k) {
    bias.add(fmt::format("\\tau_{{{}}}", name_latex(given.values[k])), symbolic.force[k]);
  }
  for (const auto& [ref, force] : model.spec().lagrangian.forces) {
    bias.add(fmt::format("Q_{{{}}}", name_latex(ref.joint.name)), force);
  }
  return energies.block() + mass.block() + bias.block();
}

}  // namespace

std::string symbolic_equations_latex(const Model& model) {
  if (model.joints().size() - model.coordinates_begin() > kMostCoordinates) return "";
  const std::string text = motion(model) + constraints(model);
  return text.empty() ? "" : "\\subsection*{By formulas}\n" + text;
}

}  // namespace ferrers
