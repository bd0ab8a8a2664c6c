#pragma once

#include <vector>

#include "ferrers/kinematics/constraints.h"
#include "ferrers/kinematics/scaling.h"
#include "ferrers/math/rank.h"

/// Problem: clusters of loops have nothing to do with each other; each moves, or not, by itself.
///
/// Given: a system and one of its clusters. Wanted: that cluster as a small system of its own, standing still where it
/// is attached, so that everything local (null spaces, second order, continuation) costs what the cluster costs.
/// The result serves kinematics only: its model and topology are those of the whole.
namespace ferrers {

struct ClusterSystem {
  System system;                   ///< With the whole's scaling, cut out: one characteristic length for all clusters.
  std::vector<int> rows, columns;  ///< Of the whole's G: row i and column k of this system's.
  std::vector<int> q, winding;     ///< Where this system's positions and windings stand in the whole's state.

  State restrict(const State& whole) const;
};

ClusterSystem make_cluster_system(const System& whole, const Scaling& scaling, const Cluster& cluster);

/// First-order motions and self-stresses at one pose, in scaled coordinates.
struct LocalMotion {
  RankDecision decision;
  MatrixXd N;  ///< nv × mobility, orthonormal: G N = 0.
  MatrixXd Z;  ///< m × redundancy, orthonormal: Gᵀ Z = 0.
  int mobility() const { return static_cast<int>(N.cols()); }
  int redundant() const { return static_cast<int>(Z.cols()); }
};

/// Looks at a system at one pose after the other.
class PoseProbe {
 public:
  PoseProbe(const System& system, const Scaling& scaling);

  void go_to(const State& state);
  /// The only place where null spaces are computed: the rank is decided by math/rank.h. `blur`: by how much the pose
  /// may be off, relative to the size (its own misclosure counts at least).
  LocalMotion first_order(double blur = 0) const;
  /// Scaled gamma(q, v) times L for the scaled velocity x: a pure number where |x| = 1. Shape: m.
  VectorXd curvature(const VectorXd& x);

 private:
  const System& system_;
  const Scaling& scaling_;
  State moving_;
  PositionKinematics pos_;
  VelocityKinematics vel_, rest_;
  ConstraintKinematics constraints_;
};

/// Scaled displacement that takes q_from to q_to (`displace`; rotations by less than half a turn). Shape: nv.
VectorXd displacement(const System& system, const Scaling& scaling, const VectorXd& q_from, const VectorXd& q_to);

}  // namespace ferrers
