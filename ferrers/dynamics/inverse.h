#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "ferrers/dynamics/friction.h"

/// Problem (inverse dynamics; the paper's direct problem): motions are prescribed; find all coordinates, the
/// multipliers and the drive efforts.
///
/// Given: drives with motion laws c_k(q) = f_k(t) that together with the constraints determine every coordinate.
/// At each instant, continued from the one before [stepanyan, "direct problem", steps 1-5]:
///   1. the laws f, f', f'';                       2. phi(q) = 0, c(q) = f         (Newton);
///   3. G v = 0, D v = f'  (linear);               4. G vdot = gamma, D vdot = f'' − (bias)  (linear);
///   5. M vdot + h − tau = Gᵀ lambda + Eᵀ u        (linear; the transposed matrix of 3 and 4).
/// With drives on tree coordinates D picks independent coordinates, which is the paper's partition.
///
/// More laws than the mechanism has motions: as many are followed as it has, chosen well conditioned at every instant;
/// the others are watched and must agree with them, position, rate and acceleration.
/// More drives than motions: E has the rows of all drives that have a motion law, and of those that have no law at all
/// (these help). Then u is not unique; the least weighted effort is taken, min Σ (weight_k u_k)², and what the choice
/// bears on is told: `effort_is_shared`, and `equations().idle_efforts` for the reactions. Drives with an effort law
/// alone act by it. Dry friction is solved for with the efforts, whose sharing is the least for the friction found.
/// Cost of an instant: O(nv³) per Newton step.
namespace ferrers {

/// How well a motion law must agree with what other laws or the constraints make of it: positions relative to the
/// model's size, rates and accelerations relative to the motion. Tables and measured laws agree to their digits only,
/// above all in their derivatives.
inline constexpr std::array<double, 3> kLawAgreement = {1e-8, 1e-6, 1e-4};

enum class PrescribedStatus {
  kSolved,
  kUndriven,       ///< Some motion is not prescribed: `message` names what moves and what to drive. Nothing computed.
  kContradictory,  ///< Prescribed motions contradict each other: `message` says which, when and by how much.
  kNotReached,     ///< The prescribed positions cannot be reached at this time: the state is the last good one.
  kUndefined,      ///< A law has no finite value, rate or acceleration at this time: `message` says whose.
  kSingular,       ///< A singular pose of the driven mechanism (dead point): no accelerations or forces.
  kUndeterminedFriction,  ///< Friction depends on reactions that are not unique (dynamics/friction.h): no forces.
  kJammed,                ///< No friction agrees with the reactions that it causes: no forces.
};

struct PrescribedResult {
  PrescribedStatus status = PrescribedStatus::kSolved;
  State state;
  VectorXd vdot;    ///< nv.
  VectorXd lambda;  ///< m, zero at the rows left out; valid after `solve_efforts`.
  VectorXd u;       ///< nu: efforts that hold the motion; of drives with an effort law alone, that.
  /// nu: the motion does not determine this effort; it is the share of the least weighted effort.
  std::vector<bool> effort_is_shared;
  std::vector<JointCoordinate> to_drive;  ///< kUndriven: drives on these would determine most of what moves.
  std::string message;
};

/// Solves prescribed motion instant by instant; holds the decision and the work space.
class PrescribedMotion {
 public:
  /// `start`: an assembled state near the motion at its first time. `options`: how dry friction takes reactions that
  /// rigid bodies leave open.
  PrescribedMotion(std::shared_ptr<const DynamicsModel> model, State start, const DistributionOptions& options = {});
  ~PrescribedMotion();
  PrescribedMotion(PrescribedMotion&&) noexcept;

  /// Decides whether the drives determine the motion. A status other than kSolved is final.
  PrescribedResult check() const;
  /// Steps 1-4 at time t (and 5 with `with_efforts`), continued from the last instant solved.
  PrescribedResult solve(double t, bool with_efforts = true);

  const Equations& equations() const;  ///< At the last instant solved.
  const Selection& selection() const;  ///< Rows chosen among the constraints, and coordinates.
  /// Ranks in doubt: at the start, and at the first singular pose met.
  const std::vector<std::string>& notices() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ferrers
