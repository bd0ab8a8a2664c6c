#include <fmt/format.h>

#include "ferrers/io/spec_reader.h"

namespace ferrers {

void SpecReader::read_lagrangian(const DocumentNode& node) {
  ObjectReader object(values_, node, Family::kLagrangian, {"lagrangian", node.at});
  if (!object.usable()) return;
  LagrangianSpec& lagrangian = spec_.lagrangian;
  lagrangian.at = node.at;
  read_section(object, "coordinates", &SpecReader::read_general_coordinate);
  lagrangian.kinetic_energy = object.expression("kinetic_energy");
  lagrangian.mass_matrix = object.formula_matrix("mass_matrix");
  lagrangian.potential_energy = object.expression("potential_energy");
  lagrangian.dissipation = object.expression("dissipation");
  lagrangian.forces = object.coordinate_formulas("forces");
  read_section(object, "constraints", &SpecReader::read_constraint);
}

void SpecReader::read_general_coordinate(const DocumentNode& node, const NameRef& name) {
  GeneralCoordinateSpec coordinate;
  coordinate.name = name;
  ObjectReader object(values_, node, Family::kGeneralCoordinate, name);
  if (object.usable()) {
    if (const auto text = object.text("unit")) {
      const std::optional<Unit> unit = *text == "1" ? Unit() : parse_unit(*text);
      if (!unit) {
        values_.error("F407", object.place("unit"), fmt::format("'{}' is no unit", *text),
                      "rad, m, 1, or units joined by '*' and '/'");
      } else if (unit->si != 1) {
        values_.error("F407", object.place("unit"),
                      fmt::format("the unit of a coordinate is SI, and '{}' is not", *text),
                      "values are in SI in all formulas; a number may carry any unit");
      } else {
        coordinate.dimension = unit->dimension;
      }
    }
    coordinate.guess = object.number_of("guess", coordinate.dimension);
    coordinate.limits = object.number_pair("limits");
  }
  spec_.lagrangian.coordinates.push_back(std::move(coordinate));
}

void SpecReader::read_constraint(const DocumentNode& node, const NameRef& name) {
  ConstraintSpec constraint;
  constraint.name = name;
  constraint.at = node.at;
  ObjectReader object(values_, node, Family::kConstraint, name);
  if (!object.usable()) return;
  constraint.on_velocities = object.tag() == "velocity";
  const auto formula = object.expression(constraint.on_velocities ? "velocity" : "position");
  if (!formula) return;
  constraint.formula = *formula;
  spec_.constraints.push_back(std::move(constraint));
}

}  // namespace ferrers
