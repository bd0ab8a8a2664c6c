#include "ferrers/redundancy/permanence.h"

#include <algorithm>
#include <cmath>

#include "ferrers/redundancy/large_motion.h"

namespace ferrers {
namespace {

constexpr std::size_t kMostBranches = 32;

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

/// A branch of the whole as it is put together: velocities in scaled coordinates.
struct Combined {
  MotionBranch branch;
  double share = 1;
};

/// Puts the clusters' motions together.
class Combiner {
 public:
  explicit Combiner(const System& system, const Scaling& scaling) : system_(system), scaling_(scaling) {
    all_.push_back({});
    all_.front().branch.tangent = MatrixXd::Zero(system.nv, 0);
    in_loops_.assign(system.nv, false);
  }

  void add(const ClusterSystem& cluster, const ClusterMotion& motion, PermanenceReport& out) {
    for (const int k : cluster.columns) in_loops_[k] = true;
    weaken(out.basis, motion.basis);
    out.configurations = std::max(out.configurations, motion.configurations);
    out.confident = out.confident && motion.confident;
    out.second_order_done = out.second_order_done && motion.second_order_done;
    out.all_branches = out.all_branches && motion.all_branches;
    const bool isolated = motion.branches.empty() && motion.basis != FiniteMobilityBasis::kNotEstablished;
    if (isolated) {
      out.is_shaky = out.is_shaky || motion.mobility > 0;
      generic_redundant_ += motion.redundant;
      isolated_redundant_ += motion.redundant;
      return;
    }
    if (motion.branches.empty()) {
      known_ = false;
      return;
    }
    int least = motion.redundant, samples = 0;
    for (const MotionBranch& branch : motion.branches) {
      least = std::min(least, branch.redundant);
      samples += branch.samples;
    }
    generic_redundant_ += least;
    multiply(cluster, motion, samples, out);
  }

  void finish(PermanenceReport& out) {
    if (!known_) return;
    std::vector<int> free;  // coordinates outside all loops
    for (int k = 0; k < system_.nv; ++k) {
      if (!in_loops_[k]) free.push_back(k);
    }
    out.generic_redundant = generic_redundant_;
    out.generic_mobility = system_.nv - (system_.m - generic_redundant_);
    out.finite_mobility = 0;
    for (Combined& one : all_) {
      MatrixXd tangent = MatrixXd::Zero(system_.nv, one.branch.tangent.cols() + static_cast<long>(free.size()));
      tangent.leftCols(one.branch.tangent.cols()) = one.branch.tangent;
      for (std::size_t i = 0; i < free.size(); ++i) {
        tangent(free[i], one.branch.tangent.cols() + static_cast<long>(i)) = 1;
      }
      const int dimension = static_cast<int>(tangent.cols());
      out.finite_mobility = std::max(*out.finite_mobility, dimension);
      if (dimension == 0) continue;
      const int redundant = isolated_redundant_ + one.branch.redundant;
      out.branches.push_back(
          {dimension, system_.nv - (system_.m - redundant), redundant, one.share, name_direction(tangent)});
    }
    std::stable_sort(out.branches.begin(), out.branches.end(),
                     [](const BranchReport& a, const BranchReport& b) { return a.dimension > b.dimension; });
  }

 private:
  // What is claimed rests on the weakest of what was used.
  static void weaken(FiniteMobilityBasis& basis, FiniteMobilityBasis with) { basis = std::max(basis, with); }

  void multiply(const ClusterSystem& cluster, const ClusterMotion& motion, int samples, PermanenceReport& out) {
    std::vector<Combined> next;
    for (const Combined& one : all_) {
      for (const MotionBranch& branch : motion.branches) {
        if (next.size() >= kMostBranches) {
          out.all_branches = false;
          break;
        }
        Combined both = one;
        MatrixXd& tangent = both.branch.tangent;
        const long first = tangent.cols();
        tangent.conservativeResize(Eigen::NoChange, first + branch.tangent.cols());
        tangent.rightCols(branch.tangent.cols()).setZero();
        tangent(cluster.columns, Eigen::seqN(first, branch.tangent.cols())) = branch.tangent;
        both.branch.redundant += branch.redundant;
        both.share *= samples > 0 ? static_cast<double>(branch.samples) / samples : 1.0;
        next.push_back(std::move(both));
      }
    }
    all_ = std::move(next);
  }

  // One velocity of the tangent space: the sum of its projections of the axes, so that every coordinate that can move
  // does, whatever the basis.
  std::vector<std::pair<std::string, double>> name_direction(const MatrixXd& tangent) const {
    VectorXd x = tangent.cols() == 1 ? VectorXd(tangent.col(0))
                                     : VectorXd(tangent * (tangent.transpose() * VectorXd::Ones(system_.nv)));
    const double largest = x.cwiseAbs().maxCoeff();
    std::vector<std::pair<std::string, double>> out;
    if (is_negligible(largest, 1.0)) return out;
    x *= scaling_.length_m / largest;
    long first = 0;
    while (is_negligible(x[first], scaling_.length_m)) ++first;
    if (x[first] < 0) x = -x;
    for (int k = 0; k < system_.nv; ++k) {
      if (!is_negligible(x[k], scaling_.length_m)) {
        out.emplace_back(system_.coordinate_names[k], x[k] * scaling_.columns[k]);
      }
    }
    return out;
  }

  const System& system_;
  const Scaling& scaling_;
  std::vector<Combined> all_;
  std::vector<bool> in_loops_;
  int generic_redundant_ = 0, isolated_redundant_ = 0;
  bool known_ = true;
};

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
  out.basis = FiniteMobilityBasis::kFirstOrder;
  const Scaling& scaling = system.scaling;
  Combiner combiner(system, scaling);
  for (std::size_t c = 0; c < system.topology->clusters.size(); ++c) {
    const ClusterSystem part = make_cluster_system(system, scaling, system.topology->clusters[c]);
    const ClusterMotion motion =
        part.system.nv <= options.largest_cluster
            ? analyze_motion(part, part.restrict(state), options.branches)
            : analyze_large_motion(system, scaling, state, static_cast<int>(c), options.branches);
    combiner.add(part, motion, out);
  }
  combiner.finish(out);
  out.kind = judge(report.redundant, out.generic_redundant);
  return out;
}

}  // namespace ferrers
