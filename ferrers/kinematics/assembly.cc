#include "ferrers/kinematics/assembly.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <random>

#include "ferrers/kinematics/constraint_blocks.h"
#include "ferrers/kinematics/coordinates.h"
#include "ferrers/kinematics/initial_values.h"
#include "ferrers/math/damped_step.h"
#include "ferrers/math/rotation.h"

namespace ferrers {
namespace {

constexpr std::size_t kLargestDense = 200;  // free coordinates; above, steps are solved sparsely

// Everything that an iteration needs, so that restarts share it.
class Closer {
 public:
  Closer(const System& system, const Scaling& scaling, const std::vector<int>& held)
      : system_(system),
        scaling_(scaling),
        place_(static_cast<std::size_t>(system.nv), 0),
        pos_(make_position_kinematics(system)),
        rest_(make_velocity_kinematics(system)),
        constraints_(make_constraint_blocks(system)) {
    for (std::size_t b = 0; b < constraints_.blocks.size(); ++b) {
      const auto& rows = system.velocity_rows;
      if (std::find(rows.begin(), rows.end(), constraints_.blocks[b].row) != rows.end()) velocity_blocks_.push_back(b);
    }
    for (const int v : held) place_[v] = -1;
    for (int v = 0; v < system.nv; ++v) {
      if (place_[v] < 0) continue;
      place_[v] = static_cast<int>(free_.size());
      free_.push_back(v);
    }
  }

  double evaluate(State& state) {
    compute_positions(system_, state.q, pos_);
    compute_constraint_blocks(system_, state, pos_, constraints_);
    for (const int b : velocity_blocks_) constraints_.blocks[b].G.setZero();  // they hold no position
    residual_ = constraints_.phi.cwiseProduct(scaling_.rows);
    return residual_.size() > 0 ? residual_.norm() : 0.0;
  }

  double run(int max_iterations, State& state, int& iterations) {
    const double floor = 1e-16 * scaling_.length_m;
    double norm = evaluate(state);
    double damping = 1;
    for (int i = 0; i < max_iterations && norm > floor && !free_.empty(); ++i, ++iterations) {
      const VectorXd step = solve_step(damping * norm);
      State trial = state;
      displace(system_, step, trial.q);
      const double trial_norm = evaluate(trial);
      if (trial_norm < norm) {
        accept_winding(system_, pos_, trial);
        state = trial;
        const bool stalled = norm < closed_tolerance(scaling_) && trial_norm > 0.5 * norm;
        norm = trial_norm;
        damping = std::max(damping / 8, 1e-3);
        if (stalled) break;
        continue;
      }
      evaluate(state);
      if (norm < closed_tolerance(scaling_) || damping > 1e12) break;
      damping *= 8;
    }
    return largest();
  }

  bool any_flipped() const {
    for (const CutJoint& cut : system_.cuts) {
      if (is_flipped(*cut.type, compute_relative_motion(cut.frames, pos_, rest_))) return true;
    }
    return false;
  }

  double largest() const { return residual_.size() > 0 ? residual_.cwiseAbs().maxCoeff() : 0.0; }
  const ConstraintBlocks& constraints() const { return constraints_; }
  const std::vector<int>& free_coordinates() const { return free_; }

 private:
  // min |J x + r|² + μ² |x|².
  VectorXd solve_step(double mu) {
    mu = std::max(mu / scaling_.length_m, 1e-9);
    VectorXd x = free_.size() <= kLargestDense ? solve_dense(mu) : solve_sparse(std::max(mu, 1e-7));
    const double limit = 0.3 * scaling_.length_m;  // about 0.3 rad
    const double size = x.cwiseAbs().maxCoeff();
    if (size > limit) x *= limit / size;
    VectorXd step = VectorXd::Zero(system_.nv);
    for (std::size_t k = 0; k < free_.size(); ++k) {
      step[free_[k]] = x[static_cast<long>(k)] * scaling_.columns[free_[k]];
    }
    return step;
  }

  // Calls use(row, free coordinate, entry of J).
  template <typename Use>
  void for_entries(Use use) const {
    for (const ConstraintBlock& block : constraints_.blocks) {
      for (std::size_t k = 0; k < block.columns.size(); ++k) {
        const int column = block.columns[k];
        if (place_[column] < 0) continue;
        for (long i = 0; i < block.G.rows(); ++i) {
          const int row = block.row + static_cast<int>(i);
          use(row, place_[column], block.G(i, static_cast<long>(k)) * scaling_.rows[row] * scaling_.columns[column]);
        }
      }
    }
  }

  VectorXd solve_dense(double mu) const {
    MatrixXd J = MatrixXd::Zero(residual_.size(), static_cast<long>(free_.size()));
    for_entries([&](int row, int column, double value) { J(row, column) += value; });
    return compute_damped_step(J, residual_, mu);
  }

  // By the normal equations, whose error the next iteration takes away.
  VectorXd solve_sparse(double mu) const {
    const long m = residual_.size(), n = static_cast<long>(free_.size());
    std::vector<Eigen::Triplet<double>> entries;
    for_entries([&](int row, int column, double value) { entries.emplace_back(row, column, value); });
    Eigen::SparseMatrix<double> J(m, n), identity(n, n);
    J.setFromTriplets(entries.begin(), entries.end());
    identity.setIdentity();
    const Eigen::SparseMatrix<double> normal = Eigen::SparseMatrix<double>(J.transpose() * J) + mu * mu * identity;
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(normal);
    return solver.solve(J.transpose() * -residual_);
  }

  const System& system_;
  const Scaling& scaling_;
  std::vector<int> free_, place_;  ///< Free coordinates, and where a coordinate stands among them (−1: held).
  PositionKinematics pos_;
  VelocityKinematics rest_;
  ConstraintBlocks constraints_;
  std::vector<std::size_t> velocity_blocks_;
  VectorXd residual_;
};

// By how much the second frame is turned off what the joint allows. Rows tell no more than sines.
double angle_off(const JointTypeInfo& type, const RelativeMotion& m, double sine) {
  int moments = 0;
  for (const int component : type.row_components) moments += component >= 3 ? 1 : 0;
  if (moments == 3) return rotation_log(m.R_F.transpose() * m.R_M).norm();
  if (moments == 2) {
    const Eigen::Vector3d a = m.R_F.col(2), b = m.R_M.col(2);
    return std::atan2(a.cross(b).norm(), a.dot(b));
  }
  return std::asin(std::min(1.0, sine));
}

std::vector<OpenJoint> find_open_joints(const System& system, const Scaling& scaling, const State& state,
                                        const VectorXd& phi) {
  std::vector<OpenJoint> open;
  const double tolerance = closed_tolerance(scaling);
  PositionKinematics pos = make_position_kinematics(system);
  const VelocityKinematics rest = make_velocity_kinematics(system);
  compute_positions(system, state.q, pos);
  for (const CutJoint& cut : system.cuts) {
    OpenJoint joint{system.joint(cut).name, 0, 0};
    for (int i = 0; i < cut.type->row_count(); ++i) {
      const double value = phi[cut.row + i];
      double& part = cut.type->row_components[i] >= 3 ? joint.angle_rad : joint.gap_m;
      part = std::hypot(part, value);
    }
    const RelativeMotion motion = compute_relative_motion(cut.frames, pos, rest);
    if (joint.angle_rad * scaling.length_m > tolerance || is_flipped(*cut.type, motion)) {
      joint.angle_rad = angle_off(*cut.type, motion, joint.angle_rad);
    }
    if (std::max(joint.gap_m, joint.angle_rad * scaling.length_m) > tolerance) open.push_back(joint);
  }
  for (const CouplingRow& row : system.couplings) {
    const double value = std::abs(phi[row.row]);
    if (value * scaling.rows[row.row] > tolerance) open.push_back({system.row_names[row.row], 0, value});
  }
  const auto size = [&](const OpenJoint& j) { return std::max(j.gap_m, j.angle_rad * scaling.length_m); };
  std::stable_sort(open.begin(), open.end(), [&](const auto& a, const auto& b) { return size(a) > size(b); });
  return open;
}

// Tries again from kicked starts; keeps the best. True when it closes the right way round.
bool close_with_kicks(const System& system, const AssemblyOptions& options, Closer& closer, const Scaling& scaling,
                      State& state, int& iterations) {
  const State start = state;
  std::mt19937 random(options.seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  double best = INFINITY;
  State best_state = state;
  for (int attempt = 0; attempt <= options.attempts; ++attempt) {
    State trial = start;
    if (attempt > 0) {
      VectorXd kick = VectorXd::Zero(system.nv);
      const double size = 0.05 * attempt * scaling.length_m;
      for (const int v : closer.free_coordinates()) kick[v] = size * uniform(random) * scaling.columns[v];
      displace(system, kick, trial.q);
    }
    const double residual = closer.run(options.max_iterations, trial, iterations);
    const bool flipped = closer.any_flipped();
    if (residual <= closed_tolerance(scaling) && !flipped) {
      state = trial;
      return true;
    }
    if (residual < best && !flipped) {
      best = residual;
      best_state = trial;
    }
  }
  state = best_state;
  return false;
}

std::string open_message(const std::vector<OpenJoint>& open, bool inconsistent) {
  std::string text = inconsistent ? "the initial positions given as exact contradict each other or the loops"
                                  : "the loops cannot be closed";
  if (!open.empty()) {
    text += ": joint '" + open.front().name + "' stays open";
    if (open.size() > 1) text += ", and " + std::to_string(open.size() - 1) + " more";
  }
  return text;
}

}  // namespace

double closed_tolerance(const Scaling& scaling) { return 1e-10 * scaling.length_m; }

double close_loops(const System& system, const Scaling& scaling, const std::vector<int>& held, int max_iterations,
                   State& state, int& iterations) {
  Closer closer(system, scaling, held);
  const double residual = closer.run(max_iterations, state, iterations);
  return closer.any_flipped() ? std::max(residual, scaling.length_m) : residual;
}

AssemblyResult assemble(const System& system, const AssemblyOptions& options) {
  AssemblyResult result;
  const Scaling& scaling = system.scaling;
  InitialValues initial = options.use_initial ? read_initial_values(system) : InitialValues();
  result.state = make_drawn_state(system);
  result.state.t = options.t;
  initial.apply_guesses(system, result.state);

  // Held coordinates walk to their values, the loops following, so that the branch is the drawn one.
  Closer closer(system, scaling, initial.held);
  const int steps = initial.steps(scaling, result.state);
  const State start = result.state;
  bool closed = true;
  for (int i = 1; i <= steps && closed; ++i) {
    initial.apply_exact(start, static_cast<double>(i) / steps, result.state);
    if (i < steps) closer.run(40, result.state, result.iterations);
  }
  closed = close_with_kicks(system, options, closer, scaling, result.state, result.iterations);
  closed = closed && initial.meet_cut_targets(system, scaling, result.state, result.iterations);
  result.residual = closer.evaluate(result.state);
  result.residual = closer.largest();
  result.state.v.setZero();
  if (closed) {
    result.status = AssemblyStatus::kAssembled;
    return result;
  }
  result.open_joints = find_open_joints(system, scaling, result.state, closer.constraints().phi);
  result.status = AssemblyStatus::kOpen;
  if (initial.any_exact()) {  // would it close without them?
    AssemblyOptions without = options;
    without.use_initial = false;
    const AssemblyResult drawn = assemble(system, without);
    if (drawn.status == AssemblyStatus::kAssembled) result.status = AssemblyStatus::kInconsistentInitial;
  }
  result.message = open_message(result.open_joints, result.status == AssemblyStatus::kInconsistentInitial);
  return result;
}

}  // namespace ferrers
