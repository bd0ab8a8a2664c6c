#include "ferrers/dynamics/linearization.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>

#include "ferrers/dynamics/equilibrium.h"
#include "ferrers/testing/build_checks.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/finite_difference.h"
#include "ferrers/testing/random_mechanism.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers {
namespace {

using namespace witness;  // NOLINT(google-build-using-namespace)

constexpr double kGravity = 9.81;

ForceSpec spring(const std::string& name, const std::string& first, const Point& on_first, const std::string& second,
                 const Point& on_second, double stiffness, std::optional<double> free_length = std::nullopt,
                 double damping = 0) {
  SpringSpec element;
  element.bodies = {NameRef(first), NameRef(second)};
  element.points = {numbers(on_first), numbers(on_second)};
  element.stiffness = Number(stiffness);
  element.damping = Number(damping);
  if (free_length) element.free_length = Number(*free_length);
  ForceSpec spec;
  spec.name = name;
  spec.element = element;
  return spec;
}

ModelSpec planar(const std::string& name) {
  ModelSpec spec;
  spec.name = name;
  spec.gravity = number3(0, -kGravity, 0);
  return spec;
}

Linearization at_start(const ModelSpec& spec) {
  const EngineProbe probe(spec);
  Linearization linear = linearize(*probe.dynamics, probe.start());
  EXPECT_EQ(linear.status, LinearizationStatus::kDone) << linear.message;
  return linear;
}

// --- Closed forms ---

TEST(LinearizationTest, APendulumSwingsWithTheRootOfGravityOverLength) {
  ModelSpec spec = planar("pendulum");
  BodySpec bob;
  bob.name = "bob";
  bob.mass = Number(2.5);
  bob.com = number3(0, -0.7, 0);
  spec.bodies = {bob};
  spec.joints = {joint(JointType::kRevolute, "pivot", "ground", "bob", {0, 0, 0})};
  const Linearization linear = at_start(spec);
  ASSERT_EQ(linear.modal.modes.size(), 1u);
  EXPECT_TRUE(linear.is_equilibrium);
  EXPECT_EQ(linear.stability.stability, Stability::kStable);
  EXPECT_NEAR(linear.modal.modes[0].frequency_rad_s(), std::sqrt(kGravity / 0.7), 1e-10);
  EXPECT_EQ(linear.modal.modes[0].damping_ratio(), 0);
  EXPECT_LT(linear.relative_error, 1e-9);
  EXPECT_EQ(linear.shapes[0].value[0], 1.0);
}

TEST(LinearizationTest, APhysicalPendulumSwingsWithItsMomentOfInertia) {
  ModelSpec spec = planar("bar");
  spec.bodies = {bar_body("bar", {0, 0, 0}, {0, -1.2, 0}, 3, 0.05)};
  spec.joints = {joint(JointType::kRevolute, "pivot", "ground", "bar", {0, 0, 0}),
                 joint(JointType::kRevolute, "again", "ground", "bar", {0, 0, 0.3})};  // redundant
  const double J = 3 * (3 * 0.05 * 0.05 + 1.2 * 1.2) / 12 + 3 * 0.36;
  const Linearization linear = at_start(spec);
  ASSERT_EQ(linear.modal.modes.size(), 1u);
  EXPECT_NEAR(linear.modal.modes[0].frequency_rad_s(), std::sqrt(3 * kGravity * 0.6 / J), 1e-10);
}

TEST(LinearizationTest, ADoublePendulumHasTheTwoFrequenciesOfItsClosedForm) {
  const double l1 = 0.8, l2 = 1.1, m1 = 2, m2 = 3;
  ModelSpec spec = planar("double");
  spec.bodies = {rod_body("upper", {0, 0, 0}, {0, -l1, 0}, m1), rod_body("lower", {0, -l1, 0}, {0, -l1 - l2, 0}, m2)};
  spec.joints = {joint(JointType::kRevolute, "top", "ground", "upper", {0, 0, 0}),
                 joint(JointType::kRevolute, "elbow", "upper", "lower", {0, -l1, 0})};
  // In angles from the vertical: M and K by hand.
  Eigen::Matrix2d M, K;
  M << (m1 / 3 + m2) * l1 * l1, m2 * l1 * l2 / 2, m2 * l1 * l2 / 2, m2 * l2 * l2 / 3;
  K << (m1 / 2 + m2) * kGravity * l1, 0, 0, m2 * kGravity * l2 / 2;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix2d> solver(K, M);
  const Linearization linear = at_start(spec);
  ASSERT_EQ(linear.modal.modes.size(), 2u);
  for (int k = 0; k < 2; ++k) {
    const double wanted = std::sqrt(solver.eigenvalues()[k]);
    EXPECT_NEAR(linear.modal.modes[k].frequency_rad_s(), wanted, 1e-10 * wanted);
    // The elbow turns by the difference of the two angles.
    const Eigen::Vector2d shape = solver.eigenvectors().col(k);
    const double ratio = (shape[1] - shape[0]) / shape[0];
    EXPECT_NEAR(std::abs(linear.shapes[k].value[1] / linear.shapes[k].value[0] - ratio), 0, 1e-8 * std::abs(ratio));
  }
}

ModelSpec sliding_mass(double m, double k, double c) {
  ModelSpec spec = planar("slide");
  spec.bodies = {box_body("block", {0, 0, 0}, {0.1, 0.1, 0.1}, m)};
  spec.joints = {joint(JointType::kPrismatic, "slide", "ground", "block", {0, 0, 0}, {0, 1, 0})};
  spec.forces = {spring("hanger", "ground", {0, 1, 0}, "block", {0, 0, 0}, k, 1 - m * kGravity / k, c)};
  return spec;
}

TEST(LinearizationTest, AMassOnASpringVibratesAndIsDampedAsInTheTextbook) {
  const double m = 2, k = 500, c = 3;
  const Linearization free = at_start(sliding_mass(m, k, 0));
  ASSERT_TRUE(free.is_equilibrium);
  EXPECT_NEAR(free.modal.modes.at(0).frequency_rad_s(), std::sqrt(k / m), 1e-9);
  const Linearization damped = at_start(sliding_mass(m, k, c));
  ASSERT_EQ(damped.modal.modes.size(), 1u);
  EXPECT_FALSE(damped.modal.undamped);
  EXPECT_NEAR(damped.modal.modes[0].frequency_rad_s(), std::sqrt(k / m), 1e-9);
  EXPECT_NEAR(damped.modal.modes[0].damping_ratio(), c / (2 * std::sqrt(k * m)), 1e-11);
  const Linearization over = at_start(sliding_mass(m, k, 200));
  ASSERT_EQ(over.modal.modes.size(), 2u);
  for (const Mode& mode : over.modal.modes) EXPECT_EQ(mode.kind, ModeKind::kDecay);
  const double root = std::sqrt(200.0 * 200 - 4 * k * m);
  EXPECT_NEAR(over.modal.modes[0].eigenvalue.real(), (-200 + root) / (2 * m), 1e-9);
  EXPECT_NEAR(over.modal.modes[1].eigenvalue.real(), (-200 - root) / (2 * m), 1e-9);
}

// One coordinate θ, the bars' angle; T = ½ J(θ) θ̇² and V(θ) by hand, a spring from the pin to the bottom roller.
struct LiftByHand {
  int stages;
  double up, k, l0;  // up: 1 where gravity points down, −1 where it hangs
  double weight() const {
    double w = 2 * stages * (0.5 + 30);
    for (int i = 1; i <= stages; ++i) w += 8 * (2 * i - 1);
    return up * kGravity * w;
  }
  double slope(double q) const { return weight() * std::cos(q) - 2 * k * std::sin(q) * (2 * std::cos(q) - l0); }
  double curvature(double q) const {
    return -weight() * std::sin(q) - 2 * k * std::cos(q) * (2 * std::cos(q) - l0) + 4 * k * std::sin(q) * std::sin(q);
  }
  double inertia(double q) const {
    const double s = std::sin(q) * std::sin(q), c = std::cos(q) * std::cos(q), J = 4 * (3 * 0.03 * 0.03 + 4) / 12;
    double sum = 2 * stages * J + 4 * s + 2.0 * stages * stages * c + 120.0 * stages * stages * c;
    for (int i = 1; i <= stages; ++i) sum += 8 * (s + (2 * i - 1) * (2 * i - 1) * c);
    return sum;
  }
  double rest() const {
    double q = 0.5;
    for (int i = 0; i < 200; ++i) q -= std::clamp(slope(q) / std::max(std::abs(curvature(q)), 1.0), -0.02, 0.02);
    return q;
  }
};

TEST(LinearizationTest, AHangingAndAStandingScissorLiftVibrateAsTheirOneCoordinateSays) {
  for (const LiftByHand& lift :
       {LiftByHand{1, -1, 800, 1.0}, {2, -1, 800, 1.2}, {3, -1, 2000, 1.5}, {1, 1, 2e4, 1.6}, {2, 1, 2e4, 1.6}}) {
    ModelSpec spec = make_scissor_lift(lift.stages);
    spec.gravity = number3(0, -lift.up * kGravity, 0);
    spec.forces = {spring("spring", "ground", {0, 0, 0}, "bottom_roller", {2 * std::cos(0.5), 0, 0}, lift.k, lift.l0)};
    const EngineProbe probe(spec);
    const EquilibriumResult rest = solve_equilibrium(*probe.dynamics, probe.start());
    ASSERT_EQ(rest.status, EquilibriumStatus::kFound) << rest.message;
    const double q = lift.rest();
    const State state = rest.state;
    double angle = NAN;
    for (const NamedCoordinate& one : measure_positions(*probe.system, state)) {
      if (one.name == "bottom_pin.angle") angle = one.value;
    }
    EXPECT_NEAR(angle, q - 0.5, 1e-10) << lift.stages;
    const Linearization linear = linearize(*probe.dynamics, state);
    ASSERT_EQ(linear.modal.modes.size(), 1u);
    const double wanted = std::sqrt(lift.curvature(q) / lift.inertia(q));
    EXPECT_NEAR(linear.modal.modes[0].frequency_rad_s(), wanted, 1e-9 * wanted) << lift.stages;
    EXPECT_EQ(rest.stability.stability, Stability::kStable);
  }
}

TEST(LinearizationTest, MotionsWithoutResistanceAreNeutralDampedOrNot) {
  for (const double damping : {0.0, 0.4}) {
    ModelSpec spec = planar("train");  // two discs on one axis, joined by a spring in torsion
    spec.gravity = number3(0, 0, -kGravity);
    spec.bodies = {bar_body("a", {0, 0, 0}, {0, 0, 0.1}, 2, 0.2), bar_body("b", {0, 0, 1}, {0, 0, 1.1}, 4, 0.3)};
    spec.joints = {joint(JointType::kRevolute, "front", "ground", "a", {0, 0, 0}),
                   joint(JointType::kRevolute, "shaft", "a", "b", {0, 0, 1})};
    TorsionSpringSpec element;
    element.coordinate.joint = "shaft";
    element.stiffness = Number(50.0);
    element.damping = Number(damping);
    ForceSpec force;
    force.name = "twist";
    force.element = element;
    spec.forces = {force};
    const Linearization linear = at_start(spec);
    const double Ja = 2 * 0.04 / 2, Jb = 4 * 0.09 / 2;
    ASSERT_EQ(linear.modal.modes.size(), 2u);
    EXPECT_EQ(linear.stability.neutral, 1);
    EXPECT_EQ(linear.modal.modes[0].kind, ModeKind::kNeutral);
    EXPECT_EQ(linear.modal.modes[0].eigenvalue, 0.0);
    EXPECT_NEAR(linear.modal.modes[1].frequency_rad_s(), std::sqrt(50 * (1 / Ja + 1 / Jb)), 1e-9);
    EXPECT_NEAR(linear.modal.modes[1].damping_ratio(), damping / 2 * std::sqrt((1 / Ja + 1 / Jb) / 50), 1e-12);
    EXPECT_NEAR(std::abs(linear.shapes[0].value[1]), 0, 1e-9);  // both discs turn together
    EXPECT_EQ(linear.modal.eigenvalues.size(), 4u);
  }
}

TEST(LinearizationTest, AnUprightPendulumRunsAwayAndEqualPendulumsShareTheirFrequency) {
  ModelSpec spec = planar("upright");
  spec.bodies = {rod_body("rod", {0, 0, 0}, {0, 2, 0}, 1)};
  spec.joints = {joint(JointType::kRevolute, "pivot", "ground", "rod", {0, 0, 0})};
  const Linearization upright = at_start(spec);
  EXPECT_EQ(upright.stability.stability, Stability::kUnstable);
  ASSERT_EQ(upright.modal.modes.size(), 2u);
  const double rate = std::sqrt(kGravity * 3 / 4);
  EXPECT_NEAR(upright.modal.modes[0].eigenvalue.real() * upright.modal.modes[1].eigenvalue.real(), -rate * rate, 1e-9);
  ModelSpec pair = planar("pair");
  for (const double x : {0.0, 3.0}) {
    const std::string name = x == 0 ? "left" : "right";
    pair.bodies.push_back(rod_body(name, {x, 0, 0}, {x, -2, 0}, 1));
    pair.joints.push_back(joint(JointType::kRevolute, name + "_pivot", "ground", name, {x, 0, 0}));
  }
  const Linearization linear = at_start(pair);
  ASSERT_EQ(linear.modal.modes.size(), 2u);
  for (const Mode& mode : linear.modal.modes) {
    EXPECT_EQ(mode.multiplicity, 2);
    EXPECT_NEAR(mode.frequency_rad_s(), rate, 1e-10);
  }
}

TEST(LinearizationTest, GyroscopicForcesSplitTheModesOfASpinningTop) {
  // A rotor on a ball joint at its mass centre, held by nothing: spinning, it nutates with (C − A)/A times its spin in
  // its own axes, C/A seen from ground: eigenvalues of the turn δ in ground's axes are ±i C/A · spin, and zeros.
  ModelSpec spec = planar("rotor");
  spec.gravity = number3(0, 0, 0);
  spec.bodies = {tensor_body("rotor", {0, 0, 0}, Eigen::Vector3d(2, 2, 3).asDiagonal(), 5)};
  spec.joints = {joint(JointType::kSpherical, "ball", "ground", "rotor", {0, 0, 0})};
  InitialSpec initial;
  initial.joint = "ball";
  initial.velocity = {Number(0.0), Number(0.0), Number(7.0)};
  spec.initial = {initial};
  const Linearization linear = at_start(spec);
  EXPECT_FALSE(linear.at_rest);
  int found = 0;
  for (const Mode& mode : linear.modal.modes) {
    if (mode.kind != ModeKind::kOscillation) continue;
    const double ratio = mode.frequency_rad_s() / 7;
    const bool known = std::abs(ratio - 1.5) < 1e-8 || std::abs(ratio - 1) < 1e-8 || std::abs(ratio - 0.5) < 1e-8;
    EXPECT_TRUE(known) << ratio;
    found += std::abs(ratio - 1.5) < 1e-8 ? 1 : 0;
    EXPECT_NEAR(mode.damping_ratio(), 0, 1e-9);
  }
  EXPECT_EQ(found, 1);
}

TEST(LinearizationTest, AwayFromEquilibriumNothingBecomesAFrequencyByRounding) {
  const Linearization linear = at_start(make_pendulum());  // level: the torque is at its largest, its slope zero
  EXPECT_TRUE(linear.at_rest);
  EXPECT_FALSE(linear.is_equilibrium);
  EXPECT_NEAR(linear.drift[1], -kGravity, 1e-12);
  ASSERT_EQ(linear.modal.modes.size(), 2u);
  for (const Mode& mode : linear.modal.modes) EXPECT_EQ(mode.kind, ModeKind::kNeutral);
}

TEST(LinearizationTest, SingularPosesAndMotionsWithoutInertiaAreSaid) {
  const EngineProbe flat(make_n_four_bar(2, M_PI / 2));
  EXPECT_EQ(linearize(*flat.dynamics, flat.start()).status, LinearizationStatus::kSingularPose);
  for (const LegEnds ends : {LegEnds::kRods, LegEnds::kSphericalSpherical}) {  // branches that part in third order
    const EngineProbe legs(make_six_legs(ends));
    EXPECT_EQ(linearize(*legs.dynamics, legs.start()).status, LinearizationStatus::kSingularPose);
  }
  ModelSpec spec = make_pendulum();
  spec.bodies[0].mass = Number(0.0);
  const EngineProbe massless(spec);
  EXPECT_EQ(linearize(*massless.dynamics, massless.start()).status, LinearizationStatus::kSingularMass);
}

TEST(LinearizationTest, ConditionsOnVelocitiesAreRefusedByName) {
  ModelSpec spec = make_pendulum();
  ConstraintSpec held;
  held.name = "held";
  held.on_velocities = true;
  held.formula = *formula(spec.joints[0].name.name + ".velocity").expression;
  spec.constraints = {held};
  const EngineProbe engine(spec);
  const Linearization linear = linearize(*engine.dynamics, engine.start());
  EXPECT_EQ(linear.status, LinearizationStatus::kUnsupported);
  EXPECT_NE(linear.message.find("'held'"), std::string::npos) << linear.message;
}

}  // namespace
}  // namespace ferrers
