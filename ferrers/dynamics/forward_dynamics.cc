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
  selection_ = select_rows_and_coordinates(system, decide_clusters(system, system.scaling, blocks));
  applied_ = VectorXd::Zero(system.nv);
  KktStructure structure = make_kkt_structure(system, selection_.rows);
  take_values(selection_.rows, blocks, structure);
  order_ = SparseKkt(structure, selection_.rows, system.scaling.columns);
  if (order_.is_complete() && ForwardProgram::knows(*model_) && ForwardProgram::pays(order_)) find_program();
  evaluate(state);
  first_pivot_ = pivot_;
}

void ForwardDynamics::find_program() {
  const auto program = model_->programs->find_or_make(*model_, order_, ForwardProgram::Extent::kAccelerations);
  if (!program->is_native()) return;
  board_ = program->make_board();
  program_ = program;
}

std::shared_ptr<const ForwardProgram> ForwardDynamics::of_states(int states) const {
  // Where loops share their code already, states in its place would need more than the nearest cache holds.
  constexpr std::size_t kLargest = 16 * 1024;
  if (program_ == nullptr || (program_->shared_part() > 0.5 && program_->code_bytes() > kLargest)) return nullptr;
  const auto program = model_->programs->find_or_make(*model_, order_, ForwardProgram::Extent::kAccelerations, states);
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
  compute_equations(*model_, state, eq);
  result_.status = order_.factor(eq.M, eq.constraints.G);
  if (result_.status != ForwardStatus::kSolved) return result_.status;
  order_.solve(eq.force, eq.constraints.gamma, result_.vdot, result_.lambda);
  pivot_ = order_.smallest_pivot();
  if (!result_.vdot.allFinite()) result_.status = ForwardStatus::kWornSelection;
  return result_.status;
}

}  // namespace ferrers
