#pragma once

#include <functional>
#include <span>
#include <string>

#include "ferrers/math/expression.h"
#include "ferrers/model/relation.h"

/// What evaluates formulas of the state at a state: compiled formulas, or the functions of a `LagrangianSystem`.
namespace ferrers {

class StateProgram {
 public:
  StateProgram() = default;
  StateProgram(std::span<const Expression> outputs, std::span<const std::string> inputs)
      : formulas_(outputs, inputs), outputs_(formulas_.output_count()) {}
  StateProgram(std::function<void(const double*, double*)> functions, int outputs)
      : functions_(std::move(functions)), outputs_(outputs) {}

  void evaluate(const double* inputs, double* outputs) const {
    if (functions_) {
      functions_(inputs, outputs);
    } else if (outputs_ > 0) {
      formulas_.evaluate(inputs, outputs);
    }
  }
  int output_count() const { return outputs_; }  ///< Room that `outputs` must have.

 private:
  ExpressionProgram formulas_;
  std::function<void(const double*, double*)> functions_;
  int outputs_ = 0;
};

// Programs of a system given by functions. Inputs: q, v (n each), t. `parameters` are copied.

/// Per constraint phi, b, c and a_1 … a_n, as relations have them (model/relation.h).
StateProgram make_constraint_program(std::shared_ptr<const LagrangianSystem> system, int coordinates, int constraints,
                                     std::vector<double> parameters);
/// M_kl for k ≤ l row by row, then h_k; and room for the whole of M.
StateProgram make_inertia_program(std::shared_ptr<const LagrangianSystem> system, int coordinates,
                                  std::vector<double> parameters);
/// Q_k.
StateProgram make_force_program(std::shared_ptr<const LagrangianSystem> system, int coordinates,
                                std::vector<double> parameters);
/// T, V and 0.
StateProgram make_energy_program(std::shared_ptr<const LagrangianSystem> system, int coordinates,
                                 std::vector<double> parameters);

}  // namespace ferrers
