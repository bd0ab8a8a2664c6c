#include "ferrers/dynamics/equilibrium.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "ferrers/dynamics/named_coordinates.h"
#include "ferrers/kinematics/assembly.h"
#include "ferrers/math/rank.h"
#include "ferrers/redundancy/rank_notice.h"

namespace ferrers {
namespace {

constexpr double kLongestStep = 0.3;    // of the body that moves most: rad or characteristic lengths
constexpr double kBlindStep = 0.05;     // the same where there is no stiffness matrix
constexpr double kFloor = 1e-6;         // least stiffness to divide by, of the scale
constexpr double kSettledPart = 1e-11;  // Newton steps this small, in characteristic lengths, are none
constexpr double kRoundings = 64 * std::numeric_limits<double>::epsilon();
constexpr double kSingularRest = 1e-7;  // of all forces: loops that close to rounding leave its root open there
constexpr double kOvershoot = 0.5;      // share of the first force that may act against the end of a step
constexpr int kMostTrials = 14, kMostPolishing = 4;

// The principal directions of the stiffness at one pose, and the forces along them.
struct Directions {
  VectorXd stiffness, force;
  MatrixXd shape;  // of unit displacement of the bodies
  double scale_N = 0;
};

class Search {
 public:
  Search(const DynamicsModel& model, const State& start, const EquilibriumOptions& options)
      : model_(model), system_(*model.system), scaling_(system_.scaling), options_(options) {
    result_.state = start;
    result_.state.v.setZero();
    result_.state.t = options.t;
  }

  EquilibriumResult run() {
    for (result_.steps = 0; result_.steps < options_.max_iterations; ++result_.steps) {
      std::optional<ReducedMotion> motion(decide());
      ReducedDerivatives derivatives = compute_reduced_stiffness(*motion, scaling_.length_m);
      if (!derivatives.valid && last_.rows.size() > motion->selection().rows.size()) {
        keep_rank(motion, derivatives);
      }
      if (derivatives.valid) last_ = motion->selection();
      const Directions at = derivatives.valid ? principal(*motion, derivatives) : blind(*motion);
      if (is_at_rest(at, derivatives.valid)) {
        finish(*motion, derivatives);
        return std::move(result_);
      }
      if (!(derivatives.valid ? step(*motion, at, derivatives) : false) && !blind_step(*motion)) break;
    }
    fail();
    return std::move(result_);
  }

 private:
  ReducedMotion decide() {
    Equations eq = make_equations(model_);
    compute_kinematics(model_, result_.state, eq);
    const Selection selection = select_independent(system_, scaling_, eq.constraints, &decision_);
    if (result_.steps == 0) first_decision_ = decision_;
    return ReducedMotion(model_, scaling_, result_.state, selection);
  }

  // Close to a singular pose with the rank of the way there: the branch that it is on has coordinates.
  void keep_rank(std::optional<ReducedMotion>& motion, ReducedDerivatives& derivatives) {
    const Selection selection = reselect(system_, scaling_, motion->equations().constraints, last_);
    ReducedMotion other(model_, scaling_, result_.state, selection);
    const ReducedDerivatives found = compute_reduced_stiffness(other, scaling_.length_m);
    if (!found.valid) return;
    derivatives = found;
    motion.emplace(std::move(other));
  }

  Directions principal(const ReducedMotion& motion, const ReducedDerivatives& derivatives) const {
    Directions at;
    if (motion.w() == 0) return at;
    const MatrixXd X = motion.body_displacements(), K = -derivatives.force_s.value;
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(0.5 * (K + K.transpose()), X.transpose() * X);
    at.stiffness = solver.eigenvalues();
    at.shape = solver.eigenvectors();
    at.force = at.shape.transpose() * motion.force();
    const double force = motion.force_scale(motion.base());
    at.scale_N = std::max(force, at.stiffness.cwiseAbs().maxCoeff() * scaling_.length_m);
    return at;
  }

  // Where motions have no coordinates: forces only.
  Directions blind(const ReducedMotion& motion) const {
    Directions at;
    const MatrixXd X = motion.body_displacements();
    const Eigen::LLT<MatrixXd> metric(X.transpose() * X);
    at.stiffness = VectorXd::Zero(motion.w());
    at.shape = metric.matrixU().solve(MatrixXd::Identity(motion.w(), motion.w()));
    at.force = at.shape.transpose() * motion.force();
    at.scale_N = motion.force_scale(motion.base());
    return at;
  }

  bool is_at_rest(const Directions& at, bool regular) {
    const double rounding = regular ? kRoundings : kSingularRest;
    result_.residual_N = at.force.size() > 0 ? at.force.norm() : 0;
    for (long k = 0; k < at.force.size(); ++k) {
      const double settled = kSettledPart * scaling_.length_m * std::abs(at.stiffness[k]);
      if (!(std::abs(at.force[k]) <= settled + rounding * at.scale_N)) return false;
    }
    return true;
  }

  bool step(ReducedMotion& motion, const Directions& at, const ReducedDerivatives& derivatives) {
    const double floor = kFloor * at.scale_N / scaling_.length_m;
    const VectorXd along = at.force.cwiseQuotient(at.stiffness.cwiseAbs().cwiseMax(floor));
    VectorXd ds = at.shape * along;
    const bool resisted = (at.stiffness.array() > floor).all();
    if (resisted) ds = derivatives.force_s.value.partialPivLu().solve(VectorXd(-motion.force()));  // Newton's
    const double reach = largest_displacement(motion.body_displacements() * ds) / scaling_.length_m;
    double share = reach > kLongestStep ? kLongestStep / reach : 1;
    const double downhill = motion.force().dot(ds);
    const VectorXd none = VectorXd::Zero(motion.w());
    for (int trial = 0; trial < kMostTrials; ++trial) {
      State next;
      if (!motion.move(share * ds, none, next)) {
        share /= 4;
        continue;
      }
      motion.evaluate(next);
      const double left = motion.force().dot(ds);
      if (left >= -kOvershoot * downhill) {
        result_.state = next;
        return true;
      }
      share *= std::clamp(downhill / (downhill - left), 0.1, 0.7);
    }
    return false;
  }

  // A short way where the forces point, closed with all rows.
  bool blind_step(ReducedMotion& motion) {
    if (++blind_steps_ > kMostTrials) return false;
    motion.evaluate(motion.base());
    const MatrixXd X = motion.body_displacements();
    const VectorXd ds = (X.transpose() * X).llt().solve(motion.force());
    const double reach = largest_displacement(X * ds) / scaling_.length_m;
    if (!(reach > 0)) return false;
    State next = motion.base();
    displace(system_, kBlindStep / reach * (motion.N() * ds), next.q);
    int iterations = 0;
    if (!(close_loops(system_, scaling_, {}, 100, next, iterations) <= closed_tolerance(scaling_))) return false;
    result_.state = next;
    return true;
  }

  // Newton's steps with the whole stiffness matrix, as long as they help.
  void polish(ReducedMotion& motion, const ReducedDerivatives& derivatives) {
    if (!derivatives.valid || motion.w() == 0) return;
    const VectorXd none = VectorXd::Zero(motion.w());
    VectorXd ds = none;
    double before = motion.force().norm();
    for (int i = 0; i < kMostPolishing && before > 0; ++i) {
      const VectorXd trial = ds + solve_least_norm(-derivatives.force_s.value, motion.force()).x;
      State next;
      if (!motion.move(trial, none, next)) break;
      motion.evaluate(next);
      const double now = motion.force().norm();
      if (!(now < before)) break;
      ds = trial;
      before = now;
      result_.state = next;
    }
  }

  void finish(ReducedMotion& motion, const ReducedDerivatives& derivatives) {
    polish(motion, derivatives);
    motion.evaluate(result_.state);
    result_.selection = motion.selection();
    result_.u = motion.equations().u;
    result_.lambda = motion.rest_multipliers(motion.equations().force);
    result_.energy = compute_energy(model_, result_.state, motion.equations().pos, motion.equations().vel);
    result_.force_scale_N = motion.force_scale(result_.state);
    if (derivatives.valid && !moves_by_itself(motion.equations().constraints)) {
      result_.stiffness = {-derivatives.force_s.value, derivatives.force_s.error};
      result_.stability = judge_stability(result_.stiffness, motion.body_displacements(), motion.M(),
                                          result_.force_scale_N, scaling_.length_m);
    }
    tell_doubt();
    for (std::string& notice : passed_limits(system_, result_.state)) result_.notices.push_back(std::move(notice));
    tell_moving_constraint(motion.equations().constraints);
    if (!model_.frictions.empty())
      result_.notices.emplace_back("dry friction is left out: it may hold other poses too");
  }

  // A constraint that moves by itself: the forces balance, but the pose does not stay.
  void tell_moving_constraint(const ConstraintKinematics& constraints) {
    if (!moves_by_itself(constraints)) return;
    long row = 0;
    constraints.nu.head(system_.m).cwiseAbs().maxCoeff(&row);
    result_.notices.push_back(
        "constraint '" + system_.row_names[static_cast<std::size_t>(row)] +
        "' moves by itself at this time: forces balance as if it stood still; whether the pose is "
        "stable is not told");
  }
  bool moves_by_itself(const ConstraintKinematics& constraints) const {
    return !constraints.nu.head(system_.m).isZero(0);
  }

  // The first decision tells what could move at all, the last one what is at rest.
  void tell_doubt() {
    const RankDecision& told = decision_.confident ? first_decision_ : decision_;
    if (!told.confident) result_.notices.push_back(doubtful_rank_notice(result_.state.t, told));
  }

  void fail() {
    ReducedMotion motion = decide();
    tell_doubt();
    result_.status = EquilibriumStatus::kNotFound;
    result_.selection = motion.selection();
    result_.u = motion.equations().u;
    result_.lambda = VectorXd::Zero(system_.m);
    result_.energy = compute_energy(model_, result_.state, motion.equations().pos, motion.equations().vel);
    result_.force_scale_N = motion.force_scale(result_.state);
    VectorXd z;
    result_.message = "no equilibrium was found in " + std::to_string(result_.steps) + " steps";
    if (motion.accelerations(z)) {
      result_.message +=
          "; still accelerating: " + name_motion(system_, scaling_, result_.state, motion.N() * z, "/s²");
    }
  }

  const DynamicsModel& model_;
  const System& system_;
  Scaling scaling_;
  EquilibriumOptions options_;
  EquilibriumResult result_;
  RankDecision first_decision_, decision_;  ///< Of the constraints, at the start and at the pose decided on last.
  Selection last_;                          ///< Of the last pose that was not singular.
  int blind_steps_ = 0;
};

}  // namespace

EquilibriumResult solve_equilibrium(const DynamicsModel& model, const State& start, const EquilibriumOptions& options) {
  EquilibriumResult result;
  result.status = EquilibriumStatus::kUnsupported;
  result.state = start;
  if (!model.unsupported.empty()) {
    result.message = "not supported: " + model.unsupported.front();
    return result;
  }
  if (!model.system->velocity_rows.empty()) {
    result.message = "not supported: which poses the constraint '" +
                     model.system->row_names[static_cast<std::size_t>(model.system->velocity_rows.front())] +
                     "' on velocities lets it come to rest in depends on the way there";
    return result;
  }
  result = Search(model, start, options).run();
  if (result.status == EquilibriumStatus::kFound && !std::isfinite(result.energy.total())) {
    result.status = EquilibriumStatus::kNotFound;
    result.message = "the energy has no finite value in the pose that was found";
  }
  return result;
}

std::vector<std::string> passed_limits(const System& system, const State& state) {
  std::vector<std::string> notices;
  const std::vector<NamedCoordinate> positions = measure_positions(system, state);
  for (const Joint& joint : system.model->joints()) {
    if (!joint.limits) continue;
    for (const NamedCoordinate& one : positions) {
      if (one.name.rfind(joint.name + ".", 0) != 0) continue;
      if (one.value < (*joint.limits)[0] || one.value > (*joint.limits)[1]) {
        notices.push_back("joint '" + joint.name + "' is outside of its limits there");
      }
    }
  }
  return notices;
}

}  // namespace ferrers
