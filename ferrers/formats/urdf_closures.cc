#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <set>

#include "ferrers/core/closest_name.h"
#include "ferrers/formats/urdf_import.h"
#include "ferrers/formats/urdf_values.h"
#include "ferrers/io/document.h"

namespace ferrers {
namespace {

constexpr std::array<std::string_view, 5> kKeys = {"closed_loop", "type", "name_mot", "joint_name", "joint_type"};

std::string upper(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(), [](unsigned char c) { return std::toupper(c); });
  return result;
}

/// Reads one file of closures. Its places are in messages as text: a diagnostic's place is one in the URDF file.
class ClosuresReader {
 public:
  ClosuresReader(std::string file, bool optional, Diagnostics& diagnostics)
      : optional_(optional), diagnostics_(diagnostics) {
    closures_.file = std::move(file);
  }

  std::optional<UrdfClosures> read(std::string_view text) {
    Diagnostics own;
    const std::optional<DocumentNode> root = parse_document(text, own);
    for (const Diagnostic& one : own.items()) {
      if (one.severity == Severity::kError) fail(one.code, one.at, one.message, one.hint);
    }
    if (failed_ || !root) return std::nullopt;
    if (root->find("ferrers") != nullptr) return not_used();
    if (root->kind != DocumentNode::Kind::kMap) {
      fail("F203", root->at, "a file of closures is a map of 'closed_loop', 'type', 'name_mot' and so on");
      return std::nullopt;
    }
    for (const DocumentEntry& entry : root->entries) {
      if (std::find(kKeys.begin(), kKeys.end(), entry.key) != kKeys.end()) continue;
      diagnostics_.notice("F601", {}, fmt::format("{}: '{}' is not read", place(entry.key_at), entry.key));
    }
    read_loops(*root);
    read_joint_types(*root);
    for (const auto& [motor, at] : names(*root, "name_mot")) closures_.motors.push_back({motor, "", place(at)});
    if (failed_) return std::nullopt;
    return std::move(closures_);
  }

  /// Another file, which may happen to lie there.
  std::optional<UrdfClosures> not_used() {
    const std::string message =
        fmt::format("'{}' is no file of closures{}", closures_.file, optional_ ? " and is not used" : "");
    const std::string hint = "a file of closures has the keys 'closed_loop' and 'type'";
    if (optional_) {
      diagnostics_.notice("F603", {}, message, hint);
    } else {
      diagnostics_.error("F606", {}, message, hint);
    }
    return std::nullopt;
  }

 private:
  using Name = std::pair<std::string, SourceRange>;

  std::string place(SourceRange at) const { return fmt::format("{}:{}:{}", closures_.file, at.line, at.column); }

  void fail(std::string_view code, SourceRange at, const std::string& message, const std::string& hint = {}) {
    failed_ = true;
    diagnostics_.error(code, {}, fmt::format("{}: {}", place(at), message), hint);
  }

  std::vector<Name> texts(const DocumentNode& list, std::string_view key) {
    std::vector<Name> result;
    if (list.kind == DocumentNode::Kind::kNull) return result;
    if (list.kind != DocumentNode::Kind::kSequence) {
      fail("F203", list.at, fmt::format("'{}' is a list", key));
      return result;
    }
    for (const DocumentNode& item : list.items) {
      if (item.is_scalar()) {
        result.emplace_back(item.text, item.at);
      } else {
        fail("F203", item.at, fmt::format("'{}' is a list of names", key));
      }
    }
    return result;
  }

  std::vector<Name> names(const DocumentNode& root, std::string_view key) {
    const DocumentNode* list = root.find(key);
    return list ? texts(*list, key) : std::vector<Name>();
  }

  /// A list that goes along with another one, or is left out.
  std::vector<Name> names_beside(const DocumentNode& root, std::string_view key, std::size_t count) {
    std::vector<Name> list = names(root, key);
    const DocumentNode* node = root.find(key);
    if (node != nullptr && list.size() != count) {
      fail("F208", node->at, fmt::format("'{}' has {} entries, not {}", key, list.size(), count));
      list.clear();
    }
    return list;
  }

  void read_loops(const DocumentNode& root) {
    const DocumentNode* loops = root.find("closed_loop");
    if (loops == nullptr || loops->kind == DocumentNode::Kind::kNull) return;
    if (loops->kind != DocumentNode::Kind::kSequence) {
      return fail("F203", loops->at, "'closed_loop' is a list of pairs of names");
    }
    const std::vector<Name> types = names_beside(root, "type", loops->items.size());
    for (std::size_t i = 0; i < loops->items.size(); ++i) {
      const std::vector<Name> pair = texts(loops->items[i], "closed_loop");
      if (pair.size() != 2) {
        fail("F208", loops->items[i].at, fmt::format("a closed loop is a pair of names, not {}", pair.size()));
        continue;
      }
      UrdfClosures::Loop loop{pair[0].first, pair[1].first, true, place(loops->items[i].at)};
      if (i < types.size()) {
        const std::string type = upper(types[i].first);
        loop.whole_frame = type != "3D";
        if (type != "3D" && type != "6D") {
          fail("F209", types[i].second, fmt::format("'{}' is no type of closed loop", types[i].first),
               "'3d' joins points, '6d' joins frames");
        }
      }
      closures_.loops.push_back(std::move(loop));
    }
  }

  void read_joint_types(const DocumentNode& root) {
    const std::vector<Name> joints = names(root, "joint_name");
    const std::vector<Name> types = names_beside(root, "joint_type", joints.size());
    if (!joints.empty() && root.find("joint_type") == nullptr) {
      fail("F202", root.find("joint_name")->at, "'joint_name' needs 'joint_type' beside it");
    }
    for (std::size_t i = 0; i < types.size(); ++i) {
      const std::string type = joint_type(upper(types[i].first));
      if (type.empty()) {
        fail("F209", types[i].second, fmt::format("'{}' is no type of joint here", types[i].first),
             "there are SPHERICAL, FIXED, UJOINT_XY and the like, and CARDAN, which is UJOINT_XY");
      }
      closures_.joint_types.push_back({joints[i].first, type, place(joints[i].second)});
    }
  }

  /// As `UrdfJoint::type` says it; empty: unknown.
  static std::string joint_type(const std::string& type) {
    if (type == "SPHERICAL") return "spherical";
    if (type == "FIXED") return "fixed";
    if (type == "CARDAN") return "universal XY";
    constexpr std::string_view kPrefix = "UJOINT_";
    if (type.rfind(kPrefix, 0) != 0 || type.size() != kPrefix.size() + 2) return "";
    const std::string axes = type.substr(kPrefix.size());
    const bool known = axes.find_first_not_of("XYZ") == std::string::npos && axes[0] != axes[1];
    return known ? "universal " + axes : "";
  }

  bool optional_;  ///< Whether the file may be another one.
  Diagnostics& diagnostics_;
  UrdfClosures closures_;
  bool failed_ = false;
};

std::string near(const UrdfImport& import, std::string_view name, bool links_too) {
  std::vector<std::string_view> known;
  for (const auto& [joint, index] : import.tree.joint_index) known.push_back(joint);
  for (const auto& [link, index] : import.tree.link_index) {
    if (links_too) known.push_back(link);
  }
  return did_you_mean(name, known);
}

/// The link whose frame a name means: the link's own, or a joint's, which is its child link's.
std::optional<int> frame_link(UrdfImport& import, const std::string& name, const std::string& place) {
  const std::optional<int> link = import.tree.find_link(name);
  const std::optional<int> joint = import.tree.find_joint(name);
  const std::optional<int> child = joint ? std::optional(import.joint(*joint).child) : std::nullopt;
  if (link && child && *link != *child) {
    import.diagnostics().error("F604", {},
                               fmt::format("{}: '{}' is a link, and also a joint with another frame", place, name),
                               "rename one of the two");
    return std::nullopt;
  }
  if (link || child) return link ? link : child;
  import.diagnostics().error("F604", {}, fmt::format("{}: there is no link and no joint '{}'", place, name),
                             near(import, name, true));
  return std::nullopt;
}

/// What two names have in common in front, as 'loop1' of 'loop1_A' and 'loop1_B'; else "closure".
std::string loop_name(std::string_view first, std::string_view second) {
  std::size_t same = 0;
  while (same < first.size() && same < second.size() && first[same] == second[same]) ++same;
  while (same > 0 && (first[same - 1] == '_' || first[same - 1] == '-')) --same;
  return same >= 3 ? std::string(first.substr(0, same)) : "closure";
}

void add_closure(UrdfImport& import, const UrdfClosures::Loop& loop) {
  const std::optional<int> first = frame_link(import, loop.first, loop.place);
  const std::optional<int> second = frame_link(import, loop.second, loop.place);
  if (!first || !second) return;
  if (*first == *second) {
    import.diagnostics().error(
        "F605", {}, fmt::format("{}: '{}' and '{}' are frames of one link", loop.place, loop.first, loop.second));
    return;
  }
  JointSpec joint;
  joint.name = import.names.add("joints", "joint", loop_name(loop.first, loop.second));
  joint.type = loop.whole_frame ? JointType::kWeld : JointType::kSpherical;
  joint.bodies = {NameRef(import.link(*first).body), NameRef(import.link(*second).body)};
  joint.frames = {PoseSpec(), PoseSpec()};
  import.spec().joints.push_back(std::move(joint));
}

/// The joints that a motor's name means: the one of that name, else all that have it within their names.
std::vector<int> motor_joints(const UrdfImport& import, const std::string& name) {
  if (const auto exact = import.tree.find_joint(name)) return {*exact};
  std::vector<int> found;
  for (std::size_t i = 0; !name.empty() && i < import.tree.joints.size(); ++i) {
    const UrdfJoint& joint = import.tree.joints[i];
    if (joint.has_one_coordinate() && joint.name.find(name) != std::string::npos) found.push_back(static_cast<int>(i));
  }
  return found;
}

void add_motor(UrdfImport& import, const UrdfClosures::Named& motor) {
  const std::vector<int> joints = motor_joints(import, motor.name);
  if (joints.empty()) {
    import.diagnostics().error("F604", {},
                               fmt::format("{}: there is no joint '{}' for a motor", motor.place, motor.name),
                               near(import, motor.name, false));
  }
  for (const int index : joints) {
    const UrdfJoint& joint = import.joint(index);
    if (joint.has_one_coordinate()) {
      import.add_drive(index, joint.name, joint.element.attribute_at("name"));
    } else {
      import.diagnostics().error("F604", {},
                                 fmt::format("{}: the {} joint '{}' has no single coordinate for a motor", motor.place,
                                             joint.type, joint.name));
    }
  }
}

}  // namespace

std::optional<UrdfClosures> read_urdf_closures(const ImportContext& context) {
  if (!context.options.closures) return std::nullopt;
  const std::string file = context.options.closures->string();
  const std::optional<std::string> text = context.load(file);
  if (!text) {
    context.diagnostics.error("F606", {}, fmt::format("the file of closures '{}' cannot be read", file));
    return std::nullopt;
  }
  const bool is_one = std::any_of(kKeys.begin(), kKeys.end(), [&](std::string_view key) {
    return key.size() > 4 && text->find(key) != std::string::npos;
  });
  ClosuresReader reader(file, context.options.closures_may_be_another_file, context.diagnostics);
  std::optional<UrdfClosures> closures = is_one ? reader.read(*text) : reader.not_used();
  if (closures) {
    context.diagnostics.notice(
        "F603", {},
        fmt::format("'{}' closes {} loops and names {} motors", file, closures->loops.size(), closures->motors.size()));
  }
  return closures;
}

void replace_urdf_joint_types(UrdfImport& import, const UrdfClosures& closures) {
  for (const UrdfClosures::Named& one : closures.joint_types) {
    const std::optional<int> found = import.tree.find_joint(one.name);
    if (!found) {
      import.diagnostics().error("F604", {}, fmt::format("{}: there is no joint '{}'", one.place, one.name),
                                 near(import, one.name, false));
      continue;
    }
    UrdfJoint& joint = import.tree.joints[static_cast<std::size_t>(*found)];
    joint.type = one.type;
    joint.replaced = true;
  }
}

void import_urdf_closures(UrdfImport& import, const UrdfClosures& closures) {
  for (const UrdfClosures::Loop& loop : closures.loops) add_closure(import, loop);
  for (const UrdfClosures::Named& motor : closures.motors) add_motor(import, motor);
}

}  // namespace ferrers
