#pragma once

#include <string>
#include <vector>

#include "ferrers/dynamics/forward.h"
#include "ferrers/kinematics/scaling.h"
#include "ferrers/redundancy/analysis.h"

/// Problem: a motion law that a simulation follows may have no value, or ask for what the constraints do not allow.
///
/// Given: the equations at a state, with `Equations::driven`; `implied`: rows of these (positions in `driven`) that the
/// constraints imply by themselves, out of the plane of a planar mechanism say. Such a drive has no say in the motion;
/// its law must agree with what the constraints make of it, position, rate and acceleration, and an effort of it would
/// be balanced by the joints alone. Times in s.
namespace ferrers {

/// Which law has a value, rate or acceleration at time t that is no finite number, in words; empty: none.
std::string find_law_without_value(const DynamicsModel& model, const Equations& eq, double t);

/// Which implied law differs from what the constraints make of it, in words; empty: none. `eq` and `vdot` (nv): of a
/// state that is on the constraints, positions and velocities.
std::string find_law_against_constraints(const DynamicsModel& model, const Scaling& scaling, const Equations& eq,
                                         const std::vector<int>& implied, const VectorXd& vdot, double t);

/// Fills `eq.idle_efforts` and `eq.idle_lambda`: a unit effort of each implied drive and the multipliers that balance
/// it. `joints`: selection of the system's own rows.
void compute_idle_drives(const System& system, const Selection& joints, const std::vector<int>& implied, Equations& eq);

}  // namespace ferrers
