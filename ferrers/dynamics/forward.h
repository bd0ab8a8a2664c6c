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

enum class Formulation {
  kNullSpace,            ///< v = N z from the selected coordinates; needs M regular on the admissible motions only.
                         ///< Cost: O(n² w + r³).
  kElimination,          ///< The paper's: dependent rows left out, multipliers from G M⁻¹ Gᵀ. Needs M regular.
                         ///< Cost: O(n³ + n r²).
  kSparse,               ///< The null-space form without zeros (forward_kkt.h). Cost: linear in local loops.
  kAugmentedLagrangian,  ///< All rows, whatever their rank, by a penalty and multipliers iterated
                         ///< (forward_augmented.cc). Cost: O(n³ + m n²).
};
inline constexpr std::array<Formulation, 4> kFormulations = {Formulation::kNullSpace, Formulation::kElimination,
                                                             Formulation::kSparse, Formulation::kAugmentedLagrangian};
std::string_view to_string(Formulation formulation);
std::optional<Formulation> find_formulation(std::string_view name);
/// The fastest accurate one for a mechanism of this size, by measurement.
Formulation recommended_formulation(const System& system);

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

/// A formulation with its work space for one selection.
class ForwardSolver {
 public:
  virtual ~ForwardSolver() = default;
  /// Allocates nothing.
  virtual void solve(const Equations& eq, ForwardResult& out) = 0;
  /// The same matrices with other right sides: M vdot = force + G_rᵀ lambda, G_r vdot = gamma_r, with the factors of
  /// the last `solve`, whose equations must still have the M and G they had. `gamma`: m. Allocates nothing; O(n²) where
  /// `solve` is O(n³). What projections and linearizations want.
  virtual void resolve(const VectorXd& force, const VectorXd& gamma, ForwardResult& out) = 0;
  /// Smallest pivot of the last factorization of the chosen rows: compare it with the one when they were chosen.
  virtual double smallest_pivot() const = 0;
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
