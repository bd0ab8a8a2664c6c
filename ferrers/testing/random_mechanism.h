#pragma once

#include <cstdint>
#include <string>

#include "ferrers/model/spec.h"
#include "ferrers/testing/absolute_solver.h"

/// Random mechanisms for property tests: the same seed gives the same mechanism (of one compiler).
///
/// A mechanism is grown from ground (sometimes from a free body) by one to four pieces, each a loop or two hung on a
/// body that is there already: planar, spherical and parallelogram loops, Bennett and Bricard linkages, doubled hinges
/// and welds, geared pairs with a coupling beside the mesh (all redundant), generic loops of random joints with at
/// least seven freedoms, arms held by a rod, a line or a plane, and coupled hinges (not redundant). At most five loops;
/// all joint types occur; random masses, mass centres and full inertia tensors; the whole is turned and moved at
/// random.
namespace ferrers::witness {

struct RandomMechanism {
  std::uint64_t seed = 0;
  std::string description;  ///< The pieces, for messages: "planar4 + bennett".
  ModelSpec spec;           ///< Drawn form; no forces but gravity.
  int loops = 0;            ///< joints − bodies (couplings not counted), at most 5.
  AbsoluteVerdict verdict;  ///< At the drawn pose; the mobility is at least 1 and the rank is clear.
};

/// Cost: a few dense singular value decompositions. Mechanisms without mobility, or whose smallest kept singular value
/// is below 1e-4 of the largest, are thrown away and grown again.
RandomMechanism make_random_mechanism(std::uint64_t seed);

/// The mechanism moved away from its drawn pose, and moving: `steps` random admissible displacements of relative size
/// `step`, each put back on the constraints, then random admissible velocities of order one.
AbsoluteState wandered(const Model& model, std::uint64_t seed, int steps = 5, double step = 0.03);

}  // namespace ferrers::witness
