#include "ferrers/kinematics/constraint_blocks.h"

#include "ferrers/kinematics/coordinates.h"
#include "ferrers/kinematics/formula_rows.h"

namespace ferrers {
namespace {

// Moves the entries of a row from a full-length workspace, which is zero again afterwards.
void take_row(Eigen::RowVectorXd& whole, int i, ConstraintBlock& block) {
  for (std::size_t k = 0; k < block.columns.size(); ++k) {
    block.G(i, static_cast<long>(k)) = whole[block.columns[k]];
    whole[block.columns[k]] = 0;
  }
}

}  // namespace

ConstraintBlocks make_constraint_blocks(const System& system) {
  ConstraintBlocks out;
  out.phi = VectorXd::Zero(system.m);
  const std::vector<std::vector<int>> columns = columns_of_rows(system);
  for (const Closure& closure : system.topology->closures) {
    ConstraintBlock block;
    block.row = closure.row;
    if (closure.row_count > 0) block.columns = columns[static_cast<std::size_t>(closure.row)];
    block.G = MatrixXd::Zero(closure.row_count, static_cast<long>(block.columns.size()));
    out.blocks.push_back(std::move(block));
  }
  return out;
}

void compute_constraint_blocks(const System& system, const State& state, const PositionKinematics& pos,
                               ConstraintBlocks& out) {
  const VelocityKinematics rest = make_velocity_kinematics(system);
  Eigen::RowVectorXd whole = Eigen::RowVectorXd::Zero(system.nv);
  Jet jets[6];
  for (std::size_t c = 0; c < system.cuts.size(); ++c) {
    const CutJoint& cut = system.cuts[c];
    const RelativeMotion motion = compute_relative_motion(cut.frames, pos, rest);
    cut.type->rows(cut.constants, motion, state.winding.data() + cut.winding, jets);
    for (int i = 0; i < cut.type->row_count(); ++i) {
      out.phi[cut.row + i] = jets[i].value;
      add_jet_row(system, cut.frames, pos, jets[i].W, 1, whole);
      take_row(whole, i, out.blocks[c]);
    }
  }
  for (std::size_t c = 0; c < system.couplings.size(); ++c) {
    const CouplingRow& coupling = system.couplings[c];
    if (coupling.block >= 0) continue;
    out.phi[coupling.row] = 0;
    for (std::size_t i = 0; i < coupling.scalars.size(); ++i) {
      const Jet jet = measure_coordinate(system, coupling.scalars[i], state, pos, rest);
      out.phi[coupling.row] += coupling.coefficients[i] * jet.value;
      add_coordinate_row(system, coupling.scalars[i], pos, jet, coupling.coefficients[i], whole);
    }
    take_row(whole, 0, out.blocks[system.cuts.size() + c]);
  }
  State still = state;
  still.v = VectorXd::Zero(system.nv);
  for (const FormulaBlock& formulas : system.formulas) {
    FormulaEvaluation at = make_formula_evaluation(formulas);
    evaluate_formulas(system, formulas, still, pos, rest, at);
    for (const FormulaBlock::Row& row : formulas.rows) {
      out.phi[row.row] = at.outputs[row.first_output];
      add_formula_row(system, formulas, row, pos, at, whole);
      take_row(whole, 0, out.blocks[system.cuts.size() + row.coupling]);
    }
  }
}

ConstraintBlocks compute_constraint_blocks(const System& system, const State& state) {
  ConstraintBlocks out = make_constraint_blocks(system);
  PositionKinematics pos = make_position_kinematics(system);
  compute_positions(system, state.q, pos);
  compute_constraint_blocks(system, state, pos, out);
  return out;
}

ConstraintBlocks cut_into_blocks(const System& system, const ConstraintKinematics& constraints) {
  ConstraintBlocks out = make_constraint_blocks(system);
  out.phi = constraints.phi;
  for (ConstraintBlock& block : out.blocks) {
    for (long i = 0; i < block.G.rows(); ++i) {
      const double* const values = constraints.G.valuePtr() + constraints.G.outerIndexPtr()[block.row + i];
      for (long k = 0; k < block.G.cols(); ++k) block.G(i, k) = values[k];
    }
  }
  return out;
}

}  // namespace ferrers
