#pragma once

#include <Eigen/SparseCore>
#include <optional>
#include <string>
#include <vector>

#include "ferrers/kinematics/assembly.h"
#include "ferrers/kinematics/joint_wrenches.h"
#include "ferrers/math/rank.h"

/// Problem: of m closure rows some follow from the others; multipliers on them are not unique, reactions of some joints
/// are all the same.
///
/// Given: a system at an assembled configuration. Wanted: the rank r of G with its certainty, a selection of r
/// independent rows and of w = n − r independent coordinates [stepanyan, eq. (2)], the self-stresses Z over all joints'
/// rows (G_all^T Z = 0), and from them which reaction components every solution shares: those with a zero row in Z. The
/// unique part of a joint's wrench has dimension rows − rank(Z_joint), in any axes.
/// Once decided, evaluation uses the `Selection` only and compares nothing with a tolerance.
/// Cost: linear in the number of loops where loops are local; O(m n min(m, n)) for a cluster without structure.
namespace ferrers {

using SparseMatrixXd = Eigen::SparseMatrix<double>;

/// The decision that evaluation runs on.
struct Selection {
  std::vector<int> rows;                        ///< r independent rows of G, ascending.
  std::vector<int> dependent;                   ///< r coordinates that they determine, ascending.
  std::vector<int> independent;                 ///< The other n − r, ascending.
  double smallest_pivot = 1;                    ///< Of the chosen block, scaled, when it was chosen.
  std::vector<int> excluded_rows(int m) const;  ///< The m − r rows left out, ascending.
};

/// One independent self-stress: the loads that joints can hold against each other.
struct SelfStress {
  int cluster = 0;            ///< Index into `Topology::clusters`.
  std::vector<int> closures;  ///< Loops that it closes through, indices into `Topology::closures`.
  std::vector<int> joints;    ///< That it loads; index into `RedundancyReport::reactions`.
};

/// What every solution shares of one joint's (or coupling's) reaction.
struct ReactionUniqueness {
  std::string joint;
  int rows = 0;
  std::vector<bool> unique;   ///< Per row.
  int unique_dimension = 0;   ///< rows − rank(Z_joint).
  MatrixXd unique_basis;      ///< rows × unique_dimension: combinations of the rows (scaled) that are unique.
  bool participates = false;  ///< Some self-stress loads it.
  bool is_constraint = true;  ///< False: a generalized coordinate, which has no rows.
};

struct RedundancyReport {
  int bodies = 0, joints = 0;
  int coordinates = 0;  ///< Generalized coordinates, which carry no body.
  int constraint_rows = 0, rank = 0, mobility = 0, redundant = 0,
      grubler = 0;                                                  ///< Over all joints, 6 velocities a body.
  int closure_coordinates = 0, closure_rows = 0, closure_rank = 0;  ///< n, m, r in tree coordinates.
  RankDecision decision;                                            ///< On the scaled closure Jacobian.
  bool exact_values = true;  ///< False: some of the decision's values stand in for singular values (large clusters).
  double characteristic_length_m = 1;
  Selection selection;
  std::vector<int> excluded_rows;  ///< Rows of G left out.
  std::vector<std::string> excluded_row_names, independent_coordinate_names;
  SparseMatrixXd self_stresses;  ///< Z: all rows × redundant; columns of unit norm in scaled units, few entries each.
  std::vector<SelfStress> self_stress_places;  ///< Per column.
  std::vector<ReactionUniqueness> reactions;   ///< As `Model::joints` in file order, then couplings.
  AllRows rows;
  double inconsistency = 0;  ///< Largest |Zᵀ phi|, m: how far the geometry contradicts itself.
};

struct AnalysisOptions {
  double blur = 0;  ///< How far the geometry is from closing, over L: blurs the singular values (math/rank.h).
};

/// Analyses redundancy at `state` (which must be assembled).
RedundancyReport analyze_redundancy(const System& system, const State& state, const AnalysisOptions& options = {});

/// Only the rank decision and the selection, for use along a motion. `preferred_independent`: velocity indices to keep
/// independent where that is well conditioned.
Selection select_independent(const System& system, const Scaling& scaling, const ConstraintKinematics& constraints,
                             RankDecision* decision = nullptr);

/// Selection with the rank of each cluster as it was decided in `previous`, rows and coordinates chosen anew.
Selection reselect(const System& system, const Scaling& scaling, const ConstraintKinematics& constraints,
                   const Selection& previous);

/// Self-stresses over all rows (orthonormal in scaled units) from their closure rows' part (m × k).
MatrixXd complete_self_stresses(const System& system, const Scaling& scaling, const AllRows& rows,
                                const PositionKinematics& pos, const JointWrenches& joints,
                                const MatrixXd& closure_part);

/// Self-stresses over all rows at a pose, each on the joints of its own loops only, as many as `selection` leaves rows
/// out, or more where the pose itself has more: no rank is decided. For mechanisms whose self-stresses would not fit as
/// a dense matrix. Empty where the pose clearly has fewer than the selection leaves out. Cost: as that of a decision.
std::optional<SparseMatrixXd> find_self_stresses(const System& system, const Scaling& scaling, const AllRows& rows,
                                                 const PositionKinematics& pos, const JointWrenches& joints,
                                                 const ConstraintKinematics& constraints, const Selection& selection);

/// The closure rows' part of the self-stresses by elimination with a selection: no rank is decided. m × (m − r).
MatrixXd self_stresses_of_selection(const System& system, const Selection& selection, const PatternMatrix& G);

}  // namespace ferrers
