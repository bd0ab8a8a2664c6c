#include "ferrers/formats/mjcf_writer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <set>

#include "ferrers/formats/mjcf_written_tree.h"
#include "ferrers/kinematics/assembly.h"
#include "ferrers/model/mass_properties.h"

namespace ferrers {
namespace mjcf {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kDeepestIndent = 50;
constexpr double kLeast = 1e-14;  // kg, kg·m²: ten times what MuJoCo takes for nothing

std::string text_of(const Vector3d& v) { return fmt::format("{} {} {}", v.x(), v.y(), v.z()); }

std::string text_of(const Eigen::Quaterniond& q) { return fmt::format("{} {} {} {}", q.w(), q.x(), q.y(), q.z()); }

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

/// ` pos="..." quat="..."`, each where it says something.
std::string place_of(const Pose& X) {
  std::string out;
  if (!X.p.isZero(0)) out += fmt::format(" pos=\"{}\"", text_of(X.p));
  if (X.R.isIdentity(0)) return out;
  return out + fmt::format(" quat=\"{}\"", text_of(Eigen::Quaterniond(X.R).normalized()));
}

constexpr std::string_view kJointKinds[] = {"hinge", "slide", "ball", "free"};

class MjcfWriter {
 public:
  MjcfWriter(const System& system, const ModelSpec& spec, Diagnostics& diagnostics)
      : system_(system),
        model_(*system.model),
        spec_(spec),
        diagnostics_(diagnostics),
        tree_(make_written_tree(system)) {
    sites_.resize(tree_.bodies.size());
  }

  std::string write() {
    add_forces();
    add_rotors();
    for (const JointId id : system_.topology->forest.cut_joints) add_closure(model_.joint(id));
    for (const WrittenTree::Screw& screw : tree_.screws) add_screw(screw);
    for (std::size_t i = 0; i < model_.couplings().size(); ++i) add_coupling(model_.couplings()[i]);
    for (const Drive& drive : model_.drives()) add_drive(drive);
    tell_of_the_rest();
    return fmt::format(
        "<mujoco model=\"{}\">\n  <compiler angle=\"radian\" autolimits=\"true\"{}/>\n"
        "  <option gravity=\"{}\"/>\n{}{}{}{}{}</mujoco>\n",
        escaped(model_.name()), bounds(), text_of(model_.gravity()), bodies(), section("tendon", tendons_),
        section("equality", equalities_), section("actuator", actuators_), section("keyframe", keyframe()));
  }

 private:
  void warn(const std::string& message) { diagnostics_.warning("F607", {}, "MJCF " + message); }
  void notice(const std::string& message) { diagnostics_.notice("F607", {}, "MJCF " + message); }

  static std::string section(std::string_view name, const std::string& lines) {
    return lines.empty() ? "" : fmt::format("  <{0}>\n{1}  </{0}>\n", name, lines);
  }

  const WrittenTree::Place* place_of(JointCoordinate coordinate) const {
    const auto found = tree_.coordinates.find(coordinate);
    return found == tree_.coordinates.end() ? nullptr : &found->second;
  }
  WrittenJoint& joint_at(const WrittenTree::Place& place) {
    return tree_.bodies[static_cast<std::size_t>(place.body)].joints[static_cast<std::size_t>(place.joint)];
  }
  /// The hinge or slide of a coordinate, or null.
  WrittenJoint* scalar_joint(const StateScalar& scalar) {
    const auto* place = scalar.is_point() ? nullptr : place_of(scalar.coordinate);
    if (place == nullptr) return nullptr;
    WrittenJoint& joint = joint_at(*place);
    return joint.kind == JointKind::kHinge || joint.kind == JointKind::kSlide ? &joint : nullptr;
  }

  /// By body; the last is written first.
  std::vector<std::vector<int>> children_of_all() const {
    std::vector<std::vector<int>> children(tree_.bodies.size());
    for (std::size_t i = tree_.bodies.size(); i-- > 1;) {
      children[static_cast<std::size_t>(tree_.bodies[i].parent)].push_back(static_cast<int>(i));
    }
    return children;
  }

  /// The start as a key, where it is not where the model is drawn; nothing where it cannot be said.
  std::string keyframe() const {
    const AssemblyResult start = assemble(system_);
    if (start.status != AssemblyStatus::kAssembled) return "";
    PositionKinematics pos = make_position_kinematics(system_);
    compute_positions(system_, start.state.q, pos);
    const std::vector<std::vector<int>> children = children_of_all();
    std::vector<double> all;
    double moved = 0;
    const auto add = [&](double value, double drawn) {
      all.push_back(value);
      moved = std::max(moved, std::abs(value - drawn));
    };
    const auto add_turn = [&](const Matrix3d& R, const Matrix3d& drawn) {
      const Eigen::Quaterniond q(R);
      all.insert(all.end(), {q.w(), q.x(), q.y(), q.z()});
      moved = std::max(moved, (R - drawn).cwiseAbs().maxCoeff());
    };
    const auto pose = [&](const WrittenBody& body) {
      return body.body.valid() ? body_pose(system_, pos, body.body) : Pose();
    };
    std::vector<int> way = children[0];
    while (!way.empty()) {
      const auto index = static_cast<std::size_t>(way.back());
      const WrittenBody& body = tree_.bodies[index];
      way.pop_back();
      for (const WrittenJoint& joint : body.joints) {
        if (joint.position >= 0) {
          add(joint.scale * start.state.q[joint.position], joint.ref);
        } else if (body.joints.size() > 1) {
          return "";
        } else {
          const Pose X_PB = pose(tree_.bodies[static_cast<std::size_t>(body.parent)]).inverse() * pose(body);
          const bool free = joint.kind == JointKind::kFree;
          for (int i = 0; free && i < 3; ++i) add(X_PB.p[i], body.X_PB.p[i]);
          if (free) {
            add_turn(X_PB.R, body.X_PB.R);
          } else {
            add_turn(body.X_PB.R.transpose() * X_PB.R, Matrix3d::Identity());
          }
        }
      }
      way.insert(way.end(), children[index].begin(), children[index].end());
    }
    if (moved < 1e-9) return "";
    return fmt::format("    <key name=\"start\" qpos=\"{}\"/>\n", fmt::join(all, " "));
  }

  /// Nested bodies, without recursion: mechanisms can be deep.
  std::string bodies() const {
    const std::vector<std::vector<int>> children = children_of_all();
    std::string out = "  <worldbody>\n";
    for (const std::string& site : sites_[0]) out += "    " + site + "\n";
    std::vector<std::pair<int, int>> stack;  // body (its end: −1 − body), depth
    for (const int child : children[0]) stack.emplace_back(child, 2);
    while (!stack.empty()) {
      const auto [index, depth] = stack.back();
      stack.pop_back();
      const std::string indent(2 * static_cast<std::size_t>(std::min(depth, kDeepestIndent)), ' ');
      if (index < 0) {
        out += indent + "</body>\n";
        continue;
      }
      append_body(tree_.bodies[static_cast<std::size_t>(index)], indent, out);
      for (const std::string& site : sites_[static_cast<std::size_t>(index)]) {
        out += fmt::format("{}  {}\n", indent, site);
      }
      stack.emplace_back(-1, depth);
      for (const int child : children[static_cast<std::size_t>(index)]) stack.emplace_back(child, depth + 1);
    }
    return out + "  </worldbody>\n";
  }

  void append_body(const WrittenBody& body, const std::string& indent, std::string& out) const {
    out += fmt::format("{}<body name=\"{}\"{}>\n", indent, body.name, mjcf::place_of(body.X_PB));
    const Body& own = model_.body(body.body);
    if (own.has_mass) out += fmt::format("{}  {}\n", indent, inertial_of(own));
    for (const WrittenJoint& joint : body.joints) out += fmt::format("{}  {}\n", indent, joint_text(joint));
  }

  /// By principal moments where MuJoCo would not find them itself: some are zero, or rounding breaks A + B >= C.
  static std::string inertial_of(const Body& body) {
    const Matrix3d& I = body.inertia_kgm2;
    const Eigen::SelfAdjointEigenSolver<Matrix3d> principal(I);
    Vector3d moments = principal.eigenvalues().cwiseMax(0);
    std::string text = fmt::format("<inertial pos=\"{}\" mass=\"{}\" ", text_of(body.com_m), body.mass_kg);
    if (moments[0] > 1e-12 * moments[2] && moments[0] + moments[1] > (1 + 1e-12) * moments[2]) {
      return text +
             fmt::format("fullinertia=\"{} {} {} {} {} {}\"/>", I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
    }
    if (moments[2] < (1 + 1e-6) * (moments[0] + moments[1])) moments[2] = std::min(moments[2], moments[0] + moments[1]);
    Matrix3d axes = principal.eigenvectors();
    if (axes.determinant() < 0) axes.col(0) = -axes.col(0);
    return text + fmt::format("quat=\"{}\" diaginertia=\"{}\"/>", text_of(Eigen::Quaterniond(axes).normalized()),
                              text_of(moments));
  }

  /// MuJoCo refuses what moves without mass or inertia, but raises both where its compiler is asked to.
  std::string bounds() {
    bool light = false;
    for (const WrittenBody& body : tree_.bodies) {
      if (!body.body.valid()) continue;
      const Body& own = model_.body(body.body);
      const Eigen::SelfAdjointEigenSolver<Matrix3d> principal(own.inertia_kgm2, Eigen::EigenvaluesOnly);
      light = light || own.mass_kg < kLeast || principal.eigenvalues()[0] < kLeast;
    }
    if (!light) return "";
    notice(fmt::format("needs a mass and an inertia of all that moves: none is written as less than {}", kLeast));
    return fmt::format(" boundmass=\"{0}\" boundinertia=\"{0}\"", kLeast);
  }

  static std::string joint_text(const WrittenJoint& joint) {
    if (joint.kind == JointKind::kFree && joint.damping[0] == 0 && joint.armature[0] == 0) {
      return fmt::format("<freejoint name=\"{}\"/>", joint.name);
    }
    std::string text =
        fmt::format("<joint name=\"{}\" type=\"{}\"", joint.name, kJointKinds[static_cast<std::size_t>(joint.kind)]);
    if (joint.kind != JointKind::kFree && !joint.pos.isZero(0)) text += fmt::format(" pos=\"{}\"", text_of(joint.pos));
    if (joint.kind == JointKind::kHinge || joint.kind == JointKind::kSlide) {
      text += fmt::format(" axis=\"{}\"", text_of(joint.axis));
    }
    const auto add = [&](std::string_view name, double value) {
      if (value != 0) text += fmt::format(" {}=\"{}\"", name, value);
    };
    add("ref", joint.ref);
    if (joint.limits) text += fmt::format(" range=\"{} {}\"", (*joint.limits)[0], (*joint.limits)[1]);
    add("stiffness", joint.stiffness);
    add("springref", joint.springref);
    add("damping", joint.damping[0]);
    add("armature", joint.armature[0]);
    return text + "/>";
  }

  void add_site(BodyId body, const std::string& name, const Pose& X) {
    const auto index = static_cast<std::size_t>(tree_.index.at(body));
    sites_[index].push_back(fmt::format("<site name=\"{}\"{}/>", name, mjcf::place_of(X)));
  }

  void add_sites(const Joint& joint, const std::string& name, const Pose& shift) {
    add_site(joint.first, name + "_first", joint.X_1F * shift);
    add_site(joint.second, name + "_second", joint.X_2M * shift);
  }

  void add_closure(const Joint& joint) {
    const auto hold = [&](std::string_view kind, const std::string& name) {
      equalities_ += fmt::format("    <{0} name=\"{1}\" site1=\"{1}_first\" site2=\"{1}_second\"/>\n", kind, name);
    };
    if (joint.type == JointType::kFree) return;
    if (joint.type == JointType::kWeld || joint.type == JointType::kSpherical) {
      add_sites(joint, joint.name, Pose());
      return hold(joint.type == JointType::kWeld ? "weld" : "connect", joint.name);
    }
    if (joint.type == JointType::kRevolute) {
      add_sites(joint, joint.name, Pose());
      hold("connect", joint.name);
      const std::string axis = unused_row(joint.name + "_axis");
      add_sites(joint, axis, Pose(Matrix3d::Identity(), lever() * Vector3d::UnitZ()));
      return hold("connect", axis);
    }
    warn(fmt::format("has no constraint for '{}', a {} joint that closes a loop: it is left out", joint.name,
                     joint_type_info(joint.type).name));
  }

  /// How far apart the two points of a revolute closure are.
  double lever() const { return system_.scaling.length_m > 0 ? system_.scaling.length_m : 1; }

  void add_screw(const WrittenTree::Screw& screw) {
    const Joint& joint = model_.joint(screw.joint);
    equalities_ +=
        fmt::format("    <joint name=\"{}\" joint1=\"{}\" joint2=\"{}\" polycoef=\"0 {} 0 0 0\"/>\n",
                    unused_row(joint.name + "_lead"), screw.slide, screw.hinge, joint.constants.lead_m / (2 * kPi));
  }

  /// A name for an equality that no joint or constraint of the model has.
  std::string unused_row(const std::string& name) {
    if (rows_.empty()) {
      for (const Joint& joint : model_.joints()) rows_.insert(joint.name);
      for (const Coupling& coupling : model_.couplings()) rows_.insert(coupling.name);
    }
    std::string free = name;
    for (int i = 2; !rows_.insert(free).second; ++i) free = fmt::format("{}_{}", name, i);
    return free;
  }

  void add_coupling(const Coupling& coupling) {
    std::vector<const WrittenJoint*> joints;
    for (const StateScalar& scalar : coupling.scalars) joints.push_back(scalar_joint(scalar));
    const bool known = std::find(joints.begin(), joints.end(), nullptr) == joints.end();
    if (known && coupling.relation && add_polynomial(coupling, joints)) return;
    if (coupling.relation || !known || joints.empty()) {
      return warn(fmt::format("cannot say the constraint '{}': it is left out", coupling.name));
    }
    double drawn = 0;  // MJCF's relations are between changes from the drawing
    for (std::size_t i = 0; i < joints.size(); ++i) drawn += coupling.coefficients[i] * joints[i]->ref;
    if (joints.size() == 2 && coupling.coefficients[0] != 0) {
      equalities_ += fmt::format("    <joint name=\"{}\" joint1=\"{}\" joint2=\"{}\" polycoef=\"{} {} 0 0 0\"/>\n",
                                 coupling.name, joints[0]->name, joints[1]->name, -drawn / coupling.coefficients[0],
                                 -coupling.coefficients[1] / coupling.coefficients[0]);
      return;
    }
    tendons_ += fmt::format("    <fixed name=\"{}\">\n", coupling.name);
    for (std::size_t i = 0; i < joints.size(); ++i) {
      tendons_ += fmt::format("      <joint joint=\"{}\" coef=\"{}\"/>\n", joints[i]->name, coupling.coefficients[i]);
    }
    tendons_ += "    </fixed>\n";
    equalities_ +=
        fmt::format("    <tendon name=\"{0}\" tendon1=\"{0}\" polycoef=\"{1} 0 0 0 0\"/>\n", coupling.name, -drawn);
  }

  /// A relation c y − p(x) = 0 of one or two joints, p of the fourth degree at most, by its derivatives as drawn.
  bool add_polynomial(const Coupling& coupling, const std::vector<const WrittenJoint*>& joints) {
    const Relation& relation = *coupling.relation;
    if (joints.size() > 2 || relation.on_velocities || relation.knows_time || relation.system) return false;
    for (std::size_t y = 0; y < joints.size(); ++y) {
      const std::optional<double> slope = relation.gradient[y].constant_value();
      if (!slope || *slope == 0) continue;
      const std::size_t x = 1 - y;
      const std::optional<std::array<double, 5>> p =
          polynomial_of(relation, joints, joints.size() == 2 ? std::optional(x) : std::nullopt);
      if (!p) continue;
      std::string other = joints.size() == 2 ? fmt::format(" joint2=\"{}\"", joints[x]->name) : "";
      equalities_ += fmt::format("    <joint name=\"{}\" joint1=\"{}\"{} polycoef=\"{} {} {} {} {}\"/>\n",
                                 coupling.name, joints[y]->name, other, -(*p)[0] / *slope, -(*p)[1] / *slope,
                                 -(*p)[2] / *slope, -(*p)[3] / *slope, -(*p)[4] / *slope);
      return true;
    }
    return false;
  }

  /// Taylor's coefficients of the residual along joint `x`, about the drawing; nothing where there are more than five.
  static std::optional<std::array<double, 5>> polynomial_of(const Relation& relation,
                                                            const std::vector<const WrittenJoint*>& joints,
                                                            std::optional<std::size_t> x) {
    std::vector<double> drawn;
    for (const WrittenJoint* joint : joints) drawn.push_back(joint->ref);
    std::array<double, 5> p = {0, 0, 0, 0, 0};
    Expression derivative = relation.residual;
    double factorial = 1;
    for (std::size_t k = 0; k < p.size(); ++k) {
      p[k] = ExpressionProgram(derivative, relation.values).evaluate(drawn.data()) / factorial;
      if (!std::isfinite(p[k])) return std::nullopt;
      if (!x) return p;
      derivative = derivative.derivative(relation.values[*x]).simplified();
      factorial *= static_cast<double>(k + 1);
    }
    if (derivative.constant_value() != 0.0) return std::nullopt;
    return p;
  }

  void add_drive(const Drive& drive) {
    const WrittenJoint* joint = drive.kind == Drive::Kind::kCoordinate ? scalar_joint({drive.coordinate}) : nullptr;
    if (!drive.acts || joint == nullptr) {
      return notice(fmt::format("is written without the drive '{}', which is not on a hinge or slide", drive.name));
    }
    actuators_ += fmt::format("    <motor name=\"{}\" joint=\"{}\"/>\n", drive.name, joint->name);
    if (!drive.motion.empty() || !drive.effort.empty()) {
      notice(fmt::format("is written without the laws of the drive '{}'", drive.name));
    }
  }

  void add_forces() {
    for (const ForceElement& force : model_.forces()) {
      const auto* damping = std::get_if<JointDamping>(&force.element);
      const auto* spring = std::get_if<TorsionSpring>(&force.element);
      const auto* place = damping != nullptr  ? place_of(damping->coordinate)
                          : spring != nullptr ? place_of(spring->coordinate)
                                              : nullptr;
      if (place == nullptr) {
        warn(fmt::format("cannot say the force '{}': it is left out", force.name));
      } else if (damping != nullptr) {
        joint_at(*place).damping[static_cast<std::size_t>(place->velocity)] += damping->damping;
      } else {
        add_spring(joint_at(*place), *spring);
      }
    }
    for (std::size_t i = 0; i < model_.coordinates_begin(); ++i) add_friction(model_.joints()[i], JointId(i));
    check_equal(&WrittenJoint::damping, "dampings");
  }

  /// Springs of one coordinate add up to one about the mean of their free angles.
  static void add_spring(WrittenJoint& joint, const TorsionSpring& spring) {
    const double sum = joint.stiffness + spring.stiffness;
    if (sum > 0) {
      joint.springref = (joint.stiffness * joint.springref + spring.stiffness * spring.free_angle) / sum;
    }
    joint.stiffness = sum;
    joint.damping[0] += spring.damping;
  }

  void add_friction(const Joint& joint, JointId id) {
    if (!joint.friction) return;
    if (joint.friction->coulomb > 0) warn(fmt::format("is written without the dry friction of '{}'", joint.name));
    const int coordinates = static_cast<int>(joint_type_info(joint.type).coordinates.size());
    for (int k = 0; joint.friction->viscous > 0 && k < coordinates; ++k) {
      if (const auto* place = place_of({id, k})) {
        joint_at(*place).damping[static_cast<std::size_t>(place->velocity)] += joint.friction->viscous;
      } else {
        warn(fmt::format("is written without the viscous friction of '{}'", joint.name));
        break;
      }
    }
  }

  /// Rotor inertias: what energies by formulas add to M at constant, single places.
  void add_rotors() {
    const Lagrangian& lagrangian = model_.lagrangian();
    bool all = !spec_.lagrangian.potential_energy && !spec_.lagrangian.dissipation && spec_.lagrangian.forces.empty() &&
               spec_.lagrangian.coordinates.empty() && !lagrangian.system;
    for (const Lagrangian::MassEntry& entry : lagrangian.mass) {
      const StateScalar& scalar = lagrangian.scalars[static_cast<std::size_t>(entry.row)];
      const std::optional<double> value = entry.value.constant_value();
      const auto* place =
          scalar.is_point() || entry.row != entry.column || !value ? nullptr : place_of(scalar.coordinate);
      if (place != nullptr) joint_at(*place).armature[static_cast<std::size_t>(place->velocity)] += *value;
      all = all && place != nullptr;
    }
    if (!all) warn("cannot say all energies and forces that are given by formulas");
    check_equal(&WrittenJoint::armature, "rotor inertias");
  }

  /// Balls and free joints have one number for all directions.
  void check_equal(std::vector<double> WrittenJoint::*numbers, std::string_view what) {
    for (WrittenBody& body : tree_.bodies) {
      for (WrittenJoint& joint : body.joints) {
        const std::vector<double>& n = joint.*numbers;
        if (std::all_of(n.begin(), n.end(), [&](double x) { return x == n[0]; })) continue;
        warn(
            fmt::format("has one number for the {} of '{}' in all directions: the first is written", what, joint.name));
      }
    }
  }

  void tell_of_the_rest() {
    if (system_.topology->general_coordinates > 0) warn("has no generalized coordinates: they are left out");
    for (const Body& body : model_.bodies()) {
      if (check_inertia(body.inertia_kgm2) != InertiaVerdict::kTriangle) continue;
      warn(
          fmt::format("readers refuse the inertia of '{}', of which one principal moment exceeds the sum of the others",
                      body.name));
    }
    const auto left_out = [&](bool present, std::string_view what) {
      if (present) notice(fmt::format("is written without {}", what));
    };
    left_out(std::any_of(model_.initial().begin(), model_.initial().end(),
                         [](const InitialValue& one) { return !one.velocity.empty(); }),
             "initial velocities");
    left_out(!model_.parameters().empty(), "parameters: formulas are written as their numbers");
    left_out(!model_.records().empty() || !model_.recorded_formulas().empty(), "recorded points and formulas");
    left_out(!model_.events().empty(), "events");
    const auto has_stiffness = [](const Joint& joint) { return joint.stiffness || joint.misalignment; };
    left_out(std::any_of(model_.joints().begin(), model_.joints().end(), has_stiffness),
             "stiffnesses and misalignments of joints");
    for (const WrittenBody& body : tree_.bodies) {
      const Body& own = model_.body(body.body.valid() ? body.body : kGround);
      if (!body.body.valid() || own.has_mass) continue;
      notice(fmt::format("takes the body '{}' without a mass for massless", own.name));
    }
  }

  const System& system_;
  const Model& model_;
  const ModelSpec& spec_;
  Diagnostics& diagnostics_;
  WrittenTree tree_;
  std::vector<std::vector<std::string>> sites_;  ///< Per written body.
  std::string tendons_, equalities_, actuators_;
  std::set<std::string> rows_;  ///< Names of equalities that are taken.
};

}  // namespace
}  // namespace mjcf

std::string write_mjcf(const ModelSpec& spec, Diagnostics& diagnostics) {
  ModelBuildResult built = build_model(spec);
  if (!built.model) {
    diagnostics.append(built.diagnostics);
    return "";
  }
  const auto system = make_system(std::move(*built.model));
  return mjcf::MjcfWriter(*system, spec, diagnostics).write();
}

}  // namespace ferrers
