#pragma once

#include <memory>
#include <optional>

#include "ferrers/dynamics/forward_program.h"

/// Problem: accelerations and multipliers of one mechanism again and again, for whoever brings his own states.
///
///   M vdot = tau + B u − h + G_rᵀ lambda,   G_r vdot = gamma_r          [stepanyan, eq. (8), (9)]
///
/// Given: a model and one state of it on the constraints. Wanted: vdot (nv) and lambda (m, N and N·m; zero at the rows
/// left out) at any other. What is decided is decided once, at the first state: rank, rows, coordinates, the order of
/// elimination, and native code where the model and the processor allow it (forward_program.h). Drives take their
/// effort laws; dry friction is left out.
namespace ferrers {

class ForwardDynamics {
 public:
  /// `state`: assembled. Throws std::invalid_argument for a model whose bodies have no masses.
  ForwardDynamics(std::shared_ptr<const DynamicsModel> model, const State& state);

  /// Allocates nothing, but for the first state that native code does not know. Cost: linear in the size of the
  /// mechanism where its loops are local.
  ForwardStatus evaluate(const State& state);
  const ForwardResult& result() const { return result_; }

  /// The rows and coordinates in use: reactions of rows that are left out are not zero but unknown.
  const Selection& selection() const { return selection_; }
  /// Smallest pivot of the last evaluation over that of the first: when it falls towards 0 the rank falls, and the
  /// selection should be chosen anew.
  double pivot_ratio() const { return first_pivot_ > 0 ? pivot_ / first_pivot_ : 1; }
  double first_pivot() const { return first_pivot_; }
  bool is_native() const { return program_ != nullptr; }
  /// The same code for so many states at once; null where there is none.
  std::shared_ptr<const ForwardProgram> of_states(int states) const;

 private:
  void find_program();
  Equations& equations();
  ForwardStatus evaluate_parts(const State& state);

  std::shared_ptr<const DynamicsModel> model_;
  Selection selection_;
  SparseKkt order_;              ///< For native code.
  std::optional<Equations> eq_;  ///< Where parts are evaluated: matrices are large.
  ForwardResult result_;
  std::shared_ptr<const ForwardProgram> program_;  ///< Null: evaluated part by part.
  Kernel::Board board_;
  VectorXd applied_;
  double pivot_ = 1, first_pivot_ = 0;
};

}  // namespace ferrers
