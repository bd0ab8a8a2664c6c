#include "ferrers/simulate/singular_poses.h"

#include <algorithm>

#include "ferrers/kinematics/assembly.h"
#include "ferrers/redundancy/cluster_rank.h"

namespace ferrers {
namespace {

constexpr double kAsGoodAsClosed = 1e-9;  // of the characteristic length; it blurs the decision

// Looks along a step.
class Track {
 public:
  Track(Evaluator& evaluator, const std::function<void(double, State&)>& state_at)
      : evaluator_(evaluator), state_at_(state_at), state_(make_drawn_state(evaluator.system())) {}

  double pivot(double t) {
    state_at_(t, state_);
    return evaluator_.evaluate(state_) == ForwardStatus::kSolved ? evaluator_.pivot() : 0.0;
  }

  RankDecision decide(double t) {
    const System& system = evaluator_.system();
    const Scaling& scaling = evaluator_.scaling();
    state_at_(t, state_);
    ConstraintBlocks blocks = compute_constraint_blocks(system, state_);
    const auto open = [&] {
      return blocks.phi.cwiseProduct(scaling.rows).lpNorm<Eigen::Infinity>() / scaling.length_m;
    };
    if (open() > kAsGoodAsClosed) {
      int iterations = 0;
      close_loops(system, scaling, {}, 5, state_, iterations);
      blocks = compute_constraint_blocks(system, state_);
    }
    return decide_clusters(system, scaling, blocks, open(), kLargestDenseInMotion).decision;
  }

 private:
  Evaluator& evaluator_;
  const std::function<void(double, State&)>& state_at_;
  State state_;
};

// Golden section until the bracket is `width` wide.
void narrow(Track& track, double width, double& a, double& b) {
  constexpr double kGolden = 0.6180339887498949;
  double left = b - kGolden * (b - a), right = a + kGolden * (b - a);
  double at_left = track.pivot(left), at_right = track.pivot(right);
  while (b - a > width) {
    if (at_left < at_right) {
      b = right;
      right = left;
      at_right = at_left;
      left = b - kGolden * (b - a);
      at_left = track.pivot(left);
    } else {
      a = left;
      left = right;
      at_left = at_right;
      right = a + kGolden * (b - a);
      at_right = track.pivot(right);
    }
  }
}

// In a narrow bracket both flanks are straight: where they meet, with an error that squares each time.
void meet_flanks(Track& track, double step, double& a, double& b) {
  for (int i = 0; i < 4; ++i) {
    const double at_a = track.pivot(a), at_b = track.pivot(b);
    const double t = at_a + at_b > 0 ? a + (b - a) * at_a / (at_a + at_b) : 0.5 * (a + b);
    const double reach = std::max(4 * (b - a) * (b - a) / step, 1e-12 * step);
    a = t - reach;
    b = t + reach;
  }
}

}  // namespace

std::optional<SingularPose> find_singular_pose(Evaluator& evaluator,
                                               const std::function<void(double, State&)>& state_at, double from,
                                               double to) {
  const System& system = evaluator.system();
  const int rank = static_cast<int>(evaluator.joint_selection().rows.size());
  if (rank == 0) return std::nullopt;
  Track track(evaluator, state_at);
  double a = from, b = to;
  narrow(track, 0.02 * (to - from), a, b);
  meet_flanks(track, to - from, a, b);
  const double t = 0.5 * (a + b);
  const RankDecision decision = track.decide(t);
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

}  // namespace ferrers
