#include "ferrers/simulate/singular_poses.h"

#include <cmath>

#include "ferrers/kinematics/assembly.h"
#include "ferrers/math/rank.h"

namespace ferrers {
namespace {

// Looks along a step.
class Track {
 public:
  Track(const System& system, const Scaling& scaling, const Hermite& step)
      : system_(system),
        scaling_(scaling),
        step_(step),
        state_(step.from),
        vdot_(step.from_vdot),
        pos_(make_position_kinematics(system)),
        rest_(make_velocity_kinematics(system)),
        constraints_(make_constraint_kinematics(system)) {}

  MatrixXd jacobian(double t) {
    step_.evaluate(system_, t, state_, vdot_);
    int iterations = 0;
    close_loops(system_, scaling_, {}, 5, state_, iterations);
    compute_positions(system_, state_.q, pos_);
    compute_constraints(system_, state_, pos_, rest_, constraints_);
    return scaling_.rows.asDiagonal() * constraints_.G * scaling_.columns.asDiagonal();
  }

  /// The smallest of the singular values that are kept elsewhere.
  double smallest_kept(double t, int rank) { return compute_singular_values(jacobian(t))[rank - 1]; }

 private:
  const System& system_;
  const Scaling& scaling_;
  const Hermite& step_;
  State state_;
  VectorXd vdot_;
  PositionKinematics pos_;
  VelocityKinematics rest_;
  ConstraintKinematics constraints_;
};

}  // namespace

std::optional<SingularPose> find_singular_pose(const System& system, const Scaling& scaling, const Hermite& step,
                                               int rank) {
  if (rank == 0) return std::nullopt;
  constexpr double kGolden = 0.6180339887498949;
  constexpr double kWidth = 1e-11;  // of the step
  Track track(system, scaling, step);
  double a = step.from.t, b = step.to.t;
  double left = b - kGolden * (b - a), right = a + kGolden * (b - a);
  double at_left = track.smallest_kept(left, rank), at_right = track.smallest_kept(right, rank);
  while (b - a > kWidth * (step.to.t - step.from.t)) {
    if (at_left < at_right) {
      b = right;
      right = left;
      at_right = at_left;
      left = b - kGolden * (b - a);
      at_left = track.smallest_kept(left, rank);
    } else {
      a = left;
      left = right;
      at_left = at_right;
      right = a + kGolden * (b - a);
      at_right = track.smallest_kept(right, rank);
    }
  }
  SingularPose pose;
  pose.t = 0.5 * (a + b);
  const RankDecision decision = analyze_rank(track.jacobian(pose.t), 1.0).decision;
  if (!decision.confident || decision.rank >= rank) return std::nullopt;
  pose.rank = decision.rank;
  pose.rank_around = rank;
  pose.mobility = system.nv - decision.rank;
  pose.redundant = system.m - decision.rank;
  return pose;
}

}  // namespace ferrers
