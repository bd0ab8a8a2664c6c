#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "ferrers/model/model.h"

/// A second opinion on mechanisms: absolute coordinates, dense matrices, singular values.
///
/// Given a model, the pose of every body and their twists, it answers the questions that the engine answers by trees,
/// cut joints and selected rows, sharing only the `Model` data with it: rank, mobility, self-stress, which reactions
/// are unique, accelerations and multipliers. Slow (dense SVD, O((6·bodies)³)) and meant for tests only.
///
/// Velocities are 6 per moving body, (ω, velocity of the mass centre), world axes; the sign rule is the project's:
/// M a + h = τ + Gᵀ λ with λ acting on a joint's second body.
namespace ferrers::witness {

/// Where every body is and how it moves; index = BodyId, ground included (and at rest).
struct AbsoluteState {
  std::vector<Pose> poses;       ///< X_WB.
  std::vector<Vector6d> twists;  ///< ω, then the velocity of the mass centre; world axes.
};

/// The drawn configuration at rest.
AbsoluteState drawn_state(const Model& model);

/// Constraint equations at a state: G V = 0 and G dV/dt = gamma, one label a row ("elbow/moment_x", or a coupling's
/// name).
struct AbsoluteConstraints {
  Eigen::MatrixXd G;                ///< rows × 6·(bodies − 1).
  Eigen::VectorXd gamma;            ///< rows.
  std::vector<std::string> labels;  ///< rows.
  /// First row of joint j, then of coupling k at [joints + k]; one more entry closes the list.
  std::vector<int> first_row;
};

/// All joints' rows and one row per coupling. gamma comes from dual numbers carried along the motion: exact.
/// `driven_at_s`: also one row per component of every drive that has a motion law ("DRIVE/motion"), whose gamma
/// holds the law's acceleration at that time.
AbsoluteConstraints absolute_constraints(const Model& model, const AbsoluteState& state,
                                         std::optional<double> driven_at_s = std::nullopt);

/// Residuals of the same rows (joints and couplings) at a pose, equal to the row's displacement to first order.
/// Screws, gear meshes and couplings take the winding of their angles from the nearest solution within three turns.
Eigen::VectorXd absolute_residual(const Model& model, const std::vector<Pose>& poses);

/// What the singular values say about a mechanism.
struct AbsoluteVerdict {
  int bodies = 0;                      ///< Without ground.
  int rows = 0;                        ///< m.
  int rank = 0;                        ///< r, of the scaled Jacobian.
  int mobility = 0;                    ///< 6·bodies − r.
  int redundant = 0;                   ///< m − r.
  Eigen::VectorXd singular_values;     ///< Of the scaled Jacobian, descending.
  double length_m = 1;                 ///< The length that made rows and columns comparable.
  Eigen::MatrixXd Z;                   ///< Self-stress basis, m × (m − r), in SI rows: Gᵀ Z = 0.
  std::vector<bool> unique_rows;       ///< Per row: no self-stress touches it.
  std::vector<int> unique_dimensions;  ///< Per joint, then per coupling: rows − rank(Z of its rows).
  int unique = 0;                      ///< How many rows are unique.
  int unique_dimension = 0;            ///< Sum over joints and couplings.
};

/// Rank at a relative singular-value tolerance, on rows and columns made comparable by the mechanism's size.
AbsoluteVerdict analyze_absolute(const Model& model, const std::vector<Pose>& poses, double tolerance = 1e-8);

/// 6·(bodies − 1) mass matrix, block diagonal, world axes at the mass centres.
Eigen::MatrixXd absolute_mass_matrix(const Model& model, const std::vector<Pose>& poses);

/// Accelerations and multipliers of one state.
struct AbsoluteMotion {
  std::vector<Vector6d> accelerations;  ///< Per body (ground zero): dω/dt, acceleration of the mass centre; world.
  Eigen::VectorXd lambda;               ///< Per row; its unique part is physics, the rest is one choice of many.
  double inconsistency = 0;     ///< ‖G a − gamma‖ / (1 + ‖gamma‖): not small when the constraints contradict.
  bool inertia_regular = true;  ///< The mass matrix is regular on the admissible motions.
  AbsoluteConstraints constraints;  ///< As solved.
};

/// Solves M a + h = τ + Gᵀ λ, G a = gamma, for any rank of G.
/// `wrenches`: per body (ground included, ignored) couple about the mass centre, then force; world axes.
/// With `driven_at_s` the drives' motion laws are constraints too, and their efforts are the last multipliers.
AbsoluteMotion solve_absolute(const Model& model, const AbsoluteState& state, const std::vector<Vector6d>& wrenches,
                              std::optional<double> driven_at_s = std::nullopt, double tolerance = 1e-8);

/// The reaction that a joint exerts on its second body: moment about `point_W`, then force; world axes.
/// `lambda_joint` are the multipliers of that joint's rows.
Vector6d joint_reaction(const Model& model, const std::vector<Pose>& poses, JointId joint,
                        const Eigen::VectorXd& lambda_joint, const Vector3d& point_W);

/// Which world components of that reaction (moment about `point_W`, then force) every solution shares.
std::array<bool, 6> unique_world_components(const Model& model, const std::vector<Pose>& poses, JointId joint,
                                            const AbsoluteVerdict& verdict, const Vector3d& point_W);

// --- Coordinates, applied forces and energy from the absolute state (absolute_forces.cc) ---

/// Position of one joint coordinate; angles in (−π, π]. Throws for spherical and free joints.
double coordinate_position(const Model& model, const std::vector<Pose>& poses, JointCoordinate coordinate);

/// Velocity of one joint coordinate (spherical and free: ω and v of the joint's point, in F axes).
double coordinate_velocity(const Model& model, const AbsoluteState& state, JointCoordinate coordinate);

/// Adds the wrench pair of one joint-coordinate effort: positive on the second body, opposite on the first.
void add_coordinate_effort(const Model& model, const std::vector<Pose>& poses, JointCoordinate coordinate,
                           double effort, std::vector<Vector6d>& wrenches);

struct AppliedForcesOptions {
  bool gravity = true;
  bool elements = true;       ///< Springs, torsion springs, damping, bushings, loads, and viscous joint friction.
  bool drive_efforts = true;  ///< The drives' effort laws.
};

/// All applied wrenches per body (ground included): couple about the mass centre, force; world axes.
/// Coulomb friction is left out: it needs reactions.
std::vector<Vector6d> applied_wrenches(const Model& model, const AbsoluteState& state, double t_s,
                                       const AppliedForcesOptions& options = {});

/// Kinetic energy plus potentials of gravity (zero at the world's origin), springs, torsion springs and bushings, J.
double total_energy(const Model& model, const AbsoluteState& state);

// --- Motion (absolute_motion.cc) ---

/// Moves poses onto the constraints by least-norm Newton steps from nearby. Returns the last residual norm.
double project_poses(const Model& model, std::vector<Pose>& poses, double tolerance = 1e-8);

/// The admissible twists nearest to the given ones.
void project_twists(const Model& model, AbsoluteState& state, double tolerance = 1e-8);

/// A basis of the admissible twists at a pose: 6·(bodies − 1) × mobility, orthonormal after scaling by `length_m`.
Eigen::MatrixXd admissible_twists(const Model& model, const std::vector<Pose>& poses, double tolerance = 1e-8);

/// The poses after the displacement `dV` (6 per moving body: small rotation, displacement of the mass centre).
std::vector<Pose> displaced(const Model& model, const std::vector<Pose>& poses, const Eigen::VectorXd& dV);

/// One classical fourth-order Runge-Kutta step of the forward dynamics; every stage is evaluated on the constraints.
AbsoluteState step_absolute(const Model& model, const AbsoluteState& state, double t_s, double step_s);

}  // namespace ferrers::witness
