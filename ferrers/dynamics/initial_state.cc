#include "ferrers/dynamics/initial_state.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "ferrers/redundancy/rate_conflict.h"
#include "ferrers/redundancy/selection.h"

namespace ferrers {
namespace {

// The velocities that `initial` gives, as rows: D v = d.
struct VelocityTargets {
  RowMatrixXd D;
  VectorXd d;
};

VelocityTargets read_targets(const DynamicsModel& model, const State& state, const Equations& eq,
                             const Scaling& scaling) {
  const System& system = *model.system;
  std::vector<std::pair<JointCoordinate, double>> given;
  for (const InitialValue& initial : system.model->initial()) {
    for (std::size_t i = 0; i < initial.velocity.size(); ++i) {
      const int index = initial.whole_joint ? static_cast<int>(i) : initial.coordinate.index;
      given.emplace_back(JointCoordinate{initial.coordinate.joint, index}, initial.velocity[i]);
    }
  }
  VelocityTargets targets{RowMatrixXd::Zero(static_cast<long>(given.size()), system.nv),
                          VectorXd::Zero(static_cast<long>(given.size()))};
  for (std::size_t i = 0; i < given.size(); ++i) {
    const long row = static_cast<long>(i);
    const auto [coordinate, value] = given[i];
    const CoordinateAccess access = system.access(coordinate);
    const JointTypeInfo& type = joint_type_info(system.model->joint(coordinate.joint).type);
    if (access.in_tree) {
      targets.D(row, access.v) = 1;
    } else if (type.coordinate_jets) {
      add_coordinate_row(system, access, eq.pos, measure_coordinate(system, access, state, eq.pos, eq.vel), 1,
                         targets.D.row(row));
    } else {  // ω or v of a spherical or free joint that closes a loop
      const FramePair& frames = system.cuts[access.cut].frames;
      const RelativeMotion m = compute_relative_motion(frames, eq.pos, eq.vel);
      Wrench W = Wrench::Zero();
      W.segment<3>(coordinate.index < 3 ? 0 : 3) = m.R_F.col(coordinate.index % 3);
      add_jet_row(system, frames, eq.pos, W, 1, targets.D.row(row));
    }
    const double scale = type.coordinates[coordinate.index].is_angular() ? scaling.length_m : 1.0;
    targets.D.row(row) *= scale;
    targets.d[row] = value * scale;
  }
  return targets;
}

// Cholesky factor of the mass matrix, or of a unit metric where it is singular (massless bodies).
Eigen::LLT<MatrixXd> make_metric(const MatrixXd& M, const Scaling& scaling) {
  Eigen::LLT<MatrixXd> llt(M);
  if (llt.info() == Eigen::Success) return llt;
  const VectorXd unit = scaling.columns.cwiseInverse().cwiseAbs2();
  const double mass = M.size() > 0 ? std::max(1e-3, (M.diagonal().cwiseQuotient(unit)).maxCoeff()) : 1.0;
  return Eigen::LLT<MatrixXd>(M + 1e-6 * mass * MatrixXd(unit.asDiagonal()));
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
  const Scaling scaling = make_scaling(system);
  Equations eq = make_equations(model);
  compute_kinematics(model, result.state, eq);
  compute_mass_matrix(model, eq);
  const VelocityTargets targets = read_targets(model, result.state, eq, scaling);
  if (const std::optional<RateConflict> conflict = find_rate_conflict(system, scaling, eq.constraints)) {
    result.status = InitialStateStatus::kInconsistentVelocities;
    result.residual = conflict->residual;
    result.message = rate_conflict_message(*conflict);
    return result;
  }
  const VectorXd nu = scaling.rows.cwiseProduct(eq.constraints.nu.head(system.m));
  if (targets.d.isZero(0) && nu.isZero(0)) return result;  // at rest

  RowMatrixXd A(system.m + targets.D.rows(), system.nv);
  A << scaling.rows.asDiagonal() * eq.constraints.G, targets.D;
  VectorXd b = VectorXd::Zero(A.rows());
  b.head(system.m) = nu;
  b.tail(targets.d.size()) = targets.d;
  const Selection closures = select_independent(system, scaling, eq.constraints);
  const VectorXd as_they_are = VectorXd::Ones(targets.d.size());  // `read_targets` scaled them
  const std::vector<int> rows = extend_selection(closures, A, system.m, as_they_are, scaling.columns).selection.rows;
  const MatrixXd A_r = A(rows, Eigen::all);
  const MatrixXd X = make_metric(eq.M, scaling).solve(A_r.transpose());
  result.state.v = X * (A_r * X).ldlt().solve(VectorXd(b(rows)));
  result.residual = (A * result.state.v - b).cwiseAbs().maxCoeff();
  const double size = std::max(b.cwiseAbs().maxCoeff(), 1e-300);
  if (result.residual > 1e-8 * size) {
    result.status = InitialStateStatus::kInconsistentVelocities;
    result.message = "the initial velocities contradict each other or the constraints";
  }
  return result;
}

}  // namespace ferrers
