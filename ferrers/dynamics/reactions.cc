#include "ferrers/dynamics/reactions.h"

#include <algorithm>

#include "ferrers/core/checks.h"
#include "ferrers/dynamics/motion_loads.h"

namespace ferrers {

/// Joints, self-stresses and multipliers of one state.
struct ReactionSolver::Instant {
  JointWrenches joints;
  MatrixXd Z;  // rows × redundant; none where they are in `Z_by_row`
  std::optional<Eigen::SparseMatrix<double, Eigen::RowMajor>> Z_by_row;
  MatrixXd shared;  // rows × idle efforts of the drives: what they load the joints with
};

struct ReactionSolver::Distributed {
  VectorXd lambda;  // all rows
  std::vector<ComponentMap> maps;
  std::optional<ForceMethod> method;  // none: nothing was distributed
  std::vector<bool> valid;            // per joint, where distributed
};

namespace {

constexpr double kLargestDenseStresses = 1e8;  // numbers
// Closure rows: beyond, poses with many loops in doubt would take minutes each.
constexpr int kMostJudged = 10000;

// As if every row could be stressed alone: nothing is unique.
Eigen::SparseMatrix<double, Eigen::RowMajor> all_in_doubt(int rows) {
  Eigen::SparseMatrix<double, Eigen::RowMajor> Z(rows, rows);
  Z.setIdentity();
  return Z;
}

// Some rows of the self-stresses, without those that are zero in all of them.
MatrixXd dense_rows(const Eigen::SparseMatrix<double, Eigen::RowMajor>& Z, int first, int count) {
  using Iterator = Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator;
  std::vector<long> columns;
  for (int i = first; i < first + count; ++i) {
    for (Iterator it(Z, i); it; ++it) columns.push_back(it.col());
  }
  std::sort(columns.begin(), columns.end());
  columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
  MatrixXd out = MatrixXd::Zero(count, static_cast<long>(columns.size()));
  for (int i = 0; i < count; ++i) {
    for (Iterator it(Z, first + i); it; ++it) {
      out(i, std::lower_bound(columns.begin(), columns.end(), it.col()) - columns.begin()) = it.value();
    }
  }
  return out;
}

// The row that gives component k of a joint's reaction, at the joint's point, from its multipliers.
Eigen::RowVectorXd component_row(const Joint& joint, const JointFrameWrenches& frame, ReactionAxes axes, int k) {
  const Vector3d axis = axes == ReactionAxes::kWorld ? Vector3d::Unit(k % 3) : Vector3d(frame.motion.R_F.col(k % 3));
  if (k < 3) return axis.transpose() * frame.T.bottomRows<3>();
  const Vector3d to_M = -reaction_point_from_M(joint, frame.motion);
  return axis.transpose() * (frame.T.topRows<3>() + cross_matrix(to_M) * frame.T.bottomRows<3>());
}

}  // namespace

ReactionNames name_reactions(const Model& model) {
  ReactionNames names;
  for (std::size_t j = 0; j < model.coordinates_begin(); ++j) names.joints.push_back(model.joints()[j].name);
  for (const Coupling& coupling : model.couplings()) names.couplings.push_back(coupling.name);
  return names;
}

ReactionSolver::ReactionSolver(std::shared_ptr<const DynamicsModel> model, const DistributionOptions& options,
                               int largest_dense)
    : model_(std::move(model)),
      options_(options),
      largest_dense_(largest_dense),
      scaling_(model_->system->scaling),
      rows_(make_all_rows(*model_->system, scaling_)),
      springs_(make_joint_springs(*model_->system, options.by, scaling_.length_m)) {}

int ReactionSolver::redundant_rows(const Selection& selection) const {
  return model_->system->m - static_cast<int>(selection.rows.size());
}

std::vector<JointReaction> ReactionSolver::solve(const State& state, const Equations& eq, const Selection& selection,
                                                 const VectorXd& vdot, const VectorXd& lambda, const VectorXd& u,
                                                 ReactionAxes axes, DistributionOutcome* outcome) const {
  const System& system = *model_->system;
  require_size(vdot.size(), system.nv, "ReactionSolver::solve: vdot");
  require_size(lambda.size(), system.m, "ReactionSolver::solve: lambda");
  require_size(u.size(), model_->nu(), "ReactionSolver::solve: u");
  Instant at;
  at.joints = compute_joint_frame_wrenches(system, state, eq.pos);
  const MatrixXd all = distribute_to_joints(system, rows_, scaling_, eq.pos, at.joints,
                                            make_motion_loads(*model_, state, eq, vdot, lambda, u));
  const bool distributes = springs_.any && redundant_rows(selection) <= kMostDistributed;
  const int redundant = redundant_rows(selection);
  const bool judges = distributes || redundant == 0 || system.m <= kMostJudged;
  if (!judges) {
    at.Z_by_row = all_in_doubt(rows_.size());
  } else if (system.m > largest_dense_ && !distributes) {
    at.Z_by_row = find_self_stresses(system, scaling_, rows_, eq.pos, at.joints, eq.constraints, selection);
    const double dense_size = static_cast<double>(rows_.size()) * redundant;
    if (!at.Z_by_row && dense_size > kLargestDenseStresses) at.Z_by_row = all_in_doubt(rows_.size());
  }
  if (!at.Z_by_row) {
    at.Z = complete_self_stresses(system, scaling_, rows_, eq.pos, at.joints,
                                  self_stresses_of_selection(system, selection, eq.constraints.G));
  }
  if (eq.idle_efforts.cols() > 0) {
    const auto k = eq.idle_efforts.cols();
    const LoadChanges idle{MatrixXd::Zero(system.nv, k), eq.idle_lambda, eq.idle_efforts,
                           MatrixXd::Zero(model_->friction_slips, k)};
    at.shared =
        distribute_to_joints(system, rows_, scaling_, eq.pos, at.joints, make_changed_loads(*model_, state, eq, idle));
  }
  DistributionOutcome local;
  DistributionOutcome& told = outcome != nullptr ? *outcome : local;
  told = {};
  if ((springs_.any && !distributes) || !judges) told.too_many = redundant;
  const Distributed solution = distribute(at, all.col(0), told);
  std::vector<JointReaction> reactions = make_reactions(at, solution, axes);
  if (options_.range) add_ranges(at, solution, axes, reactions, told);
  return reactions;
}

ReactionSolver::Distributed ReactionSolver::distribute(const Instant& at, VectorXd lambda,
                                                       DistributionOutcome& outcome) const {
  Distributed out;
  out.lambda = std::move(lambda);
  if (!springs_.any || at.Z.cols() == 0) return out;
  outcome.used = true;
  out.maps = compute_component_maps(*model_->system, at.joints);
  out.method = make_force_method(rows_, out.maps, springs_, at.Z, scaling_.length_m);
  outcome.confident = out.method->decision.confident;
  DistributionResult result =
      solve_distribution(*out.method, rows_, out.maps, out.lambda, misalignment_of_rows(rows_, out.maps, springs_));
  for (const int j : result.contradictory) outcome.contradictory.push_back(owner_name(*model_->system->model, j));
  out.lambda = std::move(result.lambda);
  out.valid = std::move(result.valid);
  return out;
}

std::vector<JointReaction> ReactionSolver::make_reactions(const Instant& at, const Distributed& solution,
                                                          ReactionAxes axes) const {
  const Model& model = *model_->system->model;
  std::vector<JointReaction> reactions(model.coordinates_begin());
  const auto stresses_of = [&](int first, int count) -> MatrixXd {
    return at.Z_by_row ? dense_rows(*at.Z_by_row, first, count) : at.Z.middleRows(first, count);
  };
  for (std::size_t j = 0; j < reactions.size(); ++j) {
    const Joint& joint = model.joints()[j];
    const int first = rows_.first[j], count = rows_.count[j];
    const bool distributed = solution.method && solution.valid[j];
    const MatrixXd stresses = stresses_of(first, count);
    const MatrixXd open = distributed ? MatrixXd(solution.method->remaining.middleRows(first, count)) : stresses;
    // What changes with the sharing of the efforts is fixed by it, as springs fix self-stresses.
    MatrixXd all(count, stresses.cols() + at.shared.cols());
    all.leftCols(stresses.cols()) = stresses;
    if (at.shared.cols() > 0) all.rightCols(at.shared.cols()) = at.shared.middleRows(first, count);
    for (int k = 0; k < 6; ++k) {
      const Eigen::RowVectorXd row = component_row(joint, at.joints[j], axes, k);
      reactions[j].value[k] = row.dot(solution.lambda.segment(first, count));
      reactions[j].status[k] = judge_component(row, component_unit(k, scaling_.length_m), all, open);
    }
    reactions[j].low = reactions[j].high = reactions[j].value;
  }
  for (std::size_t c = 0; c < model.couplings().size(); ++c) {
    const std::size_t j = model.joints().size() + c;
    const int row = rows_.first[j];
    JointReaction one;
    one.components = 1;
    one.value[0] = one.low[0] = one.high[0] = solution.lambda[row];
    const bool distributed = solution.method && solution.valid[j];
    const MatrixXd stresses = stresses_of(row, 1);
    MatrixXd all(1, stresses.cols() + at.shared.cols());
    all.leftCols(stresses.cols()) = stresses;
    if (at.shared.cols() > 0) all.rightCols(at.shared.cols()) = at.shared.row(row);
    const MatrixXd open = distributed ? MatrixXd(solution.method->remaining.row(row)) : stresses;
    one.status[0] = judge_component(Eigen::RowVectorXd::Ones(1), rows_.scale[row], all, open);
    reactions.push_back(one);
  }
  return reactions;
}

void ReactionSolver::add_ranges(const Instant& at, const Distributed& solution, ReactionAxes axes,
                                std::vector<JointReaction>& reactions, DistributionOutcome& outcome) const {
  if (!solution.method) return;
  std::vector<std::pair<std::size_t, int>> wanted;
  for (std::size_t j = 0; j < model_->system->model->coordinates_begin(); ++j) {
    for (int k = 0; k < 6; ++k) {
      if (reactions[j].status[k] == ReactionStatus::kDistributed) wanted.emplace_back(j, k);
    }
  }
  MatrixXd targets = MatrixXd::Zero(static_cast<long>(wanted.size()), rows_.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const auto [j, k] = wanted[i];
    targets.row(static_cast<long>(i)).segment(rows_.first[j], rows_.count[j]) =
        component_row(model_->system->model->joints()[j], at.joints[j], axes, k);
  }
  const ReactionBounds bounds =
      bound_reactions(*solution.method, rows_, solution.maps, solution.lambda, targets, *options_.range);
  outcome.bounds = bounds.method;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const auto [j, k] = wanted[i];
    reactions[j].low[k] = bounds.low[static_cast<long>(i)];
    reactions[j].high[k] = bounds.high[static_cast<long>(i)];
  }
}

}  // namespace ferrers
