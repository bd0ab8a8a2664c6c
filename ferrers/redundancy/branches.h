#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "ferrers/redundancy/second_order.h"

/// Problem: which motions go through a pose?
///
/// Given: a cluster of loops at an assembled pose. Wanted: the smooth branches of its motion through the pose, the
/// dimension of each, and rank and redundancy on it; or the proof that it is rigid there.
/// Method: where no row is redundant the motion is smooth, of the dimension that the rank tells (implicit functions).
/// Else the second-order test gives directions worth trying or proves that there are none; each is followed by closing
/// the loops a step away. A pose so reached belongs to a branch through the given pose when halving the way back, again
/// and again, leads to the given pose. Its dimension is that of the second-order flexes *there* (a branch can be
/// singular all along: rank alone would be too generous), confirmed by a further step along a random one of them.
/// Branches are told apart by dimension and by their tangent space at the given pose, extrapolated from two distances.
/// Seeded; steps are small, so that a walk stays on its branch of assembly. Cost: `starts` × about ten assemblies of
/// the cluster, a third of that where the pose turns out to be regular.
namespace ferrers {

/// What the finite mobility rests on.
enum class FiniteMobilityBasis {
  kFirstOrder,      ///< Nothing is redundant, or nothing moves: the rank proves it.
  kSecondOrder,     ///< Proven rigid by the second-order test.
  kContinuation,    ///< It was moved, loops closed.
  kNotEstablished,  ///< Second-order flexes exist, but nothing was seen to move.
};
std::string_view to_string(FiniteMobilityBasis basis);

struct BranchOptions {
  int starts = 24;           ///< Directions tried at a singular pose.
  int configurations = 8;    ///< Poses judged at a regular one.
  int largest_order_2 = 12;  ///< More freedoms than this: no second-order test, directions at random.
  unsigned seed = 1;
};

/// A smooth branch of motion through the pose.
struct MotionBranch {
  int dimension = 0;
  int mobility =
      0;  ///< By rank, at generic poses of the branch; larger than `dimension` where it is singular all along.
  int redundant = 0;  ///< Rows of the cluster, at generic poses of the branch.
  int samples = 0;    ///< How many walks ended on it.
  MatrixXd tangent;   ///< nv × dimension: velocities at the pose (scaled, orthonormal).
};

struct ClusterMotion {
  int mobility = 0, redundant = 0;  ///< At the pose.
  FiniteMobilityBasis basis = FiniteMobilityBasis::kNotEstablished;
  std::vector<MotionBranch> branches;  ///< Largest dimension first. Empty where rigid or not established.
  bool all_branches = true;            ///< False: tangents scatter (a cone), or so many that some may be missing.
  bool second_order_done = true;       ///< False: too many freedoms.
  int configurations = 0;              ///< Poses reached and judged.
  bool confident = true;               ///< Every rank on the way was.
};

ClusterMotion analyze_motion(const ClusterSystem& cluster, const State& state, const BranchOptions& options = {});

}  // namespace ferrers
