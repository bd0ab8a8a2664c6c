#include "ferrers/dynamics/equations.h"

#include <gtest/gtest.h>

#include <cmath>

#include "ferrers/testing/compare.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/finite_difference.h"
#include "ferrers/testing/random_mechanism.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {
namespace {

constexpr int kSeeds = 60;

void add_force(ModelSpec& spec, const std::string& name, const auto& element) {
  ForceSpec force;
  force.name = name;
  force.element = element;
  spec.forces.push_back(force);
}

/// A tree of four bodies on joints of different types: any coordinates are a state.
ModelSpec make_chain() {
  Matrix3d I;
  I << 0.3, 0.02, -0.03, 0.02, 0.4, 0.01, -0.03, 0.01, 0.35;
  ModelSpec spec;
  spec.name = "chain";
  for (int i = 0; i < 4; ++i) {
    spec.bodies.push_back(tensor_body(numbered("b", i + 1), {i + 0.4, 0.1 * i, -0.2}, I * (1 + 0.3 * i), 1 + 0.5 * i));
  }
  spec.joints = {joint(JointType::kRevolute, "hinge", "ground", "b1", {0, 0, 0}, {0, 1, 1}),
                 joint(JointType::kSpherical, "ball", "b2", "b1", {1, 0, 0}),
                 joint(JointType::kCylindrical, "tube", "b2", "b3", {2, 0.1, 0}, {1, 0, 1}),
                 joint(JointType::kFree, "loose", "b3", "b4", {3, 0, 0})};
  return spec;
}

State random_state(EngineProbe& engine, std::uint64_t seed, double size = 1) { return engine.wandered(seed, size, 1); }

Energy energy_at(const EngineProbe& engine, const State& state) {
  PositionKinematics pos = make_position_kinematics(*engine.system);
  VelocityKinematics vel = make_velocity_kinematics(*engine.system);
  compute_positions(*engine.system, state.q, pos);
  compute_velocities(*engine.system, pos, state.q, state.v, vel);
  return compute_energy(*engine.dynamics, state, pos, vel);
}

/// The state after moving along its own velocities, kept constant, for a time s.
State moved(const EngineProbe& engine, const State& state, double s) {
  State out = state;
  displace(*engine.system, s * state.v, out.q);
  return out;
}

TEST(EquationsTest, KineticEnergyIsTheMassMatrixsQuadraticForm) {
  for (int seed = 0; seed < kSeeds; ++seed) {
    EngineProbe engine(make_random_mechanism(seed).spec);
    const State state = random_state(engine, seed, 0.3);
    const double kinetic = energy_at(engine, state).kinetic;
    EXPECT_NEAR(0.5 * state.v.dot(engine.eq.M * state.v), kinetic, 1e-12 * (1 + kinetic)) << seed;
    EXPECT_TRUE(matrices_near(engine.eq.M, engine.eq.M.transpose(), 0));
    const MatrixXd M = engine.eq.M;
    compute_mass_matrix(*engine.dynamics, engine.eq);
    EXPECT_TRUE(matrices_near(engine.eq.M, M, 1e-15));
  }
}

// Along a motion of constant v: d/dt (½ vᵀ M v + V) = vᵀ h, closed loops or not, rotations included.
TEST(EquationsTest, BiasForcesBalanceTheEnergyOfUniformMotion) {
  for (int seed = 0; seed < kSeeds; ++seed) {
    EngineProbe engine(make_random_mechanism(seed).spec);
    const State state = random_state(engine, seed, 0.3);
    const double power =
        differentiate([&](double s) { return energy_at(engine, moved(engine, state, s)).total(); }, 0.0, 1e-3);
    EXPECT_NEAR(state.v.dot(engine.eq.h), power, 1e-8 * (1 + std::abs(power))) << seed;
  }
}

// Lagrange: h = Ṁ v − ½ ∂(vᵀ M v)/∂q + ∂V/∂q where velocities are the rates of q.
TEST(EquationsTest, BiasForcesAreLagranges) {
  int checked = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    EngineProbe engine(make_random_mechanism(seed).spec);
    if (engine.system->nq != engine.system->nv) continue;  // quaternions
    ++checked;
    const State state = random_state(engine, seed, 0.3);
    const VectorXd h = engine.eq.h;
    const auto mass = [&](const VectorXd& q) {
      compute_positions(*engine.system, q, engine.eq.pos);
      compute_mass_matrix(*engine.dynamics, engine.eq);
      return MatrixXd(engine.eq.M);
    };
    const auto energy = [&](const VectorXd& q, double kinetic_sign) {
      State at = state;
      at.q = q;
      const Energy e = energy_at(engine, at);
      return kinetic_sign * e.kinetic + e.gravity;
    };
    const double step = 1e-3;
    const MatrixXd M_dot = differentiate_along(mass, state.q, state.v, step);
    VectorXd wanted = M_dot * state.v;
    for (int k = 0; k < engine.system->nv; ++k) {
      wanted[k] += differentiate_along([&](const VectorXd& q) { return energy(q, -1); }, state.q,
                                       VectorXd::Unit(engine.system->nv, k), step);
    }
    EXPECT_TRUE(matrices_near(h, wanted, 1e-8)) << seed;
  }
  EXPECT_GE(checked, 10);
}

// --- Force elements ---

SpringSpec make_spring(const char* first, const char* second, double stiffness, double damping) {
  SpringSpec spring;
  spring.bodies = {NameRef(first), NameRef(second)};
  spring.points = {number3(0.2, 0.9, 0.3), number3(2.4, 0.2, -0.6)};
  spring.stiffness = Number(stiffness);
  spring.damping = Number(damping);
  spring.free_length = Number(1.7);
  return spring;
}

BushingSpec make_bushing(const char* first, const char* second, double stiffness, double damping) {
  BushingSpec bushing;
  bushing.bodies = {NameRef(first), NameRef(second)};
  bushing.place.drawn = number3(1.5, 0.3, 0.1);
  bushing.axis.drawn = number3(1, 2, 0);
  bushing.force_stiffness = number3(30 * stiffness, 50 * stiffness, 20 * stiffness);
  bushing.moment_stiffness = number3(3 * stiffness, 7 * stiffness, 5 * stiffness);
  bushing.force_damping = number3(3 * damping, 5 * damping, 2 * damping);
  bushing.moment_damping = number3(1 * damping, 4 * damping, 2 * damping);
  return bushing;
}

TorsionSpringSpec make_torsion_spring(const char* joint, const char* coordinate, double stiffness, double damping) {
  TorsionSpringSpec spring;
  spring.coordinate = {NameRef(joint), coordinate};
  spring.stiffness = Number(stiffness);
  spring.damping = Number(damping);
  spring.free_angle = Number(0.3);
  return spring;
}

/// Elastic power −dV/dt equals vᵀ tau at large displacements of every size, so a bushing has a potential too.
void expect_conservative(const ModelSpec& spec) {
  EngineProbe engine(spec);
  for (int seed = 0; seed < 20; ++seed) {
    const State state = random_state(engine, seed, 0.1 + 0.12 * seed);
    const double power =
        differentiate([&](double s) { return energy_at(engine, moved(engine, state, s)).elastic; }, 0.0, 1e-3);
    EXPECT_NEAR(state.v.dot(engine.eq.tau), -power, 1e-8 * (1 + std::abs(power))) << seed;
  }
}

TEST(ForceElementsTest, SpringsHaveAPotential) {
  ModelSpec spec = make_chain();
  add_force(spec, "spring", make_spring("ground", "b3", 100, 0));
  add_force(spec, "other", make_spring("b2", "b4", 70, 0));
  expect_conservative(spec);
}

TEST(ForceElementsTest, TorsionSpringsHaveAPotential) {
  ModelSpec spec = make_chain();
  add_force(spec, "turn", make_torsion_spring("hinge", "", 20, 0));
  add_force(spec, "twist", make_torsion_spring("tube", "angle", 11, 0));
  expect_conservative(spec);
}

TEST(ForceElementsTest, BushingsHaveAPotentialAtLargeRotations) {
  ModelSpec spec = make_chain();
  add_force(spec, "bush", make_bushing("b1", "b4", 1, 0));
  add_force(spec, "mount", make_bushing("ground", "b2", 1, 0));
  expect_conservative(spec);
}

TEST(ForceElementsTest, DampersOnlyTakeEnergy) {
  ModelSpec spec = make_chain();
  add_force(spec, "spring", make_spring("ground", "b3", 0, 4));
  add_force(spec, "turn", make_torsion_spring("hinge", "", 0, 2));
  add_force(spec, "bush", make_bushing("b1", "b4", 0, 1));
  JointDampingSpec damping;
  damping.coordinate = {NameRef("tube"), "angle"};
  damping.damping = Number(3);
  add_force(spec, "oil", damping);
  EngineProbe engine(spec);
  for (int seed = 0; seed < 20; ++seed) {
    const State state = random_state(engine, seed);
    EXPECT_LT(state.v.dot(engine.eq.tau), 0) << seed;
  }
  // Alone, the damper's power is −c times the rate squared.
  ModelSpec only = make_chain();
  add_force(only, "oil", damping);
  EngineProbe oil(only);
  const State state = random_state(oil, 1);
  const double rate = state.v[oil.system->access({*oil.model().find_joint("tube"), 0}).v];
  EXPECT_NEAR(state.v.dot(oil.eq.tau), -3 * rate * rate, 1e-13);
}

/// Everything at once against absolute coordinates; bushings apart, whose moments the witness takes for small turns.
TEST(ForceElementsTest, AccelerationsUnderEveryElementAgreeWithAbsoluteCoordinates) {
  ModelSpec spec = make_chain();
  add_force(spec, "spring", make_spring("ground", "b3", 100, 4));
  add_force(spec, "turn", make_torsion_spring("hinge", "", 20, 2));
  for (const bool is_torque : {false, true}) {
    for (const bool in_body_axes : {false, true}) {
      LoadSpec load;
      load.body = is_torque == in_body_axes ? "b4" : "b2";
      load.is_torque = is_torque;
      load.in_body_axes = in_body_axes;
      if (!is_torque) load.place = number3(2, 0.3, 0.7);
      load.components = {law("3 + t"), law("2*hinge.position"), law("-hinge.velocity")};
      add_force(spec, numbered("load", static_cast<int>(spec.forces.size())), load);
    }
  }
  FrictionSpec friction;
  friction.viscous = Number(0.7);
  spec.joints[2].friction = friction;
  spec.records = {record("tip", "b4", {3.5, 0.2, 0.1})};
  spec.drives = {coordinate_drive("motor", "hinge", "", "4 + t")};
  DriveSpec jack, hand;
  jack.name = "jack";
  jack.bodies = std::array<NameRef, 2>{NameRef("b1"), NameRef("b3")};
  jack.points = std::array<Number3, 2>{number3(0.5, 1, 0), number3(2, 0, 1)};
  jack.effort = {law("6*cos(t)")};
  hand.name = "hand";
  hand.point = NameRef("tip");
  hand.effort = {law("1"), law("-2"), law("5*t")};
  spec.drives.insert(spec.drives.end(), {jack, hand});
  EngineProbe engine(spec);
  for (int seed = 0; seed < 20; ++seed) {
    State state = random_state(engine, seed);
    state.t = 0.4;
    const ForwardResult result = engine.forward(state);
    const AbsoluteState absolute = absolute_state(*engine.system, state);
    const AbsoluteMotion wanted =
        solve_absolute(engine.model(), absolute, applied_wrenches(engine.model(), absolute, state.t));
    const auto got = engine.body_accelerations(result.vdot);
    for (std::size_t b = 1; b < got.size(); ++b) {
      EXPECT_TRUE(matrices_near(got[b], wanted.accelerations[b], 1e-9)) << seed;
    }
  }
}

/// What acts along a joint's coordinate does not depend on whether the joint is in the tree.
TEST(ForceElementsTest, EffortsOnCutJointsEqualThoseInTheTree) {
  ModelSpec spec = make_slider_crank(SliderCrankJoints::kRevolutePrismatic, 0.8);
  spec.drives = {coordinate_drive("turn", "B", "", "7 + B.position"), coordinate_drive("push", "guide", "", "-3")};
  for (const char* name : {"O", "A", "B"}) add_force(spec, name, make_torsion_spring(name, "", 13, 2));
  std::vector<Vector6d> first;
  for (std::size_t cut = 0; cut < 4; ++cut) {
    TopologyOptions options;
    options.cut.assign(4, false);
    options.cut[cut] = true;
    EngineProbe engine(spec, options);
    ASSERT_EQ(engine.system->cuts.size(), 1u);
    ASSERT_EQ(engine.system->cuts[0].joint.index(), cut);
    const EngineProbe drawn(spec);
    const State state = tree_state(*engine.system, absolute_state(*drawn.system, drawn.start()));
    const auto got = engine.body_accelerations(engine.forward(state).vdot);
    if (cut == 0) first = got;
    for (std::size_t b = 1; b < got.size(); ++b) EXPECT_TRUE(matrices_near(got[b], first[b], 1e-11)) << cut;
  }
}

// On a mechanism with loops: d/dt (T + V) is the power of efforts and dampers.
TEST(EquationsTest, EnergyChangesByThePowerOfEffortsAndDampers) {
  ModelSpec spec = make_slider_crank(SliderCrankJoints::kRevolutePrismatic, 0.8);
  spec.drives = {coordinate_drive("turn", "O", "", "7")};
  add_force(spec, "elbow", make_torsion_spring("A", "", 13, 2));
  EngineProbe engine(spec);
  const State state = engine.start();
  const ForwardResult result = engine.forward(state);
  const auto access = [&](const char* name) { return engine.system->access({*engine.model().find_joint(name), 0}); };
  const auto rate = [&](const char* name) { return state.v[access(name).v]; };
  ASSERT_TRUE(access("O").in_tree && access("A").in_tree);
  // Along q ⊕ (v s + vdot s²/2), v + vdot s.
  const double change = differentiate(
      [&](double s) {
        State at = state;
        displace(*engine.system, s * state.v + 0.5 * s * s * result.vdot, at.q);
        at.v = state.v + s * result.vdot;
        return energy_at(engine, at).total();
      },
      0.0, 1e-5);
  EXPECT_NEAR(change, 7 * rate("O") - 2 * rate("A") * rate("A"), 1e-5 * std::abs(change));
}

}  // namespace
}  // namespace ferrers::witness
