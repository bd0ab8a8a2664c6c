#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "ferrers/dynamics/forward.h"

/// Problem (inverse dynamics; the paper's direct problem): the motion of w coordinates is prescribed; find all
/// coordinates, the multipliers and the w drive efforts.
///
/// Given: drives with motion laws c_k(q) = f_k(t) that together with the constraints determine every coordinate.
/// At each instant, continued from the one before [stepanyan, "direct problem", steps 1-5]:
///   1. the laws f, f', f'';                       2. phi(q) = 0, c(q) = f         (Newton);
///   3. G v = 0, D v = f'  (linear);               4. G vdot = gamma, D vdot = f'' − (bias)  (linear);
///   5. M vdot + h − tau = Gᵀ lambda + Dᵀ u        (linear; the transposed matrix of 3 and 4).
/// With drives on tree coordinates D picks independent coordinates, which is the paper's partition.
namespace ferrers {

enum class PrescribedStatus {
  kSolved,
  kUndriven,    ///< Some motion is not prescribed: `message` names the coordinates. Nothing was computed.
  kOverdriven,  ///< Drives depend on each other or on the constraints: `message` names them. Nothing was computed.
  kNotReached,  ///< The prescribed positions cannot be reached at this time: the state is the last good one.
  kSingular,    ///< A singular pose of the driven mechanism (dead point): no accelerations or forces.
};

struct PrescribedResult {
  PrescribedStatus status = PrescribedStatus::kSolved;
  State state;
  VectorXd vdot;    ///< nv.
  VectorXd lambda;  ///< m, zero at the rows left out; valid after `solve_efforts`.
  VectorXd u;       ///< nu: efforts of the prescribed drives; those of others are their effort laws.
  std::string message;
};

/// Solves prescribed motion instant by instant; holds the decision and the work space.
class PrescribedMotion {
 public:
  /// `start`: an assembled state near the motion at its first time. Drives without a motion law act by their efforts.
  PrescribedMotion(std::shared_ptr<const DynamicsModel> model, State start);
  ~PrescribedMotion();
  PrescribedMotion(PrescribedMotion&&) noexcept;

  /// Decides whether the drives determine the motion. Call once; a status other than kSolved is final.
  PrescribedResult check() const;
  /// Steps 1-4 at time t (and 5 with `with_efforts`), continued from the last instant solved.
  PrescribedResult solve(double t, bool with_efforts = true);

  const Equations& equations() const;  ///< At the last instant solved.
  const Selection& selection() const;  ///< Rows chosen among the constraints, and coordinates.

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ferrers
