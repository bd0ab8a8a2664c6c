#include "ferrers/formats/mjcf_written_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "ferrers/kinematics/motion.h"

namespace ferrers::mjcf {
namespace {

/// One coordinate of a joint type: M moves against F along or about an axis; coordinates follow each other from F to M.
struct Step {
  int coordinate;
  JointKind kind;
  int axis;  ///< 0, 1, 2: x, y, z.
};

std::vector<Step> steps_of(JointType type) {
  constexpr JointKind kHinge = JointKind::kHinge, kSlide = JointKind::kSlide;
  switch (type) {
    case JointType::kRevolute:
      return {{0, kHinge, 2}};
    case JointType::kPrismatic:
      return {{0, kSlide, 2}};
    case JointType::kScrew:  // the slide follows the hinge: it has no coordinate of its own
      return {{0, kHinge, 2}, {-1, kSlide, 2}};
    case JointType::kCylindrical:
      return {{0, kHinge, 2}, {1, kSlide, 2}};
    case JointType::kUniversal:
      return {{0, kHinge, 2}, {1, kHinge, 0}};
    case JointType::kPlanar:
      return {{0, kSlide, 0}, {1, kSlide, 1}, {2, kHinge, 2}};
    case JointType::kSpherical:
      return {{0, JointKind::kBall, 2}};
    case JointType::kFree:
      return {{0, JointKind::kFree, 2}};
    default:
      return {};
  }
}

Pose motion_of(const Step& step, double q) {
  const Vector3d axis = Vector3d::Unit(step.axis);
  if (step.kind == JointKind::kSlide) return {Matrix3d::Identity(), q * axis};
  if (step.kind == JointKind::kHinge) return {Eigen::AngleAxisd(q, axis).toRotationMatrix(), Vector3d::Zero()};
  return {};
}

class TreeWriter {
 public:
  explicit TreeWriter(const System& system)
      : system_(system), model_(*system.model), pos_(make_position_kinematics(system)) {
    compute_positions(system, system.drawn_q, pos_);
    count_users();
  }

  WrittenTree write() {
    out_.bodies.emplace_back();
    out_.bodies[0].name = "world";
    for (const Body& body : model_.bodies()) body_names_.insert(body.name);
    for (const Joint& joint : model_.joints()) joint_names_.insert(joint.name);
    out_.index.emplace(kGround, 0);
    const auto& nodes = system_.topology->forest.nodes;
    written_of_node_.assign(nodes.size(), 0);
    for (std::size_t i = 1; i < nodes.size(); ++i) {
      if (nodes[i].body.valid()) add(i);
    }
    dissolve();
    index_coordinates();
    return std::move(out_);
  }

 private:
  /// What touches a body besides the joint that carries it.
  void count_users() {
    users_.assign(model_.bodies().size(), 0);
    for (const Joint& joint : model_.joints()) {
      if (!joint_type_info(joint.type).carries_body) continue;
      ++users_[static_cast<std::size_t>(joint.first.index())];
      ++users_[static_cast<std::size_t>(joint.second.index())];
    }
    const auto touch = [&](BodyId body) { users_[static_cast<std::size_t>(body.index())] += 3; };
    for (const ForceElement& force : model_.forces()) {
      if (const auto* spring = std::get_if<Spring>(&force.element)) touch(spring->first), touch(spring->second);
      if (const auto* bushing = std::get_if<Bushing>(&force.element)) touch(bushing->first), touch(bushing->second);
      if (const auto* load = std::get_if<Load>(&force.element)) touch(load->body);
    }
  }

  void add(std::size_t i) {
    const TreeNode& node = system_.topology->forest.nodes[i];
    WrittenBody body;
    body.body = node.body;
    body.name = model_.body(node.body).name;
    if (body.name == "world") body.name = unused("world_", body_names_);
    body.parent = written_of_node_[static_cast<std::size_t>(node.parent)];
    body.X_WB = body_pose(system_, pos_, node.body);
    const bool free = !node.joint.valid() || model_.joint(node.joint).type == JointType::kFree;
    if (free) body.parent = 0;
    body.X_PB = out_.bodies[static_cast<std::size_t>(body.parent)].X_WB.inverse() * body.X_WB;
    if (node.joint.valid()) {
      add_joints(node, system_.nodes[i], body);
    } else {
      WrittenJoint floating;
      floating.name = unused(body.name + "_floats", joint_names_);
      floating.kind = JointKind::kFree;
      body.joints.push_back(std::move(floating));
    }
    written_of_node_[i] = static_cast<int>(out_.bodies.size());
    out_.bodies.push_back(std::move(body));
  }

  /// The steps from the parent's side to the body's; their axes in the body's frame at the drawn coordinates.
  void add_joints(const TreeNode& tree_node, const Node& node, WrittenBody& body) {
    const Joint& joint = model_.joint(tree_node.joint);
    std::vector<Step> steps = steps_of(joint.type);
    const Pose X_BJ = tree_node.forward ? joint.X_2M : joint.X_1F;
    // Against the joint's direction its motions are undone one by one, the last one first.
    if (!tree_node.forward) std::reverse(steps.begin(), steps.end());
    const double sign = tree_node.forward ? 1 : -1;
    Pose back = X_BJ;  // what the later steps have moved
    std::vector<WrittenJoint> joints;
    for (std::size_t k = steps.size(); k-- > 0;) {
      const Step& step = steps[k];
      WrittenJoint written;
      written.kind = step.kind;
      written.pos = back.p;
      written.axis = sign * back.R.col(step.axis);
      const bool scalar = step.kind == JointKind::kHinge || step.kind == JointKind::kSlide;
      if (scalar) written.position = node.q + std::max(0, step.coordinate);
      if (step.coordinate < 0) written.scale = joint.constants.lead_m / (2 * 3.14159265358979323846);
      const double angle = scalar ? system_.drawn_q[node.q + std::max(0, step.coordinate)] : 0;
      written.ref = written.scale * angle;
      written.name = joint.name;
      if (steps.size() > 1) {
        written.name += step.coordinate < 0 ? "_displacement" : suffix_of(joint, step.coordinate);
        written.name = unused(written.name, joint_names_);
      }
      if (joint.limits && step.coordinate == 0) written.limits = joint.limits;
      back = back * motion_of(step, -sign * written.ref);
      sources_[written.name] = {tree_node.joint, step.coordinate};
      joints.push_back(std::move(written));
    }
    std::reverse(joints.begin(), joints.end());
    body.joints = std::move(joints);
    if (joint.type == JointType::kScrew) {
      const auto& own = body.joints;
      const bool turns_first = own[0].kind == JointKind::kHinge;
      out_.screws.push_back({tree_node.joint, own[turns_first ? 0 : 1].name, own[turns_first ? 1 : 0].name});
    }
  }

  /// The name, or where another thing has it, the name with a number.
  static std::string unused(const std::string& name, std::set<std::string>& taken) {
    std::string free = name;
    for (int i = 2; !taken.insert(free).second; ++i) free = fmt::format("{}_{}", name, i);
    return free;
  }

  static std::string suffix_of(const Joint& joint, int coordinate) {
    return "_" + std::string(joint_type_info(joint.type).coordinates[static_cast<std::size_t>(coordinate)].name);
  }

  bool is_only_between_joints(const WrittenBody& body, int children) const {
    const Body& own = model_.body(body.body);
    const bool scalar = std::all_of(body.joints.begin(), body.joints.end(),
                                    [](const WrittenJoint& joint) { return joint.kind != JointKind::kFree; });
    return children == 1 && scalar && !body.joints.empty() && own.has_mass && own.mass_kg == 0 &&
           own.inertia_kgm2.isZero(0) && users_[static_cast<std::size_t>(body.body.index())] == 2;
  }

  /// From the last body to the first, so that chains of massless bodies go into one.
  void dissolve() {
    std::vector<int> children(out_.bodies.size(), 0), only(out_.bodies.size(), -1);
    for (std::size_t i = 1; i < out_.bodies.size(); ++i) {
      const auto parent = static_cast<std::size_t>(out_.bodies[i].parent);
      ++children[parent];
      only[parent] = static_cast<int>(i);
    }
    std::vector<bool> gone(out_.bodies.size(), false);
    for (std::size_t i = out_.bodies.size() - 1; i >= 1; --i) {
      WrittenBody& body = out_.bodies[i];
      if (!is_only_between_joints(body, children[i])) continue;
      WrittenBody& child = out_.bodies[static_cast<std::size_t>(only[i])];
      if (child.joints.empty() || child.joints[0].kind == JointKind::kFree) continue;
      const Pose X_CB = child.X_PB.inverse();
      for (WrittenJoint& joint : body.joints) {
        joint.pos = X_CB * joint.pos;
        joint.axis = X_CB.R * joint.axis;
      }
      child.joints.insert(child.joints.begin(), body.joints.begin(), body.joints.end());
      child.X_PB = body.X_PB * child.X_PB;
      child.parent = body.parent;
      gone[i] = true;
      only[static_cast<std::size_t>(body.parent)] = only[i];
    }
    keep_the_others(gone);
  }

  void keep_the_others(const std::vector<bool>& gone) {
    std::vector<int> moved(out_.bodies.size(), 0);
    std::vector<WrittenBody> kept;
    for (std::size_t i = 0; i < out_.bodies.size(); ++i) {
      moved[i] = static_cast<int>(kept.size());
      if (gone[i]) continue;
      WrittenBody& body = out_.bodies[i];
      body.parent = moved[static_cast<std::size_t>(body.parent)];
      if (i > 0) out_.index.emplace(body.body, moved[i]);
      kept.push_back(std::move(body));
    }
    out_.bodies = std::move(kept);
  }

  void index_coordinates() {
    for (std::size_t b = 0; b < out_.bodies.size(); ++b) {
      for (std::size_t j = 0; j < out_.bodies[b].joints.size(); ++j) {
        WrittenJoint& joint = out_.bodies[b].joints[j];
        const int velocities = joint.kind == JointKind::kFree ? 6 : joint.kind == JointKind::kBall ? 3 : 1;
        joint.damping.assign(static_cast<std::size_t>(velocities), 0);
        joint.armature = joint.damping;
        const auto source = sources_.find(joint.name);
        if (source == sources_.end() || source->second.second < 0) continue;
        for (int k = 0; k < velocities; ++k) {
          out_.coordinates[{source->second.first, source->second.second + k}] = {static_cast<int>(b),
                                                                                 static_cast<int>(j), k};
        }
      }
    }
  }

  const System& system_;
  const Model& model_;
  PositionKinematics pos_;
  std::vector<int> users_;            ///< Per body: joints, and 3 for every other thing.
  std::vector<int> written_of_node_;  ///< Before dissolving.
  std::set<std::string> body_names_, joint_names_;
  std::map<std::string, std::pair<JointId, int>> sources_;
  WrittenTree out_;
};

}  // namespace

WrittenTree make_written_tree(const System& system) { return TreeWriter(system).write(); }

}  // namespace ferrers::mjcf
