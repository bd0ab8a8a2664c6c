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

// Golden section until the bracket is `width` wide.
void narrow(Track& track, int rank, double width, double& a, double& b) {
  constexpr double kGolden = 0.6180339887498949;
  double left = b - kGolden * (b - a), right = a + kGolden * (b - a);
  double at_left = track.smallest_kept(left, rank), at_right = track.smallest_kept(right, rank);
  while (b - a > width) {
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
}

// In a narrow bracket both flanks are straight: where they meet, with an error that squares each time.
void meet_flanks(Track& track, int rank, double step, double& a, double& b) {
  for (int i = 0; i < 4; ++i) {
    const double at_a = track.smallest_kept(a, rank), at_b = track.smallest_kept(b, rank);
    const double t = at_a + at_b > 0 ? a + (b - a) * at_a / (at_a + at_b) : 0.5 * (a + b);
    const double reach = std::max(4 * (b - a) * (b - a) / step, 1e-12 * step);
    a = t - reach;
    b = t + reach;
  }
}

std::optional<SingularPose> judge(const System& system, Track& track, double t, int rank) {
  const RankDecision decision = analyze_rank(track.jacobian(t), 1.0).decision;
  if (!decision.confident || decision.rank >= rank) return std::nullopt;
  const int all_rows = system.topology->joint_rows;
  return SingularPose{.t = t,
                      .rank = decision.rank,
                      .rank_around = rank,
                      .mobility = system.nv - decision.rank,
                      .redundant = system.m - decision.rank,
                      .all_rank = all_rows - (system.m - decision.rank),
                      .all_rank_around = all_rows - (system.m - rank)};
}

}  // namespace

std::optional<SingularPose> find_singular_pose(const System& system, const Scaling& scaling, const Hermite& step,
                                               int rank) {
  if (rank == 0) return std::nullopt;
  Track track(system, scaling, step);
  const double h = step.to.t - step.from.t;
  double a = step.from.t, b = step.to.t;
  narrow(track, rank, 0.02 * h, a, b);
  double from = a, to = b;
  meet_flanks(track, rank, h, from, to);
  if (const auto pose = judge(system, track, 0.5 * (from + to), rank)) return pose;
  narrow(track, rank, 1e-11 * h, a, b);
  return judge(system, track, 0.5 * (a + b), rank);
}

}  // namespace ferrers
