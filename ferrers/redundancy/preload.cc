#include "ferrers/redundancy/preload.h"

#include <Eigen/QR>

#include "ferrers/core/checks.h"

namespace ferrers {
namespace {

// Columns that span the same self-stresses, orthonormal in scaled units.
MatrixXd orthonormal_self_stresses(const RedundancyReport& report) {
  const VectorXd& scale = report.rows.scale;
  const MatrixXd Z(report.self_stresses);
  if (Z.cols() == 0) return Z;
  const Eigen::HouseholderQR<MatrixXd> qr(scale.cwiseInverse().asDiagonal() * Z);
  return scale.asDiagonal() * (qr.householderQ() * MatrixXd::Identity(Z.rows(), Z.cols()));
}

// What misalignment and the residual add to phi, on all rows. A residual of the size of rounding counts as none.
VectorXd displacement_of_rows(const AllRows& rows, const std::vector<ComponentMap>& maps, const JointSprings& springs,
                              const Scaling& scaling, const VectorXd& closure_residual) {
  VectorXd delta = misalignment_of_rows(rows, maps, springs);
  const bool open = closure_residual.size() > 0 &&
                    closure_residual.cwiseProduct(scaling.rows).cwiseAbs().maxCoeff() > closed_tolerance(scaling);
  for (int r = 0; open && r < rows.size(); ++r) {
    if (rows.closure_row[r] >= 0) delta[r] += closure_residual[rows.closure_row[r]];
  }
  return delta;
}

}  // namespace

PreloadReport analyze_preload(const System& system, const State& state, const RedundancyReport& report,
                              const VectorXd& closure_residual) {
  if (closure_residual.size() > 0) require_size(closure_residual.size(), system.m, "analyze_preload: closure_residual");
  PreloadReport out;
  const Scaling& scaling = system.scaling;
  const AllRows& rows = report.rows;
  const JointSprings springs = make_joint_springs(system, DistributionBy::kJointStiffness, scaling.length_m);
  PositionKinematics pos = make_position_kinematics(system);
  compute_positions(system, state.q, pos);
  const std::vector<ComponentMap> maps =
      compute_component_maps(system, compute_joint_frame_wrenches(system, state, pos));
  const VectorXd delta = displacement_of_rows(rows, maps, springs, scaling, closure_residual);
  if (delta.isZero(0)) return out;
  if (report.self_stresses.cols() > kMostPreloadStresses) {
    out.status = PreloadStatus::kTooLarge;
    return out;
  }
  const MatrixXd Z = orthonormal_self_stresses(report);
  const ForceMethod method = make_force_method(rows, maps, springs, Z, scaling.length_m);
  const DistributionResult result = solve_distribution(method, rows, maps, VectorXd::Zero(rows.size()), delta);
  out.status = result.contradictory.empty() ? PreloadStatus::kSolved : PreloadStatus::kContradictory;
  out.confident = method.decision.confident;
  for (const int j : result.contradictory) out.contradictory.push_back(owner_name(*system.model, j));
  for (std::size_t j = 0; j < maps.size(); ++j) {
    JointPreload& joint = out.joints.emplace_back();
    joint.joint = system.model->joints()[j].name;
    const MatrixXd& open_stresses = result.valid[j] ? method.remaining : Z;
    for (int k = 0; k < 6; ++k) {
      joint.status[k] = judge_component(maps[j].row(k), component_unit(k, scaling.length_m),
                                        Z.middleRows(rows.first[j], rows.count[j]),
                                        open_stresses.middleRows(rows.first[j], rows.count[j]));
      if (joint.status[k] == ReactionStatus::kDistributed) {
        joint.value[k] = maps[j].row(k).dot(result.lambda.segment(rows.first[j], rows.count[j]));
      }
    }
  }
  return out;
}

}  // namespace ferrers
