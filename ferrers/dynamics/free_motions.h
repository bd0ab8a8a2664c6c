#pragma once

#include <string>
#include <vector>

#include "ferrers/kinematics/coordinates.h"
#include "ferrers/kinematics/scaling.h"

/// Problem: prescribed motions leave some motion of a mechanism free; which, and what would have to be driven?
///
/// Given: the free motions at a state, columns of an nv × d basis F, orthonormal in scaled units. Every joint
/// coordinate that is a scalar, in the tree or cut, has a row c of rates per free motion, c = (∂ rate/∂v) F in scaled
/// units. Wanted: the coordinates that move (c ≠ 0), and d of them (or as many as there are independent ones) whose
/// rows are best conditioned: driving these would leave nothing free at this pose. Neither depends on the basis nor on
/// the choice of cut joints. Cost: O(coordinates · nv · d).
namespace ferrers {

struct FreeMotions {
  int count = 0;                          ///< d.
  std::vector<JointCoordinate> moving;    ///< In the order of the model file.
  std::vector<JointCoordinate> to_drive;  ///< Fewer than d where spherical or free joints move: drive points there.
  std::string message;
};

FreeMotions find_free_motions(const System& system, const Scaling& scaling, const State& state,
                              const PositionKinematics& pos, const VelocityKinematics& vel, const MatrixXd& free);

}  // namespace ferrers
