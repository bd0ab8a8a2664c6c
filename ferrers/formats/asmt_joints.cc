#include "ferrers/formats/asmt_joints.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "ferrers/formats/asmt_formulas.h"
#include "ferrers/formats/asmt_relations.h"
#include "ferrers/model/pose_spec.h"

namespace ferrers {
namespace {

enum class Cosines { kNone, kParallel, kPerpendicular, kAngle, kNoRotation, kConstantVelocity };

/// What a class of joints demands: rows of a joint of ours, equations of directions of its two frames, both, or a
/// relation of coordinates.
struct JointClass {
  std::string_view name;
  std::optional<JointType> joint;
  Cosines cosines = Cosines::kNone;
  std::string_view length = "";   ///< The record that holds an offset or a distance.
  bool distance_to_axis = false;  ///< `length` from the z axis of I to the point of J.
  bool half_turns = false;        ///< Its equations hold as well where frames are half a turn apart.
  std::optional<AsmtRelationKind> relation;
};

const std::vector<JointClass>& classes() {
  using T = JointType;
  using C = Cosines;
  static const std::vector<JointClass> all = {
      {"FixedJoint", T::kWeld, C::kNone, "", false, true, {}},
      {"RevoluteJoint", T::kRevolute, C::kNone, "", false, true, {}},
      {"CylindricalJoint", T::kCylindrical, C::kNone, "", false, true, {}},
      {"TranslationalJoint", T::kPrismatic, C::kNone, "", false, true, {}},
      {"SphericalJoint", T::kSpherical, C::kNone, "", false, false, {}},
      {"UniversalJoint", T::kUniversal, C::kNone, "", false, false, {}},
      {"ConstantVelocityJoint", T::kSpherical, C::kConstantVelocity, "", false, false, {}},
      {"PlanarJoint", T::kPlanar, C::kNone, "offset", false, true, {}},
      {"PointInLineJoint", T::kPointOnLine, C::kNone, "", false, false, {}},
      {"PointInPlaneJoint", T::kPointOnPlane, C::kNone, "offset", false, false, {}},
      {"LineInPlaneJoint", T::kPointOnPlane, C::kPerpendicular, "offset", false, false, {}},
      {"SphSphJoint", T::kDistance, C::kNone, "distanceIJ", false, false, {}},
      {"CylSphJoint", {}, C::kNone, "distanceIJ", true, false, {}},
      {"RevCylJoint", {}, C::kParallel, "distanceIJ", true, false, {}},
      {"RevRevJoint", T::kPointOnPlane, C::kParallel, "distanceIJ", true, false, {}},
      {"ParallelAxesJoint", {}, C::kParallel, "", false, false, {}},
      {"PerpendicularJoint", {}, C::kPerpendicular, "", false, false, {}},
      {"AngleJoint", {}, C::kAngle, "", false, false, {}},
      {"NoRotationJoint", {}, C::kNoRotation, "", false, false, {}},
      {"RackPinionJoint", {}, C::kNone, "", false, false, AsmtRelationKind::kRackPinion},
      {"ScrewJoint", {}, C::kNone, "", false, false, AsmtRelationKind::kScrew},
      {"GearJoint", {}, C::kNone, "", false, false, AsmtRelationKind::kGear},
  };
  return all;
}

Eigen::Matrix3d half_turn(int axis) {
  Eigen::Vector3d signs = -Eigen::Vector3d::Ones();
  signs[axis] = 1;
  return signs.asDiagonal();
}

class JointReader {
 public:
  explicit JointReader(AsmtImport& import) : import_(import) {}

  AsmtJoints read(const AsmtRecord& list);

 private:
  void read_joint(const AsmtRecord& record);
  std::string own_name(const AsmtRecord& record);
  double offset(const AsmtRecord& record, const JointClass& kind);
  void add_joint(const AsmtRecord& record, const JointClass& kind, AsmtMarker first, AsmtMarker second);
  Pose half_turned(const JointClass& kind, const Pose& X_12, const Pose& X_PM, SourceRange at);
  void add_equations(const AsmtRecord& record, const JointClass& kind, const AsmtMarker& first,
                     const AsmtMarker& second);

  AsmtImport& import_;
  AsmtJoints joints_;
  std::vector<AsmtRelation> relations_;
  std::string name_;  ///< Of the joint at hand.
  SourceRange name_at_;
  int turned_ = 0;
  SourceRange turned_at_;
};

// FreeCAD leaves some joints without a name, but gives their markers the joint's name.
std::string JointReader::own_name(const AsmtRecord& record) {
  const auto [name, at] = asmt_text(import_, record, "Name");
  name_at_ = at;
  if (!name.empty()) return name;
  const std::string marker = asmt_text(import_, record, "MarkerI").first;
  return marker.substr(std::min(marker.rfind('/') + 1, marker.size()));
}

double JointReader::offset(const AsmtRecord& record, const JointClass& kind) {
  if (kind.length.empty() || !record.child(kind.length)) return 0;
  return import_.geometry.number(record, kind.length).value_or(0) / import_.geometry.per_metre();
}

/// The second's frame turned by half a turn, about the axis that brings it nearest to the first's: the equations of
/// these joints hold for both, and the file's solver keeps the one that is stored.
Pose JointReader::half_turned(const JointClass& kind, const Pose& X_12, const Pose& X_PM, SourceRange at) {
  int best = -1;
  if (kind.joint == JointType::kWeld || kind.joint == JointType::kPrismatic) {
    double trace = X_12.R.trace();
    for (int axis = 0; axis < 3; ++axis) {
      const double turned = (X_12.R * half_turn(axis)).trace();
      if (turned > trace) trace = turned, best = axis;
    }
  } else if (X_12.R(2, 2) < 0) {
    best = 0;  // about x, which leaves the angle between the x axes as it is
  }
  if (best < 0) return X_PM;
  if (turned_++ == 0) turned_at_ = at;
  return {X_PM.R * half_turn(best), X_PM.p};
}

void JointReader::add_joint(const AsmtRecord& record, const JointClass& kind, AsmtMarker first, AsmtMarker second) {
  JointSpec joint;
  joint.name = NameRef(import_.add_name("joints", "joint", name_), name_at_);
  joint.type = *kind.joint;
  joint.bodies = {NameRef(import_.body(first), first.at), NameRef(import_.body(second), second.at)};
  const double along = kind.distance_to_axis || kind.joint == JointType::kDistance ? 0 : offset(record, kind);
  first.X_PM.p += along * first.X_PM.R.col(2);
  if (kind.joint == JointType::kUniversal) {  // its second axis is z of J, ours the x of the second frame
    const Eigen::Matrix3d axes = second.X_PM.R;
    second.X_PM.R << axes.col(2), axes.col(0), axes.col(1);
  }
  Pose X_12 = import_.world(first).inverse() * import_.world(second);
  if (kind.half_turns) {
    second.X_PM = half_turned(kind, X_12, second.X_PM, record.at());
    X_12 = import_.world(first).inverse() * import_.world(second);
  }
  if (kind.joint == JointType::kDistance) {
    const double length = offset(record, kind);
    joint.points = {asmt_number3(first.X_PM.p, first.at), asmt_number3(second.X_PM.p, second.at)};
    joint.points_on_bodies = true;
    joint.length = Number(length);
    joint.length->at = record.child(kind.length) ? record.child(kind.length).value_at() : record.at();
  } else {
    joint.frames = {pose_spec(first.X_PM, first.at), pose_spec(second.X_PM, second.at)};
  }
  if (joint.type == JointType::kWeld) mark_fixed(joint);
  joints_.all.push_back({static_cast<int>(import_.spec.joints.size()), first, second, X_12});
  import_.spec.joints.push_back(std::move(joint));
}

void JointReader::add_equations(const AsmtRecord& record, const JointClass& kind, const AsmtMarker& first,
                                const AsmtMarker& second) {
  const std::string plain = import_.shared_prefix.empty() || name_.rfind(import_.shared_prefix, 0) != 0
                                ? name_
                                : name_.substr(import_.shared_prefix.size());
  AsmtFrameFormulas I(import_, first, plain + "_I", record.at());
  AsmtFrameFormulas J(import_, second, plain + "_J", record.at());
  const auto demand = [&](std::string_view ending, const std::string& formula) {
    add_asmt_constraint(import_, fmt::format("{}{}", plain, ending), formula, record.at());
  };
  if (kind.distance_to_axis) {
    const double distance = offset(record, kind);
    if (!(distance > 0)) {
      import_.diagnostics.error(
          "F602", record.at(),
          fmt::format("'{}' keeps a distance of {} from an axis, which has no direction", name_, distance),
          "a point on a line is a PointInLineJoint, a common axis a CylindricalJoint");
      return;
    }
    const AsmtVector apart = J.origin() - I.origin();
    demand("_distance", fmt::format("hypot({}, {}) - {}", dot(I.axis(0), apart), dot(I.axis(1), apart), distance));
  }
  switch (kind.cosines) {
    case Cosines::kNone:
      break;
    case Cosines::kParallel:
      demand("_zx", dot(I.axis(2), J.axis(0)));
      demand("_zy", dot(I.axis(2), J.axis(1)));
      break;
    case Cosines::kPerpendicular:
      demand("_zz", dot(I.axis(2), J.axis(2)));
      break;
    case Cosines::kAngle: {
      const double angle = import_.geometry.number(record, "theIzJz").value_or(1);
      if (std::abs(std::sin(angle)) < 1e-6) {  // not a rank decision: how well the file says it
        import_.diagnostics.warning("F603", record.at(),
                                    fmt::format("'{}' keeps axes parallel by the cosine of their angle", name_),
                                    "its gradient vanishes where it holds; use a ParallelAxesJoint");
      }
      demand("_zz", fmt::format("{} - ({})", dot(I.axis(2), J.axis(2)), std::cos(angle)));
      break;
    }
    case Cosines::kNoRotation:
      demand("_yx", dot(I.axis(1), J.axis(0)));
      demand("_zx", dot(I.axis(2), J.axis(0)));
      demand("_zy", dot(I.axis(2), J.axis(1)));
      break;
    case Cosines::kConstantVelocity:
      demand("_xy", fmt::format("{} + {}", dot(I.axis(0), J.axis(1)), dot(I.axis(1), J.axis(0))));
      break;
  }
}

void JointReader::read_joint(const AsmtRecord& record) {
  record.mark_read();
  const auto kind = std::find_if(classes().begin(), classes().end(),
                                 [&](const JointClass& one) { return one.name == record.name(); });
  if (kind == classes().end()) {
    record.mark_read_with_all();
    import_.diagnostics.error("F602", record.at(),
                              fmt::format("joints of the class '{}' are not supported", record.name()),
                              "docs/formats/asmt.md lists those that are");
    return;
  }
  name_ = own_name(record);
  const AsmtMarker* const first = import_.marker(record, "MarkerI");
  const AsmtMarker* const second = import_.marker(record, "MarkerJ");
  if (first == nullptr || second == nullptr) return record.mark_read_with_all();
  if (first->part == second->part) {
    record.mark_read_with_all();
    import_.diagnostics.error("F604", record.at(),
                              fmt::format("'{}' joins '{}' with itself", name_, import_.body(*first)));
    return;
  }
  if (kind->relation) {
    relations_.push_back(read_asmt_relation(*kind->relation, record, name_, *first, *second, import_));
    return;
  }
  if (kind->joint) {
    const auto index = static_cast<int>(joints_.all.size());
    add_joint(record, *kind, *first, *second);
    const std::string markers =
        asmt_text(import_, record, "MarkerI").first + "\n" + asmt_text(import_, record, "MarkerJ").first;
    const auto path = joints_.by_path.try_emplace("/" + import_.assembly + "/" + name_, index);
    if (!path.second) path.first->second = -1;
    joints_.by_markers.try_emplace(markers, index);
  }
  if (kind->cosines != Cosines::kNone || kind->distance_to_axis) add_equations(record, *kind, *first, *second);
}

AsmtJoints JointReader::read(const AsmtRecord& list) {
  for (const AsmtRecord& record : list.children()) {
    if (!record.name().empty()) read_joint(record);
  }
  add_asmt_relations(relations_, joints_, import_);
  if (turned_ > 0) {
    import_.diagnostics.notice(
        "F603", turned_at_,
        fmt::format("{} joint{} two frames that stand about half a turn apart, and {} read with that half turn",
                    turned_, turned_ == 1 ? " has" : "s have", turned_ == 1 ? "is" : "are"),
        "OndselSolver's equations allow both, and it keeps the one that is stored");
  }
  return std::move(joints_);
}

}  // namespace

AsmtJoints read_asmt_joints(const AsmtRecord& constraint_sets, AsmtImport& import) {
  const AsmtRecord list = constraint_sets.child("Joints");
  return list ? JointReader(import).read(list) : AsmtJoints();
}

}  // namespace ferrers
