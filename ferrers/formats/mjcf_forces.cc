#include <fmt/format.h>

#include "ferrers/formats/mjcf_import.h"

namespace ferrers::mjcf {
namespace {

constexpr const char* kTurns[] = {"omega_x", "omega_y", "omega_z"};
constexpr const char* kMoves[] = {"v_x", "v_y", "v_z"};

/// Velocities of a joint as formulas read them.
std::vector<Expression> velocities_of(const TreeJoint& joint) {
  std::vector<Expression> all;
  if (joint.scalar()) return {Expression::variable(joint.name + ".velocity")};
  for (const char* word : kTurns) all.push_back(Expression::variable(fmt::format("{}.{}", joint.name, word)));
  if (joint.kind != JointKind::kFree) return all;
  for (const char* word : kMoves) all.push_back(Expression::variable(fmt::format("{}.{}", joint.name, word)));
  return all;
}

class ForceWriter {
 public:
  explicit ForceWriter(Import& import) : import_(import) {}

  void add(const TreeBody& body, const TreeJoint& joint) {
    if (joint.replaced || joint.added) return;
    if (!import_.options.ignore_springs) add_spring(body, joint);
    if (!import_.options.ignore_damping) add_damping(body, joint);
    if (!import_.options.ignore_armature && joint.armature != 0) add_armature(joint);
  }

  /// A force that carries a part of the body's weight.
  void add_compensation(const TreeBody& body) {
    if (body.gravity_compensation == 0 || !body.mass || body.mass->mass == 0) return;
    LoadSpec load;
    load.body = {body.name, body.element.main_at()};
    load.place = vector_spec(body.mass->com);
    const Vector3d force = -body.gravity_compensation * body.mass->mass * import_.settings.gravity;
    for (std::size_t i = 0; i < 3; ++i) {
      load.components[i].expression = Expression::constant(force[static_cast<int>(i)]);
    }
    add_force(body.original + "_gravcomp", body.element, load);
  }

  void finish() {
    if (!kinetic_.empty()) import_.spec().lagrangian.kinetic_energy = sum_of(kinetic_);
  }

 private:
  template <class ElementSpec>
  void add_force(const std::string& name, const Element& from, const ElementSpec& element) {
    const SourceRange at = from.main_at();
    import_.spec().forces.push_back({{import_.names.add("forces", "force", name), at}, element, at});
  }

  CoordinateRef coordinate(const TreeJoint& joint) const { return {{joint.name, joint.element.main_at()}, ""}; }

  void add_generalized_force(const TreeJoint& joint, const Expression& force) {
    auto& forces = import_.spec().lagrangian.forces;
    for (auto& [on, sum] : forces) {
      if (on.joint.name != joint.name) continue;
      sum = sum + force;
      return;
    }
    forces.emplace_back(coordinate(joint), force);
  }

  /// Whether the quadratic and cubic coefficients are of use; refuses them where there is no one coordinate.
  bool has_curve(const TreeJoint& joint, const Polynomial& polynomial, std::string_view what) const {
    if (polynomial[1] == 0 && polynomial[2] == 0) return false;
    if (joint.scalar()) return true;
    joint.element.diagnostics().error(
        "F602", joint.element.at(),
        fmt::format("the {} of '{}' is not linear, which is supported for hinges and slides only", what, joint.name));
    return false;
  }

  void add_spring(const TreeBody& body, const TreeJoint& joint) {
    const Polynomial& k = joint.stiffness;
    if (has_curve(joint, k, "stiffness")) {
      const Expression x = position_of(joint) - Expression::constant(joint.springref);
      add_generalized_force(joint, -(Expression::constant(k[1]) * x * x + Expression::constant(k[2]) * x * x * x));
    }
    if (k[0] == 0) return;
    const std::string name = joint.original + "_spring";
    if (joint.scalar()) {
      TorsionSpringSpec spring;
      spring.coordinate = coordinate(joint);
      spring.stiffness = Number(k[0]);
      spring.free_angle = Number(joint.springref);
      return add_force(name, joint.element, spring);
    }
    BushingSpec bushing = make_bushing(body, joint);  // its moment follows the rotation vector, as MuJoCo's does
    bushing.moment_stiffness = number3(k[0], k[0], k[0]);
    if (joint.kind == JointKind::kFree) bushing.force_stiffness = number3(k[0], k[0], k[0]);
    add_force(name, joint.element, bushing);
  }

  void add_damping(const TreeBody& body, const TreeJoint& joint) {
    const Polynomial& d = joint.damping;
    if (has_curve(joint, d, "damping")) {
      const Expression v = velocities_of(joint)[0];
      const Expression square =
          *Expression::parse(fmt::format("{0} * abs({0})", joint.name + ".velocity"), {}, ignored_);
      add_generalized_force(joint, -(Expression::constant(d[1]) * square + Expression::constant(d[2]) * v * v * v));
    }
    if (d[0] == 0) return;
    const std::string name = joint.original + "_damping";
    if (joint.kind != JointKind::kFree) {
      return add_force(name, joint.element, JointDampingSpec{coordinate(joint), d[0]});
    }
    BushingSpec bushing = make_bushing(body, joint);
    bushing.moment_damping = bushing.force_damping = number3(d[0], d[0], d[0]);
    add_force(name, joint.element, bushing);
  }

  /// Between the bodies of a ball or free joint, at its point; without stiffness or damping yet.
  static BushingSpec make_bushing(const TreeBody& body, const TreeJoint& joint) {
    const SourceRange at = joint.element.main_at();
    BushingSpec bushing;
    bushing.bodies = {NameRef(joint.bodies[0], at), NameRef(joint.bodies[1], at)};
    bushing.place.drawn = vector_spec(body.X_WB * joint.pos);
    return bushing;
  }

  void add_armature(const TreeJoint& joint) {
    for (const Expression& velocity : velocities_of(joint)) {
      kinetic_.push_back(Expression::constant(0.5 * joint.armature) * velocity * velocity);
    }
  }

  Import& import_;
  std::vector<Expression> kinetic_;
  Diagnostics ignored_;
};

}  // namespace

void add_joint_forces(Import& import) {
  resolve_springdampers(import);
  ForceWriter writer(import);
  for (const TreeBody& body : import.tree.bodies) {
    for (const TreeJoint& joint : body.joints) writer.add(body, joint);
    writer.add_compensation(body);
  }
  writer.finish();
}

}  // namespace ferrers::mjcf
