#include "ferrers/kinematics/constraints.h"

#include <algorithm>

#include "ferrers/kinematics/coordinates.h"
#include "ferrers/kinematics/formula_rows.h"

namespace ferrers {

namespace {

void add_columns(const System& system, const FramePair& frames, std::vector<int>& columns) {
  for (const FramePair::PathEntry& entry : frames.path) {
    const Node& node = system.nodes[entry.node];
    for (int k = node.v; k < node.v + node.nv; ++k) columns.push_back(k);
  }
}

void sort_unique(std::vector<int>& columns) {
  std::sort(columns.begin(), columns.end());
  columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
}

}  // namespace

std::vector<std::vector<int>> columns_of_rows(const System& system) {
  std::vector<std::vector<int>> out(static_cast<std::size_t>(system.m));
  for (const CutJoint& cut : system.cuts) {
    std::vector<int> columns;
    add_columns(system, cut.frames, columns);
    sort_unique(columns);
    for (int i = 0; i < cut.type->row_count(); ++i) out[cut.row + i] = columns;
  }
  for (const CouplingRow& coupling : system.couplings) {
    std::vector<int>& columns = out[coupling.row];
    for (const CoordinateAccess& access : coupling.scalars) {
      if (access.in_tree) {
        columns.push_back(access.v);
      } else {
        add_columns(system, system.frames(access), columns);
      }
    }
    sort_unique(columns);
  }
  return out;
}

ConstraintKinematics make_constraint_kinematics(const System& system,
                                                const std::vector<std::vector<int>>& driven_columns) {
  std::vector<std::vector<int>> columns = columns_of_rows(system);
  columns.insert(columns.end(), driven_columns.begin(), driven_columns.end());
  ConstraintKinematics out;
  out.phi = out.gamma = out.rate = out.nu = VectorXd::Zero(static_cast<long>(columns.size()));
  out.G = PatternMatrix(columns, system.nv);
  out.whole_row = Eigen::RowVectorXd::Zero(system.nv);
  for (const FormulaBlock& block : system.formulas) out.formulas.push_back(make_formula_evaluation(block));
  return out;
}

template <class T>
BasicRelativeMotion<T> compute_relative_motion(const FramePair& pair, const BasicPositionKinematics<T>& pos,
                                               const BasicVelocityKinematics<T>& acc) {
  using Vector = Eigen::Matrix<T, 3, 1>;
  const auto& n1 = pos.nodes[pair.node_1];
  const auto& n2 = pos.nodes[pair.node_2];
  const auto& k1 = acc.nodes[pair.node_1];
  const auto& k2 = acc.nodes[pair.node_2];
  BasicRelativeMotion<T> m;
  m.R_F = turned(n1.R, pair.X_1F.R);
  m.R_M = turned(n2.R, pair.X_2M.R);
  const Vector r_F = n1.R * as_constants<T>(pair.X_1F.p);
  const Vector r_2 = n2.R * as_constants<T>(pair.X_2M.p);  // node 2's origin to p_M
  const Vector apart = n2.p - n1.p;
  m.d = apart + r_2 - r_F;
  const Vector r_1 = apart + r_2;  // node 1's origin to p_M
  m.w1 = k1.w;
  m.w2 = k2.w;
  m.w = k2.w - k1.w;
  m.v = (k2.v + k2.w.cross(r_2)) - (k1.v + k1.w.cross(r_1));
  m.alpha = k2.alpha - k1.alpha;
  m.a = (k2.a + k2.alpha.cross(r_2) + k2.w.cross(k2.w.cross(r_2))) -
        (k1.a + k1.alpha.cross(r_1) + k1.w.cross(k1.w.cross(r_1)));
  return m;
}

template RelativeMotion compute_relative_motion(const FramePair&, const PositionKinematics&, const VelocityKinematics&);
template BasicRelativeMotion<Traced> compute_relative_motion(const FramePair&, const BasicPositionKinematics<Traced>&,
                                                             const BasicVelocityKinematics<Traced>&);

void add_jet_row(const System& system, const FramePair& pair, const PositionKinematics& pos, const Wrench& W,
                 double scale, Eigen::Ref<Eigen::RowVectorXd> row) {
  const PositionKinematics::NodePosition& n2 = pos.nodes[pair.node_2];
  const Vector3d p_M = n2.p + n2.R * pair.X_2M.p;
  for (const FramePair::PathEntry& entry : pair.path) {
    const Node& node = system.nodes[entry.node];
    const Vector3d force = W.tail<3>() * (scale * entry.sign);
    const Vector3d moment = W.head<3>() * (scale * entry.sign) + (p_M - pos.nodes[entry.node].p).cross(force);
    for (int k = node.v; k < node.v + node.nv; ++k) {
      row[k] += moment.dot(pos.S[k].head<3>()) + force.dot(pos.S[k].tail<3>());
    }
  }
}

namespace {

void compute_cut_joint(const System& system, const CutJoint& cut, const State& state, const PositionKinematics& pos,
                       const VelocityKinematics& vel, ConstraintKinematics& out) {
  const RelativeMotion motion = compute_relative_motion(cut.frames, pos, vel);
  Jet rows[6];
  cut.type->rows(cut.constants, motion, state.winding.data() + cut.winding, rows);
  for (int i = 0; i < cut.type->row_count(); ++i) {
    const int row = cut.row + i;
    out.phi[row] = rows[i].value;
    out.rate[row] = rows[i].rate;
    out.gamma[row] = -rows[i].bias;
  }
  double* const values = out.G.valuePtr();
  const int* const begin = out.G.outerIndexPtr() + cut.row;
  int in_row = 0;  // the same in all rows of the joint
  for_each_entry(system, cut, pos, rows, [&](int i, int k, double value) {
    if (i == 0) in_row = out.G.place(cut.row, k) - begin[0];
    values[begin[i] + in_row] = value;
  });
}

void compute_coupling(const System& system, const CouplingRow& coupling, const State& state,
                      const PositionKinematics& pos, const VelocityKinematics& vel, ConstraintKinematics& out) {
  const int row = coupling.row;
  out.phi[row] = out.rate[row] = out.gamma[row] = 0;
  for (std::size_t i = 0; i < coupling.scalars.size(); ++i) {
    const CoordinateAccess& access = coupling.scalars[i];
    const double c = coupling.coefficients[i];
    const Jet jet = measure_coordinate(system, access, state, pos, vel);
    out.phi[row] += c * jet.value;
    out.rate[row] += c * jet.rate;
    out.gamma[row] -= c * jet.bias;
    add_coordinate_row(system, access, pos, jet, c, out.whole_row);
  }
  out.G.take_row(row, out.whole_row);
}

}  // namespace

void compute_constraints(const System& system, const State& state, const PositionKinematics& pos,
                         const VelocityKinematics& vel, ConstraintKinematics& out) {
  for (const CutJoint& cut : system.cuts) compute_cut_joint(system, cut, state, pos, vel, out);
  compute_coupling_rows(system, state, pos, vel, out);
}

void compute_coupling_rows(const System& system, const State& state, const PositionKinematics& pos,
                           const VelocityKinematics& vel, ConstraintKinematics& out) {
  for (const CouplingRow& coupling : system.couplings) {
    if (coupling.block < 0) compute_coupling(system, coupling, state, pos, vel, out);
  }
  for (std::size_t i = 0; i < system.formulas.size(); ++i) {
    compute_formula_rows(system, system.formulas[i], state, pos, vel, out.formulas[i], out);
  }
}

void accept_winding(const System& system, const PositionKinematics& pos, State& state) {
  for (const CutJoint& cut : system.cuts) {
    if (cut.type->winding_count == 0) continue;
    const PositionKinematics::NodePosition& n1 = pos.nodes[cut.frames.node_1];
    const PositionKinematics::NodePosition& n2 = pos.nodes[cut.frames.node_2];
    RelativeMotion motion;
    motion.R_F = n1.R * cut.frames.X_1F.R;
    motion.R_M = n2.R * cut.frames.X_2M.R;
    motion.d = n2.p + n2.R * cut.frames.X_2M.p - n1.p - n1.R * cut.frames.X_1F.p;
    Jet angles[2];
    cut.type->angles(cut.constants, motion, angles);
    for (int i = 0; i < cut.type->winding_count; ++i) {
      double& reference = state.winding[cut.winding + i];
      reference = continued(angles[i], reference).value;
    }
  }
}

double fastest_turn(const System& system, const PositionKinematics& pos, const VelocityKinematics& vel) {
  double fastest = 0;
  for (const CutJoint& cut : system.cuts) {
    if (cut.type->winding_count == 0) continue;
    Jet angles[2];
    cut.type->angles(cut.constants, compute_relative_motion(cut.frames, pos, vel), angles);
    for (int i = 0; i < cut.type->winding_count; ++i) fastest = std::max(fastest, std::abs(angles[i].rate));
  }
  return fastest;
}

void compute_joint_rows(const System& system, JointId id, const State& state, const PositionKinematics& pos,
                        const VelocityKinematics& acc, RelativeMotion& motion, Jet* rows) {
  const Joint& joint = system.model->joint(id);
  const JointTypeInfo& type = joint_type_info(joint.type);
  const int closure = system.topology->closure_of_joint[id.index()];
  if (closure >= 0) {
    const CutJoint& cut = system.cuts[closure];
    motion = compute_relative_motion(cut.frames, pos, acc);
    type.rows(cut.constants, motion, state.winding.data() + cut.winding, rows);
    return;
  }
  motion = compute_relative_motion(system.frame_pair(id), pos, acc);
  // A tree joint knows its own angles.
  double winding[2] = {0, 0};
  const Node& node = system.nodes[system.topology->node_of_joint[id.index()]];
  for (int i = 0; i < std::min(2, node.nq); ++i) winding[i] = state.q[node.q + i];
  type.rows(joint.constants, motion, winding, rows);
}

}  // namespace ferrers
