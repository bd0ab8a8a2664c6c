#include "ferrers/dynamics/holding.h"

#include <Eigen/QR>
#include <algorithm>

#include "ferrers/dynamics/named_coordinates.h"
#include "ferrers/dynamics/reduced_motion.h"
#include "ferrers/math/rank.h"
#include "ferrers/redundancy/rank_notice.h"

namespace ferrers {
namespace {

// The drives in the measure of the bodies: columns of forces, each drive per newton (moments over L).
struct HoldingSystem {
  std::vector<int> drives;
  VectorXd unit;  // of the efforts: N, or N·L
  MatrixXd C;     // w × holding drives
  VectorXd b;     // what they have to balance
  Eigen::LLT<MatrixXd> metric;
};

HoldingSystem make_system(const DynamicsModel& model, const ReducedMotion& motion, const std::vector<bool>& holds,
                          const Scaling& scaling) {
  HoldingSystem out;
  for (int i = 0; i < model.nu(); ++i) {
    if (holds[i]) out.drives.push_back(i);
  }
  out.unit = VectorXd::Ones(static_cast<long>(out.drives.size()));
  for (std::size_t k = 0; k < out.drives.size(); ++k) {
    if (model.drives[out.drives[k]].rotary) out.unit[static_cast<long>(k)] = scaling.length_m;
  }
  const MatrixXd X = motion.body_displacements();
  out.metric.compute(X.transpose() * X);
  const Equations& eq = motion.equations();
  VectorXd given = eq.tau - eq.h;
  for (int i = 0; i < model.nu(); ++i) {
    if (!holds[i]) given += eq.u[i] * eq.B_transposed.row(i).transpose();
  }
  out.b = out.metric.matrixL().solve(VectorXd(-(motion.N().transpose() * given)));
  const MatrixXd B = motion.B()(Eigen::all, out.drives);
  out.C = out.metric.matrixL().solve(MatrixXd(B * out.unit.asDiagonal()));
  return out;
}

// Among all efforts that do, those with the least Σ (weight · effort)²; per unit of `hold.unit`.
VectorXd least_weighted(const DynamicsModel& model, const HoldingSystem& hold, const MatrixXd& open) {
  const VectorXd some = solve_least_norm(hold.C, hold.b).x;
  if (open.cols() == 0) return some;
  VectorXd weight = hold.unit;
  for (std::size_t k = 0; k < hold.drives.size(); ++k) {
    weight[static_cast<long>(k)] *= model.drives[hold.drives[k]].weight;
  }
  const MatrixXd weighted = weight.asDiagonal() * open;
  const VectorXd back = weighted.householderQr().solve(weight.cwiseProduct(some));
  return some - open * back;
}

// Efforts that move nothing, orthonormal in scaled units, with the multipliers that balance them.
void add_idle(const ReducedMotion& motion, const HoldingSystem& hold, const MatrixXd& open, HoldingResult& out) {
  const RowMatrixXd& B_transposed = motion.equations().B_transposed;
  const long m = motion.equations().constraints.phi.size();
  out.idle_efforts = MatrixXd::Zero(out.u.size(), open.cols());
  out.idle_lambda = MatrixXd::Zero(m, open.cols());
  for (std::size_t i = 0; i < hold.drives.size(); ++i) {
    const long row = static_cast<long>(i);
    out.idle_efforts.row(hold.drives[i]) = hold.unit[row] * open.row(row);
  }
  for (long k = 0; k < open.cols(); ++k) {
    out.idle_lambda.col(k) = motion.rest_multipliers(B_transposed.transpose() * out.idle_efforts.col(k));
  }
}

}  // namespace

std::vector<bool> holding_drives(const DynamicsModel& model) {
  std::vector<bool> holds, acts;
  for (const DriveComponent& drive : model.drives) {
    holds.push_back(drive.effort_is_sought());
    acts.push_back(drive.acts);
  }
  const bool any = std::find(holds.begin(), holds.end(), true) != holds.end();
  return any ? holds : acts;
}

std::string_view effort_unit(const DriveComponent& drive) { return !drive.has_unit ? "" : drive.rotary ? "N·m" : "N"; }

HoldingResult solve_holding_efforts(const DynamicsModel& model, const State& pose, double t) {
  const System& system = *model.system;
  HoldingResult out;
  out.state = pose;
  out.state.v.setZero();
  out.state.t = t;
  out.holds = holding_drives(model);
  if (!model.unsupported.empty()) {
    out.status = HoldingStatus::kUnsupported;
    out.message = "not supported: " + model.unsupported.front();
    return out;
  }
  const Scaling& scaling = system.scaling;
  Equations eq = make_equations(model);
  compute_kinematics(model, out.state, eq);
  RankDecision constraints;
  out.selection = select_independent(system, scaling, eq.constraints, &constraints);
  if (!constraints.confident) out.notices.push_back(doubtful_rank_notice(t, constraints));
  const ReducedMotion motion(model, scaling, out.state, out.selection);
  const HoldingSystem hold = make_system(model, motion, out.holds, scaling);
  out.energy = compute_energy(model, out.state, motion.equations().pos, motion.equations().vel);

  const RankAnalysis rank = analyze_rank(hold.C);
  out.confident = constraints.confident && rank.decision.confident;
  VectorXd least = VectorXd::Zero(static_cast<long>(hold.drives.size()));
  if (hold.C.size() > 0) least = least_weighted(model, hold, rank.right_null);
  out.u = motion.equations().u;
  out.unique.assign(out.holds.size(), true);
  for (std::size_t k = 0; k < hold.drives.size(); ++k) {
    const long row = static_cast<long>(k);
    out.u[hold.drives[k]] = hold.unit[row] * least[row];
    out.unique[hold.drives[k]] = is_negligible(rank.right_null.row(row).norm(), 1.0);
  }
  add_idle(motion, hold, rank.right_null, out);
  out.free_motions = static_cast<int>(rank.left_null.cols());
  const auto motion_of = [&](const VectorXd& x) -> VectorXd {
    return motion.N() * VectorXd(hold.metric.matrixU().solve(x));
  };
  for (long k = 0; k < rank.left_null.cols(); ++k) {
    out.free_motion_names.push_back(name_motion(system, scaling, out.state, motion_of(rank.left_null.col(k)), ""));
  }
  const VectorXd left = hold.b - hold.C * least;
  out.residual_N = left.norm();
  VectorXd force = motion.equations().tau - motion.equations().h;
  force += motion.equations().B_transposed.transpose() * out.u;
  out.lambda = motion.rest_multipliers(force);
  if (is_negligible(out.residual_N, motion.force_scale(out.state))) return out;
  out.status = HoldingStatus::kNotHeld;
  out.message = hold.drives.empty() ? "there is no drive to hold the pose" : "the drives do not hold the pose";
  out.message +=
      "; what starts to move: " + name_motion(system, scaling, out.state, motion_of(-left / left.norm()), "");
  return out;
}

}  // namespace ferrers
