#include "ferrers/dynamics/friction.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "ferrers/dynamics/motion_loads.h"

namespace ferrers {
namespace {

constexpr int kMostIterations = 60;
constexpr int kShares = 16;  // of mu, where all of it at once fails

// Reaction components of one contact in F, forces then moments, N and N·m: 6 per friction.
using ContactLoad = Eigen::Matrix<double, 6, 1>;

// N and its gradient.
double pressing_force(const BoundFriction& friction, const ContactLoad& w, ContactLoad& gradient) {
  gradient.setZero();
  double total = 0;
  const auto add = [&](const std::vector<int>& components, double factor) {
    double square = 0;
    for (const int k : components) square += w[k] * w[k];
    const double size = std::sqrt(square);
    for (const int k : components) gradient[k] += size > 0 ? factor * w[k] / size : 0;
    total += factor * size;
  };
  add(friction.forces, 1);
  if (!friction.moments.empty()) add(friction.moments, 1 / friction.radius_m);
  return total;
}

// Drive efforts that multipliers of the equations' driven rows mean.
MatrixXd driven_efforts(const DynamicsModel& model, const Equations& eq, const MatrixXd& lambda) {
  MatrixXd u = MatrixXd::Zero(model.nu(), lambda.cols());
  for (std::size_t i = 0; i < eq.driven.size(); ++i) {
    u.row(eq.driven[i]) = lambda.row(model.system->m + static_cast<long>(i));
  }
  return u;
}

}  // namespace

std::string find_slips(const Joint& joint, BoundFriction& friction) {
  const JointTypeInfo& type = joint_type_info(joint.type);
  const bool placed = type.placement == PlacementRule::kPoint || type.placement == PlacementRule::kPointAxis ||
                      type.placement == PlacementRule::kPointNormal;
  if (!placed || joint.constants.lead_m != 0) {
    return "the sliding surfaces of a " + std::string(type.name) + " joint are not known";
  }
  const bool at_a_point = type.freedoms() > 3;
  bool slides = false;
  for (int k = 0; k < 6; ++k) {
    const bool held = std::find(type.row_components.begin(), type.row_components.end(), k) != type.row_components.end();
    if (held) {
      (k < 3 ? friction.forces : friction.moments).push_back(k);
    } else if (k < 3 || (!at_a_point && friction.radius_m > 0)) {
      slides = slides || k < 3;
      friction.components[static_cast<std::size_t>(friction.slips++)] = k;
    }
  }
  if (friction.slips == 0) return "the radius at which its parts touch is missing: give 'friction' a 'radius'";
  if (!slides || friction.radius_m == 0) friction.moments.clear();
  friction.slip_scale = slides ? kSlipSpeed : kSlipRate * friction.radius_m;
  return "";
}

void compute_slip_wrenches(const BoundFriction& friction, const PositionKinematics& pos, Wrench* wrenches) {
  const Matrix3d R_F = pos.nodes[friction.frames.node_1].R * friction.frames.X_1F.R;
  for (int i = 0; i < friction.slips; ++i) {
    const int k = friction.components[static_cast<std::size_t>(i)];
    wrenches[i].setZero();
    if (k < 3) {
      wrenches[i].tail<3>() = R_F.col(k);
    } else {
      wrenches[i].head<3>() = friction.radius_m * R_F.col(k - 3);
    }
  }
}

FrictionSolver::FrictionSolver(std::shared_ptr<const DynamicsModel> model, const DistributionOptions& options)
    : model_(std::move(model)),
      scaling_(model_->system->scaling),
      rows_(make_all_rows(*model_->system, scaling_)),
      springs_(make_joint_springs(*model_->system, options.by, scaling_.length_m)),
      undetermined_(model_->frictions.size(), false),
      slip_rows_(RowMatrixXd::Zero(model_->friction_slips, model_->system->nv)),
      slip_speeds_(VectorXd::Zero(model_->friction_slips)),
      direction_(VectorXd::Zero(model_->friction_slips)),
      friction_(VectorXd::Zero(model_->friction_slips)) {}

const RowMatrixXd& FrictionSolver::slip_rows(const Equations& eq) {
  slip_rows_.setZero();
  Wrench wrenches[kMostSlips];
  for (const BoundFriction& friction : model_->frictions) {
    compute_slip_wrenches(friction, eq.pos, wrenches);
    for (int i = 0; i < friction.slips; ++i) {
      add_jet_row(*model_->system, friction.frames, eq.pos, wrenches[i], 1, slip_rows_.row(friction.first + i));
    }
  }
  return slip_rows_;
}

void FrictionSolver::measure_slips(const Equations& eq) {
  Wrench wrenches[kMostSlips];
  for (const BoundFriction& friction : model_->frictions) {
    const RelativeMotion motion = compute_relative_motion(friction.frames, eq.pos, eq.vel);
    Twist twist;
    twist << motion.w, motion.v;
    compute_slip_wrenches(friction, eq.pos, wrenches);
    auto slip = slip_speeds_.segment(friction.first, friction.slips);
    for (int i = 0; i < friction.slips; ++i) slip[i] = wrenches[i].dot(twist);
    const double speed = slip.norm();
    const double ratio = speed > 0 ? std::tanh(speed / friction.slip_scale) / speed : 0;
    direction_.segment(friction.first, friction.slips) = friction.coulomb * ratio * slip;
  }
}

std::string FrictionSolver::names(const std::vector<bool>& which) const {
  std::string text;
  for (std::size_t i = 0; i < which.size(); ++i) {
    if (!which[i]) continue;
    text += (text.empty() ? "'" : ", '") + model_->system->model->joint(model_->frictions[i].joint).name + "'";
  }
  return text;
}

// The reactions that press the contacts, 6 per friction: column 0 for the base, then per unit of friction.
MatrixXd FrictionSolver::pressing_loads(const State& state, const Equations& eq, const Selection& selection,
                                        const MotionCases& base, const MotionCases& changes) {
  const System& system = *model_->system;
  const JointWrenches joints = compute_joint_frame_wrenches(system, state, eq.pos);
  const long nf = friction_.size();
  MatrixXd all(rows_.size(), 1 + nf);
  all.col(0) =
      distribute_to_joints(system, rows_, scaling_, eq.pos, joints,
                           make_motion_loads(*model_, state, eq, base.vdot.col(0), base.lambda.col(0), base.u.col(0)));
  const LoadChanges units{changes.vdot, changes.lambda, changes.u, MatrixXd::Identity(nf, nf)};
  all.rightCols(nf) =
      distribute_to_joints(system, rows_, scaling_, eq.pos, joints, make_changed_loads(*model_, state, eq, units));

  // Prescribed motions add none: those that are followed are independent of the joints, and what the others could do
  // is fixed, since they act with no effort.
  const MatrixXd Z = complete_self_stresses(system, scaling_, rows_, eq.pos, joints,
                                            self_stresses_of_selection(system, selection, eq.constraints.G));
  const std::vector<ComponentMap> maps = compute_component_maps(system, joints);
  const bool judge = !judged_ || judged_rows_ != selection.rows;
  judged_ = true;
  judged_rows_ = selection.rows;
  std::optional<ForceMethod> method;
  std::vector<bool> valid;
  if (Z.cols() > 0 && springs_.any) {
    method = make_force_method(rows_, maps, springs_, Z, scaling_.length_m);
    const VectorXd delta = misalignment_of_rows(rows_, maps, springs_);
    for (long k = 0; k <= nf; ++k) {
      DistributionResult result = solve_distribution(*method, rows_, maps, all.col(k), k == 0 ? delta : 0 * delta);
      if (k == 0) valid = result.valid;
      all.col(k) = result.lambda;
    }
  }
  MatrixXd loads(6 * static_cast<long>(model_->frictions.size()), 1 + nf);
  for (std::size_t c = 0; c < model_->frictions.size(); ++c) {
    const BoundFriction& friction = model_->frictions[c];
    const std::size_t j = friction.joint.index();
    const int first = rows_.first[j], count = rows_.count[j];
    loads.middleRows<6>(6 * static_cast<long>(c)) = maps[j] * all.middleRows(first, count);
    if (!judge) continue;
    const bool divided = method && valid[j];
    const MatrixXd& open = divided ? method->remaining : Z;
    undetermined_[c] = false;
    for (const auto* components : {&friction.forces, &friction.moments}) {
      for (const int k : *components) {
        const ReactionStatus status = judge_component(maps[j].row(k), component_unit(k, scaling_.length_m),
                                                      Z.middleRows(first, count), open.middleRows(first, count));
        if (status == ReactionStatus::kUndetermined) undetermined_[c] = true;
      }
    }
  }
  return loads;
}

// Newton's method for f + share · N(f) direction = 0, from the friction known so far. False: it does not settle, or
// settles where the solution is not connected to the one at share 0.
bool FrictionSolver::settle(const MatrixXd& loads, double share) {
  const long nf = friction_.size();
  VectorXd residual(nf), direction = share * direction_;
  MatrixXd slope(nf, nf);
  Eigen::PartialPivLU<MatrixXd> lu(nf);
  ContactLoad gradient;
  double before = INFINITY;
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    slope.setIdentity();
    residual = friction_;
    double size = 0;
    for (std::size_t c = 0; c < model_->frictions.size(); ++c) {
      const BoundFriction& contact = model_->frictions[c];
      const auto rows = loads.middleRows<6>(6 * static_cast<long>(c));
      const ContactLoad w = rows.col(0) + rows.rightCols(nf) * friction_;
      const double pressing = pressing_force(contact, w, gradient);
      const auto along = direction.segment(contact.first, contact.slips);
      residual.segment(contact.first, contact.slips) += pressing * along;
      slope.middleRows(contact.first, contact.slips) += along * (gradient.transpose() * rows.rightCols(nf));
      size = std::max(size, std::max(pressing * contact.coulomb, friction_.cwiseAbs().maxCoeff()));
    }
    lu.compute(slope);
    const double error = residual.cwiseAbs().maxCoeff();
    if (!std::isfinite(error)) return false;
    // not a rank decision: rounding of N is a few units in the last place, and Newton's steps end there
    if (error <= 1e-15 * size || (error <= 1e-12 * size && error >= 0.5 * before)) return lu.determinant() > 0;
    before = error;
    friction_ -= lu.solve(residual);
  }
  return false;
}

bool FrictionSolver::settle_step_by_step(const MatrixXd& loads) {
  friction_.setZero();
  if (settle(loads, 1)) return true;
  friction_.setZero();
  for (int i = 1; i <= kShares; ++i) {
    if (!settle(loads, static_cast<double>(i) / kShares)) return false;
  }
  return true;
}

FrictionStatus FrictionSolver::solve(const State& state, Equations& eq, const Selection& selection,
                                     const MotionCases& base, const MotionCases& changes) {
  message_.clear();
  measure_slips(eq);
  const MatrixXd loads = pressing_loads(state, eq, selection, base, changes);
  if (std::find(undetermined_.begin(), undetermined_.end(), true) != undetermined_.end()) {
    message_ = "friction in the joints " + names(undetermined_) +
               " depends on reactions that rigid bodies leave open, so that the motion itself is not determined; give "
               "stiffness to the joints that share these reactions";
    return FrictionStatus::kUndetermined;
  }
  if (!settle_step_by_step(loads)) {
    message_ = "friction jams: no friction in the joints " + names(std::vector<bool>(model_->frictions.size(), true)) +
               " agrees with the reactions that it causes; a smaller friction coefficient would not jam";
    return FrictionStatus::kJammed;
  }
  eq.friction = friction_;
  eq.tau.noalias() += slip_rows_.transpose() * friction_;
  return FrictionStatus::kSolved;
}

FrictionStatus FrictionSolver::solve(const State& state, Equations& eq, const Selection& selection,
                                     ForwardSolver& solver, ForwardResult& result) {
  if (!any()) return FrictionStatus::kSolved;
  slip_rows(eq);
  const long nf = friction_.size(), m = result.lambda.size();
  const MotionCases base{result.vdot, result.lambda, eq.u + driven_efforts(*model_, eq, result.lambda)};
  MotionCases changes{MatrixXd::Zero(result.vdot.size(), nf), MatrixXd::Zero(m, nf), {}};
  const VectorXd no_gamma = VectorXd::Zero(m);
  for (long k = 0; k < nf; ++k) {
    solver.resolve(slip_rows_.row(k).transpose(), no_gamma, result);
    changes.vdot.col(k) = result.vdot;
    changes.lambda.col(k) = result.lambda;
  }
  changes.u = driven_efforts(*model_, eq, changes.lambda);
  const FrictionStatus status = solve(state, eq, selection, base, changes);
  if (status != FrictionStatus::kSolved) return status;
  eq.force.noalias() += slip_rows_.transpose() * friction_;
  solver.resolve(eq.force, eq.constraints.gamma, result);
  return status;
}

}  // namespace ferrers
