#include "ferrers/dynamics/linearization.h"

#include <algorithm>
#include <cmath>

#include "ferrers/redundancy/rank_notice.h"

namespace ferrers {
namespace {

constexpr double kUnseen = 1e-9;  // characteristic lengths off the equilibrium
constexpr double kRounding = 1e-14;
constexpr double kNoise = 5;     // error estimates that are no value
constexpr double kRest = 1e-9;   // of all forces: what may be left of them in equilibrium
constexpr double kEqual = 1e-6;  // relative difference of parts of a mode that count as equal

// Rotations by quaternions: δ̇ = δω + ω × δ for a turn δ in first-body axes.
MatrixXd turning(const System& system, const VectorXd& v, const MatrixXd& N, const std::vector<int>& independent) {
  MatrixXd turned = MatrixXd::Zero(N.rows(), N.cols());
  for (std::size_t i = 1; i < system.nodes.size(); ++i) {
    const Node& node = system.nodes[i];
    if (node.type->quaternion_at < 0) continue;
    turned.middleRows<3>(node.v) = cross_matrix(Vector3d(v.segment<3>(node.v))) * N.middleRows<3>(node.v);
  }
  return turned(independent, Eigen::all);
}

// Along every principal direction: what force is left is rounding, or the reach of one too small to be seen.
bool is_balanced(const ReducedMotion& motion, const StabilityVerdict& verdict, double force_N, double length_m) {
  const VectorXd left = verdict.directions.transpose() * motion.force();
  const double all = motion.w() > 0 ? verdict.stiffness.cwiseAbs().maxCoeff() * length_m : 0;
  for (long k = 0; k < left.size(); ++k) {
    const double unseen = kUnseen * std::abs(verdict.stiffness[k]) * length_m;
    if (!(std::abs(left[k]) <= kRest * force_N + unseen + kRounding * all)) return false;
  }
  return true;
}

double estimate_error(const MatrixXd& M, const ReducedDerivatives& d, const MatrixXd& A) {
  const long w = M.rows();
  const Eigen::LLT<MatrixXd> llt(M);
  const MatrixXd U = llt.matrixU(), inverse = llt.matrixU().solve(MatrixXd::Identity(w, w));
  const auto size = [&](const MatrixXd& X) { return MatrixXd(U * X * inverse).norm(); };
  const auto bound = [&](const MatrixXd& E) { return MatrixXd(U.cwiseAbs() * E * inverse.cwiseAbs()).norm(); };
  const double by_s = size(A.bottomLeftCorner(w, w)), by_v = size(A.bottomRightCorner(w, w));
  const double rate = std::max(std::sqrt(by_s), by_v);
  if (!(rate > 0)) return 0;
  return std::max(bound(d.acceleration_s.error) / (rate * rate), bound(d.acceleration_v.error) / rate);
}

ModeShape make_shape(const System& system, const Scaling& scaling, const State& state, const VectorXd& real,
                     const VectorXd& imaginary) {
  const std::vector<NamedCoordinate> re = measure_rates(system, state, real);
  const std::vector<NamedCoordinate> im = measure_rates(system, state, imaginary);
  ModeShape shape;
  double largest = 0;
  for (std::size_t i = 0; i < re.size(); ++i) {
    shape.value.emplace_back(re[i].value, im[i].value);
    const bool angular = re[i].unit == NamedCoordinate::Unit::kRadian;
    const double part = std::abs(shape.value.back()) * (angular ? scaling.length_m : 1);
    if (part <= largest * (1 + kEqual)) continue;  // of equal parts the first of the file
    largest = part;
    shape.largest = static_cast<int>(i);
  }
  if (!(largest > 0)) return shape;
  const std::complex<double> unit = shape.value[static_cast<std::size_t>(shape.largest)];
  for (std::complex<double>& value : shape.value) value /= unit;
  return shape;
}

void add_shapes(const System& system, const Scaling& scaling, Linearization& out) {
  out.joint_coordinates = measure_rates(system, out.state, out.state.v);
  for (const Mode& mode : out.modal.modes) {
    out.shapes.push_back(make_shape(system, scaling, out.state, out.N * mode.shape.real(), out.N * mode.shape.imag()));
  }
}

void fail(LinearizationStatus status, std::string message, Linearization& out) {
  out.status = status;
  out.message = std::move(message);
}

// A without the entries that are nothing but the error of their difference: a zero must not become a frequency.
MatrixXd without_noise(const ReducedDerivatives& d, MatrixXd A) {
  const long w = A.rows() / 2;
  const auto clean = [](const MatrixXd& error, auto block) {
    block =
        (block.cwiseAbs().array() <= kNoise * error.array()).select(MatrixXd::Zero(error.rows(), error.cols()), block);
  };
  clean(d.acceleration_s.error, A.bottomLeftCorner(w, w));
  clean(d.acceleration_v.error, A.bottomRightCorner(w, w));
  return A;
}

void add_matrices(const DynamicsModel& model, const ReducedMotion& motion, const ReducedDerivatives& d,
                  const VectorXd& z, Linearization& out) {
  const long w = motion.w();
  out.M = motion.M();
  out.N = motion.N();
  out.K = {-d.force_s.value, d.force_s.error};
  out.C = {-d.force_v.value, d.force_v.error};
  out.A = MatrixXd::Zero(2 * w, 2 * w);
  out.A.topLeftCorner(w, w) = turning(*model.system, out.state.v, out.N, out.selection.independent);
  out.A.topRightCorner(w, w).setIdentity();
  out.A.bottomLeftCorner(w, w) = d.acceleration_s.value;
  out.A.bottomRightCorner(w, w) = d.acceleration_v.value;
  out.B = MatrixXd::Zero(2 * w, static_cast<long>(out.inputs.size()));
  if (w > 0) out.B.bottomRows(w) = out.M.llt().solve(MatrixXd(motion.B()(Eigen::all, acting_drives(model))));
  out.drift.resize(2 * w);
  out.drift << out.state.v(out.selection.independent), z;
  if (w > 0) out.relative_error = estimate_error(out.M, d, out.A);
}

}  // namespace

Linearization linearize(const DynamicsModel& model, const State& state) {
  const System& system = *model.system;
  const Scaling& scaling = system.scaling;
  Linearization out;
  out.state = state;
  for (const int i : acting_drives(model)) out.inputs.push_back(model.drives[static_cast<std::size_t>(i)].name);
  if (!model.unsupported.empty()) {
    fail(LinearizationStatus::kUnsupported, "not supported: " + model.unsupported.front(), out);
    return out;
  }
  if (!system.velocity_rows.empty()) {
    fail(LinearizationStatus::kUnsupported,
         "not supported: constraint '" + system.row_names[static_cast<std::size_t>(system.velocity_rows.front())] +
             "' on velocities, beside which positions vary that no velocity reaches",
         out);
    return out;
  }
  if (system.knows_time) {
    fail(LinearizationStatus::kUnsupported,
         "not supported: a constraint moves by itself, so that no system with fixed coefficients describes the motion",
         out);
    return out;
  }
  Equations eq = make_equations(model);
  compute_kinematics(model, state, eq);
  RankDecision decision;
  out.selection = select_independent(system, scaling, eq.constraints, &decision);
  if (!decision.confident) out.notices.push_back(doubtful_rank_notice(state.t, decision));
  ReducedMotion motion(model, scaling, state, out.selection);
  out.coordinates = name_independent(system, out.selection, state.v);
  VectorXd z;
  if (!motion.accelerations(z)) {
    fail(LinearizationStatus::kSingularMass, "some motion has no inertia: the mass matrix is singular", out);
    return out;
  }
  const ReducedDerivatives d = compute_reduced_derivatives(motion, scaling.length_m);
  if (!d.valid) {
    fail(LinearizationStatus::kSingularPose,
         "this pose is singular: the motions through it have no linear system in independent coordinates", out);
    return out;
  }
  add_matrices(model, motion, d, z, out);
  const double force = motion.force_scale(state);
  const StabilityVerdict verdict = judge_stability(out.K, motion.body_displacements(), out.M, force, scaling.length_m);
  out.at_rest = state.v.isZero(0);
  out.is_equilibrium = out.at_rest && is_balanced(motion, verdict, force, scaling.length_m);
  if (out.is_equilibrium) {
    out.stability = verdict;
    out.modal = analyze_modes_at_rest(out.M, out.K, out.C, out.stability.neutral, out.stability.unstable);
  } else {
    out.modal = analyze_modes(out.M, without_noise(d, out.A));
  }
  add_shapes(system, scaling, out);
  if (!model.frictions.empty()) out.notices.emplace_back("dry friction is left out: it has no linear law");
  return out;
}

}  // namespace ferrers
