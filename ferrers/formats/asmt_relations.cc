#include "ferrers/formats/asmt_relations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include "ferrers/formats/asmt_formulas.h"
#include "ferrers/formats/asmt_joints.h"

namespace ferrers {
namespace {

// How exactly axes of a CAD model are parallel and meet, in rad and m; not rank decisions.
constexpr double kParallel = 1e-5;
constexpr double kMeeting = 1e-5;

/// How a marker moves against the carrier: it turns about its z axis, slides along a direction, both, or neither.
struct Side {
  std::string turn;   ///< Formula of the angle turned since the stored pose; empty: none.
  std::string slide;  ///< Formula of the way since the stored pose; empty: none.
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< Of the way, world as stored.

  /// The part of the way along `axis` as a formula.
  std::string along(const Eigen::Vector3d& axis) const {
    const double share = direction.dot(axis);
    if (slide.empty() || std::abs(share) < kParallel) return "0";
    return fmt::format("({})*{}", std::abs(std::abs(share) - 1) < kParallel ? std::copysign(1.0, share) : share, slide);
  }
};

/// Parts that are welded to each other, and the joints between such groups.
class Carriers {
 public:
  Carriers(const AsmtJoints& joints, const AsmtImport& import);

  /// How both markers move against one common part.
  std::optional<std::array<Side, 2>> sides(const AsmtRelation& relation);

 private:
  int group(int part);  ///< Of a part; -1, the assembly, is a part too.
  std::optional<Side> side(const AsmtMarker& marker, int carrier);
  std::optional<Side> side_by(const AsmtJoint& joint, const AsmtMarker& marker, bool is_second) const;

  const AsmtJoints& joints_;
  const AsmtImport& import_;
  std::vector<int> parent_;                 ///< By part + 1.
  std::vector<std::vector<int>> touching_;  ///< By group: its joints.
};

Carriers::Carriers(const AsmtJoints& joints, const AsmtImport& import)
    : joints_(joints), import_(import), parent_(import.parts.size() + 1), touching_(import.parts.size() + 1) {
  std::iota(parent_.begin(), parent_.end(), 0);
  const auto type = [&](const AsmtJoint& one) { return import.spec.joints[static_cast<std::size_t>(one.index)].type; };
  for (const AsmtJoint& one : joints.all) {
    if (type(one) != JointType::kWeld) continue;
    parent_[static_cast<std::size_t>(group(one.first.part))] = group(one.second.part);
  }
  for (std::size_t i = 0; i < joints.all.size(); ++i) {
    const JointType kind = type(joints.all[i]);
    if (kind != JointType::kRevolute && kind != JointType::kPrismatic && kind != JointType::kCylindrical) continue;
    for (const int part : {joints.all[i].first.part, joints.all[i].second.part}) {
      touching_[static_cast<std::size_t>(group(part))].push_back(static_cast<int>(i));
    }
  }
}

int Carriers::group(int part) {
  auto root = static_cast<std::size_t>(part + 1);
  while (static_cast<std::size_t>(parent_[root]) != root) {
    parent_[root] = parent_[static_cast<std::size_t>(parent_[root])];  // shorter for the next
    root = static_cast<std::size_t>(parent_[root]);
  }
  return static_cast<int>(root);
}

std::optional<Side> Carriers::side_by(const AsmtJoint& joint, const AsmtMarker& marker, bool is_second) const {
  const JointSpec& spec = import_.spec.joints[static_cast<std::size_t>(joint.index)];
  const Pose X_WF = import_.world(is_second ? joint.second : joint.first);
  const Pose X_WM = import_.world(marker);
  const Eigen::Vector3d axis = X_WF.R.col(2);
  const double onward = is_second ? 1 : -1;
  Side found;
  if (spec.type != JointType::kRevolute) {
    const char* const word = spec.type == JointType::kPrismatic ? "position" : "displacement";
    found.slide = fmt::format("({}.{} - ({}))", spec.name.name, word, joint.displacement());
    found.direction = onward * axis;
  }
  if (spec.type != JointType::kPrismatic) {
    const Eigen::Vector3d z = X_WM.R.col(2);
    const bool parallel = axis.cross(z).norm() < kParallel;
    if (!parallel || axis.cross(X_WM.p - X_WF.p).norm() > kMeeting) return std::nullopt;
    const char* const word = spec.type == JointType::kRevolute ? "position" : "angle";
    found.turn =
        fmt::format("({})*({}.{} - ({}))", axis.dot(z) > 0 ? onward : -onward, spec.name.name, word, joint.angle());
  }
  return found;
}

std::optional<Side> Carriers::side(const AsmtMarker& marker, int carrier) {
  const int own = group(marker.part);
  if (own == carrier) return Side();
  for (const int i : touching_[static_cast<std::size_t>(own)]) {
    const AsmtJoint& joint = joints_.all[static_cast<std::size_t>(i)];
    const bool is_second = group(joint.second.part) == own;
    if (group(is_second ? joint.first.part : joint.second.part) != carrier) continue;
    if (const auto found = side_by(joint, marker, is_second)) return found;
  }
  return std::nullopt;
}

std::optional<std::array<Side, 2>> Carriers::sides(const AsmtRelation& relation) {
  const int own = group(relation.first.part);
  std::vector<int> candidates;
  for (const int i : touching_[static_cast<std::size_t>(own)]) {
    const AsmtJoint& joint = joints_.all[static_cast<std::size_t>(i)];
    const int a = group(joint.first.part), b = group(joint.second.part);
    candidates.push_back(a == own ? b : a);
  }
  candidates.push_back(own);
  for (const int carrier : candidates) {
    const auto first = side(relation.first, carrier), second = side(relation.second, carrier);
    const bool gears = relation.kind == AsmtRelationKind::kGear;
    if (!first || !second || (gears && (first->turn.empty() || second->turn.empty()))) continue;
    return std::array<Side, 2>{*first, *second};
  }
  return std::nullopt;
}

std::string or_zero(const std::string& formula) { return formula.empty() ? "0" : formula; }

std::string formula_of(const AsmtRelation& relation, const Side& I, const Side& J, const AsmtImport& import) {
  const Pose X_WI = import.world(relation.first);
  const Eigen::Vector3d apart = import.world(relation.second).p - X_WI.p;
  const std::string turn = fmt::format("({} - {})", or_zero(J.turn), or_zero(I.turn));
  const auto way = [&](int axis) {
    const Eigen::Vector3d along = X_WI.R.col(axis);
    return fmt::format("({} - {})", J.along(along), I.along(along));
  };
  switch (relation.kind) {
    case AsmtRelationKind::kGear:
      return fmt::format("{} + ({})*{}", J.turn, relation.lengths[0] / relation.lengths[1], I.turn);
    case AsmtRelationKind::kScrew:
      return fmt::format("{} - ({})*{}", way(2), relation.lengths[0] / (2 * std::numbers::pi), turn);
    case AsmtRelationKind::kRackPinion:
      break;
  }
  if (I.turn.empty()) return fmt::format("{} + ({})*{}", way(0), relation.lengths[0], turn);
  const double x = X_WI.R.col(0).dot(apart), y = X_WI.R.col(1).dot(apart);
  return fmt::format("cos({0})*(({1}) + {2}) + sin({0})*(({3}) + {4}) - ({1}) + ({5})*{6}", I.turn, x, way(0), y,
                     way(1), relation.lengths[0], turn);
}

}  // namespace

AsmtRelation read_asmt_relation(AsmtRelationKind kind, const AsmtRecord& record, const std::string& name,
                                const AsmtMarker& first, const AsmtMarker& second, AsmtImport& import) {
  AsmtRelation relation{kind, name, record.at(), first, second, {0, 0}};
  const auto length = [&](std::string_view which) {
    const std::optional<double> value = import.geometry.number(record, which);
    if (value && *value == 0 && kind == AsmtRelationKind::kGear) {
      import.diagnostics.error("F206", record.child(which).value_at(),
                               fmt::format("'{}' of '{}' is zero", which, name));
    }
    return value.value_or(0) / import.geometry.per_metre();
  };
  switch (kind) {
    case AsmtRelationKind::kGear:
      relation.lengths = {length("radiusI"), length("radiusJ")};
      break;
    case AsmtRelationKind::kScrew:
      relation.lengths[0] = length("pitch");
      break;
    case AsmtRelationKind::kRackPinion:
      relation.lengths[0] = length("pitchRadius");
      break;
  }
  return relation;
}

void add_asmt_relations(const std::vector<AsmtRelation>& relations, const AsmtJoints& joints, AsmtImport& import) {
  if (relations.empty() || import.diagnostics.has_errors()) return;
  Carriers carriers(joints, import);
  for (const AsmtRelation& relation : relations) {
    const auto found = carriers.sides(relation);
    if (!found) {
      import.diagnostics.error("F602", relation.at,
                               fmt::format("'{}' relates motions that no joint coordinates give", relation.name),
                               relation.kind == AsmtRelationKind::kGear
                                   ? "both gears need hinges on one part, about z of their markers"
                                   : "both parts need a hinge about z of their markers, or a slider, on one part");
      continue;
    }
    std::string name = relation.name;
    if (name.rfind(import.shared_prefix, 0) == 0) name.erase(0, import.shared_prefix.size());
    add_asmt_constraint(import, name, formula_of(relation, (*found)[0], (*found)[1], import), relation.at);
  }
}

}  // namespace ferrers
