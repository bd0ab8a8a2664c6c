#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ferrers/dynamics/reactions.h"
#include "ferrers/kinematics/joint_wrenches.h"

/// Problem: dry friction in joints depends on the reactions, which depend on the friction.
///
/// Given: the equations at a state and joints with `friction: {coulomb, radius}`. Every such joint is one contact whose
/// parts slide with the slip s: its free translations, m/s, and its free rotations times the radius r at which the
/// parts touch (point_on_line and point_on_plane touch at the point itself: only translations count). Friction is
/// opposite to the slip, with the regularised law of Coulomb
///
///   f = −mu N tanh(|s| / s_0) s/|s|,     N = |F| + |M| / r,
///
/// F and M: force and moment of the constraint. M counts where the joint slides and r is given (a carriage of that
/// reach; a bearing's span is not known, so that bending does not add to a bearing's friction). So a revolute brakes
/// with mu r |F|, a block on a line with mu |F|. s_0 is 1e-3 m/s where the joint slides, r · 1e-3 rad/s where it only
/// turns: what sticks creeps at less than that.
/// Wanted: f (nf components along the slips), accelerations and multipliers with
///
///   M vdot + h = tau + B u + Cᵀ f + G_rᵀ lambda,   G_r vdot = gamma_r,   C: nf × nv, rows ∂s/∂v.
///
/// Reactions are linear in f, so that f solves nf equations; Newton's method from f = 0 to rounding, with smaller mu
/// first where that fails: the solution found is the one that grows out of frictionless motion as mu grows. Where there
/// is none (jamming, after Painlevé), that is said. Where N is not unique the motion itself is not
/// [fraczek2011]: such joints are named, unless joint stiffness divides the reactions (redundancy/distribution.h).
/// Cost: one evaluation, O(nf n²) for the linear dependence, O(nf³) per iteration.
namespace ferrers {

constexpr int kMostSlips = 6;
constexpr double kSlipSpeed = 1e-3;  ///< s_0 of joints that slide, m/s.
constexpr double kSlipRate = 1e-3;   ///< s_0 / r of joints that only turn, rad/s.

/// Fills how a joint slips and what presses it. Returns why it cannot have dry friction, or an empty text.
std::string find_slips(const Joint& joint, BoundFriction& friction);

/// Wrenches on the second body at p_M (moment, force, world) per unit of friction force along each slip; also the
/// gradients of the slip speeds: s = wrench · V_rel.
void compute_slip_wrenches(const BoundFriction& friction, const PositionKinematics& pos, Wrench* wrenches);

enum class FrictionStatus {
  kSolved,
  kUndetermined,  ///< Friction depends on a reaction that rigid bodies leave open: no result is valid.
  kJammed,        ///< No friction force agrees with the reactions that it causes: no result is valid.
};

/// A motion's accelerations, multipliers and drive efforts, one case per column: nv, m (or more rows), nu.
struct MotionCases {
  MatrixXd vdot, lambda, u;
};

class FrictionSolver {
 public:
  explicit FrictionSolver(std::shared_ptr<const DynamicsModel> model, const DistributionOptions& options = {});

  bool any() const { return !model_->frictions.empty(); }

  /// After `solver.solve(eq, result)`, which was solved without friction: adds friction to `eq` (friction, tau, force)
  /// and to the result. `selection`: of the system's own rows, without driven ones, of the same decision as the
  /// solver's; which reactions are unique is judged anew when its rows change.
  FrictionStatus solve(const State& state, Equations& eq, const Selection& selection, ForwardSolver& solver,
                       ForwardResult& result);

  /// The same for any motion that is linear in the friction: `base` without it, `changes` per unit of each component.
  /// Fills `eq.friction` and `eq.tau`; what else changes is `changes` times `eq.friction`.
  FrictionStatus solve(const State& state, Equations& eq, const Selection& selection, const MotionCases& base,
                       const MotionCases& changes);

  /// ∂s/∂v at `eq`, nf × nv.
  const RowMatrixXd& slip_rows(const Equations& eq);

  /// After kSolved: power of all dry friction, W; never positive.
  double power() const { return slip_speeds_.dot(friction_); }
  /// What a status other than kSolved means, with the joints' names.
  const std::string& message() const { return message_; }

 private:
  void measure_slips(const Equations& eq);
  MatrixXd pressing_loads(const State& state, const Equations& eq, const Selection& selection, const MotionCases& base,
                          const MotionCases& changes);
  bool settle(const MatrixXd& loads, double share);
  bool settle_step_by_step(const MatrixXd& loads);
  std::string names(const std::vector<bool>& which) const;

  std::shared_ptr<const DynamicsModel> model_;
  Scaling scaling_;
  AllRows rows_;
  JointSprings springs_;
  std::vector<int> judged_rows_;  ///< The selection that `undetermined_` belongs to.
  bool judged_ = false;
  std::vector<bool> undetermined_;  ///< Per friction.
  RowMatrixXd slip_rows_;
  VectorXd slip_speeds_, direction_;  ///< nf: s; mu tanh(|s|/s_0) s/|s|.
  VectorXd friction_;
  std::string message_;
};

}  // namespace ferrers
