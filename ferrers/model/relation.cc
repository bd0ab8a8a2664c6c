#include "ferrers/model/relation.h"

#include <algorithm>

#include "ferrers/core/checks.h"

namespace ferrers {
namespace {

constexpr std::string_view kTimeName = "t";

bool is_zero(const Expression& e) { return e.constant_value() == 0.0; }

// (∂/∂t + ẋ_j ∂/∂x_j) f.
Expression along_motion(const Expression& f, const std::vector<std::string>& values,
                        const std::vector<std::string>& rates) {
  return f.rate([&](std::string_view name) -> std::optional<Expression> {
    if (name == kTimeName) return Expression::constant(1);
    const auto found = std::find(values.begin(), values.end(), name);
    if (found == values.end()) return std::nullopt;
    return Expression::variable(rates[static_cast<std::size_t>(found - values.begin())]);
  });
}

// `rate`: a·ẋ + b.
void add_bias(const Expression& rate, Relation& relation) {
  relation.bias = along_motion(rate, relation.values, relation.rates);
  relation.knows_time = relation.offset.constant_value() != 0.0;
}

}  // namespace

Relation make_relation(const Expression& residual, const FormulaScalars& scalars) {
  Relation relation;
  relation.values = scalars.values;
  relation.rates = scalars.rates;
  relation.residual = residual.simplified();
  for (const std::string& value : relation.values) relation.gradient.push_back(residual.derivative(value));
  relation.offset = residual.derivative(kTimeName);
  add_bias(along_motion(residual, relation.values, relation.rates), relation);
  return relation;
}

std::optional<Relation> make_velocity_relation(const Expression& formula, const FormulaScalars& scalars) {
  Relation relation;
  relation.on_velocities = true;
  relation.values = scalars.values;
  relation.rates = scalars.rates;
  for (const std::string& rate : relation.rates) {
    relation.gradient.push_back(formula.derivative(rate));
    const Expression& a = relation.gradient.back();
    const auto reads = [&a](const std::string& other) { return a.depends_on(other); };
    if (std::any_of(relation.rates.begin(), relation.rates.end(), reads)) return std::nullopt;
  }
  const auto is_rate = [&](std::string_view name) {
    return std::find(relation.rates.begin(), relation.rates.end(), name) != relation.rates.end();
  };
  relation.offset = formula
                        .substitute([&](std::string_view name) -> std::optional<Expression> {
                          if (!is_rate(name)) return std::nullopt;
                          return Expression();
                        })
                        .simplified();
  add_bias(formula, relation);
  return relation;
}

Relation make_map(std::vector<Expression> gradient, const FormulaScalars& scalars) {
  Relation relation;
  relation.on_velocities = true;
  relation.values = scalars.values;
  relation.rates = scalars.rates;
  relation.gradient = std::move(gradient);
  std::vector<Expression> rate;
  for (std::size_t k = 0; k < relation.values.size(); ++k) {
    rate.push_back(relation.gradient[k] * Expression::variable(relation.rates[k]));
  }
  add_bias(sum_of(rate), relation);
  return relation;
}

bool Lagrangian::has_forces() const { return system != nullptr || !std::all_of(force.begin(), force.end(), is_zero); }

Lagrangian make_lagrangian(const Expression& kinetic, const Expression& potential, const Expression& dissipation,
                           const std::vector<Expression>& forces, const FormulaScalars& scalars) {
  require_size(static_cast<long>(forces.size()), static_cast<long>(scalars.scalars.size()), "make_lagrangian: forces");
  Lagrangian out;
  out.scalars = scalars.scalars;
  out.values = scalars.values;
  out.rates = scalars.rates;
  const int count = static_cast<int>(out.values.size());
  std::vector<Expression> kinetic_part = {-kinetic};
  for (int k = 0; k < count; ++k) {
    const Expression momentum = kinetic.derivative(out.rates[k]);
    for (int l = k; l < count; ++l) {
      Expression entry = momentum.derivative(out.rates[l]);
      if (!is_zero(entry)) out.mass.push_back({k, l, std::move(entry)});
    }
    const Expression inertia = along_motion(momentum, out.values, out.rates);
    const Expression along = (kinetic - potential).derivative(out.values[k]);
    out.bias.push_back((inertia - along).simplified());
    out.force.push_back((forces[k] - dissipation.derivative(out.rates[k])).simplified());
    kinetic_part.push_back(momentum * Expression::variable(out.rates[k]));
  }
  out.kinetic_part = sum_of(kinetic_part).simplified();
  out.potential_part = potential.simplified();
  out.power_of_time = (potential.derivative(kTimeName) - kinetic.derivative(kTimeName)).simplified();
  return out;
}

}  // namespace ferrers
