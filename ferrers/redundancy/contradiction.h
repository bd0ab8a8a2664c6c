#pragma once

#include <string>
#include <vector>

#include "ferrers/kinematics/assembly.h"
#include "ferrers/math/rank.h"

/// Problem: contradiction is not redundancy. A row that repeats others either agrees with them, and nothing is lost, or
/// asks for something else, and the mechanism cannot be put together at all. By how much, and which joints quarrel?
///
/// Given: what assembly reached. Wanted: whether loops that stay open contradict themselves (phi is in equilibrium as a
/// load, Gᵀ y = 0 with y ~ phi: no displacement brings them nearer) or were merely not closed; the misclosure zᵀ phi of
/// each cluster of loops with the self-stress z on which it stands; and whether joints with stiffness take it up.
/// The pose is the best fit of redundancy/best_fit.h, so that neither it nor the misclosure depends on units, axes or
/// the choice of cut joints (to first order in the misclosure).
/// A misclosure ε blurs singular values by about ε/L: rank at that pose is decided with the blur told (math/rank.h).
/// One that may be rounded input, about 1e-11 … 1e-8 of L, is in doubt: then both readings are given. Nothing is
/// repaired: verdicts describe the model as given. Cost: nothing to speak of where all closes; else that of best fits
/// of the open clusters, dense.
namespace ferrers {

enum class ClosureVerdict {
  kCloses,         ///< Every loop closes at `state`.
  kElastic,        ///< Loops contradict themselves and joints with stiffness take that up: `misfit` is theirs.
  kContradictory,  ///< No pose closes them: `contradictions` tells by how much.
  kNotFound,       ///< No pose near closing was reached, or only the initial positions are at odds.
};
std::string_view to_string(ClosureVerdict verdict);

/// How far one joint would have to give. Contradictory: with all joints giving alike; elastic: by their stiffness.
struct JointGap {
  std::string joint;
  double gap_m = 0, angle_rad = 0;
};

/// What one cluster of loops misses.
struct Contradiction {
  bool angular = false;    ///< The self-stress is of moments only: `misclosure` is in rad, else in m.
  bool has_joints = true;  ///< False: couplings and constraints only, `misclosure` in their own unit.
  double misclosure = 0;   ///< zᵀ phi > 0.
  VectorXd self_stress;    ///< z, all joints' rows, SI: the largest force in a joint 1 N (if angular, moment 1 N·m).
  double residual_m = 0;   ///< Least root of the sum of squares of all joints' gaps, angles times L.
  std::vector<JointGap> joints;  ///< Those that the self-stress loads, in the order of the file.
};

/// How far a body lies from where it was drawn.
struct LargestMove {
  std::string body, turned_body;
  double distance_m = 0, angle_rad = 0;
};

struct ContradictionReport {
  ClosureVerdict verdict = ClosureVerdict::kCloses;
  bool confident = true;  ///< False: closed and contradictory are both tenable, see `text`.
  State state;            ///< Assembled; elastic and contradictory: the best fit. At rest.
  double residual_m = 0;  ///< Over all clusters, like `Contradiction::residual_m`.
  double blur = 0;        ///< residual_m over the characteristic length: for rank decisions at `state`.
  VectorXd misfit;        ///< phi at `state` (m numbers, SI): the delta of the force method.
  std::vector<Contradiction> contradictions;  ///< Largest residual first; also where in doubt.
  /// The reading that the loops close but for rounding; set unless all closes confidently.
  RankDecision if_closed;
  int mobility_if_closed = 0, redundant_if_closed = 0;
  LargestMove moved;
  bool stiffness_in_vain = false;  ///< Contradictory although joints have stiffness: none where it is needed.
  std::string text, hint;          ///< For the designer; empty where all closes confidently.
};

ContradictionReport analyze_contradiction(const System& system, const AssemblyResult& assembly);

/// "0.52 µm", "3 mm", "1.2 m"; "4 µrad", "2 mrad".
std::string length_text(double length_m);
std::string angle_text(double angle_rad);

}  // namespace ferrers
