#include "ferrers/formats/urdf_writer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "ferrers/formats/name_map.h"
#include "ferrers/kinematics/assembly.h"
#include "ferrers/kinematics/constraint_blocks.h"
#include "ferrers/model/joints/joint_type.h"

namespace ferrers {
namespace {

using Eigen::Vector3d;

/// One `<joint>` of the file, and what hangs on it.
struct WrittenJoint {
  std::string name, type;  ///< Type as URDF calls it.
  std::string parent, child;
  Pose origin;
  Vector3d axis = Vector3d::UnitX();
  std::string limit, dynamics, mimic;  ///< Elements, empty where there are none.
};

struct WrittenLink {
  std::string name;
  const Body* body = nullptr;  ///< Null: weighs nothing.
  Pose X_BL;                   ///< The link's frame on the body.
};

std::string number_text(double value) { return fmt::format("{}", value == 0 ? 0.0 : value); }

std::string vector_text(const Vector3d& v) {
  return fmt::format("{} {} {}", number_text(v.x()), number_text(v.y()), number_text(v.z()));
}

/// Roll, pitch, yaw about fixed axes, in this order.
Vector3d roll_pitch_yaw(const Eigen::Matrix3d& R) {
  const double pitch = std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0)));
  if (std::hypot(R(0, 0), R(1, 0)) < 1e-9) {  // roll and yaw are one rotation: all of it is roll
    const double roll = std::atan2(-R(1, 2), R(1, 1));
    return {roll, pitch, 0};
  }
  return {std::atan2(R(2, 1), R(2, 2)), pitch, std::atan2(R(1, 0), R(0, 0))};
}

std::string origin_text(const Pose& pose) {
  return fmt::format("<origin xyz=\"{}\" rpy=\"{}\"/>", vector_text(pose.p), vector_text(roll_pitch_yaw(pose.R)));
}

std::string in_quotes(std::string_view name) { return fmt::format("'{}'", name); }

bool has_one_coordinate(JointType type) { return type == JointType::kRevolute || type == JointType::kPrismatic; }

/// Lays out links and joints, then writes them.
class UrdfWriter {
 public:
  UrdfWriter(const Model& model, std::span<const VisualShape> visuals, Diagnostics& diagnostics)
      : model_(model), visuals_(visuals), diagnostics_(diagnostics) {}

  UrdfText write() {
    take_names();
    lay_out_tree();
    for (std::size_t i = 0; i < model_.coordinates_begin(); ++i) {
      if (!in_tree_[i]) close_loop(model_.joints()[i]);
    }
    tell_another_start();
    add_damping();
    add_mimics();
    tell_what_is_left_out();
    return {urdf_text(), closures_text()};
  }

 private:
  void take_names() {
    links_.push_back({names_.add("links", "link", "world"), nullptr, {}});
    link_of_body_.assign(model_.bodies().size(), -1);
    link_of_body_[0] = 0;
    for (std::size_t i = 1; i < model_.bodies().size(); ++i) {
      body_names_.push_back(names_.add("links", "link", model_.bodies()[i].name));
    }
    for (const Joint& joint : model_.joints()) joint_names_[joint.name] = names_.add("joints", "joint", joint.name);
    in_tree_.assign(model_.joints().size(), false);
  }

  /// A URDF starts with all joints at zero, and loops that are open there may close in another way.
  void tell_another_start() {
    const auto system = make_system(std::make_shared<const Model>(model_));
    const auto& nodes = system->topology->forest.nodes;
    bool zero = true;
    for (std::size_t i = 1; i < nodes.size(); ++i) {
      if (!nodes[i].joint.valid()) continue;
      const auto coordinates = joint_type_info(model_.joint(nodes[i].joint).type).coordinates;
      for (std::size_t k = 0; k < coordinates.size(); ++k) {
        const double drawn = system->drawn_q[system->nodes[i].q + static_cast<int>(k)];
        zero = zero && (!coordinates[k].is_scalar() || std::abs(drawn) < 1e-9);
      }
    }
    const ConstraintBlocks blocks = compute_constraint_blocks(*system, make_drawn_state(*system));
    const bool closed = system->cuts.empty() || blocks.phi.cwiseProduct(system->scaling.rows).cwiseAbs().maxCoeff() <
                                                    closed_tolerance(system->scaling);
    if (!zero) {
      lost("joints start at zero, not where the model is drawn: with loops it may be put together in another way");
    } else if (!closed) {
      lost("loops are open at the start as in the model, but may be closed in another way");
    }
  }

  static bool can_carry(JointType type) {
    switch (type) {
      case JointType::kWeld:
      case JointType::kRevolute:
      case JointType::kPrismatic:
      case JointType::kPlanar:
      case JointType::kFree:
      case JointType::kCylindrical:
      case JointType::kUniversal:
      case JointType::kSpherical:
        return true;
      default:
        return false;
    }
  }

  /// Outwards from ground, in the order of the joints; what no joint reaches floats.
  void lay_out_tree() {
    std::vector<std::vector<int>> joints_of(model_.bodies().size());
    for (std::size_t i = 0; i < model_.coordinates_begin(); ++i) {
      const Joint& joint = model_.joints()[i];
      if (!can_carry(joint.type)) continue;
      joints_of[index(joint.first)].push_back(static_cast<int>(i));
      joints_of[index(joint.second)].push_back(static_cast<int>(i));
    }
    std::vector<std::size_t> order = {0};
    for (std::size_t start = 1, next = 0; start <= model_.bodies().size(); ++start) {
      for (; next < order.size(); ++next) {
        for (const int joint : joints_of[order[next]]) carry_next(static_cast<std::size_t>(joint), order[next], order);
      }
      if (start == model_.bodies().size() || link_of_body_[start] >= 0) continue;
      float_body(start);
      order.push_back(start);
    }
  }

  static std::size_t index(BodyId id) { return static_cast<std::size_t>(id.index()); }

  void carry_next(std::size_t position, std::size_t from, std::vector<std::size_t>& order) {
    const Joint& joint = model_.joints()[position];
    const bool forward = index(joint.first) == from;
    const std::size_t to = forward ? index(joint.second) : index(joint.first);
    if (in_tree_[position] || link_of_body_[to] >= 0) return;
    in_tree_[position] = true;
    Carried carried{joint, forward ? joint.X_1F : joint.X_2M, forward ? joint.X_2M : joint.X_1F, forward ? 1.0 : -1.0};
    carry(carried, link_of_body_[from], to);
    order.push_back(to);
    if (!forward && (joint.type == JointType::kPlanar || joint.type == JointType::kFree ||
                     joint.type == JointType::kUniversal || joint.type == JointType::kSpherical)) {
      told("'{}' goes from its second body to its first in the file, so its coordinates are others", joint.name);
    }
  }

  struct Carried {
    const Joint& joint;
    Pose X_PF, X_CM;  ///< On the carrying and on the carried body.
    double sense;     ///< −1: the carried body is the joint's first.
  };

  int add_body_link(std::size_t body, const Vector3d& origin) {
    links_.push_back({body_names_[body - 1], &model_.bodies()[body], {Eigen::Matrix3d::Identity(), origin}});
    link_of_body_[body] = static_cast<int>(links_.size()) - 1;
    return link_of_body_[body];
  }

  int add_massless_link(const std::string& name, const Pose& X_BL = {}) {
    links_.push_back({names_.add("links", "link", name), nullptr, X_BL});
    return static_cast<int>(links_.size()) - 1;
  }

  const WrittenLink& link(int index) const { return links_[static_cast<std::size_t>(index)]; }

  /// The joint's frame on a body, seen from the body's link.
  Pose on_link(int link_index, const Pose& X_BF) const { return link(link_index).X_BL.inverse() * X_BF; }

  WrittenJoint& add_joint(const std::string& name, std::string_view type, int parent, int child, const Pose& origin) {
    WrittenJoint joint;
    joint.name = name;
    joint.type = type;
    joint.parent = link(parent).name;
    joint.child = link(child).name;
    joint.origin = origin;
    joints_.push_back(std::move(joint));
    return joints_.back();
  }

  void carry(const Carried& carried, int parent, std::size_t body) {
    const int child = add_body_link(body, carried.X_CM.p);
    const Pose X_LM = on_link(child, carried.X_CM);
    const Pose X_PF = on_link(parent, carried.X_PF);
    write_joint(carried, parent, child, X_PF, X_LM);
  }

  /// X_PF and X_LM: the joint's frames on the parent link and on the child link, the latter without an offset.
  void write_joint(const Carried& carried, int parent, int child, const Pose& X_PF, const Pose& X_LM) {
    const Joint& joint = carried.joint;
    const std::string& name = joint_names_.at(joint.name);
    const Pose origin = X_PF * X_LM.inverse();
    const Vector3d axis = carried.sense * X_LM.R.col(2);
    switch (joint.type) {
      case JointType::kWeld:
        add_joint(name, "fixed", parent, child, origin);
        break;
      case JointType::kFree:
        add_joint(name, "floating", parent, child, origin);
        break;
      case JointType::kPlanar:
        add_joint(name, "planar", parent, child, origin).axis = axis;
        break;
      case JointType::kRevolute:
      case JointType::kPrismatic:
        add_one_coordinate_joint(joint, parent, child, origin, axis);
        break;
      default:
        add_row(carried, parent, child, X_PF, X_LM);
    }
  }

  void add_one_coordinate_joint(const Joint& joint, int parent, int child, const Pose& origin, const Vector3d& axis) {
    const bool turns = joint.type == JointType::kRevolute;
    const std::string_view type = !turns ? "prismatic" : joint.limits ? "revolute" : "continuous";
    WrittenJoint& written = add_joint(joint_names_.at(joint.name), type, parent, child, origin);
    written.axis = axis;
    written_index_[joint.name] = joints_.size() - 1;
    if (joint.limits) {
      written.limit = fmt::format(R"(<limit lower="{}" upper="{}" effort="1e9" velocity="1e9"/>)", (*joint.limits)[0],
                                  (*joint.limits)[1]);
    } else if (!turns) {
      written.limit = R"(<limit effort="1e9" velocity="1e9"/>)";
    }
  }

  /// A joint of several coordinates as joints of one each, with links between that weigh nothing.
  void add_row(const Carried& carried, int parent, int child, const Pose& X_PF, const Pose& X_LM) {
    const Joint& joint = carried.joint;
    struct Step {
      std::string_view type;
      Vector3d axis;  ///< In the joint's frame.
    };
    std::vector<Step> steps;
    if (joint.type == JointType::kCylindrical) {
      steps = {{"continuous", Vector3d::UnitZ()}, {"prismatic", Vector3d::UnitZ()}};
    } else if (joint.type == JointType::kUniversal) {
      steps = {{"continuous", Vector3d::UnitZ()}, {"continuous", Vector3d::UnitX()}};
      if (carried.sense < 0) std::swap(steps[0], steps[1]);
    } else {
      steps = {{"continuous", Vector3d::UnitX()}, {"continuous", Vector3d::UnitY()}, {"continuous", Vector3d::UnitZ()}};
    }
    told("'{}' is written as {} joints in a row", joint.name, steps.size());
    int from = parent;
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const std::string name = names_.add("joints", "joint", fmt::format("{}_{}", joint.name, i + 1));
      const bool last = i + 1 == steps.size();
      const int to = last ? child : add_massless_link(fmt::format("{}_{}", joint.name, i + 1));
      const Pose start = i == 0 ? X_PF : Pose();
      const Pose end = last ? X_LM.inverse() : Pose();
      WrittenJoint& written = add_joint(name, steps[i].type, from, to, start * end);
      written.axis = carried.sense * (end.R.transpose() * steps[i].axis);
      if (steps[i].type == "prismatic") written.limit = R"(<limit effort="1e9" velocity="1e9"/>)";
      from = to;
    }
  }

  void float_body(std::size_t body) {
    const int child = add_body_link(body, Vector3d::Zero());
    const std::string name = names_.add("joints", "joint", model_.bodies()[body].name + "_free");
    add_joint(name, "floating", 0, child, model_.bodies()[body].X_WB);
  }

  /// A link fixed to a body's link, whose frame is the joint's there.
  int add_marker(const std::string& name, BodyId body, const Pose& X_BF) {
    const int parent = link_of_body_[index(body)];
    const int marker = add_massless_link(name);
    add_joint(names_.add("joints", "joint", name + "_frame"), "fixed", parent, marker, on_link(parent, X_BF));
    return marker;
  }

  /// Files of closures name links and joints alike: the name is neither's.
  std::string marker_name(const std::string& name) const {
    std::string free = name;
    for (int i = 2; model_.find_joint(free) || model_.find_body(free); ++i) free = fmt::format("{}_{}", name, i);
    return free;
  }

  void close_loop(const Joint& joint) {
    if (!can_carry(joint.type)) {
      lost("the {} joint '{}' is left out", joint_type_info(joint.type).name, joint.name);
      return;
    }
    if (joint.type == JointType::kFree) return;  // holds nothing
    const int second = add_marker(marker_name(joint.name + "_B"), joint.second, joint.X_2M);
    int first = 0;
    if (joint.type == JointType::kWeld || joint.type == JointType::kSpherical) {
      first = add_marker(marker_name(joint.name + "_A"), joint.first, joint.X_1F);
    } else {
      first = add_massless_link(marker_name(joint.name + "_A"));
      const int parent = link_of_body_[index(joint.first)];
      write_joint({joint, joint.X_1F, {}, 1}, parent, first, on_link(parent, joint.X_1F), {});
    }
    loops_.push_back(fmt::format("[{}, {}]", in_quotes(link(first).name), in_quotes(link(second).name)));
    loop_types_.push_back(joint.type == JointType::kSpherical ? "'3d'" : "'6d'");
  }

  WrittenJoint* written(JointId id) {
    const Joint& joint = model_.joint(id);
    const auto found = written_index_.find(joint.name);
    return found == written_index_.end() ? nullptr : &joints_[found->second];
  }

  void add_damping() {
    std::map<int, double> damping;
    for (const ForceElement& force : model_.forces()) {
      const auto* one = std::get_if<JointDamping>(&force.element);
      if (one == nullptr || written(one->coordinate.joint) == nullptr) {
        lost("the force element '{}' is left out", force.name);
      } else {
        damping[one->coordinate.joint.index()] += one->damping;
      }
    }
    for (std::size_t i = 0; i < model_.coordinates_begin(); ++i) {
      const Joint& joint = model_.joints()[i];
      if (joint.stiffness || joint.misalignment) lost("stiffness and misalignment of '{}' are left out", joint.name);
      if (!joint.friction) continue;
      if (has_one_coordinate(joint.type)) damping[static_cast<int>(i)] += joint.friction->viscous;
      if (joint.friction->viscous > 0 && !has_one_coordinate(joint.type)) {
        lost("viscous friction in '{}' is left out", joint.name);
      }
      if (joint.friction->coulomb > 0) lost("Coulomb friction in '{}' is left out", joint.name);
    }
    for (const auto& [joint, c] : damping) {
      if (WrittenJoint* one = written(JointId(joint))) {
        one->dynamics = fmt::format(R"(<dynamics damping="{}"/>)", number_text(c));
      }
    }
  }

  /// q_0 = multiplier q_1 + offset, where a coupling or formula says that.
  struct Mimic {
    double multiplier = 0, offset = 0;
  };

  static std::optional<Mimic> mimic(const Coupling& coupling) {
    if (coupling.scalars.size() != 2 || coupling.scalars[0].is_point() || coupling.scalars[1].is_point()) return {};
    std::array<std::optional<double>, 3> c;
    if (!coupling.relation) {
      c = {coupling.coefficients[0], coupling.coefficients[1], 0.0};
    } else if (!coupling.relation->on_velocities && !coupling.relation->system && !coupling.relation->knows_time) {
      c[0] = coupling.relation->gradient[0].constant_value();
      c[1] = coupling.relation->gradient[1].constant_value();
      c[2] = coupling.relation->residual.substitute([](std::string_view) { return Expression::constant(0); })
                 .simplified()
                 .constant_value();
    }
    if (!c[0] || !c[1] || !c[2] || *c[0] == 0) return {};
    return Mimic{-*c[1] / *c[0], -*c[2] / *c[0]};
  }

  void add_mimics() {
    for (const Coupling& coupling : model_.couplings()) {
      const std::optional<Mimic> found = mimic(coupling);
      WrittenJoint* first = found ? written(coupling.scalars[0].coordinate.joint) : nullptr;
      const WrittenJoint* second = found ? written(coupling.scalars[1].coordinate.joint) : nullptr;
      if (first == nullptr || second == nullptr || !first->mimic.empty()) {
        lost("the coupling or constraint '{}' is left out", coupling.name);
        continue;
      }
      first->mimic = fmt::format(R"(<mimic joint="{}" multiplier="{}" offset="{}"/>)", second->name,
                                 number_text(found->multiplier), number_text(found->offset));
    }
  }

  template <class... Arguments>
  void told(fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    diagnostics_.notice("F607", {}, "URDF: " + fmt::format(text, std::forward<Arguments>(arguments)...));
  }

  /// Of what makes the written mechanism another one.
  template <class... Arguments>
  void lost(fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    diagnostics_.warning("F607", {}, "URDF: " + fmt::format(text, std::forward<Arguments>(arguments)...));
  }

  void tell_what_is_left_out() {
    const auto count = [&](std::string_view what, std::size_t n) {
      if (n > 0) told("{} left out: {}", what, n);
    };
    if (model_.gravity() != Vector3d(0, 0, -9.81)) lost("gravity is left out; readers take their own");
    count("initial values", model_.initial().size());
    count("records", model_.records().size() + model_.recorded_formulas().size());
    count("events", model_.events().size());
    count("parameters, whose values stand in their places,", model_.parameters().size());
    if (model_.spec().lagrangian.given()) lost("energies and coordinates of 'lagrangian' are left out");
  }

  std::string inertial_text(const WrittenLink& link) const {
    if (link.body == nullptr || !link.body->has_mass) return {};
    const Body& body = *link.body;
    if (body.mass_kg == 0 && body.inertia_kgm2.norm() == 0) return {};
    const Eigen::Matrix3d& I = body.inertia_kgm2;
    return fmt::format(
        "    <inertial>\n      {}\n      <mass value=\"{}\"/>\n"
        "      <inertia ixx=\"{}\" ixy=\"{}\" ixz=\"{}\" iyy=\"{}\" iyz=\"{}\" izz=\"{}\"/>\n    </inertial>\n",
        origin_text({Eigen::Matrix3d::Identity(), body.com_m - link.X_BL.p}), number_text(body.mass_kg),
        number_text(I(0, 0)), number_text(I(0, 1)), number_text(I(0, 2)), number_text(I(1, 1)), number_text(I(1, 2)),
        number_text(I(2, 2)));
  }

  static std::string shape_text(const VisualShape& shape) {
    using Kind = VisualShape::Kind;
    const auto& s = shape.size;
    switch (shape.kind) {
      case Kind::kBox:
        return fmt::format(R"(<box size="{} {} {}"/>)", s[0], s[1], s[2]);
      case Kind::kSphere:
        return fmt::format(R"(<sphere radius="{}"/>)", s[0]);
      case Kind::kCylinder:
      case Kind::kCapsule:
        return fmt::format(R"(<{} radius="{}" length="{}"/>)", shape.kind == Kind::kCapsule ? "capsule" : "cylinder",
                           s[0], s[1]);
      case Kind::kMesh:
        return fmt::format(R"(<mesh filename="{}" scale="{} {} {}"/>)", escaped(shape.mesh), s[0], s[1], s[2]);
      case Kind::kEllipsoid:
        break;
    }
    return {};
  }

  static std::string escaped(std::string_view text) {
    std::string result;
    for (const char c : text) {
      switch (c) {
        case '&':
          result += "&amp;";
          break;
        case '<':
          result += "&lt;";
          break;
        case '"':
          result += "&quot;";
          break;
        default:
          result += c;
      }
    }
    return result;
  }

  std::string visuals_text(const WrittenLink& link) const {
    std::string text;
    const bool is_ground = &link == &links_.front();
    if (link.body == nullptr && !is_ground) return text;
    const std::string_view body = is_ground ? std::string_view("ground") : std::string_view(link.body->name);
    for (const VisualShape& shape : visuals_) {
      const std::string geometry = shape_text(shape);
      if (shape.body != body || geometry.empty()) continue;
      text += fmt::format("    <visual>\n      {}\n      <geometry>{}</geometry>\n",
                          origin_text(link.X_BL.inverse() * shape.X_BS), geometry);
      if (shape.rgba) {
        const auto& c = *shape.rgba;
        text +=
            fmt::format("      <material name=\"\"><color rgba=\"{} {} {} {}\"/></material>\n", c[0], c[1], c[2], c[3]);
      }
      text += "    </visual>\n";
    }
    return text;
  }

  std::string drives_text() {
    std::string text;
    for (const Drive& drive : model_.drives()) {
      const WrittenJoint* joint = drive.kind == Drive::Kind::kCoordinate ? written(drive.coordinate.joint) : nullptr;
      if (joint == nullptr) {
        told("the drive '{}' is left out", drive.name);
        continue;
      }
      if (!drive.motion.empty() || !drive.effort.empty()) told("the laws of the drive '{}' are left out", drive.name);
      text += fmt::format(
          "  <transmission name=\"{0}\">\n    <type>transmission_interface/SimpleTransmission</type>\n"
          "    <joint name=\"{1}\"/>\n    <actuator name=\"{0}\"/>\n  </transmission>\n",
          drive.name, joint->name);
    }
    return text;
  }

  std::string urdf_text() {
    std::string text = fmt::format("<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n", escaped(model_.name()));
    for (const WrittenLink& one : links_) {
      const std::string contents = inertial_text(one) + visuals_text(one);
      text += contents.empty() ? fmt::format("  <link name=\"{}\"/>\n", one.name)
                               : fmt::format("  <link name=\"{}\">\n{}  </link>\n", one.name, contents);
    }
    for (const WrittenJoint& one : joints_) {
      text += fmt::format(
          "  <joint name=\"{}\" type=\"{}\">\n    {}\n    <parent link=\"{}\"/>\n    <child link=\"{}\"/>\n", one.name,
          one.type, origin_text(one.origin), one.parent, one.child);
      if (one.type != "fixed" && one.type != "floating") {
        text += fmt::format("    <axis xyz=\"{}\"/>\n", vector_text(one.axis));
      }
      for (const std::string* part : {&one.limit, &one.dynamics, &one.mimic}) {
        if (!part->empty()) text += fmt::format("    {}\n", *part);
      }
      text += "  </joint>\n";
    }
    return text + drives_text() + "</robot>\n";
  }

  std::string closures_text() const {
    if (loops_.empty()) return {};
    return fmt::format("closed_loop: [{}]\ntype: [{}]\n", fmt::join(loops_, ", "), fmt::join(loop_types_, ", "));
  }

  const Model& model_;
  std::span<const VisualShape> visuals_;
  Diagnostics& diagnostics_;
  NameMap names_;
  std::vector<std::string> body_names_;  ///< Without ground.
  std::map<std::string, std::string> joint_names_;
  std::map<std::string, std::size_t> written_index_;  ///< Joints of one coordinate.
  std::vector<WrittenLink> links_;
  std::vector<WrittenJoint> joints_;
  std::vector<int> link_of_body_;
  std::vector<bool> in_tree_;
  std::vector<std::string> loops_, loop_types_;
};

}  // namespace

UrdfText write_urdf(const Model& model, std::span<const VisualShape> visuals, Diagnostics& diagnostics) {
  return UrdfWriter(model, visuals, diagnostics).write();
}

}  // namespace ferrers
