#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "ferrers/dynamics/forward.h"
#include "ferrers/dynamics/reactions.h"
#include "ferrers/testing/absolute_solver.h"
#include "ferrers/testing/random_source.h"

/// The engine beside its witness: one mechanism, laid out for evaluation, at states that either of them gives.
namespace ferrers::witness {

/// The tree coordinates of an absolute state, which must satisfy the tree joints (angles within half a turn of the
/// drawing).
State tree_state(const System& system, const AbsoluteState& absolute);

/// The absolute state of tree coordinates.
AbsoluteState absolute_state(const System& system, const State& state);

/// A mechanism with everything that one evaluation needs.
struct EngineProbe {
  std::shared_ptr<const System> system;
  std::shared_ptr<const DynamicsModel> dynamics;
  Scaling scaling;
  Equations eq;
  Selection selection;

  /// Throws `std::invalid_argument` with the first diagnostic when the specification does not build.
  explicit EngineProbe(const ModelSpec& spec, const TopologyOptions& options = {});

  const Model& model() const { return *system->model; }

  /// The mechanism as the engine assembles it, with its initial velocities. Throws when it does not assemble.
  State start() const;

  /// Random coordinates put on the constraints from the drawn pose, and random admissible velocities of order `speed`.
  State wandered(std::uint64_t seed, double distance = 0.3, double speed = 1);

  /// Fills `eq` and `selection` at `state`.
  void evaluate(const State& state);

  /// Evaluates, decides and solves.
  ForwardResult forward(const State& state, Formulation formulation = Formulation::kNullSpace);

  /// Accelerations of all bodies in the witness's form: dω/dt and the acceleration of the mass centre; ground zero.
  /// `evaluate` must have been called at the state.
  std::vector<Vector6d> body_accelerations(const VectorXd& vdot) const;

  /// Of the joints alone, without multipliers of couplings.
  std::vector<JointReaction> reactions(const State& state, const ForwardResult& result,
                                       ReactionAxes axes = ReactionAxes::kWorld) const;
};

}  // namespace ferrers::witness
