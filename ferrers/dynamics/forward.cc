#include "ferrers/dynamics/forward.h"

namespace ferrers {

std::string_view to_string(Formulation formulation) {
  switch (formulation) {
    case Formulation::kNullSpace:
      return "null-space";
    case Formulation::kElimination:
      return "elimination";
    case Formulation::kSparse:
      return "sparse";
    case Formulation::kAugmentedLagrangian:
      return "augmented-lagrangian";
  }
  return "";
}

std::optional<Formulation> find_formulation(std::string_view name) {
  for (const Formulation formulation : kFormulations) {
    if (to_string(formulation) == name) return formulation;
  }
  return std::nullopt;
}

Formulation recommended_formulation() { return Formulation::kSparse; }

std::unique_ptr<ForwardSolver> make_forward_solver(Formulation formulation, const System& system,
                                                   const Selection& selection) {
  switch (formulation) {
    case Formulation::kElimination:
      return make_elimination_solver(system, selection);
    case Formulation::kSparse:
      return make_sparse_solver(system, selection);
    case Formulation::kAugmentedLagrangian:
      return make_augmented_solver(system, selection);
    case Formulation::kNullSpace:
      break;
  }
  return make_null_space_solver(system, selection);
}

ForwardResult make_forward_result(const System& system) {
  return {ForwardStatus::kSolved, VectorXd::Zero(system.nv), VectorXd::Zero(system.m)};
}

ForwardResult make_forward_result(const Equations& eq) {
  return {ForwardStatus::kSolved, VectorXd::Zero(eq.h.size()), VectorXd::Zero(eq.constraints.phi.size())};
}

}  // namespace ferrers
