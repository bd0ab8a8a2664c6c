#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ferrers/core/closest_name.h"
#include "ferrers/model/build_internal.h"
#include "ferrers/model/lagrangian_system.h"

namespace ferrers {
namespace {

constexpr std::string_view kVelocitySuffix = ".velocity";

/// Adds what a formula reads, each scalar once, in the order of appearance.
void collect(const StateFormula& formula, const Model& model, FormulaScalars& out) {
  for (const LawInput& input : formula.inputs) {
    if (input.kind == LawInput::Kind::kTime) continue;
    if (std::find(out.scalars.begin(), out.scalars.end(), input.scalar) != out.scalars.end()) continue;
    out.scalars.push_back(input.scalar);
    out.values.push_back(model.scalar_name(input.scalar));
    out.rates.push_back(model.rate_name(input.scalar));
  }
}

bool reads_rates(const StateFormula& formula) {
  return std::any_of(formula.inputs.begin(), formula.inputs.end(),
                     [](const LawInput& input) { return input.kind == LawInput::Kind::kVelocity; });
}

JointType coordinate_type(const Dimension& dimension) {
  if (dimension == kPureNumber) return JointType::kAngleCoordinate;
  return dimension == kLength ? JointType::kLengthCoordinate : JointType::kOtherCoordinate;
}

}  // namespace

void ModelAssembler::build_coordinates() {
  model_.coordinates_begin_ = model_.joints_.size();
  for (const GeneralCoordinateSpec& spec : spec_->lagrangian.coordinates) {
    Joint coordinate;
    coordinate.name = spec.name.name;
    coordinate.type = coordinate_type(spec.dimension);
    coordinate.dimension = spec.dimension;
    coordinate.first = coordinate.second = kGround;
    if (spec.limits) {
      const double low = number((*spec.limits)[0], spec.dimension, {"limits", spec.name});
      const double high = number((*spec.limits)[1], spec.dimension, {"limits", spec.name});
      if (low >= high) {
        diagnostics_.error("F326", place_of((*spec.limits)[0], {"limits", spec.name}),
                           fmt::format("the limits of '{}' are not in order", spec.name.name),
                           "write the lower one first");
      }
      coordinate.limits = {low, high};
    }
    if (parameter_index_.count(spec.name.name) != 0) {
      diagnostics_.error("F302", spec.name.at,
                         fmt::format("the coordinate '{}' has the name of a parameter", spec.name.name),
                         "formulas could not tell them apart");
    }
    if (spec.name.name == "t" || spec.name.name == "energy" || is_expression_keyword(spec.name.name)) {
      diagnostics_.error("F301", spec.name.at, fmt::format("'{}' cannot be the name of a coordinate", spec.name.name),
                         "formulas or the columns of the results use it already");
    }
    if (spec.guess) {
      InitialValue guess;
      guess.coordinate = {JointId(model_.joints_.size()), 0};
      guess.position = {number(*spec.guess, spec.dimension, {"guess", spec.name})};
      guess.guess = true;
      guess.at = place_of(*spec.guess, {"guess", spec.name});
      coordinate_guesses_.push_back(std::move(guess));
    }
    model_.joints_.push_back(std::move(coordinate));
    joint_is_placed_.push_back(false);  // it has no place
  }
}

/// The formula with parameters as numbers and every name in its one spelling. Nothing, after a message, if wrong.
std::optional<StateFormula> ModelAssembler::state_formula(const Expression& expression, LawScope scope,
                                                          std::optional<Dimension> wanted, Field field) {
  check_dimension(expression, wanted, field);
  StateFormula out;
  std::vector<std::pair<std::string, std::string>> spelling;
  bool usable = true;
  for (const ExpressionName& name : expression.names()) {
    const auto parameter = parameter_index_.find(name.name);
    if (parameter != parameter_index_.end() && name.name != "t") {
      usable = usable && std::isfinite(model_.parameters_[static_cast<std::size_t>(parameter->second)].value);
      continue;
    }
    const std::optional<LawInput> input = law_input(name, scope, field);
    usable = usable && input.has_value();
    if (!input) continue;
    const bool is_time = input->kind == LawInput::Kind::kTime;
    const std::string canonical = is_time                                    ? "t"
                                  : input->kind == LawInput::Kind::kPosition ? model_.scalar_name(input->scalar)
                                                                             : model_.rate_name(input->scalar);
    spelling.emplace_back(name.name, canonical);
    if (std::find(out.inputs.begin(), out.inputs.end(), *input) != out.inputs.end()) continue;
    out.names.push_back(canonical);
    out.inputs.push_back(*input);
  }
  if (!usable) return std::nullopt;
  out.symbolic = expression.substitute([&](std::string_view name) -> std::optional<Expression> {
    for (const auto& [written, canonical] : spelling) {
      if (written == name && written != canonical) return Expression::variable(canonical);
    }
    return std::nullopt;
  });
  out.expression = out.symbolic.substitute([&](std::string_view name) -> std::optional<Expression> {
    const auto parameter = parameter_index_.find(std::string(name));
    if (name == "t" || parameter == parameter_index_.end()) return std::nullopt;
    return Expression::constant(model_.parameters_[static_cast<std::size_t>(parameter->second)].value);
  });
  const std::optional<double> constant = out.expression.constant_value();
  if (!constant || std::isfinite(*constant)) return out;
  diagnostics_.error("F408", place_or(expression.at(), field.owner),
                     fmt::format("the formula of '{}' of '{}' has no finite value", field.key, field.owner.name));
  return std::nullopt;
}

void ModelAssembler::build_constraints() {
  for (const ConstraintSpec& spec : spec_->constraints) {
    Coupling coupling;
    coupling.name = spec.name.name;
    const Field field{spec.on_velocities ? "velocity" : "position", spec.name};
    const std::optional<StateFormula> formula = state_formula(spec.formula, LawScope::kOfState, std::nullopt, field);
    FormulaScalars scalars;
    if (formula) collect(*formula, model_, scalars);
    if (formula && scalars.scalars.empty()) {
      diagnostics_.error("F336", place_or(spec.at, spec.name),
                         fmt::format("the constraint '{}' reads no coordinate", spec.name.name),
                         "a constraint is a formula of coordinates or points that is zero");
    } else if (formula && !spec.on_velocities && reads_rates(*formula)) {
      diagnostics_.error(
          "F336", place_or(spec.formula.at(), spec.name),
          fmt::format("the constraint '{}' on positions reads velocities", spec.name.name),
          fmt::format("a constraint that is linear in velocities is written {}: {{velocity: = ...}}", spec.name.name));
    } else if (formula && !spec.on_velocities) {
      Relation relation = make_relation(formula->expression, scalars);
      relation.symbolic = formula->symbolic;
      coupling.relation = std::make_shared<const Relation>(std::move(relation));
    } else if (formula) {
      std::optional<Relation> relation = make_velocity_relation(formula->expression, scalars);
      if (!relation || !reads_rates(*formula)) {
        diagnostics_.error("F336", place_or(spec.formula.at(), spec.name),
                           fmt::format("the constraint '{}' is not linear in the velocities", spec.name.name),
                           "write a sum of velocities times formulas of positions and time");
      } else {
        relation->symbolic = formula->symbolic;
        coupling.relation = std::make_shared<const Relation>(std::move(*relation));
      }
    }
    coupling.scalars = std::move(scalars.scalars);
    model_.couplings_.push_back(std::move(coupling));
  }
}

namespace {

/// Lagrange's equations need an entry for every coordinate that a force acts along.
int index_of(const StateScalar& scalar, const Model& model, FormulaScalars& all) {
  const auto found = std::find(all.scalars.begin(), all.scalars.end(), scalar);
  if (found != all.scalars.end()) return static_cast<int>(found - all.scalars.begin());
  all.scalars.push_back(scalar);
  all.values.push_back(model.scalar_name(scalar));
  all.rates.push_back(model.rate_name(scalar));
  return static_cast<int>(all.scalars.size()) - 1;
}

}  // namespace

/// ½ vᵀ M v of a matrix given entry by entry.
std::optional<Expression> ModelAssembler::energy_of_mass_matrix() {
  const LagrangianSpec& spec = spec_->lagrangian;
  const NameRef section("lagrangian", spec.at);
  const std::size_t n = spec.coordinates.size();
  const bool square = spec.mass_matrix.size() == n && std::all_of(spec.mass_matrix.begin(), spec.mass_matrix.end(),
                                                                  [n](const auto& row) { return row.size() == n; });
  if (!square) {
    diagnostics_.error("F337", spec.at, fmt::format("'mass_matrix' wants {} rows of {} entries", n, n),
                       "one for each coordinate, in their order");
    return std::nullopt;
  }
  Expression energy;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      const Expression& entry = spec.mass_matrix[i][j];
      if (entry.to_string() != spec.mass_matrix[j][i].to_string()) {
        diagnostics_.error("F337", place_or(entry.at(), section),
                           fmt::format("'mass_matrix' is not symmetric at row {}, column {}", i + 1, j + 1),
                           "write both entries in the same way");
        return std::nullopt;
      }
      if (entry.constant_value() == 0.0) continue;
      const Expression half_rates = Expression::constant(0.5) *
                                    Expression::variable(spec.coordinates[i].name.name + std::string(kVelocitySuffix)) *
                                    Expression::variable(spec.coordinates[j].name.name + std::string(kVelocitySuffix));
      energy = energy + entry * half_rates;
    }
  }
  return energy;
}

/// A system given by functions: every constraint and every entry of M is over all its coordinates.
void ModelAssembler::build_function_system() {
  const LagrangianSpec& spec = spec_->lagrangian;
  if (spec.kinetic_energy || spec.potential_energy || spec.dissipation || !spec.mass_matrix.empty() ||
      !spec.forces.empty()) {
    diagnostics_.error("F211", spec.at, "a Lagrangian system is given by functions and by formulas",
                       "leave one of them out; constraints by formulas may be added");
    return;
  }
  const int n = static_cast<int>(spec.coordinates.size());
  const int m = static_cast<int>(spec.function_constraints.size());
  if (n != spec.system->coordinates() || m != spec.system->constraints()) {
    diagnostics_.error("F337", spec.at,
                       fmt::format("the functions are of {} coordinates and {} constraints, but {} and {} are named",
                                   spec.system->coordinates(), spec.system->constraints(), n, m),
                       "name every one of them, in the functions' order");
    return;
  }
  Lagrangian& lagrangian = model_.lagrangian_;
  lagrangian.system = spec.system;
  for (int k = 0; k < n; ++k) {
    const StateScalar scalar{{JointId(model_.coordinates_begin_ + static_cast<std::size_t>(k)), 0}};
    lagrangian.scalars.push_back(scalar);
    lagrangian.values.push_back(model_.scalar_name(scalar));
    lagrangian.rates.push_back(model_.rate_name(scalar));
    for (int l = k; l < n; ++l) lagrangian.mass.push_back({k, l, Expression()});
  }
  lagrangian.bias.assign(static_cast<std::size_t>(n), Expression());
  lagrangian.force = lagrangian.bias;
  for (std::size_t i = 0; i < spec.function_constraints.size(); ++i) {
    Relation relation;
    relation.on_velocities = spec.function_constraints[i].on_velocities;
    relation.values = lagrangian.values;
    relation.rates = lagrangian.rates;
    relation.system = spec.system;
    relation.index = static_cast<int>(i);
    relation.knows_time = spec.system->knows_time();
    model_.couplings_.push_back({spec.function_constraints[i].name.name,
                                 lagrangian.scalars,
                                 {},
                                 std::make_shared<const Relation>(std::move(relation))});
  }
}

void ModelAssembler::build_lagrangian() {
  const LagrangianSpec& spec = spec_->lagrangian;
  const NameRef section("lagrangian", spec.at);
  if (spec.system) return build_function_system();
  FormulaScalars scalars;
  bool usable = true;
  const auto energy = [&](const std::optional<Expression>& given, std::string_view key, Dimension wanted,
                          Expression& symbolic) {
    if (!given) return Expression();
    const std::optional<StateFormula> formula = state_formula(*given, LawScope::kOfState, wanted, Field{key, section});
    usable = usable && formula.has_value();
    if (!formula) return Expression();
    if (key == "potential_energy" && reads_rates(*formula)) {
      diagnostics_.error("F337", place_or(given->at(), section), "'potential_energy' reads velocities",
                         "what depends on velocities belongs to 'kinetic_energy', 'dissipation' or 'forces'");
      usable = false;
    }
    collect(*formula, model_, scalars);
    symbolic = formula->symbolic;
    return formula->expression;
  };
  std::optional<Expression> kinetic_energy = spec.kinetic_energy;
  if (!spec.mass_matrix.empty()) {
    if (kinetic_energy) {
      diagnostics_.error("F211", spec.at, "'kinetic_energy' and 'mass_matrix' exclude each other");
    }
    kinetic_energy = energy_of_mass_matrix();
    usable = usable && kinetic_energy.has_value();
  }
  Expression T, V, R;
  const Expression kinetic = energy(kinetic_energy, "kinetic_energy", kTorque, T);
  const Expression potential = energy(spec.potential_energy, "potential_energy", kTorque, V);
  const Expression dissipation = energy(spec.dissipation, "dissipation", kTorque / kTime, R);
  std::vector<std::pair<int, Expression>> forces;
  for (const auto& [ref, formula] : spec.forces) {
    const Field field{"forces", ref.joint};
    const std::optional<JointCoordinate> along = find_coordinate(ref, field);
    const std::optional<StateFormula> force = state_formula(
        formula, LawScope::kOfState, along ? std::optional(effort_dimension(*along)) : std::nullopt, field);
    usable = usable && along && force;
    if (!along || !force) continue;
    collect(*force, model_, scalars);
    forces.emplace_back(index_of({*along, -1, 0}, model_, scalars), force->expression);
  }
  if (!usable || scalars.scalars.empty()) return;
  std::vector<Expression> along(scalars.scalars.size());
  for (auto& [k, force] : forces) {
    along[static_cast<std::size_t>(k)] = along[static_cast<std::size_t>(k)] + force;
  }
  model_.lagrangian_ = make_lagrangian(kinetic, potential, dissipation, along, scalars);
  model_.lagrangian_.kinetic = std::move(T);
  model_.lagrangian_.potential = std::move(V);
  model_.lagrangian_.dissipation = std::move(R);
}

/// A drive by a formula: on a quantity s(x), or by its map.
bool ModelAssembler::place_drive_by_formula(const DriveSpec& spec, Drive& drive) {
  drive.kind = Drive::Kind::kFormula;
  FormulaScalars scalars;
  if (spec.quantity) {
    const std::optional<StateFormula> formula =
        state_formula(*spec.quantity, LawScope::kOfState, std::nullopt, {"quantity", spec.name});
    if (!formula) return false;
    collect(*formula, model_, scalars);
    if (scalars.scalars.empty() || reads_rates(*formula)) {
      diagnostics_.error("F329", place_or(spec.quantity->at(), spec.name),
                         fmt::format("the quantity of the drive '{}' must be a formula of positions", spec.name.name));
      return false;
    }
    drive.relation = std::make_shared<const Relation>(make_relation(formula->expression, scalars));
    if (drive.relation->knows_time) {
      diagnostics_.error("F329", place_or(spec.quantity->at(), spec.name),
                         fmt::format("the quantity of the drive '{}' reads the time", spec.name.name),
                         "put the time into 'motion' or 'effort'; a constraint may know it");
      return false;
    }
  } else {
    std::vector<std::pair<int, Expression>> entries;
    for (const auto& [ref, entry] : spec.map) {
      const std::optional<JointCoordinate> along = find_coordinate(ref, {"map", spec.name});
      const std::optional<StateFormula> formula =
          state_formula(entry, LawScope::kOfState, std::nullopt, {"map", spec.name});
      if (!along || !formula) return false;
      if (reads_rates(*formula)) {
        diagnostics_.error("F329", place_or(entry.at(), spec.name),
                           fmt::format("the map of the drive '{}' reads velocities", spec.name.name),
                           "d_j is a formula of positions and parameters; put the rest into 'effort'");
        return false;
      }
      collect(*formula, model_, scalars);
      entries.emplace_back(index_of({*along, -1, 0}, model_, scalars), formula->expression);
    }
    std::vector<Expression> gradient(scalars.scalars.size());
    for (auto& [k, entry] : entries) gradient[static_cast<std::size_t>(k)] = std::move(entry);
    drive.relation = std::make_shared<const Relation>(make_map(std::move(gradient), scalars));
    if (!spec.motion.empty()) {
      diagnostics_.error(
          "F329", place_or(spec.motion.front().at, spec.name),
          fmt::format("the drive '{}' is given by its map, so no position of it can be prescribed", spec.name.name),
          "prescribe a coordinate under 'motions', or give the drive a 'quantity'");
      return false;
    }
  }
  drive.scalars = std::move(scalars.scalars);
  return true;
}

void ModelAssembler::build_motions() {
  for (const auto& [ref, motion] : spec_->motions) {
    const Field field{"motions", ref.joint};
    const std::optional<JointCoordinate> found = find_coordinate(ref, field);
    if (!found) continue;
    Drive drive;
    drive.name = model_.coordinate_name(*found);
    drive.coordinate = *found;
    drive.acts = false;
    for (const Drive& other : model_.drives_) {
      if (other.acts || !(other.coordinate == drive.coordinate)) continue;
      diagnostics_.error("F302", ref.joint.at, fmt::format("'motions' prescribes '{}' twice", drive.name),
                         "leave one of them out");
    }
    drive.motion = drive_laws({motion}, LawScope::kOfTime, position_dimension(*found), drive, field);
    model_.drives_.push_back(std::move(drive));
  }
}

}  // namespace ferrers
