#include "ferrers/dynamics/reduced_motion.h"

#include <algorithm>
#include <cmath>

#include "ferrers/kinematics/assembly.h"
#include "ferrers/math/extrapolated_difference.h"
#include "ferrers/math/maximum.h"
#include "ferrers/math/rank_pivot.h"

namespace ferrers {
namespace {

constexpr int kMostIterations = 15;
constexpr double kOpen = 1e2;     // closed tolerances by which rows left out may miss
constexpr double kReach = 0.08;   // first difference step: rad or characteristic lengths of the body that moves most
constexpr double kFirstRate = 1;  // and in rates: rad/s

}  // namespace

ReducedMotion::ReducedMotion(const DynamicsModel& model, const Scaling& scaling, State base, Selection selection)
    : model_(model),
      system_(*model.system),
      scaling_(scaling),
      base_(std::move(base)),
      selection_(std::move(selection)),
      eq_(make_equations(model)) {
  N_ = MatrixXd::Zero(system_.nv, w());
  for (int k = 0; k < w(); ++k) N_(selection_.independent[k], k) = 1;
  evaluate(base_);
  base_N_ = N_;
  base_residual_ = residual(true);
}

void ReducedMotion::factor() {
  if (!selection_.rows.empty()) lu_.compute(eq_.constraints.G(selection_.rows, selection_.dependent));
}

void ReducedMotion::evaluate(const State& state) {
  q_ = state.q;
  compute_equations(model_, state, eq_);
  factor();
  VectorXd p = VectorXd::Zero(system_.nv);
  if (!selection_.rows.empty()) {
    N_(selection_.dependent, Eigen::all) =
        MatrixXd(-lu_.solve(MatrixXd(eq_.constraints.G(selection_.rows, selection_.independent))));
    p(selection_.dependent) = VectorXd(lu_.solve(VectorXd(eq_.constraints.gamma(selection_.rows))));
  }
  M_r_.noalias() = N_.transpose() * (eq_.M * N_);
  f_r_.noalias() = N_.transpose() * (eq_.force - eq_.M * p);
}

bool ReducedMotion::accelerations(VectorXd& z) const {
  const Eigen::LLT<MatrixXd> llt(M_r_);
  if (llt.info() != Eigen::Success) return false;
  for (int k = 0; k < w(); ++k) {
    const int v = selection_.independent[k];
    const double root = llt.matrixLLT()(k, k);
    if (is_lost_pivot(root * root, eq_.M(v, v) + M_r_(k, k))) return false;
  }
  z = llt.solve(f_r_);
  return z.allFinite();
}

double ReducedMotion::residual(bool all) const {
  double largest = 0;
  const auto add = [&](int row) {
    largest = max_keeping_nan(largest, std::abs(eq_.constraints.phi[row]) * scaling_.rows[row]);
  };
  if (all) {
    for (int row = 0; row < system_.m; ++row) add(row);
  } else {
    for (const int row : selection_.rows) add(row);
  }
  return largest;
}

bool ReducedMotion::move(const VectorXd& ds, const VectorXd& dv, State& out) {
  left_open_ = false;
  out = base_;
  out.v.setZero();
  displace(system_, base_N_ * ds, out.q);
  double before = INFINITY;
  for (int i = 0; i < kMostIterations; ++i) {
    compute_kinematics(model_, out, eq_);
    factor();
    const double size = residual(false);
    if (!std::isfinite(size)) return false;
    if (size == 0 || (size <= closed_tolerance(scaling_) && size > 0.1 * before)) break;
    if (i > 4 && size > 0.5 * before) return false;
    before = size;
    VectorXd step = VectorXd::Zero(system_.nv);
    step(selection_.dependent) = VectorXd(-lu_.solve(VectorXd(eq_.constraints.phi(selection_.rows))));
    if (!(step.cwiseQuotient(scaling_.columns).cwiseAbs().maxCoeff() <= scaling_.length_m)) return false;
    displace(system_, step, out.q);
  }
  left_open_ = !(residual(true) <= std::max(kOpen * closed_tolerance(scaling_), 10 * base_residual_));
  if (left_open_) return false;
  accept_winding(system_, eq_.pos, out);
  out.v(selection_.independent) = base_.v(selection_.independent) + dv;
  if (selection_.rows.empty()) return true;
  const VectorXd driven =
      eq_.constraints.G(selection_.rows, selection_.independent) * VectorXd(out.v(selection_.independent));
  out.v(selection_.dependent) = VectorXd(lu_.solve(VectorXd(eq_.constraints.nu(selection_.rows) - driven)));
  return out.v.allFinite();
}

MatrixXd ReducedMotion::body_displacements() const {
  const long bodies = static_cast<long>(system_.nodes.size()) - 1;
  MatrixXd X = MatrixXd::Zero(6 * bodies, w());
  VelocityKinematics rates = make_velocity_kinematics(system_);
  for (int k = 0; k < w(); ++k) {
    compute_velocities<double>(system_, eq_.pos, q_, N_.col(k), rates);
    for (long i = 0; i < bodies; ++i) {
      const std::size_t node = static_cast<std::size_t>(i) + 1;
      const NodePoint centre{static_cast<int>(node), model_.inertias[node].com_N};
      if (!system_.nodes[node].type->carries_body) {
        const int v = system_.nodes[node].v;
        X(6 * i, k) = N_(v, k) / scaling_.columns[v];
        continue;
      }
      X.block<3, 1>(6 * i, k) = scaling_.length_m * rates.nodes[node].w;
      X.block<3, 1>(6 * i + 3, k) = point_velocity(eq_.pos, rates, centre);
    }
  }
  return X;
}

double largest_displacement(const VectorXd& bodies) {
  double largest = 0;
  for (long i = 0; i + 3 <= bodies.size(); i += 3) largest = std::max(largest, bodies.segment<3>(i).norm());
  return largest;
}

double ReducedMotion::force_scale(const State& state) const {
  std::vector<Wrenches> on_nodes(system_.nodes.size(), Wrenches::Zero(6, 1));
  VectorXd efforts = VectorXd::Zero(system_.nv);
  compute_force_elements(model_, state, eq_.pos, eq_.vel, on_nodes, efforts);
  double sum = efforts.cwiseProduct(scaling_.columns).cwiseAbs().sum();
  const double gravity = system_.model->gravity().norm();
  for (std::size_t i = 1; i < on_nodes.size(); ++i) {
    sum += on_nodes[i].col(0).tail<3>().norm() + on_nodes[i].col(0).head<3>().norm() / scaling_.length_m;
    sum += model_.inertias[i].mass_kg * gravity;
  }
  for (const CoordinateAccess& access : model_.lagrangian.scalars) {
    if (access.in_tree) sum += (std::abs(eq_.h[access.v]) + std::abs(eq_.tau[access.v])) * scaling_.columns[access.v];
  }
  for (int k = 0; k < model_.nu(); ++k) {
    sum += std::abs(eq_.u[k]) * eq_.B_transposed.row(k).transpose().cwiseProduct(scaling_.columns).norm();
  }
  return sum;
}

VectorXd ReducedMotion::rest_multipliers(const VectorXd& force) const {
  VectorXd lambda = VectorXd::Zero(system_.m);
  if (!selection_.rows.empty()) {
    lambda(selection_.rows) = VectorXd(lu_.transpose().solve(VectorXd(-force(selection_.dependent))));
  }
  return lambda;
}

namespace {

EstimatedMatrix zeros(long rows, long columns) {
  return {MatrixXd::Zero(rows, columns), MatrixXd::Zero(rows, columns)};
}

void take(const DifferenceResult& from, long first, long column, EstimatedMatrix& out) {
  out.value.col(column) = from.value.segment(first, out.value.rows());
  out.error.col(column) = from.error.segment(first, out.error.rows());
}

// Whether generic directions can be gone at all: where branches of motion cross, each alone can, their sum cannot.
bool has_coordinates(ReducedMotion& motion, const MatrixXd& X, double length_m) {
  const long w = motion.w();
  VectorXd ds(w);
  for (const double turn : {1.0, -1.0}) {
    for (long k = 0; k < w; ++k) {
      const double reach = largest_displacement(X.col(k)) / length_m;
      const double share = 0.5 + std::fmod(0.618034 * static_cast<double>(k + 1), 1.0);  // nothing special
      ds[k] = (k % 2 == 0 ? 1 : turn) * share * (reach > 0 ? kReach / reach : 1);
    }
    State state;
    bool reached = false;
    int open = 0;  // steps after which only rows left out stay open: a short one could hide behind the tolerance
    for (double share = 1; share > 1e-3 && !reached && open < 2; share /= 2) {
      reached = true;
      for (const double way : {share, -share}) {
        if (!reached || motion.move(way * ds, VectorXd::Zero(w), state)) continue;
        reached = false;
        open += motion.left_rows_open() ? 1 : 0;
      }
    }
    if (!reached) return false;
  }
  return true;
}

ReducedDerivatives differentiate(ReducedMotion& motion, double length_m, bool all) {
  const long w = motion.w();
  ReducedDerivatives out;
  out.force_s = out.force_v = out.acceleration_s = out.acceleration_v = zeros(w, w);
  motion.evaluate(motion.base());
  const MatrixXd X = motion.body_displacements();
  const auto evaluate = [&](const VectorXd& ds, const VectorXd& dv, VectorXd& values) {
    State state;
    if (!motion.move(ds, dv, state)) return false;
    motion.evaluate(state);
    values.head(w) = motion.force();
    VectorXd z;
    if (all && !motion.accelerations(z)) return false;
    if (all) values.tail(w) = z;
    return values.allFinite();
  };
  const long size = all ? 2 * w : w;
  out.valid = w == 0 || has_coordinates(motion, X, length_m);
  for (long k = 0; k < w && out.valid; ++k) {
    const VectorXd unit = VectorXd::Unit(w, k), none = VectorXd::Zero(w);
    const double reach = largest_displacement(X.col(k)) / length_m;
    const double scale = reach > 0 ? 1 / reach : 1;
    const DifferenceResult by_s = compute_extrapolated_difference(
        [&](double h, VectorXd& values) { return evaluate(h * unit, none, values); }, size, kReach * scale);
    out.valid = by_s.valid;
    take(by_s, 0, k, out.force_s);
    if (!all || !out.valid) continue;
    take(by_s, w, k, out.acceleration_s);
    const DifferenceResult by_v = compute_extrapolated_difference(
        [&](double h, VectorXd& values) { return evaluate(none, h * unit, values); }, size, kFirstRate * scale);
    out.valid = by_v.valid;
    take(by_v, 0, k, out.force_v);
    take(by_v, w, k, out.acceleration_v);
  }
  motion.evaluate(motion.base());
  return out;
}

}  // namespace

ReducedDerivatives compute_reduced_stiffness(ReducedMotion& motion, double length_m) {
  return differentiate(motion, length_m, false);
}

ReducedDerivatives compute_reduced_derivatives(ReducedMotion& motion, double length_m) {
  return differentiate(motion, length_m, true);
}

}  // namespace ferrers
