#pragma once

#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "ferrers/kinematics/coordinates.h"
#include "ferrers/kinematics/formula_rows.h"

/// A system with its inertias, force elements and drives laid out for evaluation. Const; shared.
namespace ferrers {

struct NodeInertia {
  double mass_kg = 0;
  Vector3d com_N = Vector3d::Zero();  ///< Mass centre in the node frame, m.
  Matrix3d I_N = Matrix3d::Zero();    ///< About the mass centre, node axes, kg·m².
};

/// A law with its inputs resolved to coordinates.
struct BoundLaw {
  Law law;
  std::vector<LawInput::Kind> kinds;
  std::vector<CoordinateAccess> accesses;  ///< One per input; unused for time.
  double evaluate(const System& system, const State& state, const PositionKinematics& pos,
                  const VelocityKinematics& vel) const;
};

struct BoundSpring {
  NodePoint point_1, point_2;
  double stiffness = 0, damping = 0, free_length_m = 0;
};
struct BoundTorsionSpring {
  CoordinateAccess access;
  double stiffness = 0, damping = 0, free_angle = 0;
};
struct BoundBushing {
  FramePair frames;
  Vector6d stiffness, damping;
};
struct BoundLoad {
  NodePoint point;
  Matrix3d R_NB = Matrix3d::Identity();  ///< Body axes in the node frame.
  bool is_torque = false, in_body_axes = false;
  std::array<BoundLaw, 3> components;
};

/// Dry friction in a joint (see dynamics/friction.h): where its parts slide on each other, and what presses them.
struct BoundFriction {
  JointId joint;
  FramePair frames;
  double coulomb = 0, radius_m = 0;
  double slip_scale = 0;             ///< Slip speed over which friction builds up, m/s.
  int first = 0;                     ///< Its first slip among all.
  int slips = 0;                     ///< How many directions it can slip in.
  std::array<int, 6> components{};   ///< Per slip: along (0-2) or about (3-5) which axis of F.
  std::vector<int> forces, moments;  ///< Reaction components in F that press the parts together, 0-2 and 3-5.
};

/// Energies and forces by formulas, compiled (dynamics/lagrangian_terms.h).
struct BoundLagrangian {
  std::vector<CoordinateAccess> scalars;
  bool in_tree = true;                            ///< All scalars are entries of q and v.
  std::vector<std::pair<int, int>> mass;          ///< M_kl that are not always zero, k ≤ l.
  std::vector<std::pair<int, int>> mass_pattern;  ///< Entries of M that they can reach.
  StateProgram inertia;                           ///< The M_kl in the order of `mass`, then h_k.
  StateProgram force;                             ///< Q_k.
  StateProgram energy;                            ///< Kinetic and potential part, power of time.
  bool has_forces = false, power_of_time = false;
};
FormulaEvaluation make_lagrangian_evaluation(const BoundLagrangian& bound);

/// One scalar that a drive moves: a joint coordinate, the distance of two points, a component of a point's position, or
/// a quantity by a formula.
struct DriveComponent {
  std::string name;
  DriveId drive;
  int component = 0;
  Drive::Kind kind = Drive::Kind::kCoordinate;
  JointCoordinate coordinate;
  CoordinateAccess access;  ///< kCoordinate.
  FramePair frames;         ///< kDistance, kPoint: origins of F and M are the points.
  FormulaBlock formula;     ///< kFormula: one row, s and its gradient d.
  bool acts = true;         ///< False: its motion is prescribed, but no effort of it is sought (`motions`).
  std::optional<Law> motion;
  std::optional<BoundLaw> effort;
  double weight = 1;     ///< Of its effort where drives share a load.
  bool rotary = false;   ///< Its effort is a torque, N·m.
  bool has_unit = true;  ///< False: by a formula, or on a coordinate that is neither an angle nor a length.
  /// Whether inverse dynamics finds its effort: a motion is prescribed, or it has no law at all and helps.
  bool effort_is_sought() const { return acts && (motion.has_value() || !effort.has_value()); }
};

class ForwardPrograms;

/// What has been made for one model and is found again by its next user (dynamics/forward_program.h). A copy of a model
/// may become another one: it begins with nothing.
class FoundPrograms {
 public:
  FoundPrograms();
  FoundPrograms(const FoundPrograms& other);
  FoundPrograms& operator=(const FoundPrograms& other);
  ForwardPrograms* operator->() const { return programs_.get(); }

 private:
  std::shared_ptr<ForwardPrograms> programs_;
};

struct DynamicsModel {
  std::shared_ptr<const System> system;
  std::vector<NodeInertia> inertias;  ///< Per node.
  std::vector<BoundSpring> springs;
  std::vector<BoundTorsionSpring> torsion_springs;  ///< Also joint damping and viscous joint friction.
  std::vector<BoundBushing> bushings;               ///< Also viscous friction of joints without scalar coordinates.
  std::vector<BoundLoad> loads;
  std::vector<BoundFriction> frictions;      ///< Dry friction; depends on reactions.
  int friction_slips = 0;                    ///< nf: slips of all frictions.
  std::vector<DriveComponent> drives;        ///< nu of them.
  std::vector<BoundLaw> events;              ///< Formulas of `Model::events()`.
  std::vector<BoundLaw> recorded;            ///< Of `Model::recorded_formulas()`.
  std::vector<std::string> massless_bodies;  ///< Bodies without a given mass: dynamics must refuse them.
  std::vector<std::string> unsupported;      ///< What the model asks and the dynamics cannot do, in words.
  BoundLagrangian lagrangian;
  bool has_forces = false;
  FoundPrograms programs;
  int nu() const { return static_cast<int>(drives.size()); }
};

std::shared_ptr<const DynamicsModel> make_dynamics_model(std::shared_ptr<const System> system);

/// The drives that act, as indices: all but the prescribed motions without one.
std::vector<int> acting_drives(const DynamicsModel& model);

/// Work space for `measure_drive`, enough for every drive of the model.
FormulaEvaluation make_drive_evaluation(const DynamicsModel& model);

/// The scalar a drive moves, as a jet with its frames' wrench; and its row ∂rate/∂v. A drive by a formula has no wrench
/// of its own: `work` then holds its gradient and the jets of its scalars, which its row is made of. Allocates nothing.
Jet measure_drive(const DynamicsModel& model, const DriveComponent& drive, const State& state,
                  const PositionKinematics& pos, const VelocityKinematics& vel, FormulaEvaluation& work);
void add_drive_row(const DynamicsModel& model, const DriveComponent& drive, const PositionKinematics& pos,
                   const Jet& jet, const FormulaEvaluation& work, Eigen::Ref<Eigen::RowVectorXd> row);

}  // namespace ferrers
