#include "ferrers/redundancy/large_motion.h"

#include <algorithm>
#include <random>

#include "ferrers/kinematics/assembly.h"
#include "ferrers/redundancy/cluster_rank.h"

namespace ferrers {
namespace {

constexpr int kMostDirections = 200;  // of a tangent space that is kept as a matrix

struct JudgedPose {
  State state;
  ClusterDecision decision;
};

class Walker {
 public:
  Walker(const System& system, const Scaling& scaling, int cluster, unsigned seed)
      : system_(system), scaling_(scaling), cluster_(cluster), random_(seed) {}

  JudgedPose judge(State state) const {
    ClusterDecision decision = decide_clusters(system_, scaling_, compute_constraint_blocks(system_, state));
    return {std::move(state), std::move(decision)};
  }
  const ClusterRank& rank_of(const JudgedPose& pose) const { return pose.decision.clusters[cluster_]; }
  int mobility(const JudgedPose& pose) const {
    return static_cast<int>(rank_of(pose).columns.size()) - rank_of(pose).rank;
  }
  int redundant(const JudgedPose& pose) const {
    return static_cast<int>(rank_of(pose).rows.size()) - rank_of(pose).rank;
  }

  /// A pose about `size` (rad, or characteristic lengths) away along the null space; nothing where none is reached.
  std::optional<JudgedPose> step(const JudgedPose& from, double size) {
    std::normal_distribution<double> normal;
    VectorXd weights(mobility(from));
    for (double& weight : weights) weight = normal(random_);
    const ClusterRank& cluster = rank_of(from);
    VectorXd x = cluster.elimination.null_vector(weights);
    x *= size * scaling_.length_m / x.cwiseAbs().maxCoeff();
    VectorXd whole = VectorXd::Zero(system_.nv);
    whole(cluster.columns) = x;
    State there = from.state;
    displace(system_, whole.cwiseProduct(scaling_.columns), there.q);
    int iterations = 0;
    if (close_loops(system_, scaling_, {}, 60, there, iterations) > closed_tolerance(scaling_)) return std::nullopt;
    const VectorXd moved = displacement(system_, scaling_, from.state.q, there.q);
    if (moved(cluster.columns).dot(x) < 0.3 * x.squaredNorm()) return std::nullopt;  // it fell back
    return judge(std::move(there));
  }

  MatrixXd tangent(const JudgedPose& pose) const {
    const ClusterRank& cluster = rank_of(pose);
    const int w = mobility(pose);
    MatrixXd out(static_cast<long>(cluster.columns.size()), std::min(w, kMostDirections));
    for (int k = 0; k < out.cols(); ++k)
      out.col(k) = cluster.elimination.null_vector(VectorXd::Unit(w, k)).normalized();
    return out;
  }

 private:
  const System& system_;
  const Scaling& scaling_;
  int cluster_;
  std::mt19937 random_;
};

}  // namespace

ClusterMotion analyze_large_motion(const System& system, const Scaling& scaling, const State& state, int cluster,
                                   const BranchOptions& options) {
  Walker walker(system, scaling, cluster, options.seed);
  const JudgedPose start = walker.judge(state);
  ClusterMotion out;
  out.mobility = walker.mobility(start);
  out.redundant = walker.redundant(start);
  out.confident = start.decision.decision.confident;
  if (out.mobility == 0 || out.redundant == 0) out.basis = FiniteMobilityBasis::kFirstOrder;
  if (out.mobility == 0) return out;
  std::optional<JudgedPose> generic;
  for (int attempt = 0; attempt < options.configurations && out.configurations < options.configurations / 2;
       ++attempt) {
    std::optional<JudgedPose> there = walker.step(start, 0.2 / (1 + attempt % 3));
    if (!there) continue;
    ++out.configurations;
    out.confident = out.confident && there->decision.decision.confident;
    if (!generic || walker.redundant(*there) < walker.redundant(*generic)) generic = std::move(there);
  }
  if (out.redundant > 0 && !generic) return out;
  const JudgedPose& typical = generic && walker.redundant(*generic) < out.redundant ? *generic : start;
  if (out.redundant > 0) out.basis = FiniteMobilityBasis::kContinuation;
  out.all_branches = out.second_order_done = &typical == &start;
  out.branches.push_back({walker.mobility(typical), walker.mobility(typical), walker.redundant(typical),
                          std::max(1, out.configurations), walker.tangent(typical)});
  return out;
}

}  // namespace ferrers
