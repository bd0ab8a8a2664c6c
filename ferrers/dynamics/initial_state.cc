#include "ferrers/dynamics/initial_state.h"

#include <algorithm>

#include "ferrers/dynamics/forward_kkt.h"
#include "ferrers/redundancy/rate_conflict.h"
#include "ferrers/redundancy/selection.h"

namespace ferrers {
namespace {

// The velocities that `initial` gives: rows after those of the constraints, A v = b.
struct VelocityRows {
  PatternMatrix A;
  VectorXd b;
  std::vector<std::vector<int>> columns;  // per given velocity
};

struct GivenVelocity {
  JointCoordinate coordinate;
  double value;
};

std::vector<GivenVelocity> given_velocities(const Model& model) {
  std::vector<GivenVelocity> given;
  for (const InitialValue& initial : model.initial()) {
    for (std::size_t i = 0; i < initial.velocity.size(); ++i) {
      const int index = initial.whole_joint ? static_cast<int>(i) : initial.coordinate.index;
      given.push_back({{initial.coordinate.joint, index}, initial.velocity[i]});
    }
  }
  return given;
}

std::vector<int> columns_of(const System& system, const CoordinateAccess& access) {
  std::vector<int> columns;
  if (access.in_tree) return {access.v};
  for (const FramePair::PathEntry& entry : system.cuts[access.cut].frames.path) {
    const Node& node = system.nodes[entry.node];
    for (int k = node.v; k < node.v + node.nv; ++k) columns.push_back(k);
  }
  std::sort(columns.begin(), columns.end());
  return columns;
}

void add_velocity_row(const System& system, const GivenVelocity& given, const State& state, const Equations& eq,
                      double scale, Eigen::RowVectorXd& row) {
  const CoordinateAccess access = system.access(given.coordinate);
  if (access.in_tree) {
    row[access.v] += scale;
  } else if (joint_type_info(system.model->joint(given.coordinate.joint).type).coordinate_jets) {
    add_coordinate_row(system, access, eq.pos, measure_coordinate(system, access, state, eq.pos, eq.vel), scale, row);
  } else {  // ω or v of a spherical or free joint that closes a loop
    const FramePair& frames = system.cuts[access.cut].frames;
    const RelativeMotion m = compute_relative_motion(frames, eq.pos, eq.vel);
    Wrench W = Wrench::Zero();
    W.segment<3>(given.coordinate.index < 3 ? 0 : 3) = m.R_F.col(given.coordinate.index % 3);
    add_jet_row(system, frames, eq.pos, W, scale, row);
  }
}

// The constraints' rows as they are; those of given velocities in m/s, angular ones times L.
VelocityRows make_velocity_rows(const System& system, const Scaling& scaling, const std::vector<GivenVelocity>& given,
                                const State& state, const Equations& eq) {
  VelocityRows out;
  for (const GivenVelocity& one : given) out.columns.push_back(columns_of(system, system.access(one.coordinate)));
  ConstraintKinematics rows = make_constraint_kinematics(system, out.columns);
  const PatternMatrix& G = eq.constraints.G;
  std::copy_n(G.valuePtr(), G.nonZeros(), rows.G.valuePtr());
  out.b = VectorXd::Zero(rows.G.rows());
  out.b.head(system.m) = eq.constraints.nu.head(system.m);
  for (std::size_t i = 0; i < given.size(); ++i) {
    const JointTypeInfo& type = joint_type_info(system.model->joint(given[i].coordinate.joint).type);
    const double scale = type.coordinates[given[i].coordinate.index].is_angular() ? scaling.length_m : 1.0;
    add_velocity_row(system, given[i], state, eq, scale, rows.whole_row);
    rows.G.take_row(system.m + static_cast<int>(i), rows.whole_row);
    out.b[system.m + static_cast<long>(i)] = given[i].value * scale;
  }
  out.A = std::move(rows.G);
  return out;
}

// min ½ vᵀ M v with A_r v = b_r; in a unit metric where the masses leave motions open. Not finite where the rows are
// not independent.
VectorXd solve_slowest(const System& system, const Scaling& scaling, const std::vector<int>& rows,
                       const VelocityRows& wanted, PatternMatrix M) {
  KktStructure structure = make_kkt_structure(system, rows);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (rows[k] >= system.m) structure.rows[k] = wanted.columns[static_cast<std::size_t>(rows[k] - system.m)];
  }
  take_values(rows, wanted.A, structure);
  SparseKkt kkt(structure, rows, scaling.columns);
  if (kkt.factor(M, wanted.A) != ForwardStatus::kSolved) {
    double mass = 1e-3;
    for (int v = 0; v < system.nv; ++v) mass = std::max(mass, M(v, v) * scaling.columns[v] * scaling.columns[v]);
    for (int v = 0; v < system.nv; ++v) M.entry(v, v) += 1e-6 * mass / (scaling.columns[v] * scaling.columns[v]);
    if (kkt.factor(M, wanted.A) != ForwardStatus::kSolved) return VectorXd::Constant(system.nv, NAN);
  }
  VectorXd v(system.nv), lambda(wanted.b.size());
  kkt.solve(VectorXd::Zero(system.nv), wanted.b, v, lambda);
  return v;
}

}  // namespace

InitialStateResult make_initial_state(const DynamicsModel& model, const AssemblyOptions& options) {
  const System& system = *model.system;
  InitialStateResult result;
  result.assembly = assemble(system, options);
  result.state = result.assembly.state;
  result.message = result.assembly.message;
  if (result.assembly.status != AssemblyStatus::kAssembled) {
    result.status = InitialStateStatus::kNotAssembled;
    return result;
  }
  const Scaling& scaling = system.scaling;
  Equations eq = make_equations(model);
  compute_kinematics(model, result.state, eq);
  compute_mass_matrix(model, eq);
  const std::vector<GivenVelocity> given = given_velocities(*system.model);
  if (const std::optional<RateConflict> conflict = find_rate_conflict(system, scaling, eq.constraints)) {
    result.status = InitialStateStatus::kInconsistentVelocities;
    result.residual = conflict->residual;
    result.message = rate_conflict_message(*conflict);
    return result;
  }
  const VelocityRows wanted = make_velocity_rows(system, scaling, given, result.state, eq);
  if (wanted.b.isZero(0)) return result;  // at rest

  const Selection closures = select_independent(system, scaling, eq.constraints);
  VectorXd row_scale = VectorXd::Ones(wanted.b.size());
  row_scale.head(system.m) = scaling.rows;
  const VectorXd of_given = row_scale.tail(static_cast<long>(given.size()));
  const std::vector<int> rows =
      extend_selection(closures, wanted.A, system.m, of_given, scaling.columns).selection.rows;
  result.state.v = solve_slowest(system, scaling, rows, wanted, eq.M);
  const VectorXd b = row_scale.cwiseProduct(wanted.b);
  result.residual = (row_scale.cwiseProduct(wanted.A * result.state.v) - b).cwiseAbs().maxCoeff();
  const double size = std::max(b.cwiseAbs().maxCoeff(), 1e-300);
  if (!(result.residual <= 1e-8 * size)) {
    result.status = InitialStateStatus::kInconsistentVelocities;
    result.message = "the initial velocities contradict each other or the constraints";
  }
  return result;
}

}  // namespace ferrers
