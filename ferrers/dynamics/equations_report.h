#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "ferrers/dynamics/inverse.h"

/// Problem: the equations of a mechanism at one state, whole and in numbers, to be read, checked and put beside others.
///
/// Given: a model and a state. Wanted: every quantity of the system [stepanyan, eqs. (6)-(9)]
///
///   (6) phi(q) = 0    (7) G v = nu    (8) G vdot = gamma    (9) M vdot + h = tau + B u + Gᵀ lambda
///
/// with the decision that it stands on (which r of the m rows count, which w = n − r coordinates are independent, how
/// certain that is), its solution, and what the solution leaves in each of the four groups, rows left out included.
/// With r of the rows the groups are 3r + n equations.
/// What the solution is found for: efforts u given, motion wanted (forward dynamics, the paper's inverse problem), or
/// the motions of drives given, efforts wanted (inverse dynamics, the paper's direct problem).
/// A multiplier is told as unique only where no self-stress touches it. The solver's own multipliers, which are zero at
/// the rows left out, are one choice of many: they stand apart under a name that says so.
/// Cost: that of `analyze_redundancy` and of one evaluation, O(n³ + m² n).
namespace ferrers {

enum class EquationsProblem {
  kForward,  ///< Efforts by their laws, else 0; accelerations and multipliers are found.
  kInverse   ///< Motions by their laws; all coordinates, multipliers and efforts are found.
};

enum class EquationsStatus {
  kSolved,
  kSingularMass,          ///< Some motion has no inertia: the equations are told, there is no solution.
  kUndeterminedFriction,  ///< Dry friction depends on reactions that are not unique: no solution.
  kJammed,                ///< No dry friction agrees with the reactions that it causes: no solution.
  kBadMotion,             ///< Inverse: motions are missing, contradict each other, or have no value: nothing computed.
  kNotReached,            ///< Inverse: the prescribed positions cannot be reached: nothing computed.
  kSingular,              ///< A singular pose, where the equations have no finite solution: no solution.
};

/// How well one group of equations holds, over all its rows, those left out included.
struct EquationResidual {
  int equation = 6;    ///< 6 to 9.
  double largest = 0;  ///< Largest magnitude of left less right side, angles and moments by the characteristic length.
  double size = 0;     ///< What to compare it with, alike scaled: the largest sum of magnitudes of a row's terms; for
                       ///< (6) the characteristic length.
  std::string unit;    ///< Of both: m, m/s, m/s², N.
  std::string at;      ///< The row or coordinate where it is largest; empty: all are zero.
  double relative() const { return size > 0 ? largest / size : largest; }
};

struct EquationsReport {
  EquationsProblem problem = EquationsProblem::kForward;
  EquationsStatus status = EquationsStatus::kSolved;
  std::string message;  ///< What a status other than kSolved means here.

  // The decision.
  int n = 0, m = 0, r = 0, w = 0;  ///< Coordinates, rows, their rank, mobility.
  Selection selection;
  RankDecision decision;
  bool exact_values = true;  ///< False: some of its values stand in for singular values (large clusters).
  double characteristic_length_m = 1;
  std::vector<std::string> position_names;    ///< nq.
  std::vector<std::string> coordinate_names;  ///< n, as `System::coordinate_names`.
  std::vector<std::string> row_names;         ///< m, as `System::row_names`.
  std::vector<std::string> coordinate_units;  ///< n: rad or m; empty where not known.
  std::vector<std::string> row_units;         ///< m: of phi.
  std::vector<int> excluded_rows;             ///< m − r.
  int equation_count() const { return 3 * r + n; }

  // The equations: valid but for kBadMotion and kNotReached.
  bool has_equations = false;
  State state;          ///< q (nq), v (n), t.
  Equations equations;  ///< phi, G, nu, gamma, M, h, tau, B; dry friction that was solved for is in tau.

  // The solution: valid with kSolved.
  VectorXd vdot;                 ///< n.
  VectorXd lambda_of_kept_rows;  ///< m: the multipliers with those of the rows left out zero, one choice of many.
  /// m: kUnique, kUndetermined; kDistributed where only the sharing of efforts among drives bears on it.
  std::vector<ReactionStatus> lambda_status;
  VectorXd u;                          ///< nu.
  std::vector<bool> effort_is_found;   ///< nu: not by a law, but as the motion needs it.
  std::vector<bool> effort_is_shared;  ///< nu: not unique, the share of the least weighted effort (dynamics/inverse.h).
  std::vector<EquationResidual> residuals;  ///< (6) and (7), with a solution (8) and (9) as well.
  std::vector<std::string> notices;         ///< A rank in doubt, and equations that do not hold.

  bool solved() const { return status == EquationsStatus::kSolved; }
};

/// Everything at `state`, which must be assembled; laws are taken at `state.t`, s. With kInverse the state is where the
/// walk to the prescribed positions starts; the report's own state is the one reached.
/// Throws `std::invalid_argument` where `model` is null or the state's sizes are not the model's.
EquationsReport analyze_equations(const std::shared_ptr<const DynamicsModel>& model, const State& state,
                                  EquationsProblem problem = EquationsProblem::kForward);

/// The multipliers that every solution shares: no null vector of Gᵀ over the rows, and no effort that drives share,
/// touches them. `eq` filled at a state of which `selection` is the decision. Shape: m.
/// Cost: O(m (m − r)²).
std::vector<ReactionStatus> judge_multipliers(const DynamicsModel& model, const Equations& eq,
                                              const Selection& selection);

/// What `vdot` (n), `lambda` (m) and `u` (nu) leave of (6)-(9) in `eq`; without `vdot`, `lambda` and `u` (empty) of (6)
/// and (7). `v`: n. Cost: O(m n + n²).
std::vector<EquationResidual> measure_residuals(const DynamicsModel& model, const Equations& eq, const VectorXd& v,
                                                const VectorXd& vdot, const VectorXd& lambda, const VectorXd& u);

}  // namespace ferrers
