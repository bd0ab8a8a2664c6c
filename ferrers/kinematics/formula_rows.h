#pragma once

#include <span>
#include <vector>

#include "ferrers/kinematics/constraints.h"

/// Constraint rows that are given by formulas of scalars x_k of the state (model/relation.h), where each x_k has its
/// own row and bias: ẋ_k = R_k v, ẍ_k = R_k vdot + β_k.
///
///   phi,   G = a_k R_k,   nu = −b,   gamma = −(c + a_k β_k)
namespace ferrers {

/// Puts every relation of the model into the block of its cluster and compiles the blocks. Called by `make_system`.
void add_formula_blocks(System& system);

FormulaEvaluation make_formula_evaluation(const FormulaBlock& block);

/// First output of a block after those of its rows: where the inertia of a system without bodies follows (M_kl, then
/// h_k, as in model/relation.h). The number of outputs where there is none.
int outputs_of_rows(const FormulaBlock& block);

/// Fills `out`. `acc`: as for `measure_coordinate`. Allocates nothing. Cost: O(scalars + size of the formulas).
void evaluate_formulas(const System& system, const FormulaBlock& block, const State& state,
                       const PositionKinematics& pos, const VelocityKinematics& acc, FormulaEvaluation& out);

/// A relation of its own, outside of the system's rows: a drive's quantity.
FormulaBlock make_formula_block(const System& system, const Relation& relation, std::span<const StateScalar> scalars);

/// phi with its rate a·ẋ + b and bias c + a_k β_k. W is not used.
Jet formula_jet(const FormulaBlock& block, const FormulaBlock::Row& row, const FormulaEvaluation& at);

/// Adds Σ a_k R_k, `a` being the gradient of a relation over these scalars of the block.
void add_formula_row(const System& system, const FormulaBlock& block, const FormulaBlock::Row& row,
                     const PositionKinematics& pos, const FormulaEvaluation& at, Eigen::Ref<Eigen::RowVectorXd> out);

/// phi, rate, nu, gamma and G of the block's rows. `work` is filled.
void compute_formula_rows(const System& system, const FormulaBlock& block, const State& state,
                          const PositionKinematics& pos, const VelocityKinematics& vel, FormulaEvaluation& work,
                          ConstraintKinematics& out);

/// Coefficients a_k of every coupling at a pose, those of linear ones too: what its multiplier gives to each scalar.
std::vector<std::vector<double>> coupling_coefficients(const System& system, const State& state,
                                                       const PositionKinematics& pos);

}  // namespace ferrers
