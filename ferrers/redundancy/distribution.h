#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ferrers/kinematics/joint_wrenches.h"
#include "ferrers/math/rank.h"

/// Problem: rigid bodies determine the multipliers of redundant constraints only up to self-stresses; how the joints
/// really divide a load follows from their compliance.
///
/// Given: multipliers lambda_p of all joints' rows that balance the loads, the self-stresses Z (G_allᵀ Z = 0), and each
/// joint as a spring between its seats: w = −k (displacement + delta) per component along the joint's frame, delta its
/// misalignment. Wanted, among all lambda = lambda_p + Z y, the one that the springs can follow without opening a loop:
///
///   Zᵀ (C lambda + delta) = 0,   C = Σ_j S_jᵀ diag(1/k_j) S_j          (force method, least complementary energy)
///
/// where S_j gives the components (force, then moment, along the joint's frame at its point) of joint j's wrench per
/// unit multiplier. It is the limit of elastic joints that grow stiff. Components without stiffness are rigid, 1/k = 0.
/// Self-stresses that work on no spring stay free: what they touch stays undetermined. Which ones is decided from the
/// pattern of springs alone, in scaled units, so that no size of a stiffness and no unit bears on it; a delta that such
/// a self-stress works on cannot be assembled at all.
/// The result depends neither on lambda_p nor on the basis Z. Solved as least squares by orthogonal factors, never
/// through Zᵀ C Z: what a joint carries is exact to about a hundred roundings times the ratio of the largest to the
/// smallest stiffness, relative to the whole load (1e-9 up to six decades, as measured on random mechanisms). Cost:
/// O(springs · k²) for k self-stresses. Source: [przemieniecki1968], with multipliers in the place of member forces.
namespace ferrers {

enum class ReactionStatus {
  kUnique,        ///< Every solution of the equations of motion shares the value.
  kDistributed,   ///< Fixed by added physics (joint stiffness), named with the result.
  kUndetermined,  ///< Not determined by rigid-body dynamics: no value is given.
};
std::string_view to_string(ReactionStatus status);

/// What divides indeterminate reactions.
enum class DistributionBy {
  kJointStiffness,  ///< "stiffness": that of the joints which have one; the others are rigid.
  kEqualStiffness,  ///< "equal": every joint alike, k for forces and k L² for moments; the model's own is not used.
  kNothing,         ///< "none".
};
std::string_view to_string(DistributionBy by);
std::optional<DistributionBy> find_distribution(std::string_view name);

/// The joints as springs, per joint; force then moment along the joint's frame.
struct JointSprings {
  std::vector<Vector6d> compliance;    ///< 1/k: m/N and rad/(N·m); zero: rigid. Equal stiffness: with k = 1 N/m.
  std::vector<Vector6d> misalignment;  ///< delta: m and rad.
  bool any = false;                    ///< False: nothing to distribute by.
};
JointSprings make_joint_springs(const System& system, DistributionBy by, double length_m);

/// S_j: components of a joint's wrench per unit multiplier, 6 × rows: force then moment, N and N·m, on the second body
/// at the joint's point. Along F; of a gear mesh with x along its line of action, which F does not follow.
using ComponentMap = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6>;
std::vector<ComponentMap> compute_component_maps(const System& system, const JointWrenches& joints);

/// One component of a joint that gives way and that some self-stress loads.
struct SpringComponent {
  int joint = 0, component = 0;
  double compliance = 0;
};

/// The self-stresses at one pose, divided into those that springs fix and those that stay free.
struct ForceMethod {
  MatrixXd fixed;      ///< Rows × k_1, orthonormal in scaled units.
  MatrixXd remaining;  ///< Rows × (k − k_1): no spring gives way to them.
  std::vector<SpringComponent> springs;
  MatrixXd work;          ///< springs × k_1: load of each spring per unit of each fixed self-stress, N and N·m.
  RankDecision decision;  ///< How many are fixed; without singular values where a bound of them was enough.
  double length_m = 1;    ///< Of the scaled units.
};

/// `Z`: rows × k, orthonormal in scaled units (`AllRows::scale`).
ForceMethod make_force_method(const AllRows& rows, const std::vector<ComponentMap>& maps, const JointSprings& springs,
                              const MatrixXd& Z, double length_m);

/// Loads of the springs under multipliers of all rows.
VectorXd spring_loads(const ForceMethod& method, const AllRows& rows, const std::vector<ComponentMap>& maps,
                      const VectorXd& lambda);

/// delta of all rows from the joints' misalignments: what is added to phi there.
VectorXd misalignment_of_rows(const AllRows& rows, const std::vector<ComponentMap>& maps, const JointSprings& springs);

struct DistributionResult {
  /// Joints and couplings (indices as in `AllRows`) whose rigid parts `delta` contradicts: none, or they cannot be
  /// assembled.
  std::vector<int> contradictory;
  std::vector<bool> valid;  ///< Per joint and coupling: no self-stress ties it to contradictory ones.
  VectorXd lambda;          ///< All rows; where valid, and no remaining self-stress works.
};

/// Solves for the multipliers. `lambda_p` and `delta`: all rows; `lambda_p` = 0 gives what misalignment alone does.
DistributionResult solve_distribution(const ForceMethod& method, const AllRows& rows,
                                      const std::vector<ComponentMap>& maps, const VectorXd& lambda_p,
                                      const VectorXd& delta);

/// Status of a reaction component that a joint's multipliers give as row · lambda_joint: unique where no self-stress
/// works on it, distributed where springs fix all that do. `unit`: that of the component. `Z_joint`: the joint's rows
/// of all self-stresses; `remaining_joint`: of those that stay free, all of them where nothing was distributed.
ReactionStatus judge_component(const Eigen::RowVectorXd& row, double unit, const Eigen::Ref<const MatrixXd>& Z_joint,
                               const Eigen::Ref<const MatrixXd>& remaining_joint);

/// Size of component k (force, then moment) that counts as one: 1 N, L N·m.
inline double component_unit(int k, double length_m) { return k < 3 ? 1.0 : length_m; }

/// Name of a joint or coupling by its index in `AllRows`.
const std::string& owner_name(const Model& model, int joint_or_coupling);

}  // namespace ferrers
