#pragma once

#include "ferrers/kinematics/motion.h"

namespace ferrers {

/// The model's `initial` positions sorted by how they can be met: coordinates of tree joints are set and held, those of
/// cut joints are reached by Newton steps, guesses only start the search.
struct InitialValues {
  struct TreeTarget {
    int q = 0, v = 0;
    bool rotation = false;  ///< Four values of a quaternion from q on, three velocities from v on.
    double value[4] = {};
  };
  struct CutTarget {
    CoordinateAccess access;
    double value = 0;
  };
  /// Pose of a cut spherical joint (rotation only) or free joint.
  struct CutPose {
    int cut = 0;  ///< Index into `System::cuts`.
    Pose X_FM;
    bool position = false;
  };
  std::vector<TreeTarget> exact, guesses;
  std::vector<CutTarget> cut;
  std::vector<CutPose> cut_poses;
  std::vector<int> held;  ///< Velocity indices that `exact` fixes.

  bool any_exact() const { return !exact.empty() || !cut.empty() || !cut_poses.empty(); }
  void apply_guesses(const System& system, State& state) const;
  /// How many steps take the held coordinates to their values (about 0.1 rad each).
  int steps(const Scaling& scaling, const State& from) const;
  void apply_exact(const State& from, double fraction, State& state) const;
  /// Moves the other coordinates until the cut joints' targets hold too. False if they cannot.
  bool meet_cut_targets(const System& system, const Scaling& scaling, State& state, int& iterations) const;
};

InitialValues read_initial_values(const System& system);

/// The drawn state with guesses and exact positions of tree coordinates put in as they are.
State make_guessed_state(const System& system);

}  // namespace ferrers
