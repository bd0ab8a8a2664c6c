#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string_view>

#include "ferrers/dynamics/equations.h"
#include "ferrers/redundancy/analysis.h"

/// Problem (forward dynamics; the paper's inverse problem): accelerations and multipliers for given forces
/// [stepanyan, eq. (8), (9)].
///
/// Given: the equations at a state and a selection of independent rows and coordinates. Wanted: vdot with G_r vdot =
/// gamma_r and lambda with M vdot = force + G_rᵀ lambda. Rows left out get lambda = 0; where reactions are not unique
/// this is one of many (see redundancy/analysis.h). Every formulation has this one signature, lives in its own file,
/// and agrees with the others to rounding (tested).
namespace ferrers {

/// Which when, by measurement (bench/evaluation_bench.cc): the sparse form is the fastest at every size, and as
/// accurate as the null-space form, which it equals without its zeros. The null-space form pivots its rows anew at
/// every evaluation where the sparse form keeps its order: it is the reference. Elimination is the paper's; near a
/// singular pose it loses twice the digits. The augmented Lagrangian needs no decision and takes contradictory rows.
/// Equations and solution together in µs, least of repeated runs on a busy core (x86-64-v2); N: chain of N four-bars.
///                         four-bar  Bricard  N = 10  N = 40  N = 100  N = 300
///   null-space                0.67      1.0     6.3      59      730    14000
///   elimination               0.87      1.8     8.9     210     2700    43000
///   sparse                    0.43      0.7     3.2      13       50      130
///   augmented Lagrangian       1.3      2.8      14     160     1000     9300
enum class Formulation {
  kNullSpace,            ///< v = N z from the selected coordinates; needs M regular on the admissible motions only.
                         ///< Cost: O(n² w + r³).
  kElimination,          ///< The paper's: dependent rows left out, multipliers from G M⁻¹ Gᵀ. Needs M regular.
                         ///< Cost: O(n³ + n r²).
  kSparse,               ///< The null-space form without zeros (forward_kkt.h). Cost: linear in local loops.
  kAugmentedLagrangian,  ///< All rows, any rank, by a penalty made exact by multipliers (forward_augmented.cc).
                         ///< Cost: O(n³ + m n) and a few passes of O(n² + m n).
};
inline constexpr std::array<Formulation, 4> kFormulations = {Formulation::kNullSpace, Formulation::kElimination,
                                                             Formulation::kSparse, Formulation::kAugmentedLagrangian};
std::string_view to_string(Formulation formulation);
std::optional<Formulation> find_formulation(std::string_view name);
/// What to take where nothing speaks for another one, at any size; see the figures above.
Formulation recommended_formulation();

enum class ForwardStatus {
  kSolved,         ///< vdot and lambda are valid.
  kSingularMass,   ///< The mass matrix is singular on the admissible motions: outputs are not valid.
  kWornSelection,  ///< The chosen rows or coordinates no longer fit: select again. Outputs are not valid.
  kNotConverged,   ///< An iteration ran out of its bound: outputs are its last values, not accurate.
};

struct ForwardResult {
  ForwardStatus status = ForwardStatus::kSolved;
  VectorXd vdot;    ///< nv.
  VectorXd lambda;  ///< m; zero at the rows left out.
};

class SparseKkt;

/// A formulation with its work space for one selection.
class ForwardSolver {
 public:
  virtual ~ForwardSolver() = default;
  /// Allocates nothing, but for the sparse form's first time: it chooses its order of elimination then.
  virtual void solve(const Equations& eq, ForwardResult& out) = 0;
  /// The same matrices with other right sides: M vdot = force + G_rᵀ lambda, G_r vdot = gamma_r, with the factors of
  /// the last `solve`, whose equations must still have the M and G they had. `gamma`: m. Allocates nothing; O(n²) where
  /// `solve` is O(n³). What projections and linearizations want.
  virtual void resolve(const VectorXd& force, const VectorXd& gamma, ForwardResult& out) = 0;
  /// Smallest pivot of the last factorization of the chosen rows: compare it with the one when they were chosen. It
  /// falls in proportion to the distance from a pose where those rows lose rank (the augmented Lagrangian's only down
  /// to 3e-5 of its healthy size).
  virtual double smallest_pivot() const = 0;
  /// The order in which the equations are eliminated, where that never changes and is known by now; else null.
  virtual const SparseKkt* order() const { return nullptr; }
};

std::unique_ptr<ForwardSolver> make_forward_solver(Formulation formulation, const System& system,
                                                   const Selection& selection);
std::unique_ptr<ForwardSolver> make_null_space_solver(const System& system, const Selection& selection);
std::unique_ptr<ForwardSolver> make_elimination_solver(const System& system, const Selection& selection);
std::unique_ptr<ForwardSolver> make_sparse_solver(const System& system, const Selection& selection);
std::unique_ptr<ForwardSolver> make_augmented_solver(const System& system, const Selection& selection);

/// `rows`: of the constraints; as many as the system has, and driven ones if there are any.
ForwardResult make_forward_result(const System& system);
ForwardResult make_forward_result(const Equations& eq);

}  // namespace ferrers
