#include "ferrers/dynamics/forward_dynamics.h"

#include <utility>

#include "ferrers/core/checks.h"
#include "ferrers/redundancy/selection.h"

namespace ferrers {

ForwardDynamics::ForwardDynamics(std::shared_ptr<const DynamicsModel> model, const State& state)
    : model_(std::move(model)), result_(make_forward_result(*model_->system)) {
  const System& system = *model_->system;
  require(model_->massless_bodies.empty(), "ForwardDynamics: a body has no mass");
  const ConstraintBlocks blocks = compute_constraint_blocks(system, state);
  selection_ = select_rows_and_coordinates(system, decide_clusters(system, make_scaling(system), blocks));
  applied_ = VectorXd::Zero(system.nv);
  if (ForwardProgram::knows(*model_)) find_program(blocks);
  evaluate(state);
  first_pivot_ = pivot_;
}

void ForwardDynamics::find_program(const ConstraintBlocks& blocks) {
  const System& system = *model_->system;
  KktStructure structure = make_kkt_structure(system, selection_.rows);
  take_values(selection_.rows, blocks, structure);
  order_ = SparseKkt(structure, selection_.rows, make_scaling(system).columns);
  if (!order_.is_complete()) return;
  const auto program = (*model_->programs).find_or_make(*model_, order_, ForwardProgram::Extent::kAccelerations);
  if (!program->is_native()) return;
  board_ = program->make_board();
  program_ = program;
}

std::shared_ptr<const ForwardProgram> ForwardDynamics::of_states(int states) const {
  // Where loops share their code already, states in its place would need more than the nearest cache holds.
  constexpr std::size_t kLargest = 16 * 1024;
  if (program_ == nullptr || (program_->shared_part() > 0.5 && program_->code_bytes() > kLargest)) return nullptr;
  const auto program =
      (*model_->programs).find_or_make(*model_, order_, ForwardProgram::Extent::kAccelerations, states);
  return program->is_native() ? program : nullptr;
}

Equations& ForwardDynamics::equations() {
  if (!eq_) eq_ = make_equations(*model_);
  return *eq_;
}

ForwardStatus ForwardDynamics::evaluate(const State& state) {
  if (program_ == nullptr || !ForwardProgram::reaches(state)) return evaluate_parts(state);
  if (program_->wants_applied()) compute_untraced_forces(*model_, state, equations(), applied_);
  ForwardProgram::Watched watched;
  const ForwardStatus status = program_->evaluate(state, applied_, board_, result_, watched);
  pivot_ = watched.smallest_pivot;
  return status == ForwardStatus::kSolved ? status : evaluate_parts(state);
}

ForwardStatus ForwardDynamics::evaluate_parts(const State& state) {
  Equations& eq = equations();
  if (solver_ == nullptr) solver_ = make_forward_solver(Formulation::kSparse, *model_->system, selection_);
  compute_equations(*model_, state, eq);
  solver_->solve(eq, result_);
  pivot_ = solver_->smallest_pivot();
  return result_.status;
}

}  // namespace ferrers
