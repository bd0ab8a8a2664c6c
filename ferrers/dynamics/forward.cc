#include "ferrers/dynamics/forward.h"

namespace ferrers {

std::string_view to_string(Formulation formulation) {
  return formulation == Formulation::kNullSpace ? "null-space" : "elimination";
}

std::unique_ptr<ForwardSolver> make_forward_solver(Formulation formulation, const System& system,
                                                   const Selection& selection) {
  return formulation == Formulation::kNullSpace ? make_null_space_solver(system, selection)
                                                : make_elimination_solver(system, selection);
}

ForwardResult make_forward_result(const System& system) {
  return {ForwardStatus::kSolved, VectorXd::Zero(system.nv), VectorXd::Zero(system.m)};
}

ForwardResult make_forward_result(const Equations& eq) {
  return {ForwardStatus::kSolved, VectorXd::Zero(eq.h.size()), VectorXd::Zero(eq.constraints.phi.size())};
}

}  // namespace ferrers
