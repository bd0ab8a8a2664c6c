#include "ferrers/redundancy/permanence.h"

#include <algorithm>
#include <random>

namespace ferrers {
namespace {

// One walk's work space.
class Walker {
 public:
  Walker(const System& system, unsigned seed)
      : system_(system),
        scaling_(make_scaling(system)),
        pos_(make_position_kinematics(system)),
        rest_(make_velocity_kinematics(system)),
        constraints_(make_constraint_kinematics(system)),
        random_(seed) {}

  /// Rank at a state.
  RankAnalysis analyze(const State& state) {
    compute_positions(system_, state.q, pos_);
    compute_constraints(system_, state, pos_, rest_, constraints_);
    return analyze_rank(scaling_.rows.asDiagonal() * constraints_.G * scaling_.columns.asDiagonal(), 1.0);
  }

  /// Moves `size` (rad, or characteristic lengths) along a random direction of the null space and closes the loops.
  bool move(const RankAnalysis& at, double size, State& state) {
    if (at.right_null.cols() == 0) return false;
    std::normal_distribution<double> normal;
    VectorXd weights(at.right_null.cols());
    for (double& weight : weights) weight = normal(random_);
    VectorXd direction = at.right_null * weights;
    direction *= size * scaling_.length_m / direction.cwiseAbs().maxCoeff();
    const State from = state;
    displace(system_, direction.cwiseProduct(scaling_.columns), state.q);
    int iterations = 0;
    const double residual = close_loops(system_, scaling_, {}, 60, state, iterations);
    if (residual > closed_tolerance(scaling_)) return false;
    return distance(from, state) > 0.3 * size;
  }

 private:
  // Largest motion of a scalar coordinate, in rad or characteristic lengths (quaternions count by their entries).
  double distance(const State& a, const State& b) const {
    double largest = 0;
    for (const Node& node : system_.nodes) {
      for (int k = 0; k < node.nq; ++k) {
        const bool scalar = node.nq == node.nv;
        const double unit = scalar ? scaling_.columns[node.v + k] * scaling_.length_m : 0.5;
        largest = std::max(largest, std::abs(a.q[node.q + k] - b.q[node.q + k]) / unit);
      }
    }
    return largest;
  }

  const System& system_;
  Scaling scaling_;
  PositionKinematics pos_;
  VelocityKinematics rest_;
  ConstraintKinematics constraints_;
  std::mt19937 random_;
};

Permanence judge(int redundant, std::optional<int> generic) {
  if (redundant == 0) return Permanence::kNone;
  if (!generic) return Permanence::kUnknown;
  if (*generic == 0) return Permanence::kConfiguration;
  return redundant > *generic ? Permanence::kMixed : Permanence::kPermanent;
}

bool holds_as_drawn_only(const Model& model) {
  return std::any_of(model.joints().begin(), model.joints().end(), [](const Joint& joint) {
    return joint.type == JointType::kGearMesh && joint.constants.mesh_holds_as_drawn_only;
  });
}

}  // namespace

std::string_view to_string(Permanence kind) {
  switch (kind) {
    case Permanence::kNone:
      return "none";
    case Permanence::kPermanent:
      return "permanent";
    case Permanence::kConfiguration:
      return "configuration";
    case Permanence::kMixed:
      return "mixed";
    case Permanence::kUnknown:
      break;
  }
  return "unknown";
}

PermanenceReport analyze_permanence(const System& system, const State& state, const RedundancyReport& report,
                                    const PermanenceOptions& options) {
  PermanenceReport out;
  if (holds_as_drawn_only(*system.model)) {
    if (report.redundant == 0) out.kind = Permanence::kNone;
    return out;
  }
  if (report.mobility == 0) {  // a structure has no other configuration
    out.generic_mobility = 0;
    out.generic_redundant = report.redundant;
    out.finite_mobility = 0;
    out.kind = judge(report.redundant, report.redundant);
    return out;
  }
  Walker walker(system, options.seed);
  const RankAnalysis start = walker.analyze(state);
  int largest_rank = -1;
  for (int attempt = 0; attempt < 3 * options.configurations && out.configurations < options.configurations;
       ++attempt) {
    State there = state;
    // Steps of several sizes: a far one may not close, a near one may look like the pose it came from.
    const double size = 0.35 / (1 + attempt % 3);
    if (!walker.move(start, size, there)) continue;
    State further = there;
    if (walker.move(walker.analyze(there), size, further)) there = further;
    const RankDecision decision = walker.analyze(there).decision;
    out.confident = out.confident && decision.confident;
    largest_rank = std::max(largest_rank, decision.rank);
    ++out.configurations;
  }
  if (largest_rank >= 0) {
    // Rank can only be lower at special poses; the given one counts too.
    largest_rank = std::max(largest_rank, report.closure_rank);
    out.generic_redundant = system.m - largest_rank;
    out.generic_mobility = system.nv - largest_rank;
    out.finite_mobility = out.generic_mobility;
  }
  out.kind = judge(report.redundant, out.generic_redundant);
  return out;
}

}  // namespace ferrers
