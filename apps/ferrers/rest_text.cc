#include "rest_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

using namespace ferrers;  // NOLINT(google-build-using-namespace)

namespace {

constexpr double kNothing = 1e-12;  // of the largest of its kind: shown as zero
constexpr long kWidestMatrix = 6;   // columns that fit a page
constexpr std::size_t kMostShapes = 6;

using Rows = std::vector<std::vector<std::string>>;

std::string line(std::string_view label, std::string_view text) { return fmt::format("  {:<15}{}\n", label, text); }

std::string shown(double value, double largest) { return std::abs(value) <= kNothing * largest ? "0" : number(value); }

std::string with_degrees(const NamedCoordinate& one) {
  const std::string text = fmt::format("{} {}", shown(one.value, 1), to_string(one.unit));
  if (one.unit != NamedCoordinate::Unit::kRadian || std::abs(one.value) <= kNothing) return text;
  return fmt::format("{} ({} degrees)", text, number(one.value * 180 / std::numbers::pi));
}

std::string positions_text(const System& system, const State& state, const Style& style) {
  Rows rows = {{"coordinate", "position"}};
  for (const NamedCoordinate& one : measure_positions(system, state)) rows.push_back({one.name, with_degrees(one)});
  return rows.size() > 1 ? "\n" + table(rows, "  ", style) : "";
}

std::string energy_text(const DynamicsModel& model, const Energy& energy) {
  const char* potential = model.lagrangian.energy.output_count() == 0 ? "gravity" : "gravity and V";
  return line("energy", fmt::format("{} J: {} {} J, springs {} J", number(energy.total()), potential,
                                    number(energy.gravity), number(energy.elastic)));
}

std::string stability_text(const System& system, const StabilityVerdict& verdict, const Style& style) {
  if (verdict.stability == Stability::kUnknown) {
    return line("stability",
                style.yellow(system.knows_time ? "not told: a constraint moves by itself, or this pose is singular"
                                               : "unknown: this pose is singular, its motions have no stiffness"));
  }
  std::string text(to_string(verdict.stability));
  const auto add = [&](int count, std::string_view what) {
    if (count == 0) return;
    text += fmt::format("{} {} {}", text.find(':') == std::string::npos ? ":" : ",", counted(count, "motion"), what);
  };
  add(verdict.stable, "resisted");
  add(verdict.neutral, "without resistance");
  add(verdict.unstable, "running away");
  if (verdict.stable + verdict.neutral + verdict.unstable == 0) text += ": nothing can move";
  if (!verdict.confident) text += "; which ones meet no resistance is in doubt";
  if (!verdict.conservative) text += "; by eigenvalues, as some force has no potential";
  return line("stability", verdict.stability == Stability::kStable ? text : style.yellow(text));
}

std::string drives_text(const RestDocument& document, const Style& style) {
  const DynamicsModel& model = *document.dynamics;
  const std::vector<int> acting = acting_drives(model);
  if (acting.empty()) return "";
  const HoldingResult* holding = document.holding;
  Rows rows = {{"drive", "effort", ""}};
  for (const int i : acting) {
    const auto k = static_cast<std::size_t>(i);
    const double u = holding != nullptr ? holding->u[i] : document.equilibrium->u[i];
    std::string remark;
    if (holding == nullptr || !holding->holds[k]) {
      remark = model.drives[k].effort ? "by its law" : "has no effort law";
    } else if (!holding->unique[k]) {
      remark = "one choice of many, the least";
    }
    rows.push_back({model.drives[k].name, fmt::format("{} {}", number(u), effort_unit(model.drives[k])), remark});
  }
  return "\n" + table(rows, "  ", style);
}

std::string reactions_text(const RestDocument& document, const Style& style) {
  if (document.reactions == nullptr || document.reactions->empty()) return "";
  double largest = 0;
  bool undetermined = false, distributed = false;
  for (const JointReaction& one : *document.reactions) {
    for (int k = 0; k < one.components; ++k) {
      if (one.status[k] == ReactionStatus::kUndetermined) continue;
      largest = std::max(largest, std::abs(one.value[k]));
    }
  }
  const auto cell = [&](const JointReaction& one, int k) {
    if (one.status[k] == ReactionStatus::kUndetermined) {
      undetermined = true;
      return std::string("?");
    }
    if (one.status[k] != ReactionStatus::kDistributed) return shown(one.value[k], largest);
    distributed = true;
    return shown(one.value[k], largest) + " ~";
  };
  const ReactionNames names = name_reactions(*document.dynamics->system->model);
  Rows rows = {{"joint", "force_x", "force_y", "force_z", "moment_x", "moment_y", "moment_z"}};
  Rows multipliers = {{"constraint", "multiplier"}};
  for (std::size_t j = 0; j < document.reactions->size(); ++j) {
    const JointReaction& one = (*document.reactions)[j];
    if (one.components == 1) {
      multipliers.push_back({names.couplings[j - names.joints.size()], cell(one, 0)});
      continue;
    }
    rows.push_back({names.joints[j]});
    for (int k = 0; k < 6; ++k) rows.back().push_back(cell(one, k));
  }
  std::string text;
  if (rows.size() > 1) {
    text += "\n" + table(rows, "  ", style);
    text += style.dim("  Reactions on each joint's second body, N and N·m.") + "\n";
  }
  if (multipliers.size() > 1) {
    text += "\n" + table(multipliers, "  ", style);
    text += style.dim("  Multipliers of couplings and constraints: J per unit of what is zero.") + "\n";
  }
  const bool shared = document.holding != nullptr && document.holding->idle_efforts.cols() > 0;
  if (distributed && shared) {
    text +=
        style.dim("  ~: as the drives share the load by the least effort, or the joints by their stiffness.") + "\n";
  } else if (distributed) {
    text += style.dim("  ~: shared out by the stiffness of the joints.") + "\n";
  }
  if (undetermined) {
    text += style.dim(
        "  ?: undetermined. Rigid bodies do not tell how redundant constraints share the load; give joints a\n"
        "  'stiffness', or say --distribute equal.\n");
  }
  return text;
}

std::string notices_text(const std::vector<std::string>& notices) {
  std::string text;
  for (const std::string& notice : notices) text += line("note", notice);
  return text;
}

std::string equilibrium_text(const RestDocument& document, const Style& style) {
  const EquilibriumResult& rest = *document.equilibrium;
  std::string text =
      line("found", fmt::format("in {}, loads at t = {} s", counted(rest.steps, "step"), number(rest.state.t)));
  text +=
      stability_text(*document.dynamics->system, rest.stability, style) + energy_text(*document.dynamics, rest.energy);
  text +=
      line("balance", fmt::format("{} N left of {} N that act", rough(rest.residual_N), number(rest.force_scale_N)));
  return text + notices_text(rest.notices);
}

std::string holding_text(const RestDocument& document) {
  const HoldingResult& held = *document.holding;
  std::string text = line("loads", fmt::format("at t = {} s", number(held.state.t)));
  text += energy_text(*document.dynamics, held.energy);
  for (const std::string& name : held.free_motion_names) {
    text += line("balanced only", "no drive resists: " + name);
  }
  if (!held.confident) text += line("note", "how many motions the drives resist is in doubt");
  return text + notices_text(held.notices);
}

std::string matrix_text(std::string_view name, const MatrixXd& M, const Style& style) {
  Rows rows(1);
  rows[0].assign(static_cast<std::size_t>(M.cols()) + 1, "");
  rows[0][0] = name;
  const double largest = M.size() > 0 ? M.cwiseAbs().maxCoeff() : 0;
  for (long i = 0; i < M.rows(); ++i) {
    rows.push_back({""});
    for (long k = 0; k < M.cols(); ++k) rows.back().push_back(shown(M(i, k), largest));
  }
  return "\n" + table(rows, "  ", style);
}

std::string mode_row_text(const Mode& mode) {
  const double rate = mode.frequency_rad_s();
  switch (mode.kind) {
    case ModeKind::kOscillation:
      return fmt::format("{} Hz, {} rad/s", number(rate / (2 * std::numbers::pi)), number(rate));
    case ModeKind::kDecay:
      return fmt::format("dies away as exp({} t)", number(mode.eigenvalue.real()));
    case ModeKind::kGrowth:
      return fmt::format("runs away as exp({} t)", number(mode.eigenvalue.real()));
    case ModeKind::kNeutral:
      break;
  }
  return "0: moves without resistance";
}

std::string modes_text(const Linearization& linear, const Style& style) {
  if (linear.modal.modes.empty()) return "";
  Rows rows = {{"mode", "frequency", "damping", "moves most", ""}};
  for (std::size_t i = 0; i < linear.modal.modes.size(); ++i) {
    const Mode& mode = linear.modal.modes[i];
    const bool oscillates = mode.kind == ModeKind::kOscillation;
    rows.push_back({fmt::format("{}", i + 1), mode_row_text(mode), oscillates ? shown(mode.damping_ratio(), 1) : "",
                    linear.joint_coordinates[static_cast<std::size_t>(linear.shapes[i].largest)].name,
                    mode.multiplicity > 1 ? fmt::format("one of {} alike", mode.multiplicity) : ""});
  }
  return "\n" + table(rows, "  ", style);
}

std::string part_text(const std::complex<double>& value) {
  if (std::abs(value) <= 1e-9) return "0";
  if (std::abs(value.imag()) <= 1e-9 * std::abs(value)) return number(value.real());
  return fmt::format("{} at {:.3g}°", number(std::abs(value)), std::arg(value) * 180 / std::numbers::pi);
}

std::string shapes_text(const Linearization& linear, const Style& style) {
  const std::size_t count = std::min(linear.shapes.size(), kMostShapes);
  if (count == 0) return "";
  Rows rows = {{"shape"}};
  for (std::size_t i = 0; i < count; ++i) rows[0].push_back(fmt::format("mode {}", i + 1));
  for (std::size_t k = 0; k < linear.joint_coordinates.size(); ++k) {
    const NamedCoordinate& one = linear.joint_coordinates[k];
    rows.push_back({fmt::format("{}, {}", one.name, to_string(one.unit))});
    for (std::size_t i = 0; i < count; ++i) rows.back().push_back(part_text(linear.shapes[i].value[k]));
  }
  std::string text = "\n" + table(rows, "  ", style);
  if (count < linear.shapes.size()) text += style.dim("  The other shapes: --json.") + "\n";
  return text;
}

}  // namespace

std::string rest_text(const RestDocument& document, const Style& style) {
  const bool hold = document.holding != nullptr;
  std::string text = fmt::format("{}: {}\n\n", style.bold(document.model),
                                 hold ? "held at rest in the initial pose" : "an equilibrium");
  text += hold ? holding_text(document) : equilibrium_text(document, style);
  const State& state = hold ? document.holding->state : document.equilibrium->state;
  text += positions_text(*document.dynamics->system, state, style);
  return text + drives_text(document, style) + reactions_text(document, style);
}

std::string linearization_text(const LinearizationDocument& document, const Style& style) {
  const Linearization& linear = *document.linear;
  std::string text = fmt::format("{}: linear system at the {}\n\n", style.bold(document.model),
                                 document.at_equilibrium ? "equilibrium" : "initial state");
  const char* rest = linear.is_equilibrium ? "at rest, in equilibrium"
                     : linear.at_rest      ? "at rest, but not in equilibrium: it starts to move"
                                           : "in motion";
  text += line("state", linear.is_equilibrium ? rest : style.yellow(rest));
  if (linear.is_equilibrium) text += stability_text(*document.dynamics->system, linear.stability, style);
  std::vector<std::string> names;
  for (const NamedCoordinate& one : linear.coordinates) names.push_back(one.name);
  text += wrapped_list("  coordinates    ", names.empty() ? std::vector<std::string>{"none: nothing can move"} : names,
                       "                 ");
  if (!linear.inputs.empty()) text += wrapped_list("  inputs         ", linear.inputs, "                 ");
  text += line("accuracy", fmt::format("{} of A, estimated", rough(linear.relative_error)));
  text += notices_text(linear.notices);
  if (!linear.is_equilibrium) text += line("note", "frequencies are those of the system as it stands at this instant");
  text += modes_text(linear, style) + shapes_text(linear, style);
  if (linear.A.cols() == 0) return text;
  if (linear.A.cols() > kWidestMatrix) {
    return text +
           fmt::format("\n  A is {0} × {0}, B {0} × {1}: --json prints them.\n", linear.A.rows(), linear.B.cols());
  }
  text += matrix_text("A", linear.A, style);
  return linear.B.cols() > 0 ? text + matrix_text("B", linear.B, style) : text;
}
