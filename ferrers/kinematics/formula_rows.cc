#include "ferrers/kinematics/formula_rows.h"

#include <algorithm>
#include <map>
#include <tuple>

#include "ferrers/kinematics/coordinates.h"

namespace ferrers {
namespace {

constexpr int kOffset = 1, kBias = 2, kGradient = 3;  // after phi, at a row's first output

// Collects the relations of one cluster.
class BlockMaker {
 public:
  explicit BlockMaker(System& system) : system_(system) {}

  void add(int coupling_index) {
    const Coupling& coupling = system_.model->couplings()[coupling_index];
    CouplingRow& target = system_.couplings[coupling_index];
    FormulaBlock::Row row;
    row.coupling = coupling_index;
    row.row = target.row;
    row.first_output = static_cast<int>(outputs_.size());
    const Relation& relation = *coupling.relation;
    outputs_.push_back(relation.residual);
    outputs_.push_back(relation.offset);
    outputs_.push_back(relation.bias);
    outputs_.insert(outputs_.end(), relation.gradient.begin(), relation.gradient.end());
    for (std::size_t k = 0; k < coupling.scalars.size(); ++k) {
      row.scalars.push_back(place_of(coupling.scalars[k], target.scalars[k], relation.values[k], relation.rates[k]));
      row.in_tree = row.in_tree && target.scalars[k].in_tree;
    }
    target.block = static_cast<int>(system_.formulas.size());
    target.relation = static_cast<int>(block_.rows.size());
    block_.rows.push_back(std::move(row));
  }

  // Where there are no bodies the energies' derivatives are computed along, after what the rows want: they share most
  // sines and products with the constraints.
  // Only where they read nothing else: a block must not know coordinates outside of its cluster.
  void add_energies(const Lagrangian& lagrangian) {
    for (const StateScalar& scalar : lagrangian.scalars) {
      if (places_.count(scalar) == 0) return;
    }
    for (const Lagrangian::MassEntry& entry : lagrangian.mass) outputs_.push_back(entry.value);
    outputs_.insert(outputs_.end(), lagrangian.bias.begin(), lagrangian.bias.end());
  }

  void finish() {
    if (block_.rows.empty()) return;
    std::vector<std::string> inputs = values_;
    inputs.insert(inputs.end(), rates_.begin(), rates_.end());
    inputs.emplace_back("t");
    block_.program = StateProgram(outputs_, inputs);
    system_.formulas.push_back(std::move(block_));
  }

 private:
  int place_of(const StateScalar& scalar, const CoordinateAccess& access, const std::string& value,
               const std::string& rate) {
    const auto [found, is_new] = places_.emplace(scalar, static_cast<int>(block_.scalars.size()));
    if (is_new) {
      block_.scalars.push_back(access);
      values_.push_back(value);
      rates_.push_back(rate);
    }
    return found->second;
  }

  System& system_;
  FormulaBlock block_;
  std::vector<Expression> outputs_;
  std::vector<std::string> values_, rates_;
  std::map<StateScalar, int> places_;
};

// The constraints of a system given by functions: one block, in which every row reads every coordinate.
void add_function_block(System& system, const std::vector<int>& couplings) {
  if (couplings.empty()) return;
  const Model& model = *system.model;
  const Coupling& first = model.couplings()[couplings.front()];
  const int n = static_cast<int>(first.scalars.size()), m = static_cast<int>(couplings.size());
  FormulaBlock block;
  for (const StateScalar& scalar : first.scalars) block.scalars.push_back(system.scalar_access(scalar));
  for (const int c : couplings) {
    FormulaBlock::Row row;
    row.coupling = c;
    row.row = system.couplings[c].row;
    row.first_output = model.couplings()[c].relation->index * (n + kGradient);
    for (int k = 0; k < n; ++k) row.scalars.push_back(k);
    system.couplings[c].block = static_cast<int>(system.formulas.size());
    system.couplings[c].relation = static_cast<int>(block.rows.size());
    block.rows.push_back(std::move(row));
  }
  std::vector<double> parameters;
  for (const Parameter& parameter : model.parameters()) parameters.push_back(parameter.value);
  block.program = make_constraint_program(first.relation->system, n, m, std::move(parameters));
  system.formulas.push_back(std::move(block));
}

}  // namespace

void add_formula_blocks(System& system) {
  const std::vector<Closure>& closures = system.topology->closures;
  const bool with_energies = system.body_nodes == 1 && system.topology->clusters.size() == 1 &&
                             system.model->lagrangian().any() && !system.model->lagrangian().system;
  for (const Cluster& cluster : system.topology->clusters) {
    BlockMaker maker(system);
    std::vector<int> of_functions;
    for (const int c : cluster.closures) {
      if (!closures[c].coupling.valid()) continue;
      const int coupling = closures[c].coupling.index();
      const Relation* const relation = system.model->couplings()[coupling].relation.get();
      if (relation == nullptr) continue;
      if (relation->system) {
        of_functions.push_back(coupling);
      } else {
        maker.add(coupling);
      }
    }
    if (with_energies) maker.add_energies(system.model->lagrangian());
    maker.finish();
    add_function_block(system, of_functions);
  }
}

FormulaBlock make_formula_block(const System& system, const Relation& relation, std::span<const StateScalar> scalars) {
  FormulaBlock block;
  FormulaBlock::Row row;
  for (const StateScalar& scalar : scalars) {
    row.scalars.push_back(static_cast<int>(block.scalars.size()));
    block.scalars.push_back(system.scalar_access(scalar));
    row.in_tree = row.in_tree && block.scalars.back().in_tree;
  }
  std::vector<Expression> outputs = {relation.residual, relation.offset, relation.bias};
  outputs.insert(outputs.end(), relation.gradient.begin(), relation.gradient.end());
  std::vector<std::string> inputs = relation.values;
  inputs.insert(inputs.end(), relation.rates.begin(), relation.rates.end());
  inputs.emplace_back("t");
  block.program = StateProgram(outputs, inputs);
  block.rows.push_back(std::move(row));
  return block;
}

Jet formula_jet(const FormulaBlock& block, const FormulaBlock::Row& row, const FormulaEvaluation& at) {
  const double* const result = at.outputs.data() + row.first_output;
  const double* const rates = at.inputs.data() + block.scalars.size();
  Jet jet;
  jet.value = result[0];
  jet.rate = result[kOffset];
  jet.bias = result[kBias];
  for (std::size_t i = 0; i < row.scalars.size(); ++i) {
    jet.rate += result[kGradient + i] * rates[row.scalars[i]];
    jet.bias += result[kGradient + i] * at.jets[row.scalars[i]].bias;
  }
  return jet;
}

FormulaEvaluation make_formula_evaluation(const FormulaBlock& block) {
  return {std::vector<Jet>(block.scalars.size()), std::vector<double>(block.input_count()),
          std::vector<double>(block.program.output_count())};
}

int outputs_of_rows(const FormulaBlock& block) {
  const FormulaBlock::Row& last = block.rows.back();
  return last.first_output + kGradient + static_cast<int>(last.scalars.size());
}

void evaluate_formulas(const System& system, const FormulaBlock& block, const State& state,
                       const PositionKinematics& pos, const VelocityKinematics& acc, FormulaEvaluation& out) {
  const std::size_t count = block.scalars.size();
  for (std::size_t k = 0; k < count; ++k) {
    const CoordinateAccess& access = block.scalars[k];
    if (access.in_tree) {  // no frames to look at; `jets[k].bias` stays zero
      out.inputs[k] = access.q >= 0 ? state.q[access.q] : 0;
      out.inputs[count + k] = state.v[access.v];
      continue;
    }
    out.jets[k] = measure_coordinate(system, access, state, pos, acc);
    out.inputs[k] = out.jets[k].value;
    out.inputs[count + k] = out.jets[k].rate;
  }
  out.inputs[2 * count] = state.t;
  block.program.evaluate(out.inputs.data(), out.outputs.data());
}

void add_formula_row(const System& system, const FormulaBlock& block, const FormulaBlock::Row& row,
                     const PositionKinematics& pos, const FormulaEvaluation& at, Eigen::Ref<Eigen::RowVectorXd> out) {
  const double* const a = at.outputs.data() + row.first_output + kGradient;
  for (std::size_t i = 0; i < row.scalars.size(); ++i) {
    const int k = row.scalars[i];
    if (row.in_tree) {
      out[block.scalars[k].v] += a[i];
    } else {
      add_coordinate_row(system, block.scalars[k], pos, at.jets[k], a[i], out);
    }
  }
}

void compute_formula_rows(const System& system, const FormulaBlock& block, const State& state,
                          const PositionKinematics& pos, const VelocityKinematics& vel, FormulaEvaluation& work,
                          ConstraintKinematics& out) {
  evaluate_formulas(system, block, state, pos, vel, work);
  const CoordinateAccess* const scalars = block.scalars.data();
  const double* const rates = work.inputs.data() + block.scalars.size();
  for (const FormulaBlock::Row& row : block.rows) {
    if (row.in_tree) {  // R_k is a unit row, and no two of them are the same
      const double* const result = work.outputs.data() + row.first_output;
      const double* a = result + kGradient;
      double rate = 0;
      for (const int k : row.scalars) {
        out.G.entry(row.row, scalars[k].v) = *a;
        rate += *a++ * rates[k];
      }
      out.phi[row.row] = result[0];
      out.nu[row.row] = -result[kOffset];
      out.rate[row.row] = rate;
      out.gamma[row.row] = -result[kBias];
      continue;
    }
    const Jet jet = formula_jet(block, row, work);
    out.phi[row.row] = jet.value;
    out.nu[row.row] = -work.outputs[row.first_output + kOffset];
    out.rate[row.row] = jet.rate + out.nu[row.row];
    out.gamma[row.row] = -jet.bias;
    add_formula_row(system, block, row, pos, work, out.whole_row);
    out.G.take_row(row.row, out.whole_row);
  }
}

std::vector<std::vector<double>> coupling_coefficients(const System& system, const State& state,
                                                       const PositionKinematics& pos) {
  std::vector<std::vector<double>> all;
  for (const CouplingRow& coupling : system.couplings) all.push_back(coupling.coefficients);
  if (system.formulas.empty()) return all;
  const VelocityKinematics rest = make_velocity_kinematics(system);
  State still = state;
  still.v = VectorXd::Zero(system.nv);
  for (const FormulaBlock& block : system.formulas) {
    FormulaEvaluation at = make_formula_evaluation(block);
    evaluate_formulas(system, block, still, pos, rest, at);
    for (const FormulaBlock::Row& row : block.rows) {
      const double* const a = at.outputs.data() + row.first_output + kGradient;
      all[row.coupling].assign(a, a + row.scalars.size());
    }
  }
  return all;
}

}  // namespace ferrers
