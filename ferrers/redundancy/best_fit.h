#pragma once

#include "ferrers/kinematics/assembly.h"
#include "ferrers/kinematics/joint_wrenches.h"
#include "ferrers/math/rank.h"
#include "ferrers/redundancy/distribution.h"

/// Problem: loops that cannot close come nearest to closing at some pose. Where, and what stays open, must not depend
/// on which joints were cut.
///
/// Given: a cluster of loops, a start, and how far every joint gives per unit load. Wanted: the pose at which the
/// joints, all of them giving a little, close the loops with the least energy
///   f(q) = phiᵀ A⁻¹ phi,   A = Dᵀ C D,
/// where D (rows × m) are the loads on all joints' rows per unit multiplier of the closure rows and C the joints'
/// compliances (redundancy/distribution.h). With equal compliances f is the least sum of squares of the gaps of all
/// joints (angles times L), with those of the model twice the elastic energy. At the best pose y = A⁻¹ phi is in
/// equilibrium, Gᵀ y = 0: a self-stress, D y its share in every joint, C D y the joints' gaps. Misalignment is not
/// read. Method: Gauss-Newton in the directions that G resists. Along the others (the motion that there would be if the
/// loops closed) f varies as the square of the misclosure only: quasi-Newton steps on the value that Gauss-Newton
/// leaves, its slope by central differences. Cost per pose: O(m n min(m, n) + m³) in the cluster, dense.
namespace ferrers {

/// Rows and columns of one cluster of closures.
struct ClusterRows {
  std::vector<int> rows;     ///< Of phi and G.
  std::vector<int> columns;  ///< Velocity coordinates that may move.
};
/// `held`: velocity coordinates left out of `columns`.
std::vector<ClusterRows> cluster_rows(const System& system, const std::vector<int>& held = {});

/// How far joints and couplings give way.
struct Compliance {
  std::vector<Vector6d> joints;  ///< Per joint, force then moment along its frame; m/N and rad/(N·m).
  double couplings = 0;          ///< Of their rows in scaled units.
};
/// All joints alike, k = 1 N/m and L² N·m/rad: f is then in m².
Compliance equal_compliance(const System& system, double length_m);
/// That of the model. Rigid components get 1e-12 of the largest compliance, so that what the others can take up leaves
/// nothing to them. `any`: some joint has stiffness.
Compliance model_compliance(const System& system, double length_m, bool& any);

struct BestFit {
  State state;
  VectorXd phi;           ///< The cluster's rows of phi there, m or rad.
  VectorXd stress;        ///< y, the cluster's rows, SI.
  VectorXd joint_stress;  ///< D y, all joints' rows, SI.
  double residual = 0;    ///< √f: m where compliances are equal.
  double slope = 0;  ///< |Gᵀ y| over |G| |y| in scaled units, in the directions that G resists: 0 at the best pose.
  RankDecision decision;       ///< On the cluster's scaled G there, the misclosure told.
  std::vector<Vector6d> gaps;  ///< Per joint, C D y: translation then rotation along its frame, m and rad.
};

/// The best fit near `start`.
BestFit find_best_fit(const System& system, const Scaling& scaling, const ClusterRows& cluster,
                      const Compliance& compliance, const State& start);

}  // namespace ferrers
