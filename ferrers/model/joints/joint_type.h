#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include "ferrers/math/traced.h"
#include "ferrers/model/joints/relative_motion.h"
#include "ferrers/model/model.h"

/// What the engine knows of a joint type, one file per type behind one table: the only place that tells types apart.
///
/// Given: frames F on the first and M on the second body, coinciding at zero coordinates. A type with named coordinates
/// can carry a body in the spanning tree: pose X_FM(q) and twist V_M − V_F = S(q) v. Every type can close a loop: 6 − f
/// rows phi(X_FM) = 0. Properties that hold (tested at random poses): rows' wrenches T are orthogonal to S on the
/// joint's own motion, W is the exact gradient of phi and `bias` the exact rest of its second derivative, off the
/// manifold too.
namespace ferrers {

/// Components in the names of constraint rows and reactions; 0-2 are forces and 3-5 moments along F's axes.
inline constexpr std::array<std::string_view, 6> kComponentNames = {"force_x",  "force_y",  "force_z",
                                                                    "moment_x", "moment_y", "moment_z"};

enum class CoordinateKind { kAngle, kDisplacement, kRotationRate, kPointVelocity, kOther };

/// One velocity coordinate. `kAngle`, `kDisplacement` and `kOther` (neither) are also position coordinates of the same
/// name.
struct CoordinateInfo {
  std::string_view name;
  CoordinateKind kind;
  bool is_scalar() const { return kind != CoordinateKind::kRotationRate && kind != CoordinateKind::kPointVelocity; }
  bool is_angular() const { return kind == CoordinateKind::kAngle || kind == CoordinateKind::kRotationRate; }
};

/// One function for numbers and for traced ones (math/traced.h), of which evaluations are compiled.
template <template <class> class Signature>
struct JointFunction {
  Signature<double> numbers = nullptr;
  Signature<Traced> traced = nullptr;
  // Called like a function, with either.
  operator Signature<double>() const { return numbers; }
  operator Signature<Traced>() const { return traced; }
};

/// Pose of M in F, in F axes.
template <class T>
using MotionSignature = void (*)(const JointConstants&, const T* q, BasicPose<T>& X_FM);
/// Columns of S in F axes at p_M (angular, linear), and Ṡ v.
template <class T>
using SubspaceSignature = void (*)(const JointConstants&, const T* q, const T* v, Eigen::Matrix<T, 6, 1>* S,
                                   Eigen::Matrix<T, 6, 1>& S_dot_v);
/// The 6 − f rows, which vanish where the joint is closed. `winding`: one reference per angle (see `angles`).
template <class T>
using RowsSignature = void (*)(const JointConstants&, const BasicRelativeMotion<T>&, const T* winding,
                               BasicJet<T>* rows);
/// The joint's scalar coordinates as functions of the relative pose; angles as principal values.
using CoordinatesFunction = void (*)(const JointConstants&, const RelativeMotion&, Jet* coordinates);
/// Angles whose turns must be followed (see `State::winding`), as principal values.
using AnglesFunction = void (*)(const JointConstants&, const RelativeMotion&, Jet* angles);

/// Which keys place a joint of this type.
enum class PlacementRule { kPoint, kPointAxis, kPointTwoAxes, kPointNormal, kTwoPoints, kMesh, kNone };

struct JointTypeInfo {
  JointType type;
  std::string_view name;
  PlacementRule placement;
  int nq = 0;                                        ///< Position coordinates as a tree joint (quaternions take 4).
  int nv = 0;                                        ///< Velocity coordinates as a tree joint.
  std::span<const CoordinateInfo> coordinates = {};  ///< nv of them.
  std::span<const std::string_view> position_names = {};  ///< nq of them.
  std::span<const int> row_components = {};               ///< Row i is called after kComponentNames[row_components[i]].
  bool can_be_tree = false;
  bool carries_body = true;  ///< False: a generalized coordinate, between ground and nothing.
  int quaternion_at = -1;    ///< Index in q of a unit quaternion (w, x, y, z), or −1.
  int winding_count = 0;     ///< Number of `angles`.
  JointFunction<MotionSignature> motion = {};
  JointFunction<SubspaceSignature> subspace = {};
  bool constant_subspace = true;  ///< Ṡ = 0 in F axes.
  JointFunction<RowsSignature> rows = {};
  CoordinatesFunction coordinate_jets = nullptr;  ///< Null where coordinates are not scalars of the pose.
  AnglesFunction angles = nullptr;

  int row_count() const { return static_cast<int>(row_components.size()); }
  int freedoms() const { return 6 - row_count(); }
};

const JointTypeInfo& joint_type_info(JointType type);
/// What columns and reports call a coordinate: "joint.angle"; a generalized coordinate by its own name.
std::string coordinate_label(const Joint& joint, std::string_view coordinate);
/// The joints of the file format: all but the generalized coordinates.
std::span<const JointTypeInfo* const> all_joint_types();
const JointTypeInfo* find_joint_type(std::string_view name);

// The types, one file each.
extern const JointTypeInfo kWeldJoint, kRevoluteJoint, kPrismaticJoint, kScrewJoint, kCylindricalJoint, kUniversalJoint,
    kSphericalJoint, kPlanarJoint, kPointOnLineJoint, kPointOnPlaneJoint, kDistanceJoint, kGearMeshJoint, kFreeJoint,
    kAngleCoordinate, kLengthCoordinate, kOtherCoordinate;

/// Row of the moment that keeps the two z axes parallel, along x or y of F, and the rows shared by several types.
template <class T>
BasicJet<T> moment_x_row(const BasicRelativeMotion<T>& m) {
  return -dot(m, m.R_F.col(1), m.R_M.col(2));
}
template <class T>
BasicJet<T> moment_y_row(const BasicRelativeMotion<T>& m) {
  return dot(m, m.R_F.col(0), m.R_M.col(2));
}
template <class T>
BasicJet<T> moment_z_row(const BasicRelativeMotion<T>& m) {
  return dot(m, m.R_F.col(1), m.R_M.col(0));
}
/// Rotation of M about z of F, principal value.
template <class T>
BasicJet<T> angle_about_z(const BasicRelativeMotion<T>& m) {
  return atan2(dot(m, m.R_F.col(1), m.R_M.col(0)), dot(m, m.R_F.col(0), m.R_M.col(0)));
}

/// True when the rows vanish but the axes point the wrong way round (dot products cannot tell).
bool is_flipped(const JointTypeInfo& type, const RelativeMotion& m);

/// A point of the reaction: p_M − p_F relative offset from p_M, in world axes; zero but for gear meshes (the pitch
/// point).
Eigen::Vector3d reaction_point_from_M(const Joint& joint, const RelativeMotion& m);

}  // namespace ferrers
