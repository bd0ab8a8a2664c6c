#include "ferrers/io/rest_report.h"

#include <numbers>

#include "ferrers/dynamics/named_coordinates.h"
#include "ferrers/io/json_matrices.h"

namespace ferrers {
namespace {

OrderedJson complex_value(const std::complex<double>& value) { return {{"re", value.real()}, {"im", value.imag()}}; }

OrderedJson coordinate_value(const NamedCoordinate& one, bool with_value) {
  OrderedJson value;
  value["coordinate"] = one.name;
  if (with_value) value["value"] = one.value;
  value["unit"] = text_or_null(std::string(to_string(one.unit)));
  return value;
}

OrderedJson coordinate_values(const std::vector<NamedCoordinate>& all, bool with_value) {
  OrderedJson out = OrderedJson::array();
  for (const NamedCoordinate& one : all) out.push_back(coordinate_value(one, with_value));
  return out;
}

OrderedJson stability_value(const StabilityVerdict& verdict) {
  return {{"verdict", to_string(verdict.stability)},
          {"confident", verdict.confident},
          {"conservative", verdict.conservative},
          {"stable", verdict.stable},
          {"neutral", verdict.neutral},
          {"unstable", verdict.unstable},
          {"stiffnesses_N_per_m", vector_value(verdict.stiffness)}};
}

OrderedJson reaction_values(const Model& model, const std::vector<JointReaction>& reactions) {
  OrderedJson all = OrderedJson::array();
  const ReactionNames names = name_reactions(model);
  for (std::size_t j = 0; j < reactions.size(); ++j) {
    const bool joint = j < names.joints.size();
    OrderedJson components = OrderedJson::object();
    for (int k = 0; k < reactions[j].components; ++k) {
      const bool known = reactions[j].status[k] != ReactionStatus::kUndetermined;
      components[joint ? std::string(kComponentNames[k]) : "multiplier"] = {
          {"value", known ? OrderedJson(reactions[j].value[k]) : OrderedJson()},
          {"status", to_string(reactions[j].status[k])}};
    }
    const std::string& name = joint ? names.joints[j] : names.couplings[j - names.joints.size()];
    all.push_back(OrderedJson{{"joint", name}, {"components", std::move(components)}});
  }
  return all;
}

OrderedJson drive_values(const DynamicsModel& model, const VectorXd& u, const HoldingResult* holding) {
  OrderedJson all = OrderedJson::array();
  for (const int i : acting_drives(model)) {
    const auto k = static_cast<std::size_t>(i);
    OrderedJson value;
    value["drive"] = model.drives[k].name;
    value["effort"] = u[i];
    value["unit"] = effort_unit(model.drives[k]);
    value["holds"] = holding != nullptr && holding->holds[k];
    value["unique"] = holding == nullptr || holding->unique[k];
    all.push_back(std::move(value));
  }
  return all;
}

OrderedJson energy_value(const Energy& energy) {
  return {{"gravity", energy.gravity}, {"elastic", energy.elastic}, {"total", energy.total()}};
}

OrderedJson names_of(const std::vector<NamedCoordinate>& all) {
  OrderedJson out = OrderedJson::array();
  for (const NamedCoordinate& one : all) out.push_back(one.name);
  return out;
}

void add_equilibrium(const RestDocument& document, OrderedJson& out) {
  const EquilibriumResult& rest = *document.equilibrium;
  const bool found = rest.status == EquilibriumStatus::kFound;
  out["status"] = found ? "found" : rest.status == EquilibriumStatus::kNotFound ? "not_found" : "unsupported";
  out["message"] = text_or_null(rest.message);
  out["t"] = rest.state.t;
  if (rest.status == EquilibriumStatus::kUnsupported) return;
  const System& system = *document.dynamics->system;
  out["positions"] = coordinate_values(measure_positions(system, rest.state), true);
  out["energy_J"] = energy_value(rest.energy);
  out["independent_coordinates"] = names_of(name_independent(system, rest.selection, rest.state.v));
  out["drives"] = drive_values(*document.dynamics, rest.u, nullptr);
  out["residual_N"] = rest.residual_N;
  out["forces_N"] = rest.force_scale_N;
  out["steps"] = rest.steps;
  out["notices"] = rest.notices;
  if (!found) return;
  out["stability"] = stability_value(rest.stability);
  if (rest.stability.stability != Stability::kUnknown) out["stiffness_matrix"] = matrix_value(rest.stiffness.value);
}

void add_holding(const RestDocument& document, OrderedJson& out) {
  const HoldingResult& held = *document.holding;
  const bool holds = held.status == HoldingStatus::kHeld;
  out["status"] = holds ? "held" : held.status == HoldingStatus::kNotHeld ? "not_held" : "unsupported";
  out["message"] = text_or_null(held.message);
  out["t"] = held.state.t;
  if (held.status == HoldingStatus::kUnsupported) return;
  const System& system = *document.dynamics->system;
  out["positions"] = coordinate_values(measure_positions(system, held.state), true);
  out["energy_J"] = energy_value(held.energy);
  out["independent_coordinates"] = names_of(name_independent(system, held.selection, held.state.v));
  out["drives"] = drive_values(*document.dynamics, held.u, &held);
  out["free_motions"] = held.free_motion_names;
  out["residual_N"] = held.residual_N;
  out["notices"] = held.notices;
}

void finish(const std::string& model, const Diagnostics* diagnostics, bool done, OrderedJson& out) {
  out["model"] = text_or_null(model);
  out["ok"] = done && (diagnostics == nullptr || !diagnostics->has_errors());
  out["diagnostics"] = diagnostics != nullptr ? diagnostics_value(*diagnostics) : OrderedJson::array();
}

OrderedJson mode_value(const Linearization& linear, std::size_t index) {
  const Mode& mode = linear.modal.modes[index];
  const ModeShape& shape = linear.shapes[index];
  OrderedJson value, parts = OrderedJson::object();
  const bool oscillates = mode.kind == ModeKind::kOscillation;
  value["kind"] = to_string(mode.kind);
  value["eigenvalue"] = complex_value(mode.eigenvalue);
  value["frequency_hz"] = oscillates ? OrderedJson(mode.frequency_rad_s() / (2 * std::numbers::pi)) : OrderedJson();
  value["frequency_rad_s"] = oscillates ? OrderedJson(mode.frequency_rad_s()) : OrderedJson();
  value["damping_ratio"] = oscillates ? OrderedJson(mode.damping_ratio()) : OrderedJson();
  value["multiplicity"] = mode.multiplicity;
  for (std::size_t i = 0; i < shape.value.size(); ++i) {
    parts[linear.joint_coordinates[i].name] = complex_value(shape.value[i]);
  }
  value["moves_most"] = shape.value.empty()
                            ? OrderedJson()
                            : OrderedJson(linear.joint_coordinates[static_cast<std::size_t>(shape.largest)].name);
  value["shape"] = std::move(parts);
  return value;
}

void add_modes(const Linearization& linear, OrderedJson& out) {
  OrderedJson eigenvalues = OrderedJson::array(), modes = OrderedJson::array();
  OrderedJson frequencies = OrderedJson::array(), ratios = OrderedJson::array();
  for (const auto& value : linear.modal.eigenvalues) eigenvalues.push_back(complex_value(value));
  for (std::size_t i = 0; i < linear.modal.modes.size(); ++i) {
    modes.push_back(mode_value(linear, i));
    frequencies.push_back(modes.back()["frequency_hz"]);
    ratios.push_back(modes.back()["damping_ratio"]);
  }
  out["eigenvalues"] = std::move(eigenvalues);
  out["frequencies_hz"] = std::move(frequencies);
  out["damping_ratios"] = std::move(ratios);
  out["modes"] = std::move(modes);
}

std::string_view status_name(LinearizationStatus status) {
  switch (status) {
    case LinearizationStatus::kDone:
      return "done";
    case LinearizationStatus::kSingularPose:
      return "singular_pose";
    case LinearizationStatus::kSingularMass:
      return "singular_mass";
    case LinearizationStatus::kUnsupported:
      break;
  }
  return "unsupported";
}

void add_linearization(const Linearization& linear, const DynamicsModel& model, OrderedJson& out) {
  out["status"] = status_name(linear.status);
  out["message"] = text_or_null(linear.message);
  out["t"] = linear.state.t;
  if (linear.status != LinearizationStatus::kDone) return;
  out["at_rest"] = linear.at_rest;
  out["in_equilibrium"] = linear.is_equilibrium;
  out["coordinates"] = coordinate_values(linear.coordinates, false);
  OrderedJson inputs = OrderedJson::array();
  for (const int i : acting_drives(model)) {
    const DriveComponent& drive = model.drives[static_cast<std::size_t>(i)];
    inputs.push_back({{"drive", drive.name}, {"unit", effort_unit(drive)}});
  }
  out["inputs"] = std::move(inputs);
  out["A"] = matrix_value(linear.A);
  out["B"] = matrix_value(linear.B);
  out["c"] = vector_value(linear.drift);
  out["mass_matrix"] = matrix_value(linear.M);
  out["stiffness_matrix"] = matrix_value(linear.K.value);
  out["damping_matrix"] = matrix_value(linear.C.value);
  out["relative_error"] = linear.relative_error;
  if (linear.is_equilibrium) out["stability"] = stability_value(linear.stability);
  add_modes(linear, out);
  out["notices"] = linear.notices;
}

}  // namespace

std::string write_rest_json(const RestDocument& document) {
  OrderedJson out;
  out["schema"] = "ferrers.equilibrium/1";
  for (const char* key : {"model", "ok", "task", "status", "message", "t", "positions", "energy_J", "stability",
                          "independent_coordinates", "stiffness_matrix", "drives", "free_motions", "reactions",
                          "residual_N", "forces_N", "steps", "notices"}) {
    out[key] = nullptr;
  }
  bool done = false;
  if (document.equilibrium != nullptr) {
    out["task"] = "find";
    add_equilibrium(document, out);
    done = document.equilibrium->status == EquilibriumStatus::kFound;
  } else if (document.holding != nullptr) {
    out["task"] = "hold";
    add_holding(document, out);
    done = document.holding->status == HoldingStatus::kHeld;
  }
  if (document.reactions != nullptr) {
    out["reactions"] = reaction_values(*document.dynamics->system->model, *document.reactions);
  }
  finish(document.model, document.diagnostics, done, out);
  return json_text(out);
}

std::string write_linearization_json(const LinearizationDocument& document) {
  OrderedJson out;
  out["schema"] = "ferrers.linearize/1";
  for (const char* key : {"model",
                          "ok",
                          "at",
                          "status",
                          "message",
                          "t",
                          "at_rest",
                          "in_equilibrium",
                          "coordinates",
                          "inputs",
                          "A",
                          "B",
                          "c",
                          "mass_matrix",
                          "stiffness_matrix",
                          "damping_matrix",
                          "relative_error",
                          "stability",
                          "eigenvalues",
                          "frequencies_hz",
                          "damping_ratios",
                          "modes",
                          "notices"}) {
    out[key] = nullptr;
  }
  out["at"] = document.at_equilibrium ? "equilibrium" : "initial";
  if (document.linear != nullptr) add_linearization(*document.linear, *document.dynamics, out);
  const bool done = document.linear != nullptr && document.linear->status == LinearizationStatus::kDone;
  finish(document.model, document.diagnostics, done, out);
  return json_text(out);
}

}  // namespace ferrers
