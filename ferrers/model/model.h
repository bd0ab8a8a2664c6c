#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "ferrers/core/ids.h"
#include "ferrers/math/rotation.h"
#include "ferrers/model/coordinate.h"
#include "ferrers/model/law.h"
#include "ferrers/model/relation.h"
#include "ferrers/model/spec.h"

namespace ferrers {

using Vector3d = Eigen::Vector3d;
using Matrix3d = Eigen::Matrix3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// A body of the file that became part of a rigid group, because welds with `merge` hold it.
struct Part {
  std::string name;
  Pose X_BP;  ///< Its own frame in that of the body: as its welds put it.
  Pose X_WP;  ///< As drawn.
};

/// A rigid body. Its frame is the world frame of the drawing, or the frame that its `pose` gives.
struct Body {
  std::string name;
  bool has_mass = false;  ///< False: no mass was given (good for `analyze` only).
  double mass_kg = 0;
  Vector3d com_m = Vector3d::Zero();         ///< In the body frame.
  Matrix3d inertia_kgm2 = Matrix3d::Zero();  ///< About the mass centre, body axes.
  Pose X_WB;                                 ///< Pose as drawn.
  /// Of a rigid group: all its parts in the order of the file, ground first; name and frame of the body are those of
  /// the first. Empty: the body is one part.
  std::vector<Part> parts;
  std::vector<std::string> merged_welds;  ///< By name: what holds the parts together. They bear no reactions.
};

/// Numbers that only some joint types use.
struct JointConstants {
  double lead_m = 0;    ///< kScrew: advance per turn.
  double length_m = 0;  ///< kDistance.
  /// kGearMesh: signed base radii about z of the centres (which are the origins of F and M), and whether the mesh
  /// follows the line of centres; if not, `mesh_holds_as_drawn_only`.
  double base_radius_1_m = 0, base_radius_2_m = 0;
  double mesh_side = 1;      ///< kGearMesh: sign of (line of action)·(line of centres).
  double mesh_offset_m = 0;  ///< kGearMesh: makes the residual zero as drawn.
  bool mesh_holds_as_drawn_only = false;
  Vector3d pitch_point_F_m = Vector3d::Zero();
  Vector3d line_of_action_F = Vector3d::UnitX();
};

struct Friction {
  double viscous = 0, coulomb = 0, radius_m = 0;
};

/// A joint, or a generalized coordinate (`Model::coordinates_begin`). Frame F on its first body and frame M on its
/// second coincide when every coordinate is zero (for `distance` and `gear_mesh`, F and M sit at the two points or
/// centres).
struct Joint {
  std::string name;
  JointType type = JointType::kRevolute;
  BodyId first, second;
  Pose X_1F;  ///< In the first body's frame.
  Pose X_2M;  ///< In the second body's frame.
  JointConstants constants;
  std::optional<Vector6d> stiffness;     ///< Force (3) then moment (3) in F axes; entries may be infinity (rigid).
  std::optional<Vector6d> misalignment;  ///< Translation (3) then rotation (3) in F axes.
  std::optional<std::array<double, 2>> limits;
  std::optional<Friction> friction;
  bool drawn = true;  ///< False: given on each body by itself, so a loop need not close as drawn.
  /// Given by frames: as drawn its coordinates are what the bodies' poses make of them, else they are zero.
  bool by_frames = false;
  Dimension dimension;  ///< Of a generalized coordinate.
};

/// One equation between scalars of the state: linear with constant coefficients, or a relation by formulas.
struct Coupling {
  std::string name;
  std::vector<StateScalar> scalars;          ///< What it joins.
  std::vector<double> coefficients;          ///< Σ c q = 0; empty where there is a relation.
  std::shared_ptr<const Relation> relation;  ///< Over the same scalars, in their order; null: linear.
};

struct Spring {
  BodyId first, second;
  Vector3d point_1_m, point_2_m;  ///< In the bodies' frames.
  double stiffness = 0, damping = 0, free_length_m = 0;
};
struct TorsionSpring {
  JointCoordinate coordinate;
  double stiffness = 0, damping = 0, free_angle = 0;
};
struct JointDamping {
  JointCoordinate coordinate;
  double damping = 0;
};
struct Bushing {
  BodyId first, second;
  Pose X_1F, X_2M;
  Vector6d stiffness, damping;  ///< Force (3) then moment (3), F axes.
};
struct Load {
  BodyId body;
  bool is_torque = false;
  Vector3d point_m = Vector3d::Zero();  ///< In the body's frame.
  std::array<Law, 3> components;
  bool in_body_axes = false;
  Matrix3d R_BP = Matrix3d::Identity();  ///< Axes of the part that the file names, which `in_body_axes` means.
};
struct ForceElement {
  std::string name;
  std::variant<Spring, TorsionSpring, JointDamping, Bushing, Load> element;
};

/// A drive on a joint coordinate, on the distance of two points, on a recorded point (three components, world axes), or
/// by a formula: on a quantity s of the state, or by its map d_j alone.
struct Drive {
  enum class Kind { kCoordinate, kDistance, kPoint, kFormula };
  std::string name;
  Kind kind = Kind::kCoordinate;
  JointCoordinate coordinate;  ///< kCoordinate.
  BodyId first, second;        ///< kDistance; kPoint: `second` carries the point.
  Vector3d point_1_m = Vector3d::Zero(), point_2_m = Vector3d::Zero();
  /// kFormula: s = 0 as a relation, whose gradient is d_j; `on_velocities` for a map.
  std::shared_ptr<const Relation> relation;
  std::vector<StateScalar> scalars;  ///< kFormula: of the relation.
  bool acts = true;                  ///< False: a prescribed motion without a drive of its own (`motions`).
  std::vector<Law> motion;           ///< Empty, 1, or 3 for kPoint.
  std::vector<Law> effort;
  double weight = 1;  ///< Of the effort (N, N·m) where drives share a load: Σ (weight · effort)² is the least.
  int components() const { return kind == Kind::kPoint ? 3 : 1; }
};

struct InitialValue {
  JointCoordinate coordinate;
  bool whole_joint = false;  ///< Values for all of the joint's coordinates.
  std::vector<double> position, velocity;
  bool guess = false;
  SourceRange at;
};

struct RecordedPoint {
  std::string name;
  BodyId body;
  Vector3d point_m = Vector3d::Zero();  ///< In the body's frame.
};

/// A formula of time and state that is written with the results.
struct RecordedFormula {
  std::string name;
  Law law;
};

struct Event {
  std::string name;
  EventSpec::Action action = EventSpec::Action::kStop;
  Law when;
  DriveId drive;
};

struct Parameter {
  std::string name;
  double value = 0;
  std::optional<double> min, max, tolerance;
  std::optional<Dimension> dimension;
  std::string doc;
};

struct ModelBuildResult;

/// A mechanism, checked and with every number computed. Const after it is built; holds no state.
///
/// It keeps the specification it was built from, so that `with_parameters` can make another.
class Model {
 public:
  const std::string& name() const { return name_; }
  const Vector3d& gravity() const { return gravity_; }
  const std::vector<Body>& bodies() const { return bodies_; }  ///< [0] is ground.
  /// In the order of the file; after them, from `coordinates_begin` on, the generalized coordinates of `lagrangian`,
  /// which stand here so that they are named, driven, started and recorded like joint coordinates.
  const std::vector<Joint>& joints() const { return joints_; }
  std::size_t coordinates_begin() const { return coordinates_begin_; }
  bool is_coordinate(std::size_t joint) const { return joint >= coordinates_begin_; }
  /// `couplings` of the file, then `constraints`.
  const std::vector<Coupling>& couplings() const { return couplings_; }
  const Lagrangian& lagrangian() const { return lagrangian_; }
  const std::vector<ForceElement>& forces() const { return forces_; }
  const std::vector<Drive>& drives() const { return drives_; }
  const std::vector<InitialValue>& initial() const { return initial_; }
  const std::vector<RecordedPoint>& records() const { return records_; }
  const std::vector<RecordedFormula>& recorded_formulas() const { return recorded_formulas_; }
  const std::vector<Event>& events() const { return events_; }
  const std::vector<Parameter>& parameters() const { return parameters_; }
  const ModelSpec& spec() const { return *spec_; }
  /// Parameter values (SI) that the model was built with instead of the specification's.
  const std::map<std::string, double>& overrides() const { return overrides_; }

  const Body& body(BodyId id) const { return bodies_.at(id.index()); }
  const Joint& joint(JointId id) const { return joints_.at(id.index()); }

  std::optional<BodyId> find_body(std::string_view name) const;  ///< Also by the name of one of its parts.
  /// A body of the file, whether it is a part of a rigid group or not. Throws where there is none.
  Part part(std::string_view name) const;
  /// The joint's place in `spec().joints`, which also has welds that were merged.
  std::size_t spec_index(JointId id) const;
  std::optional<JointId> find_joint(std::string_view name) const;
  /// "joint" or "joint.coordinate", as couplings and drives write it.
  std::string coordinate_name(JointCoordinate coordinate) const;
  /// As formulas write its value and its rate: "theta", "main.position", "P.x"; "theta.velocity", "P.x.velocity".
  std::string scalar_name(const StateScalar& scalar) const;
  std::string rate_name(const StateScalar& scalar) const;

  /// The same mechanism with other parameter values (SI), on top of those that this model was built with.
  /// Unknown names and bad results are diagnostics. Cost: that of `build_model`.
  ModelBuildResult with_parameters(const std::map<std::string, double>& values) const;

 private:
  friend class ModelAssembler;  // model/build_internal.h: the only writer
  std::string name_;
  Vector3d gravity_ = Vector3d(0, 0, -9.81);
  std::vector<Body> bodies_;
  std::vector<Joint> joints_;
  std::size_t coordinates_begin_ = 0;
  std::vector<Coupling> couplings_;
  Lagrangian lagrangian_;
  std::vector<ForceElement> forces_;
  std::vector<Drive> drives_;
  std::vector<InitialValue> initial_;
  std::vector<RecordedPoint> records_;
  std::vector<RecordedFormula> recorded_formulas_;
  std::vector<Event> events_;
  std::vector<Parameter> parameters_;
  std::shared_ptr<const ModelSpec> spec_;
  std::map<std::string, double> overrides_;  ///< Parameter values that replace the specification's, SI.
};

/// A model, or the reasons why there is none (warnings may stand beside a model).
struct ModelBuildResult {
  std::optional<Model> model;
  Diagnostics diagnostics;
};

/// Checks a specification and computes its model. All errors at once; nothing throws.
/// `parameter_values` override the parameters' own values (SI).
/// Cost: linear in the size of the specification.
ModelBuildResult build_model(ModelSpec spec, const std::map<std::string, double>& parameter_values = {});

}  // namespace ferrers
