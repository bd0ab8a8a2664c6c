#include "ferrers/formats/sdf_joints.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "ferrers/formats/sdf_axis_data.h"
#include "ferrers/formats/sdf_versions.h"
#include "ferrers/model/pose_spec.h"

namespace ferrers {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kSamePlace = 1e-9;      // m or rad: what is written with fewer digits is drawn together
constexpr double kPerpendicular = 1e-6;  // cosine of the angle of a universal joint's axes

struct TypeEntry {
  std::string_view name;
  JointType type;
  int axes;
  int coordinates;
};

constexpr std::array<TypeEntry, 9> kTypes = {{{"fixed", JointType::kWeld, 0, 0},
                                              {"revolute", JointType::kRevolute, 1, 1},
                                              {"continuous", JointType::kRevolute, 1, 1},
                                              {"prismatic", JointType::kPrismatic, 1, 1},
                                              {"screw", JointType::kScrew, 1, 1},
                                              {"universal", JointType::kUniversal, 2, 2},
                                              {"revolute2", JointType::kUniversal, 2, 2},
                                              {"ball", JointType::kSpherical, 0, 3},
                                              {"gearbox", JointType::kGearMesh, 0, 0}}};

const TypeEntry* find_type(std::string_view name) {
  for (const TypeEntry& one : kTypes) {
    if (one.name == name) return &one;
  }
  return nullptr;
}

/// One of the two sides of a joint.
struct Side {
  std::string body;
  Pose X_WB;  ///< Of the body as drawn.
  Pose X_WJ;  ///< Of the joint's frame on it.
};

class JointReader {
 public:
  JointReader(SdfTree& tree, const SdfBodies& bodies, const ImportOptions& options, NameMap& names, ModelSpec& spec)
      : tree_(tree), bodies_(bodies), options_(options), names_(names), spec_(spec) {}

  SdfMadeJoint read(const SdfJoint& joint);

 private:
  std::optional<std::array<Side, 2>> sides(const SdfJoint& joint, const TypeEntry& type);
  bool part_of_mechanism(const SdfJoint& joint, const TypeEntry& type, const std::array<Side, 2>& sides) const;
  std::optional<Matrix3d> axes(const SdfJoint& joint, const TypeEntry& type);
  void draw_open(const SdfJoint& joint, int parent, int child, std::array<Side, 2>& sides);
  Number lead(const SdfElement& joint) const;

  SdfTree& tree_;
  const SdfBodies& bodies_;
  const ImportOptions& options_;
  NameMap& names_;
  ModelSpec& spec_;
};

/// As SDF has it, the joint's frame is where its <pose> draws it, on both sides. But where the joint has no <pose> and
/// its parent is a frame drawn elsewhere, the two named frames are what it brings together.
void JointReader::draw_open(const SdfJoint& joint, int parent, int child, std::array<Side, 2>& sides) {
  if (joint.has_pose || tree_.frames[parent].kind != SdfFrame::Kind::kFrame) return;
  const Pose X_WP = tree_.frames.pose_in_world(parent);
  const Pose apart = X_WP.inverse() * sides[1].X_WJ;
  const double far = apart.p.norm();
  const double turned = (apart.R - Matrix3d::Identity()).norm();
  if (!(far > kSamePlace) && !(turned > kSamePlace)) return;
  sides[0].X_WJ = X_WP;
  std::string how = far > kSamePlace ? fmt::format("{:.4g} m apart", far) : "";
  if (turned > kSamePlace) how += how.empty() ? "turned against each other" : " and turned";
  joint.element.warning("F603",
                        fmt::format("the frames '{}' and '{}', which the joint '{}' connects, are drawn {}: the joint "
                                    "is taken to bring them together",
                                    tree_.frames[parent].name, tree_.frames[child].name, tree_.shown(joint.path), how),
                        "libsdformat would place the joint at its child, as drawn; an empty <pose/> in the joint says "
                        "so here too");
}

std::optional<std::array<Side, 2>> JointReader::sides(const SdfJoint& joint, const TypeEntry& type) {
  SdfFrames& frames = tree_.frames;
  const SdfElement parent = joint.element.child("parent");
  const SdfElement child = joint.element.child("child");
  if (!parent) joint.element.error("F202", fmt::format("the joint '{}' has no <parent>", tree_.shown(joint.path)));
  if (!parent || !child) return std::nullopt;
  const auto first = frames.find_or_tell(joint.scope, {parent.text(), parent}, "<parent>");
  const auto second = frames.find(joint.scope, child.text());  // told by the frames
  if (!first || !second) return std::nullopt;
  if (child.text() == "world") {
    child.text_error("F605", "the world cannot be the child of a joint", "exchange <parent> and <child>");
    return std::nullopt;
  }
  std::array<Side, 2> both;
  for (const std::size_t i : {0u, 1u}) {
    const int body = frames.body_of(i == 0 ? *first : *second);
    both[i].body = bodies_.of(body);
    if (both[i].body != kGround) both[i].X_WB = frames.pose_in_world(body);
    both[i].X_WJ = frames.pose_in_world(joint.frame);
  }
  if (type.type != JointType::kWeld) draw_open(joint, *first, *second, both);
  return both;
}

/// Whether the joint does anything: not between two parts of the ground.
bool JointReader::part_of_mechanism(const SdfJoint& joint, const TypeEntry& type,
                                    const std::array<Side, 2>& both) const {
  const std::string name = tree_.shown(joint.path);
  if (both[0].body.empty() || both[1].body.empty()) return false;  // of a link that has its own message
  if (both[0].body == kGround && both[1].body == kGround) {
    joint.element.notice("F603", fmt::format("the joint '{}' is left out: nothing that it connects can move", name));
    joint.element.xml().mark_read_with_all();
    return false;
  }
  if (both[0].body == both[1].body) {
    joint.element.error("F316", fmt::format("the joint '{}' connects '{}' with itself", name, both[0].body));
    return false;
  }
  const bool to_ground = both[0].body == kGround || both[1].body == kGround;
  if (options_.base == ImportBase::kFree && type.type == JointType::kWeld && to_ground) {
    joint.element.notice("F603", fmt::format("the joint '{}' is left out, so that the model is free", name));
    return false;
  }
  return true;
}

/// The joint's axes in its frame, as a rotation: z is the axis, x the second one.
std::optional<Matrix3d> JointReader::axes(const SdfJoint& joint, const TypeEntry& type) {
  if (type.axes == 0) return Matrix3d::Identity();
  const SdfElement axis = joint.element.child("axis");
  const SdfElement axis2 = type.axes == 2 ? joint.element.child("axis2") : SdfElement();
  if (!axis || (type.axes == 2 && !axis2)) {
    joint.element.error("F202",
                        fmt::format("the joint '{}' has no <{}>", tree_.shown(joint.path), axis ? "axis2" : "axis"));
    return std::nullopt;
  }
  const Vector3d z = read_sdf_axis(tree_, joint, axis);
  if (type.axes == 1) return frame_from_z(z);
  const Vector3d x = read_sdf_axis(tree_, joint, axis2);
  if (std::abs(z.dot(x)) > kPerpendicular) {
    axis2.error("F319",
                fmt::format("the axes of the {} joint '{}' are not perpendicular", type.name, tree_.shown(joint.path)),
                "two revolute joints with a body between them can have any axes");
    return std::nullopt;
  }
  return frame_from_zx(z, x);
}

/// Metres per turn, right-handed. <thread_pitch> is in radians per metre and left-handed, as Gazebo took it.
Number JointReader::lead(const SdfElement& joint) const {
  if (joint.child("screw_thread_pitch")) return joint.number("screw_thread_pitch", 1);
  if (!joint.child("thread_pitch")) {
    joint.error("F202", "a screw joint needs a <screw_thread_pitch>", "in metres per turn, positive if right-handed");
    return 1;
  }
  Number pitch = joint.number("thread_pitch", 1);
  joint.child("thread_pitch")
      .notice("F603", "<thread_pitch> is understood as Gazebo does: radians per metre, positive if left-handed",
              "<screw_thread_pitch> is in metres per turn, positive if right-handed");
  if (pitch.value == 0) {
    joint.child("thread_pitch").text_error("F322", "a screw of zero radians per metre has no lead");
    return pitch;
  }
  pitch.value = -2 * std::numbers::pi / pitch.value;
  return pitch;
}

SdfMadeJoint JointReader::read(const SdfJoint& joint) {
  const SdfElement& element = joint.element;
  const std::string written = element.attribute("type");
  const TypeEntry* type = find_type(written);
  if (!type) {
    if (written.empty()) {
      element.error("F202", fmt::format("the joint '{}' has no 'type'", tree_.shown(joint.path)));
    } else {
      element.attribute_error("type", "F602", fmt::format("joints of type '{}' are not read", written));
    }
    return {};
  }
  const std::optional<std::array<Side, 2>> both = sides(joint, *type);
  if (type->type == JointType::kGearMesh || !both || !part_of_mechanism(joint, *type, *both)) return {};
  const std::optional<Matrix3d> R_JA = axes(joint, *type);
  if (!R_JA) return {};

  SdfMadeJoint made;
  made.name = names_.add("joints", "joint", tree_.shown(joint.path));
  made.turns = type->type == JointType::kRevolute;
  made.coordinates = type->coordinates;
  made.axis = (*both)[1].X_WJ.R * R_JA->col(2);
  JointSpec spec;
  spec.name = NameRef(made.name, element.attribute_at("name"));
  spec.type = type->type;
  spec.frames.emplace();
  for (const std::size_t i : {0u, 1u}) {
    const Side& side = (*both)[i];
    made.bodies[i] = side.body;
    spec.bodies[i] = NameRef(side.body, element.child(i == 0 ? "parent" : "child").text_at());
    (*spec.frames)[i] = pose_spec(side.X_WB.inverse() * side.X_WJ * Pose(*R_JA, Vector3d::Zero()), element.at());
  }
  if (type->type == JointType::kScrew) spec.lead = lead(element);
  if (type->type == JointType::kWeld) mark_fixed(spec);
  read_sdf_axis_data(element, {written, made.name, type->axes}, options_, names_, spec, spec_.forces);
  spec_.joints.push_back(std::move(spec));
  return made;
}

}  // namespace

Eigen::Vector3d read_sdf_axis(SdfTree& tree, const SdfJoint& joint, const SdfElement& axis) {
  SdfFrames& frames = tree.frames;
  const Matrix3d R_WJ = frames.pose_in_world(joint.frame).R;
  Matrix3d R_JE = Matrix3d::Identity();
  const SdfElement xyz = axis.child("xyz");
  const std::string expressed_in = xyz ? xyz.attribute("expressed_in") : "";
  const bool older = axis.version() < kUniqueFrameNames;
  if (older && axis.flag("use_parent_model_frame", axis.version() < kAxisInJointFrame)) {
    R_JE = R_WJ.transpose() * frames.pose_in_world(frames.own_frame(joint.scope)).R;
  } else if (!older && !expressed_in.empty()) {
    const auto frame = frames.find_or_tell(joint.scope, {expressed_in, xyz}, "'expressed_in'");
    if (frame) R_JE = R_WJ.transpose() * frames.pose_in_world(*frame).R;
  }
  const Vector3d written = axis.vector("xyz").value_or(Vector3d::UnitZ());
  const double scale = written.cwiseAbs().maxCoeff();
  if (!(scale > 0)) {
    xyz.text_error("F318", "the axis has no direction: it is zero");
    return Vector3d::UnitZ();
  }
  return R_JE * (written / scale).normalized();
}

std::vector<SdfMadeJoint> read_sdf_joints(SdfTree& tree, const SdfBodies& bodies, const ImportOptions& options,
                                          NameMap& names, ModelSpec& spec) {
  JointReader reader(tree, bodies, options, names, spec);
  std::vector<SdfMadeJoint> made;
  for (const SdfJoint& joint : tree.joints) made.push_back(reader.read(joint));
  return made;
}

}  // namespace ferrers
