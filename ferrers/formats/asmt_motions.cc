#include "ferrers/formats/asmt_motions.h"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "ferrers/formats/asmt_law.h"

namespace ferrers {
namespace {

// A side of a limit that the file leaves open, in rad or m: farther than anything goes.
constexpr double kOpen = 1e9;

/// A joint coordinate that a motion or limit is about.
struct Target {
  JointSpec* joint = nullptr;
  bool reversed = false;  ///< The markers are named the other way round.
};

/// The joint that `record` names, or the one between its two markers; nothing, with an error (F604), where there is
/// none.
std::optional<Target> find_target(const AsmtRecord& record, const AsmtJoints& joints, AsmtImport& import) {
  const auto [path, at] = asmt_text(import, record, "MotionJoint");
  const std::string I = asmt_text(import, record, "MarkerI").first, J = asmt_text(import, record, "MarkerJ").first;
  int index = -1;
  bool reversed = false;
  if (!path.empty()) {
    const auto found = joints.by_path.find(path);
    if (found == joints.by_path.end() || found->second < 0) {
      import.diagnostics.error(
          "F604", at,
          fmt::format("'{}' is {}", path, found == joints.by_path.end() ? "no joint that was read" : "several joints"));
      return std::nullopt;
    }
    index = found->second;
  } else {
    auto found = joints.by_markers.find(I + "\n" + J);
    if (found == joints.by_markers.end()) {
      found = joints.by_markers.find(J + "\n" + I);
      reversed = true;
    }
    if (found == joints.by_markers.end()) {
      import.diagnostics.error("F604", record.at(),
                               fmt::format("'{}' is about two markers that no joint joins", record.name()));
      return std::nullopt;
    }
    index = found->second;
  }
  const int in_spec = joints.all[static_cast<std::size_t>(index)].index;
  return Target{&import.spec.joints[static_cast<std::size_t>(in_spec)], reversed};
}

/// The name of the rotation or translation among the joint's coordinates; empty where it is the only one; nothing where
/// the joint has none.
std::optional<std::string> coordinate_of(const JointSpec& joint, bool rotation) {
  if (joint.type == JointType::kCylindrical) return rotation ? "angle" : "displacement";
  if (joint.type == (rotation ? JointType::kRevolute : JointType::kPrismatic)) return std::string();
  return std::nullopt;
}

void read_motion(const AsmtRecord& record, const AsmtJoints& joints, AsmtImport& import) {
  const bool rotation = record.name() == "RotationalMotion";
  const auto [name, name_at] = asmt_text(import, record, "Name");
  if (!rotation && record.name() != "TranslationalMotion") {
    record.mark_read_with_all();
    import.diagnostics.error("F602", record.at(),
                             fmt::format("motions of the class '{}' are not supported", record.name()),
                             "RotationalMotion and TranslationalMotion are");
    return;
  }
  const auto [text, at] = asmt_text(import, record, rotation ? "RotationZ" : "TranslationZ");
  const std::optional<Target> target = find_target(record, joints, import);
  const double unit = rotation ? 1 : 1 / import.geometry.per_metre();
  const std::optional<Expression> law =
      read_asmt_law(text, at, target && target->reversed ? -unit : unit, import.diagnostics);
  if (!target || !law) return;
  const std::optional<std::string> coordinate = coordinate_of(*target->joint, rotation);
  if (!coordinate) {
    import.diagnostics.error("F602", record.at(),
                             fmt::format("'{}' moves '{}', which has no {}", name, target->joint->name.name,
                                         rotation ? "angle" : "displacement"));
    return;
  }
  DriveSpec drive;
  drive.name = NameRef(import.add_name("drives", "drive", name), name_at);
  drive.coordinate = CoordinateRef{NameRef(target->joint->name.name, at), *coordinate};
  drive.motion.emplace_back();
  drive.motion.front().expression = *law;
  drive.motion.front().at = at;
  drive.at = record.at();
  import.spec.drives.push_back(std::move(drive));
}

void read_limit(const AsmtRecord& record, const AsmtJoints& joints, AsmtImport& import) {
  const bool rotation = record.name() == "RotationLimit";
  const std::string name = asmt_text(import, record, "Name").first;
  if (!rotation && record.name() != "TranslationLimit") {
    record.mark_read_with_all();
    import.diagnostics.warning("F601", record.at(),
                               fmt::format("the limit '{}' of the class '{}' is not read", name, record.name()));
    return;
  }
  const auto [text, at] = asmt_text(import, record, "Limit");
  const auto [type, type_at] = asmt_text(import, record, "Type");
  (void)asmt_text(import, record, "Tol");
  const bool upper = type == "=<" || type == "<=", lower = type == "=>" || type == ">=";
  if (!upper && !lower) {
    import.diagnostics.error("F209", type_at, fmt::format("'{}' is no type of limit", type), "'=<' or '=>'");
  }
  const std::optional<Target> target = find_target(record, joints, import);
  const auto law = read_asmt_law(text, at, rotation ? 1 : 1 / import.geometry.per_metre(), import.diagnostics);
  if (!target || !law || upper == lower) return;
  const std::optional<double> value = law->constant_value();
  if (!value) {
    import.diagnostics.error("F602", at, fmt::format("the limit '{}' changes in time", name));
    return;
  }
  const std::optional<std::string> coordinate = coordinate_of(*target->joint, rotation);
  if (!coordinate || !coordinate->empty()) {
    import.diagnostics.warning(
        "F601", record.at(), fmt::format("the limit '{}' is not read: only joints of one coordinate have limits", name),
        "limits take part in no equation; runs tell where they are crossed");
    return;
  }
  std::optional<std::array<Number, 2>>& limits = target->joint->limits;
  if (!limits) limits = {Number(-kOpen), Number(kOpen)};
  Number& side = (*limits)[upper != target->reversed ? 1 : 0];
  side = Number(target->reversed ? -*value : *value);
  side.at = at;
}

}  // namespace

void read_asmt_motions(const AsmtRecord& constraint_sets, const AsmtJoints& joints, AsmtImport& import) {
  const AsmtRecord list = constraint_sets.child("Motions");
  if (!list) return;
  for (const AsmtRecord& record : list.children()) {
    if (record.name().empty()) continue;
    record.mark_read();
    read_motion(record, joints, import);
  }
}

void read_asmt_limits(const AsmtRecord& constraint_sets, const AsmtJoints& joints, AsmtImport& import) {
  const AsmtRecord list = constraint_sets.child("Limits");
  if (!list) return;
  for (const AsmtRecord& record : list.children()) {
    if (record.name().empty()) continue;
    record.mark_read();
    if (const AsmtRecord behavior = record.child("Behavior");
        behavior && behavior.value(import.diagnostics) == "Rigid") {
      record.mark_read_with_all();  // what follows says nothing of a rigid one
    }
    read_limit(record, joints, import);
  }
}

}  // namespace ferrers
