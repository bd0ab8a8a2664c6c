#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "ferrers/core/diagnostics.h"
#include "ferrers/core/units.h"
#include "ferrers/math/expression.h"

/// The mechanism as its author described it: names, and numbers that may still be expressions over the parameters.
/// Readers and C++ users fill a `ModelSpec`; `build_model` (model/build.h) checks it and computes a `Model`.
/// Everything here is in SI; a place (`at`) is unknown for what was not read from a file.
namespace ferrers {

class LagrangianSystem;

/// A literal, or an expression over the parameters.
struct Number {
  double value = 0;                      ///< Used when `expression` is empty.
  std::optional<Expression> expression;  ///< Over parameters only (laws of time are `LawSpec`).
  SourceRange at;

  Number() = default;
  Number(double v) : value(v) {}  // Implicit: numbers are written as numbers
};

using Number3 = std::array<Number, 3>;

inline Number3 number3(double x, double y, double z) { return {Number(x), Number(y), Number(z)}; }

/// A name as written, with its place.
struct NameRef {
  std::string name;
  SourceRange at;

  NameRef() = default;
  NameRef(std::string n, SourceRange where = {}) : name(std::move(n)), at(where) {}  // NOLINT
  NameRef(const char* n) : name(n) {}                                                // NOLINT
};

struct ParameterSpec {
  NameRef name;
  Number value;                        ///< May use parameters in any order; cycles are errors.
  std::optional<Dimension> dimension;  ///< Known when written with a unit.
  std::optional<Number> min, max, tolerance;
  std::string doc;
};

/// Rotation by an axis and angle, or by a quaternion (w, x, y, z), not both.
struct RotationSpec {
  std::optional<std::pair<Number3, Number>> axis_angle;
  std::optional<std::array<Number, 4>> quaternion;
  SourceRange at;
};

struct PoseSpec {
  Number3 position;
  std::optional<RotationSpec> rotation;
  SourceRange at;
};

struct InertiaSpec {
  enum class Kind { kPoint, kTensor, kRod, kBox, kCylinder, kSphere };
  Kind kind = Kind::kPoint;
  Number3 moments, products;        ///< kTensor: Ixx Iyy Izz; Ixy Ixz Iyz (tensor entries, −∫xy dm).
  std::optional<Number3> from, to;  ///< kRod (required), kCylinder (its axis): end points, in the body's drawing frame.
  Number3 size;                     ///< kBox: edge lengths along its axes.
  Number radius;                    ///< kCylinder, kSphere (solid).
  std::optional<RotationSpec> rotation;  ///< kBox, kTensor: turns the shape's axes in the drawing frame.
  bool unphysical = false;  ///< kTensor: one moment may exceed the sum of the others; a warning then, no error.
  SourceRange at;
};

struct BodySpec {
  NameRef name;
  std::optional<Number> mass;
  std::optional<Number3> com;  ///< Needed with a mass, unless the shape has end points (then their middle).
  InertiaSpec inertia;
  std::optional<PoseSpec> pose;  ///< Present: com, inertia and per-body places are in this frame, given in the world.
};

/// A point or direction: drawn once in the world, or given on both bodies in their own frames.
struct PlaceSpec {
  std::optional<Number3> drawn;
  std::vector<std::pair<NameRef, Number3>> on_body;  ///< Two entries, one per body of the joint, or empty.
  SourceRange at;
  bool given() const { return drawn.has_value() || !on_body.empty(); }
};

enum class JointType {
  kWeld,
  kRevolute,
  kPrismatic,
  kScrew,
  kCylindrical,
  kUniversal,
  kSpherical,
  kPlanar,
  kPointOnLine,
  kPointOnPlane,
  kDistance,
  kGearMesh,
  kFree,
  // Not joints of the file: generalized coordinates of `lagrangian`, which carry no body.
  kAngleCoordinate,
  kLengthCoordinate,
  kOtherCoordinate,
};

struct StiffnessSpec {
  std::optional<Number3> force, moment;  ///< N/m, N·m/rad in the joint's frame.
  SourceRange at;
};

struct MisalignmentSpec {
  std::optional<Number3> translation, rotation;  ///< m, rad in the joint's frame.
  SourceRange at;
};

struct FrictionSpec {
  std::optional<Number> viscous, coulomb, radius;
  SourceRange at;
};

struct JointSpec {
  NameRef name;
  JointType type = JointType::kRevolute;
  std::array<NameRef, 2> bodies;  ///< First, second.
  PlaceSpec place;                ///< `at`.
  PlaceSpec axis;                 ///< `axis` or `normal`.
  PlaceSpec axis2;                ///< kUniversal: the second of `axes`.
  std::optional<Number3> x;       ///< Optional x direction of the joint's frame, drawn.
  /// Instead of places, axes and x: the joint's frame on its first and on its second body, each in that body's own
  /// drawing frame; z is the axis or normal, and the second's x is a universal joint's second axis. Coordinates are
  /// zero where the two frames coincide.
  std::optional<std::array<PoseSpec, 2>> frames;
  bool merge = false;  ///< kWeld: its bodies are one; the weld is no joint any more and bears no reactions.
  Number lead;         ///< kScrew: m per turn.
  std::optional<std::array<Number3, 2>>
      points;  ///< kDistance: on the first, on the second; drawn, or in the bodies' frames when they have poses
  bool points_on_bodies = false;          ///< kDistance: `points` is keyed by body: each in its body's own frame.
  std::optional<Number> length;           ///< kDistance: else the distance as drawn.
  std::optional<Number3> line_of_action;  ///< kGearMesh: direction, drawn.
  std::optional<std::array<Number3, 2>> centers;  ///< kGearMesh: centres of first and second, drawn.
  std::optional<StiffnessSpec> stiffness;
  std::optional<MisalignmentSpec> misalignment;
  std::optional<std::array<Number, 2>> limits;  ///< Low, high of the (only) coordinate.
  std::optional<FrictionSpec> friction;
};

/// `joint`, or `joint.coordinate` where the joint has several.
struct CoordinateRef {
  NameRef joint;
  std::string coordinate;  ///< Empty: the joint's only coordinate.
};

struct CouplingSpec {
  NameRef name;
  std::vector<CoordinateRef> coordinates;
  std::vector<Number> coefficients;  ///< Σ c q = 0, zero as drawn. A gear b = ratio·a becomes (−ratio, 1).
  SourceRange at;
};

/// A relation between coordinates by a formula: phi = 0 of positions and time, or one that is linear in velocities.
struct ConstraintSpec {
  NameRef name;
  Expression formula;          ///< Over coordinates, points, parameters and t; is zero.
  bool on_velocities = false;  ///< Linear in velocities (rolling); need not be the derivative of anything.
  SourceRange at;
};

/// A generalized coordinate of a system given by its own energies and constraints.
struct GeneralCoordinateSpec {
  NameRef name;
  Dimension dimension;          ///< Of its unit; an angle is a pure number.
  std::optional<Number> guess;  ///< Where the assembly starts; else 0.
  std::optional<std::array<Number, 2>> limits;
};

/// A system given as the source method gives it [stepanyan, eq. (5)]: energies and forces as formulas over the state.
/// Absent formulas are zero; `mass_matrix` stands for a kinetic energy ½ vᵀ M v.
/// Without formulas: everything by the functions of `system` (model/lagrangian_system.h), for users of C++.
struct LagrangianSpec {
  struct FunctionConstraint {
    NameRef name;
    bool on_velocities = false;
  };
  std::vector<GeneralCoordinateSpec> coordinates;
  std::optional<Expression> kinetic_energy, potential_energy;
  std::optional<Expression> dissipation;                     ///< Rayleigh's function: forces −∂R/∂v.
  std::vector<std::vector<Expression>> mass_matrix;          ///< In the order of the coordinates; empty: not given.
  std::vector<std::pair<CoordinateRef, Expression>> forces;  ///< Generalized forces along coordinates.
  std::shared_ptr<const LagrangianSystem> system;
  std::vector<FunctionConstraint> function_constraints;  ///< Of `system`, in the order of its rows.
  SourceRange at;
  bool given() const {
    return !coordinates.empty() || kinetic_energy || potential_energy || dissipation || !mass_matrix.empty() ||
           !forces.empty();
  }
};

/// A scalar function of time, or of time and joint coordinates.
struct LawSpec {
  std::optional<Expression> expression;  ///< Over t, parameters and (for efforts and forces) joint coordinates.
  /// A sampled law: times and values read from a CSV file by the reader; interpolated by a twice differentiable spline.
  std::optional<std::pair<std::vector<double>, std::vector<double>>> samples;
  std::string file;  ///< For messages and writing back.
  int column = 0;
  SourceRange at;
};

struct DriveSpec {
  NameRef name;
  std::optional<CoordinateRef> coordinate;  ///< On a joint coordinate, or
  std::optional<std::array<NameRef, 2>>
      bodies;  ///< on the distance of two points (drawn, or in body frames if posed), or
  std::optional<std::array<Number3, 2>> points;
  std::optional<NameRef> point;        ///< on a recorded point (three laws, world axes), or
  std::optional<Expression> quantity;  ///< on a quantity s of the state: d_j = ∂s/∂q_j, or
  /// by its map d_j alone: formulas along coordinates. Such a drive moves nothing that could be prescribed.
  std::vector<std::pair<CoordinateRef, Expression>> map;
  std::vector<LawSpec> motion, effort;  ///< Empty, one, or three (recorded point).
  std::optional<Number> weight;         ///< Of its effort where drives share a load.
  SourceRange at;
};

struct SpringSpec {
  std::array<NameRef, 2> bodies;
  std::array<Number3, 2> points;  ///< Each in its body's drawing frame (the world, or the body's pose).
  Number stiffness, damping;
  std::optional<Number> free_length;  ///< Else the length as drawn.
};
struct TorsionSpringSpec {
  CoordinateRef coordinate;
  Number stiffness, damping, free_angle;
};
struct JointDampingSpec {
  CoordinateRef coordinate;
  Number damping;
};
struct BushingSpec {
  std::array<NameRef, 2> bodies;
  PlaceSpec place, axis;
  std::optional<Number3> x;
  Number3 force_stiffness, moment_stiffness, force_damping, moment_damping;
};
/// `force` (at a point) or `torque` on a body: three laws, in world or body axes.
struct LoadSpec {
  NameRef body;
  bool is_torque = false;
  std::optional<Number3> place;  ///< For a force; in the body's drawing frame.
  std::array<LawSpec, 3> components;
  bool in_body_axes = false;
};

struct ForceSpec {
  NameRef name;
  std::variant<SpringSpec, TorsionSpringSpec, JointDampingSpec, BushingSpec, LoadSpec> element;
  SourceRange at;
};

struct InitialSpec {
  NameRef joint;
  std::string coordinate;        ///< Empty: all the joint's coordinates in order.
  std::vector<Number> position;  ///< Empty: not given. Quaternions as (w, x, y, z).
  std::vector<Number> velocity;
  bool guess = false;
  SourceRange at;
};

struct RecordSpec {
  NameRef name;
  NameRef body;
  Number3 place;                      ///< In the body's drawing frame.
  std::optional<Expression> formula;  ///< Instead of a point: a formula of time and state.
  SourceRange at;
};

struct EventSpec {
  enum class Action { kStop, kRecord, kSwitch };
  NameRef name;
  Expression when;  ///< Acts at a zero.
  Action action = Action::kStop;
  std::optional<NameRef> drive;  ///< kSwitch: switched off or on.
  SourceRange at;
};

struct ModelSpec {
  std::string name;
  std::string doc;
  Number3 gravity = number3(0, 0, -9.81);
  std::vector<ParameterSpec> parameters;
  std::vector<BodySpec> bodies;  ///< Without ground.
  std::vector<JointSpec> joints;
  std::vector<CouplingSpec> couplings;
  std::vector<ConstraintSpec> constraints;
  LagrangianSpec lagrangian;
  std::vector<std::pair<CoordinateRef, LawSpec>> motions;  ///< Prescribed without a drive of their own.
  std::vector<ForceSpec> forces;
  std::vector<DriveSpec> drives;
  std::vector<InitialSpec> initial;
  std::vector<RecordSpec> records;
  std::vector<EventSpec> events;
};

/// Welds stay joints, and what they hold stays several bodies.
inline void keep_welds(ModelSpec& spec) {
  for (JointSpec& joint : spec.joints) joint.merge = false;
}

}  // namespace ferrers
