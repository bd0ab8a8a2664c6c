#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ferrers/math/expression.h"
#include "ferrers/model/coordinate.h"

/// Problem: constraints and energies are given as formulas; the equations of motion want their derivatives.
///
/// Given: a formula over scalars x_k of the state (coordinates, points), their rates and t. Wanted: exact derivatives,
/// as formulas. Where x_k is itself a function of q (the angle of a joint that closes a loop), the chain rule is the
/// evaluator's: everything here treats the x_k as if they were free.
namespace ferrers {

class LagrangianSystem;

/// What a formula reads, with the names that it uses for values and rates. The order is that of `Relation::gradient`.
struct FormulaScalars {
  std::vector<StateScalar> scalars;
  std::vector<std::string> values, rates;
};

/// One constraint [stepanyan, eq. (1), (3), (4)]: phi(x, t) = 0, or a(x, t)·ẋ + b(x, t) = 0.
///
///   a_k ẋ_k + b = 0,   a_k ẍ_k + c = 0,   a_k = ∂phi/∂x_k,  b = ∂phi/∂t,  c = (∂/∂t + ẋ_j ∂/∂x_j)(a_k ẋ_k + b)
struct Relation {
  bool on_velocities = false;
  std::vector<std::string> values, rates;  ///< Names of x_k and ẋ_k in the formulas; time is `t`.
  Expression residual;                     ///< phi; 0 for a relation on velocities.
  std::vector<Expression> gradient;        ///< a_k.
  Expression offset;                       ///< b.
  Expression bias;                         ///< c.
  Expression symbolic;                     ///< As given, with the names of parameters: for people.
  /// Instead of all formulas: constraint number `index` of a system given by functions, over all its coordinates.
  std::shared_ptr<const LagrangianSystem> system;
  int index = 0;
  bool knows_time = false;
};

Relation make_relation(const Expression& residual, const FormulaScalars& scalars);
/// Nothing where the formula is not linear in the rates.
std::optional<Relation> make_velocity_relation(const Expression& formula, const FormulaScalars& scalars);
/// The relation a·ẋ = 0 with these a.
Relation make_map(std::vector<Expression> gradient, const FormulaScalars& scalars);

/// Energies and generalized forces, and what Lagrange's equations make of them [stepanyan, eq. (5), (9)]:
///
///   d/dt(∂T/∂ẋ_k) − ∂T/∂x_k + ∂V/∂x_k = M_kl ẍ_l + h_k,   Q_k = f_k − ∂R/∂ẋ_k
///
/// M_kl = ∂²T/∂ẋ_k∂ẋ_l; h_k = ∂²T/∂ẋ_k∂x_l ẋ_l + ∂²T/∂ẋ_k∂t − ∂T/∂x_k + ∂V/∂x_k. T need not be quadratic in the
/// rates.
struct Lagrangian {
  std::vector<StateScalar> scalars;
  std::vector<std::string> values, rates;
  Expression kinetic, potential, dissipation;  ///< T, V, R as given, with the names of parameters: for people.
  struct MassEntry {
    int row = 0, column = 0;  ///< row ≤ column.
    Expression value;
  };
  std::vector<MassEntry> mass;    ///< The entries that are not identically zero.
  std::vector<Expression> bias;   ///< h_k.
  std::vector<Expression> force;  ///< Q_k.
  /// ẋ_k ∂T/∂ẋ_k − T (T itself where it is quadratic), V, and what their sum changes by with time alone, ∂V/∂t − ∂T/∂t.
  Expression kinetic_part, potential_part, power_of_time;
  std::shared_ptr<const LagrangianSystem> system;  ///< Instead of all formulas.
  bool any() const { return !scalars.empty(); }
  bool has_forces() const;
};

Lagrangian make_lagrangian(const Expression& kinetic, const Expression& potential, const Expression& dissipation,
                           const std::vector<Expression>& forces, const FormulaScalars& scalars);

}  // namespace ferrers
