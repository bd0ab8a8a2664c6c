#include "ferrers/redundancy/branches.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>

#include "ferrers/redundancy/reduced_closure.h"

namespace ferrers {
namespace {

constexpr double kNearStep = 0.2;     // rad, or characteristic lengths
constexpr double kSameTangent = 0.2;  // largest sine between tangent spaces that count as one
constexpr int kMostBranches = 16;
constexpr int kLarge = 60;  // coordinates: more than that, and fewer poses must do

/// A pose away from the given one.
struct Reached {
  State state;
  VectorXd way;  ///< Scaled displacement from the pose it came from.
};

/// A reached pose with what it tells.
struct Judged {
  LocalMotion local;
  MatrixXd tangent;  ///< Of the branch there; no columns where it could not be told.
  int dimension() const { return static_cast<int>(tangent.cols()); }
};

MatrixXd random_matrix(int rows, int columns, std::mt19937& random) {
  std::normal_distribution<double> normal;
  MatrixXd out(rows, columns);
  for (double& entry : out.reshaped()) entry = normal(random);
  return out;
}

double sine_between(const MatrixXd& A, const MatrixXd& B) { return (A - B * (B.transpose() * A)).norm(); }

/// Walks on the constraints of one cluster.
class Walker {
 public:
  Walker(const ClusterSystem& cluster, const State& pose, const BranchOptions& options)
      : cluster_(cluster), pose_(pose), options_(options), probe_(cluster.system, cluster.system.scaling) {}

  /// At the given pose.
  LocalMotion look(const State& state) {
    probe_.go_to(state);
    return probe_.first_order();
  }

  /// At a reached pose. What is in doubt there may be a double zero.
  LocalMotion look_away(const State& state) {
    LocalMotion local = look(state);
    return local.decision.confident ? local : probe_.first_order(kDoubleZeroBlur);
  }

  /// The flexes at the pose that was looked at last.
  FlexCone flexes(const LocalMotion& local, int starts) {
    return find_second_order_flexes(compute_second_order_forms(probe_, local), starts, options_.seed);
  }

  /// A step of `size` (largest coordinate, rad or characteristic lengths) along x (scaled), then the loops closed.
  std::optional<Reached> step(const State& from, ReducedClosure& closure, const VectorXd& x, double size) const {
    const double length = cluster_.system.scaling.length_m;
    return close(from, closure, x * (size * length / x.cwiseAbs().maxCoeff()), 0.3 * size * length);
  }

  /// Halves the way back again and again. The pose half-way, or nothing where the way does not lead back to the pose.
  std::optional<Reached> half_way_back(ReducedClosure& closure, const Reached& far) const {
    constexpr int kHalvings = 5;
    std::optional<Reached> first;
    Reached here = far;
    double last_miss = 1;
    for (int i = 0; i < kHalvings; ++i) {
      const VectorXd half = 0.5 * here.way;
      const auto back = close(pose_, closure, half, 0);
      if (!back && i < 2) return std::nullopt;
      if (!back) break;  // near enough: closer to the pose, loops close badly
      const double miss = (back->way - half).norm() / half.norm();
      if (miss > std::max(0.15, 0.9 * last_miss)) return std::nullopt;  // bends more, not less: it leads elsewhere
      last_miss = miss;
      here = *back;
      if (i == 0) first = here;
    }
    return first;
  }

  /// The branch that a reached pose is on. Where its rank is lower than its dimension tells, it is so all along: then
  /// the forms' gradients vanish along it, and its tangent is where all forms and their gradients do.
  Judged judge(const State& state) {
    Judged out{look_away(state), {}};
    const int w = out.local.mobility();
    if (out.local.redundant() == 0 || w > options_.largest_order_2) {
      out.tangent = out.local.N;
      return out;
    }
    const CommonKernel kernel = find_common_kernel(compute_second_order_forms(probe_, out.local, kDoubleZeroBlur));
    out.tangent = kernel.confident ? MatrixXd(out.local.N * kernel.basis) : MatrixXd(out.local.N.rows(), 0);
    return out;
  }

 private:
  std::optional<Reached> close(const State& from, ReducedClosure& closure, const VectorXd& way, double least) const {
    Reached out{from, {}};
    displace(cluster_.system, way.cwiseProduct(cluster_.system.scaling.columns), out.state.q);
    if (!closure.close(out.state)) return std::nullopt;
    out.way = displacement(cluster_.system, cluster_.system.scaling, from.q, out.state.q);
    if (out.way.cwiseAbs().maxCoeff() < least) return std::nullopt;
    return out;
  }

  const ClusterSystem& cluster_;
  const State& pose_;
  const BranchOptions& options_;
  PoseProbe probe_;
};

/// The analysis of one pose.
class Analysis {
 public:
  Analysis(const ClusterSystem& cluster, const State& pose, BranchOptions options)
      : cluster_(cluster), pose_(pose), options_(options), walker_(cluster, pose, options_), random_(options.seed) {
    if (cluster.system.nv <= kLarge) return;
    options_.configurations = std::min(options_.configurations, 4);
    options_.starts = std::min(options_.starts, 4);
  }

  ClusterMotion run() {
    const LocalMotion local = walker_.look(pose_);
    note(local);
    out_.mobility = local.mobility();
    out_.redundant = local.redundant();
    if (out_.mobility == 0 || out_.redundant == 0) {
      out_.basis = FiniteMobilityBasis::kFirstOrder;
      if (out_.mobility > 0) out_.branches.push_back({out_.mobility, out_.mobility, out_.redundant, 1, local.N});
      return std::move(out_);
    }
    out_.second_order_done = out_.mobility <= options_.largest_order_2;
    out_.all_branches = out_.second_order_done;
    FlexCone cone;
    if (out_.second_order_done) cone = walker_.flexes(local, options_.starts);
    if (cone.is_rigid) {
      out_.basis = FiniteMobilityBasis::kSecondOrder;
      out_.confident = out_.confident && cone.confident;
      return std::move(out_);
    }
    ReducedClosure closure(cluster_, local);
    if (cone.is_linear && cone.flexes.size() > 0 && cone.span.cols() == out_.mobility) try_regular(local, closure);
    if (out_.branches.empty()) try_singular(local, closure, cone);
    finish();
    return std::move(out_);
  }

 private:
  void note(const LocalMotion& local) { out_.confident = out_.confident && local.decision.confident; }

  // Nothing obstructs any direction at second order: is it a pose like its neighbours? Then one branch goes through it.
  void try_regular(const LocalMotion& local, ReducedClosure& closure) {
    MotionBranch found{out_.mobility, out_.mobility, out_.redundant, 0, local.N};
    for (int i = 0; i < 2 * options_.configurations && out_.configurations < options_.configurations; ++i) {
      const VectorXd x = local.N * direction(out_.mobility, i);
      const auto there = walker_.step(pose_, closure, x, 0.35 / (1 + i % 3));
      if (!there || !follows(local.N, there->way, x)) continue;
      const Judged reached = walker_.judge(there->state);
      if (reached.dimension() != out_.mobility) {  // singular after all
        out_.configurations = 0;
        return;
      }
      note(reached.local);
      ++out_.configurations;
      if (walk_on(there->state, reached.local, reached.tangent, found)) ++found.samples;
    }
    if (found.samples > 0) out_.branches.push_back(found);
  }

  // The way taken keeps to the direction asked for.
  static bool follows(const MatrixXd& N, const VectorXd& way, const VectorXd& x) {
    const VectorXd taken = N.transpose() * way, asked = N.transpose() * x;
    return taken.dot(asked) > 0.9 * taken.norm() * asked.norm();
  }

  VectorXd direction(int size, int i) {
    VectorXd z = random_matrix(size, 1, random_);
    if (size == 1) z[0] = i % 2 == 0 ? 1 : -1;
    return z;
  }

  // A further step on the branch, in a random direction of its tangent, which confirms that it moves along its tangent;
  // the rank there counts too.
  bool walk_on(const State& from, const LocalMotion& local, const MatrixXd& tangent, MotionBranch& branch) {
    ReducedClosure closure(cluster_, local);
    for (int attempt = 0; attempt < 3; ++attempt) {
      const VectorXd x = tangent * direction(static_cast<int>(tangent.cols()), attempt);
      const auto there = walker_.step(from, closure, x, 0.25 / (1 << attempt));
      if (!there || !follows(local.N, there->way, x)) continue;
      const Judged reached = walker_.judge(there->state);
      if (reached.dimension() != static_cast<int>(tangent.cols())) continue;  // one of the two is a special pose
      ++out_.configurations;
      if (reached.local.mobility() < branch.mobility) {
        branch.mobility = reached.local.mobility();
        branch.redundant = reached.local.redundant();
      }
      return true;
    }
    return false;
  }

  void try_singular(const LocalMotion& local, ReducedClosure& closure, const FlexCone& cone) {
    std::vector<VectorXd> ways;
    for (const VectorXd& z : cone.flexes) {
      ways.emplace_back(local.N * z);
      ways.emplace_back(-ways.back());
      if (cone.flexes.size() > 8 || out_.mobility == 1) continue;
      for (const double sign : {1.0, -1.0}) {  // where a branch bends away like a cusp, not quite along it
        ways.emplace_back(local.N * (sign * z + 0.3 * direction(out_.mobility, 0).normalized()));
      }
    }
    const std::size_t least = ways.empty() ? options_.starts : ways.size() + options_.starts / 3;
    while (ways.size() < least) ways.emplace_back(local.N * direction(out_.mobility, static_cast<int>(ways.size())));
    int walks = 0;
    for (const VectorXd& x : ways) {
      if (++walks > 2 * options_.starts || settled(walks)) break;
      walk(closure, x);
    }
    look_elsewhere(local, closure);
  }

  // Tries the directions at right angles to the branches that are known, until no more are found.
  void look_elsewhere(const LocalMotion& local, ReducedClosure& closure) {
    for (std::size_t b = 0; b < out_.branches.size() && b < 4; ++b) {
      const MatrixXd known = local.N.transpose() * out_.branches[b].tangent;
      for (int i = 0; i < options_.starts / 3 + out_.mobility; ++i) {
        VectorXd z = direction(out_.mobility, i);
        z -= known * (known.transpose() * z);
        walk(closure, local.N * z);
      }
    }
  }

  void walk(ReducedClosure& closure, const VectorXd& x) {
    // In many freedoms at once the largest coordinate says little about each.
    const double size = kNearStep * std::sqrt(std::max(1.0, 0.5 * out_.mobility));
    if (!follow(closure, x, size)) follow(closure, x, size / 4);
  }

  // Every branch was met several times: more walks would find the same.
  bool settled(int walks) const {
    return walks > options_.starts && !out_.branches.empty() &&
           std::all_of(out_.branches.begin(), out_.branches.end(), [](const MotionBranch& b) { return b.samples > 2; });
  }

  bool follow(ReducedClosure& closure, const VectorXd& x, double size) {
    const auto far = walker_.step(pose_, closure, x, size);
    if (!far) return false;
    const auto half = walker_.half_way_back(closure, *far);
    if (!half) return false;
    const Judged at_half = walker_.judge(half->state);
    const Judged at_far = walker_.judge(far->state);
    const int d = at_far.dimension();
    if (d == 0 || at_half.dimension() != d) return false;
    MotionBranch found;
    found.dimension = d;
    found.mobility = at_far.local.mobility();
    found.redundant = at_far.local.redundant();
    if (!walk_on(far->state, at_far.local, at_far.tangent, found)) return false;
    note(at_far.local);
    ++out_.configurations;
    count(at_half.tangent, at_far.tangent, found);
    return true;
  }

  // Tangent space at the pose: projectors extrapolated from the full and the half way.
  static MatrixXd extrapolate(const MatrixXd& half, const MatrixXd& far) {
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(2 * half * half.transpose() - far * far.transpose());
    return eigen.eigenvectors().rightCols(far.cols());
  }

  void count(const MatrixXd& half, const MatrixXd& far, MotionBranch found) {
    found.tangent = extrapolate(half, far);
    found.samples = 1;
    // How much it turns on the way bounds what extrapolation leaves.
    const double allowed = std::clamp(sine_between(far, half), kSameTangent, 2 * kSameTangent);
    for (MotionBranch& known : out_.branches) {
      if (known.dimension != found.dimension || sine_between(found.tangent, known.tangent) > allowed) continue;
      ++known.samples;
      if (found.mobility < known.mobility) {
        known.mobility = found.mobility;
        known.redundant = found.redundant;
      }
      return;
    }
    if (out_.branches.size() < kMostBranches) {
      out_.branches.push_back(std::move(found));
    } else {
      out_.all_branches = false;
    }
  }

  void finish() {
    if (out_.branches.empty()) return;  // not established
    out_.basis = FiniteMobilityBasis::kContinuation;
    std::stable_sort(out_.branches.begin(), out_.branches.end(),
                     [](const MotionBranch& a, const MotionBranch& b) { return a.dimension > b.dimension; });
  }

  const ClusterSystem& cluster_;
  const State& pose_;
  BranchOptions options_;
  Walker walker_;
  std::mt19937 random_;
  ClusterMotion out_;
};

}  // namespace

std::string_view to_string(FiniteMobilityBasis basis) {
  switch (basis) {
    case FiniteMobilityBasis::kFirstOrder:
      return "first order";
    case FiniteMobilityBasis::kSecondOrder:
      return "second order";
    case FiniteMobilityBasis::kContinuation:
      return "continuation";
    case FiniteMobilityBasis::kNotEstablished:
      break;
  }
  return "not established";
}

ClusterMotion analyze_motion(const ClusterSystem& cluster, const State& state, const BranchOptions& options) {
  return Analysis(cluster, state, options).run();
}

}  // namespace ferrers
