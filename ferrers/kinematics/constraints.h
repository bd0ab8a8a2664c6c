#pragma once

#include "ferrers/kinematics/constants.h"
#include "ferrers/kinematics/motion.h"
#include "ferrers/math/pattern_matrix.h"

namespace ferrers {

/// What the evaluation of one block needs besides its outputs, and what it finds.
struct FormulaEvaluation {
  std::vector<Jet> jets;        ///< Per scalar.
  std::vector<double> inputs;   ///< Values, rates, t.
  std::vector<double> outputs;  ///< See `FormulaBlock`.
};

/// The constraints of a system at one state, whatever its coordinates: what redundancy analysis and the equations of
/// motion consume.
///
///   phi(q) = 0,   G v = nu,   G vdot = gamma(q, v)        [stepanyan, eq. (1), (3), (4)]
///
/// nu is 0 but for relations that know the time; rows of prescribed motions may follow the system's own
/// (dynamics/equations.h). Rows are named (`System::row_names`).
struct ConstraintKinematics {
  VectorXd phi;                             ///< m: residual, m or rad.
  PatternMatrix G;                          ///< m × nv: exact Jacobian, also off the manifold.
  VectorXd gamma;                           ///< m.
  VectorXd rate;                            ///< m: G v.
  VectorXd nu;                              ///< m.
  std::vector<FormulaEvaluation> formulas;  ///< Work space, per block of relations.
  Eigen::RowVectorXd whole_row;             ///< Work space, nv; zero between uses.
};

/// Per row, the velocity coordinates that it can touch, ascending; the same for all rows of a joint.
std::vector<std::vector<int>> columns_of_rows(const System& system);

/// `driven_columns`: those of further rows after the system's own.
ConstraintKinematics make_constraint_kinematics(const System& system,
                                                const std::vector<std::vector<int>>& driven_columns = {});

/// Fills phi, G, gamma and rate. Allocates nothing. Cost: O(Σ rows × length of their loops).
void compute_constraints(const System& system, const State& state, const PositionKinematics& pos,
                         const VelocityKinematics& vel, ConstraintKinematics& out);
/// Of these the rows of couplings and formulas alone.
void compute_coupling_rows(const System& system, const State& state, const PositionKinematics& pos,
                           const VelocityKinematics& vel, ConstraintKinematics& out);

/// Relative motion of two frames; `acc` holds bias accelerations (or complete ones: then a jet's `bias` is all of f'').
template <class T>
BasicRelativeMotion<T> compute_relative_motion(const FramePair& pair, const BasicPositionKinematics<T>& pos,
                                               const BasicVelocityKinematics<T>& acc);

/// The rows of a joint that closes a loop, on the coordinates of the loop: calls `write(row, coordinate, value)` with
/// rows counted from 0. Each coordinate's twist is brought to p_M once for all rows.
template <class T, class Write>
void for_each_entry(const System& system, const CutJoint& cut, const BasicPositionKinematics<T>& pos,
                    const BasicJet<T>* rows, Write write);

/// Row of G of a jet: G v = W · V_rel. Adds `scale` times it to `row` (nv).
void add_jet_row(const System& system, const FramePair& pair, const PositionKinematics& pos, const Wrench& W,
                 double scale, Eigen::Ref<Eigen::RowVectorXd> row);

/// The turns of all cut angles at these poses, continued from `state.winding`.
void accept_winding(const System& system, const PositionKinematics& pos, State& state);

/// The fastest of these turns, rad/s. What goes on for longer than π over it loses count.
double fastest_turn(const System& system, const PositionKinematics& pos, const VelocityKinematics& vel);

/// Jets of all rows of one joint (in the tree or cut) at these poses, world axes at p_M; `acc` as above.
/// Shapes: row_count of the joint's type. A tree joint's rows vanish by construction; their wrenches W matter.
void compute_joint_rows(const System& system, JointId joint, const State& state, const PositionKinematics& pos,
                        const VelocityKinematics& acc, RelativeMotion& motion, Jet* rows);

// ---------------------------------------------------------------------------------------------------------------------

template <class T, class Write>
void for_each_entry(const System& system, const CutJoint& cut, const BasicPositionKinematics<T>& pos,
                    const BasicJet<T>* rows, Write write) {
  using Vector = Eigen::Matrix<T, 3, 1>;
  const int count = cut.type->row_count();
  const auto& n2 = pos.nodes[cut.frames.node_2];
  const Vector p_M = n2.p + n2.R * as_constants<T>(cut.frames.X_2M.p);
  for (const FramePair::PathEntry& entry : cut.frames.path) {
    const Node& node = system.nodes[entry.node];
    const Vector lever = p_M - pos.nodes[entry.node].p;
    for (int k = node.v; k < node.v + node.nv; ++k) {
      const Vector w = T(entry.sign) * pos.S[k].template head<3>();
      const Vector v = T(entry.sign) * pos.S[k].template tail<3>() + w.cross(lever);
      for (int i = 0; i < count; ++i) {
        write(i, k, rows[i].W.template head<3>().dot(w) + rows[i].W.template tail<3>().dot(v));
      }
    }
  }
}

}  // namespace ferrers
