#include "ferrers/dynamics/lagrangian_terms.h"

#include <algorithm>

namespace ferrers {
namespace {

// Calls use(v) with every column that a scalar's rate can depend on.
template <typename Use>
void for_columns(const System& system, const CoordinateAccess& access, Use use) {
  if (access.in_tree) return use(access.v);
  for (const FramePair::PathEntry& entry : system.frames(access).path) {
    const Node& node = system.nodes[entry.node];
    for (int k = node.v; k < node.v + node.nv; ++k) use(k);
  }
}

// No body adds to what the formulas give.
bool is_alone(const DynamicsModel& model) { return model.lagrangian.in_tree && model.system->body_nodes == 1; }

// The program of the constraints computes the inertia along.
bool is_computed_along(const DynamicsModel& model) {
  const std::vector<FormulaBlock>& blocks = model.system->formulas;
  return blocks.size() == 1 && is_alone(model) &&
         blocks.front().program.output_count() > outputs_of_rows(blocks.front());
}

// M_kl and h_k at the state of `eq`; `at`: where they are evaluated if they were not computed along.
const double* inertia_at(const DynamicsModel& model, const Equations& eq, FormulaEvaluation& at) {
  if (is_computed_along(model)) {
    return eq.constraints.formulas.front().outputs.data() + outputs_of_rows(model.system->formulas.front());
  }
  model.lagrangian.inertia.evaluate(at.inputs.data(), at.outputs.data());
  return at.outputs.data();
}

// Entry of R_k in column v; `rows` holds those of scalars outside of the tree.
double entry(const BoundLagrangian& bound, const RowMatrixXd& rows, int k, int v) {
  const CoordinateAccess& access = bound.scalars[k];
  if (access.in_tree) return access.v == v ? 1 : 0;
  return rows(k, v);
}

// A generalized effort along x_k as loads, case `column`.
void add_effort(const System& system, const BoundLagrangian& bound, const PositionKinematics& pos,
                const FormulaEvaluation& at, int k, double effort, std::vector<Wrenches>& on_nodes,
                Eigen::Ref<VectorXd> efforts, int column) {
  const CoordinateAccess& access = bound.scalars[k];
  if (access.in_tree) {
    efforts[access.v] += effort;
    return;
  }
  const FramePair& frames = system.frames(access);
  const Vector3d p = point_position(pos, {frames.node_2, frames.X_2M.p});
  const Wrench w = at.jets[k].W * effort;
  const auto add = [&](int node, double sign) {
    auto target = on_nodes[node].col(column);
    const Vector3d force = sign * w.tail<3>();
    target.head<3>() += sign * w.head<3>() + (p - pos.nodes[node].p).cross(force);
    target.tail<3>() += force;
  };
  add(frames.node_2, 1);
  add(frames.node_1, -1);
}

}  // namespace

std::vector<std::pair<int, int>> lagrangian_mass_pattern(const System& system) {
  const Lagrangian& lagrangian = system.model->lagrangian();
  std::vector<CoordinateAccess> scalars;
  for (const StateScalar& scalar : lagrangian.scalars) scalars.push_back(system.scalar_access(scalar));
  std::vector<std::pair<int, int>> pattern;
  for (const Lagrangian::MassEntry& mass : lagrangian.mass) {
    for_columns(system, scalars[mass.row], [&](int a) {
      for_columns(system, scalars[mass.column], [&](int b) {
        pattern.emplace_back(a, b);
        pattern.emplace_back(b, a);
      });
    });
  }
  std::sort(pattern.begin(), pattern.end());
  pattern.erase(std::unique(pattern.begin(), pattern.end()), pattern.end());
  return pattern;
}

void read_lagrangian_inputs(const DynamicsModel& model, const State& state, const PositionKinematics& pos,
                            const VelocityKinematics& vel, FormulaEvaluation& out) {
  const BoundLagrangian& bound = model.lagrangian;
  const std::size_t count = bound.scalars.size();
  if (count == 0) return;
  for (std::size_t k = 0; k < count; ++k) {
    const CoordinateAccess& access = bound.scalars[k];
    if (access.in_tree) {
      out.inputs[k] = access.q >= 0 ? state.q[access.q] : 0;
      out.inputs[count + k] = state.v[access.v];
      continue;
    }
    out.jets[k] = measure_coordinate(*model.system, access, state, pos, vel);
    out.inputs[k] = out.jets[k].value;
    out.inputs[count + k] = out.jets[k].rate;
  }
  out.inputs[2 * count] = state.t;
}

bool needs_lagrangian_inputs(const DynamicsModel& model) {
  return !model.lagrangian.scalars.empty() && (model.lagrangian.has_forces || !is_computed_along(model));
}

void clear_lagrangian_mass(const DynamicsModel& model, PatternMatrix& M) {
  if (is_alone(model)) return;
  for (const auto& [a, b] : model.lagrangian.mass_pattern) M.entry(a, b) = 0;
}

void add_lagrangian_inertia(const DynamicsModel& model, Equations& eq, bool with_bias) {
  const BoundLagrangian& bound = model.lagrangian;
  const int count = static_cast<int>(bound.scalars.size());
  if (count == 0) return;
  FormulaEvaluation& at = eq.lagrangian;
  const double* const inertia = inertia_at(model, eq, at);
  const double* const bias = inertia + bound.mass.size();
  if (is_alone(model)) {
    for (std::size_t e = 0; e < bound.mass.size(); ++e) {
      const int a = bound.scalars[bound.mass[e].first].v, b = bound.scalars[bound.mass[e].second].v;
      eq.M.entry(a, b) = eq.M.entry(b, a) = inertia[e];
    }
    for (int k = 0; k < count && with_bias; ++k) eq.h[bound.scalars[k].v] = bias[k];
    return;
  }
  if (bound.in_tree) {
    for (std::size_t e = 0; e < bound.mass.size(); ++e) {
      const auto [k, l] = bound.mass[e];
      const int a = bound.scalars[k].v, b = bound.scalars[l].v;
      eq.M.entry(a, b) += inertia[e];
      if (a != b) eq.M.entry(b, a) += inertia[e];
    }
    for (int k = 0; k < count && with_bias; ++k) eq.h[bound.scalars[k].v] += bias[k];
    return;
  }
  const System& system = *model.system;
  for (int k = 0; k < count; ++k) {
    if (bound.scalars[k].in_tree) continue;
    clear_coordinate_row(system, bound.scalars[k], eq.lagrangian_rows.row(k));
    add_coordinate_row(system, bound.scalars[k], eq.pos, at.jets[k], 1, eq.lagrangian_rows.row(k));
  }
  const auto add_bias = [&](int k, double effort) {
    for_columns(system, bound.scalars[k], [&](int v) { eq.h[v] += entry(bound, eq.lagrangian_rows, k, v) * effort; });
  };
  for (std::size_t e = 0; e < bound.mass.size(); ++e) {
    const auto [k, l] = bound.mass[e];
    const double mass = inertia[e];
    for_columns(system, bound.scalars[k], [&, k = k, l = l](int a) {
      for_columns(system, bound.scalars[l], [&](int b) {
        const double value = mass * entry(bound, eq.lagrangian_rows, k, a) * entry(bound, eq.lagrangian_rows, l, b);
        eq.M.entry(a, b) += value;
        if (k != l) eq.M.entry(b, a) += value;
      });
    });
    if (!with_bias) continue;
    add_bias(k, mass * at.jets[l].bias);
    if (k != l) add_bias(l, mass * at.jets[k].bias);
  }
  for (int k = 0; k < count && with_bias; ++k) add_bias(k, bias[k]);
}

void add_lagrangian_forces(const DynamicsModel& model, const PositionKinematics& pos, FormulaEvaluation& at,
                           std::vector<Wrenches>& on_nodes, VectorXd& efforts) {
  const BoundLagrangian& bound = model.lagrangian;
  if (!bound.has_forces) return;
  bound.force.evaluate(at.inputs.data(), at.outputs.data());
  for (std::size_t k = 0; k < bound.scalars.size(); ++k) {
    if (at.outputs[k] != 0) {
      add_effort(*model.system, bound, pos, at, static_cast<int>(k), at.outputs[k], on_nodes, efforts, 0);
    }
  }
}

void add_lagrangian_loads(const DynamicsModel& model, const Equations& eq, const VectorXd& vdot, bool bias, int column,
                          Loads& loads) {
  const BoundLagrangian& bound = model.lagrangian;
  const int count = static_cast<int>(bound.scalars.size());
  if (count == 0) return;
  const System& system = *model.system;
  FormulaEvaluation at = eq.lagrangian;
  const double* const inertia = inertia_at(model, eq, at);
  VectorXd accelerations(count), effort = VectorXd::Zero(count);
  for (int k = 0; k < count; ++k) {
    const CoordinateAccess& access = bound.scalars[k];
    accelerations[k] = access.in_tree ? vdot[access.v] : eq.lagrangian_rows.row(k).dot(vdot);
    if (bias) {
      accelerations[k] += at.jets[k].bias;
      effort[k] -= inertia[bound.mass.size() + static_cast<std::size_t>(k)];
    }
  }
  for (std::size_t e = 0; e < bound.mass.size(); ++e) {
    const auto [k, l] = bound.mass[e];
    effort[k] -= inertia[e] * accelerations[l];
    if (k != l) effort[l] -= inertia[e] * accelerations[k];
  }
  for (int k = 0; k < count; ++k) {
    add_effort(system, bound, eq.pos, at, k, effort[k], loads.on_nodes, loads.tree_efforts.col(column), column);
  }
}

LagrangianEnergy compute_lagrangian_energy(const DynamicsModel& model, const State& state,
                                           const PositionKinematics& pos, const VelocityKinematics& vel) {
  const BoundLagrangian& bound = model.lagrangian;
  if (bound.scalars.empty()) return {};
  FormulaEvaluation at = make_lagrangian_evaluation(bound);
  read_lagrangian_inputs(model, state, pos, vel, at);
  double results[3] = {0, 0, 0};
  bound.energy.evaluate(at.inputs.data(), results);
  return {results[0], results[1], results[2]};
}

}  // namespace ferrers
