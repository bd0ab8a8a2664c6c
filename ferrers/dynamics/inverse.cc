#include "ferrers/dynamics/inverse.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace ferrers {

struct PrescribedMotion::Impl {
  std::shared_ptr<const DynamicsModel> model;
  const System& system;
  Scaling scaling;
  Equations eq;
  Selection selection;
  std::vector<int> prescribed;  // drive components with a motion law
  PrescribedResult current;     // last instant solved
  bool started = false;
  bool rates_known = false;
  bool singular_here = false;  // at the last instant
  Selection reported;          // there: what is independent at that pose

  // Rows [G_r; D] of the square system, residuals and biases of D.
  RowMatrixXd D;
  VectorXd drive_scale, drive_value, drive_bias;
  MatrixXd A;
  Eigen::PartialPivLU<MatrixXd> lu;

  Impl(std::shared_ptr<const DynamicsModel> m, State start)
      : model(std::move(m)), system(*model->system), scaling(make_scaling(system)), eq(make_equations(*model)) {
    for (int i = 0; i < model->nu(); ++i) {
      if (model->drives[i].motion) prescribed.push_back(i);
    }
    const long k = static_cast<long>(prescribed.size());
    D = RowMatrixXd::Zero(k, system.nv);
    drive_value = drive_bias = VectorXd::Zero(k);
    drive_scale = VectorXd::Ones(k);
    for (long i = 0; i < k; ++i) {
      const DriveComponent& drive = model->drives[prescribed[i]];
      if (drive.kind != Drive::Kind::kCoordinate) continue;
      const Joint& joint = system.model->joint(drive.coordinate.joint);
      const CoordinateKind kind = joint_type_info(joint.type).coordinates[drive.coordinate.index].kind;
      if (kind == CoordinateKind::kAngle || kind == CoordinateKind::kRotationRate) drive_scale[i] = scaling.length_m;
    }
    current.state = std::move(start);
    current.vdot = VectorXd::Zero(system.nv);
    current.lambda = VectorXd::Zero(system.m);
    current.u = VectorXd::Zero(model->nu());
    evaluate(current.state);
    selection = select_independent(system, scaling, eq.constraints);
  }

  // Constraints and drives at a state.
  void evaluate(const State& state) {
    compute_kinematics(*model, state, eq);
    D.setZero();
    for (std::size_t i = 0; i < prescribed.size(); ++i) {
      const DriveComponent& drive = model->drives[prescribed[i]];
      const Jet jet = measure_drive(*model, drive, state, eq.pos, eq.vel);
      drive_value[static_cast<long>(i)] = jet.value;
      drive_bias[static_cast<long>(i)] = jet.bias;
      add_drive_row(*model, drive, eq.pos, jet, D.row(static_cast<long>(i)));
    }
  }

  MatrixXd scaled_drive_rows() const { return drive_scale.asDiagonal() * D * scaling.columns.asDiagonal(); }

  void factor() {
    const int r = static_cast<int>(selection.rows.size());
    A.resize(system.nv, system.nv);
    for (int i = 0; i < r; ++i) A.row(i) = eq.constraints.G.row(selection.rows[i]);
    A.bottomRows(D.rows()) = D;
    lu.compute(A);
  }

  // One instant's positions: Newton from `state` towards the drives' targets.
  bool solve_positions(State& state, const VectorXd& target) {
    const int r = static_cast<int>(selection.rows.size());
    VectorXd residual(system.nv);
    double before = INFINITY;
    for (int i = 0; i < 30; ++i) {
      evaluate(state);
      double size = 0;
      for (int k = 0; k < r; ++k) {
        const int row = selection.rows[k];
        residual[k] = eq.constraints.phi[row];
        size = std::max(size, std::abs(residual[k]) * scaling.rows[row]);
      }
      residual.tail(D.rows()) = drive_value - target;
      size = std::max(size, D.rows() > 0 ? (drive_value - target).cwiseProduct(drive_scale).cwiseAbs().maxCoeff() : 0);
      if (!std::isfinite(size)) return false;
      const bool settled = size <= closed_tolerance(scaling) && size > 0.1 * before;
      if (settled || size == 0) return all_rows_hold();
      before = size;
      factor();
      VectorXd step = lu.solve(-residual);
      const double length = step.cwiseQuotient(scaling.columns).cwiseAbs().maxCoeff() / scaling.length_m;
      if (!std::isfinite(length)) return false;
      if (length > 0.5) step *= 0.5 / length;
      displace(system, step, state.q);
    }
    return before <= closed_tolerance(scaling) && all_rows_hold();
  }

  bool all_rows_hold() const {
    if (system.m == 0) return true;
    return eq.constraints.phi.cwiseProduct(scaling.rows).cwiseAbs().maxCoeff() <= 1e3 * closed_tolerance(scaling);
  }

  VectorXd targets(double t) const {
    VectorXd target(static_cast<long>(prescribed.size()));
    for (long i = 0; i < target.size(); ++i) target[i] = model->drives[prescribed[i]].motion->motion(t).value;
    return target;
  }

  // How far the drives go between two sets of targets, in rad or characteristic lengths.
  double distance(const VectorXd& a, const VectorXd& b) const {
    if (a.size() == 0) return 0;
    return (a - b).cwiseProduct(drive_scale).cwiseAbs().maxCoeff() / scaling.length_m;
  }

  // Walks from where the mechanism is to `target`, in pieces small enough to stay on the branch.
  bool walk(State& state, const VectorXd& target) {
    evaluate(state);
    VectorXd from = drive_value;
    double done = 0, piece = 1 / std::max(1.0, std::ceil(distance(from, target) / 0.1));
    while (done < 1) {
      const double next = std::min(1.0, done + piece);
      State trial = state;
      if (solve_positions(trial, from + next * (target - from))) {
        accept_winding(system, eq.pos, trial);
        state = trial;
        done = next;
        refresh_selection();
        continue;
      }
      piece /= 4;
      if (piece < 1e-5) return false;
    }
    return true;
  }

  // The rows kept must stay well conditioned along the motion; their number does not change here.
  void refresh_selection() { selection = reselect(system, scaling, eq.constraints, selection); }

  bool solve_rates(double t) {
    const int r = static_cast<int>(selection.rows.size());
    State& state = current.state;
    VectorXd rhs = VectorXd::Zero(system.nv);
    std::vector<Law::Motion> motions;
    for (const int i : prescribed) motions.push_back(model->drives[i].motion->motion(t));
    state.v.setZero();
    evaluate(state);
    factor();
    for (std::size_t i = 0; i < motions.size(); ++i) rhs[r + static_cast<long>(i)] = motions[i].rate;
    singular_here = !is_regular();
    if (singular_here) reported = select_independent(system, scaling, eq.constraints);
    if (!solve_square(rhs, state.v)) return false;
    evaluate(state);
    for (int k = 0; k < r; ++k) rhs[k] = eq.constraints.gamma[selection.rows[k]];
    for (std::size_t i = 0; i < motions.size(); ++i) {
      rhs[r + static_cast<long>(i)] = motions[i].acceleration - drive_bias[static_cast<long>(i)];
    }
    return solve_square(rhs, current.vdot);
  }

  // A x = rhs. At a singular pose the least solution in scaled units, where the equations do not contradict each other:
  // motions that are free there for an instant (an idle spin) are taken to rest.
  bool solve_square(const VectorXd& rhs, VectorXd& x) const {
    if (!singular_here) {
      x = lu.solve(rhs);
      return x.allFinite();
    }
    const VectorXd scales = row_scales();
    const LeastNormResult least =
        solve_least_norm(scales.asDiagonal() * A * scaling.columns.asDiagonal(), scales.cwiseProduct(rhs));
    x = scaling.columns.cwiseProduct(least.x);
    return is_negligible(least.residual, std::max(scales.cwiseProduct(rhs).norm(), 1e-300));
  }

  bool is_regular() const {
    const MatrixXd scaled = row_scales().asDiagonal() * A * scaling.columns.asDiagonal();
    return decide_rank(scaled.jacobiSvd().singularValues(), 1.0).rank == system.nv;
  }

  VectorXd row_scales() const {
    VectorXd scales(system.nv);
    const int r = static_cast<int>(selection.rows.size());
    for (int k = 0; k < r; ++k) scales[k] = scaling.rows[selection.rows[k]];
    scales.tail(D.rows()) = drive_scale;
    return scales;
  }

  bool solve_efforts() {
    const int r = static_cast<int>(selection.rows.size());
    compute_mass_and_bias(*model, eq);
    compute_applied_forces(*model, current.state, eq);
    VectorXd rhs = eq.M * current.vdot + eq.h - eq.tau;
    current.u = eq.u;
    for (const int i : prescribed) current.u[i] = 0;
    rhs.noalias() -= eq.B_transposed.transpose() * current.u;
    VectorXd x;
    if (singular_here) {
      const VectorXd scales = row_scales();
      const MatrixXd scaled = scaling.columns.asDiagonal() * A.transpose() * scales.asDiagonal();
      const LeastNormResult least = solve_least_norm(scaled, scaling.columns.cwiseProduct(rhs));
      if (!is_negligible(least.residual, std::max(scaling.columns.cwiseProduct(rhs).norm(), 1e-300))) return false;
      x = scales.cwiseProduct(least.x);
    } else {
      x = lu.transpose().solve(rhs);
    }
    current.lambda.setZero();
    for (int k = 0; k < r; ++k) current.lambda[selection.rows[k]] = x[k];
    for (std::size_t i = 0; i < prescribed.size(); ++i) current.u[prescribed[i]] = x[r + static_cast<long>(i)];
    return true;
  }
};

PrescribedMotion::PrescribedMotion(std::shared_ptr<const DynamicsModel> model, State start)
    : impl_(std::make_unique<Impl>(std::move(model), std::move(start))) {}
PrescribedMotion::~PrescribedMotion() = default;
PrescribedMotion::PrescribedMotion(PrescribedMotion&&) noexcept = default;

PrescribedResult PrescribedMotion::check() const {
  const Impl& s = *impl_;
  PrescribedResult result = s.current;
  const int r = static_cast<int>(s.selection.rows.size());
  MatrixXd A(r + s.D.rows(), s.system.nv);
  for (int i = 0; i < r; ++i) {
    const int row = s.selection.rows[i];
    A.row(i) = s.scaling.rows[row] * s.eq.constraints.G.row(row) * s.scaling.columns.asDiagonal();
  }
  A.bottomRows(s.D.rows()) = s.scaled_drive_rows();
  const RankAnalysis analysis = analyze_rank(A, 1.0);
  const int rank = analysis.decision.rank;
  if (rank < s.system.nv) {
    result.status = PrescribedStatus::kUndriven;
    result.message = "the drives leave " + std::to_string(s.system.nv - rank) + " motion(s) free; still moving:";
    for (int v = 0; v < s.system.nv; ++v) {
      if (!is_negligible(analysis.right_null.row(v).norm(), 1.0)) result.message += " " + s.system.coordinate_names[v];
    }
  } else if (rank < A.rows()) {
    result.status = PrescribedStatus::kOverdriven;
    result.message = "more motions are prescribed than the mechanism has; they depend on each other:";
    for (std::size_t i = 0; i < s.prescribed.size(); ++i) {
      const auto row = analysis.left_null.row(r + static_cast<long>(i));
      if (!is_negligible(row.norm(), 1.0)) result.message += " " + s.model->drives[s.prescribed[i]].name;
    }
  }
  return result;
}

PrescribedResult PrescribedMotion::solve(double t, bool with_efforts) {
  Impl& s = *impl_;
  State state = s.current.state;
  if (s.started && s.rates_known) {  // predict, then correct
    const double dt = t - state.t;
    const VectorXd step = dt * state.v + 0.5 * dt * dt * s.current.vdot;
    const double size = step.cwiseQuotient(s.scaling.columns).cwiseAbs().maxCoeff() / s.scaling.length_m;
    if (size < 0.3) displace(s.system, step, state.q);
  }
  const VectorXd target = s.targets(t);
  State walked = s.current.state;
  bool reached = s.solve_positions(state, target) && s.started;
  if (reached) {
    accept_winding(s.system, s.eq.pos, state);
    s.refresh_selection();
  } else {
    reached = s.walk(walked, target);
    state = walked;
  }
  if (!reached) {
    s.current.status = PrescribedStatus::kNotReached;
    s.current.message = "the prescribed positions cannot be reached at t = " + std::to_string(t) + " s";
    return s.current;
  }
  state.t = t;
  s.current.state = state;
  s.started = true;
  s.rates_known = s.solve_rates(t);
  s.current.status = s.rates_known ? PrescribedStatus::kSolved : PrescribedStatus::kSingular;
  if (!s.rates_known) {
    s.current.message = "the driven mechanism is at a singular pose (a dead point) at t = " + std::to_string(t) + " s";
    return s.current;
  }
  if (with_efforts && !s.solve_efforts()) {
    s.current.status = PrescribedStatus::kSingular;
    s.current.message =
        "no finite efforts hold the motion through the singular pose at t = " + std::to_string(t) + " s";
  }
  return s.current;
}

const Equations& PrescribedMotion::equations() const { return impl_->eq; }
const Selection& PrescribedMotion::selection() const {
  return impl_->singular_here ? impl_->reported : impl_->selection;
}

}  // namespace ferrers
