#include <gtest/gtest.h>

#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/random_source.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {
namespace {

// A tensor with products: that of random point masses about their centre.
Eigen::Matrix3d random_tensor(RandomSource& random) {
  Eigen::Matrix3d I = Eigen::Matrix3d::Zero();
  for (int i = 0; i < 6; ++i) {
    const Eigen::Vector3d r = random.vector(0.5);
    I += random.between(0.5, 2) * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
  }
  return I;
}

// Euler: I dω/dt + ω × I ω = 0 in any axes, here the world's; the mass centre falls.
TEST(ForceElementsTest, AFreeBodyWithProductsOfInertiaTumblesAsEulerSays) {
  RandomSource random(11);
  for (int trial = 0; trial < 10; ++trial) {
    ModelSpec spec;
    spec.name = "tumbler";
    const Eigen::Matrix3d I = random_tensor(random);
    ASSERT_GT(std::abs(I(0, 1)) + std::abs(I(0, 2)) + std::abs(I(1, 2)), 0.01);
    spec.bodies = {tensor_body("body", {0.1, 0.2, -0.3}, I, 2)};
    spec.joints = {joint(JointType::kFree, "float", "ground", "body", {0.5, 0, 0})};
    EngineProbe engine(spec);
    const State state = engine.wandered(static_cast<std::uint64_t>(trial) + 1, 1.0, 3);
    const ForwardResult result = engine.forward(state);
    ASSERT_EQ(result.status, ForwardStatus::kSolved);
    const Vector6d acceleration = engine.body_accelerations(result.vdot)[1];
    const Matrix3d R = body_pose(*engine.system, engine.eq.pos, BodyId(1)).R;
    const Vector3d w = engine.eq.vel.nodes[1].w;
    const Matrix3d I_world = R * I * R.transpose();
    const Vector3d wanted = I_world.ldlt().solve(-w.cross(I_world * w));
    EXPECT_LT((acceleration.head<3>() - wanted).norm(), 1e-12 * (1 + wanted.norm()));
    EXPECT_LT((acceleration.tail<3>() - Vector3d(0, 0, -9.81)).norm(), 1e-12);
  }
}

// The products matter: a rotor about z with products Ixz, Iyz wants bearing moments ω² (−Iyz, Ixz) at constant speed.
TEST(ForceElementsTest, AnUnbalancedRotorLoadsItsBearingByItsProducts) {
  ModelSpec spec;
  spec.name = "rotor";
  spec.gravity = number3(0, 0, 0);
  Eigen::Matrix3d I = Eigen::Vector3d(2, 2.5, 3).asDiagonal();
  I(0, 2) = I(2, 0) = 0.3;
  I(1, 2) = I(2, 1) = -0.2;
  I(0, 1) = I(1, 0) = 0.1;
  spec.bodies = {tensor_body("rotor", {0, 0, 0}, I, 4)};
  spec.joints = {joint(JointType::kRevolute, "bearing", "ground", "rotor", {0, 0, 0})};
  EngineProbe engine(spec);
  State state = make_drawn_state(*engine.system);
  state.v[0] = 7;
  const ForwardResult result = engine.forward(state);
  EXPECT_NEAR(result.vdot[0], 0, 1e-13);
  const JointReaction bearing = engine.reactions(state, result)[0];
  // ω × I ω with ω along z: ω² (−Iyz, Ixz, 0).
  EXPECT_NEAR(bearing.value[3], 49 * 0.2, 1e-11);
  EXPECT_NEAR(bearing.value[4], 49 * 0.3, 1e-11);
}

// --- Viscous friction of joints without scalar coordinates ---

void add_viscous(JointSpec& joint, double viscous) {
  FrictionSpec friction;
  friction.viscous = Number(viscous);
  joint.friction = friction;
}

// In the tree and cut, against the second engine, which takes efforts along the angular velocities.
TEST(ForceElementsTest, ViscousFrictionOfASphericalJointOpposesTheRelativeRotation) {
  RandomSource random(5);
  ModelSpec spec;
  spec.name = "balls";
  spec.bodies = {tensor_body("a", {1, 0, 0}, random_tensor(random), 2),
                 tensor_body("b", {2, 1, 0}, random_tensor(random), 3)};
  spec.joints = {joint(JointType::kSpherical, "A", "ground", "a", {0, 0, 0}),
                 joint(JointType::kSpherical, "B", "a", "b", {2, 0, 0}),
                 joint(JointType::kSpherical, "C", "b", "ground", {3, 2, 0})};
  for (JointSpec& one : spec.joints) add_viscous(one, 0.7);
  for (std::size_t cut = 0; cut < 3; ++cut) {
    TopologyOptions options;
    options.cut.assign(3, false);
    options.cut[cut] = true;
    EngineProbe engine(spec, options);
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const State state = engine.wandered(seed);
      const ForwardResult result = engine.forward(state);
      ASSERT_EQ(result.status, ForwardStatus::kSolved);
      const AbsoluteState absolute = absolute_state(*engine.system, state);
      const AbsoluteMotion wanted =
          solve_absolute(engine.model(), absolute, applied_wrenches(engine.model(), absolute, 0));
      const auto got = engine.body_accelerations(result.vdot);
      for (std::size_t b = 1; b < got.size(); ++b) {
        EXPECT_LT((got[b] - wanted.accelerations[b]).norm(), 1e-9 * (1 + got[b].norm())) << cut << " " << seed;
      }
    }
  }
}

// One body on one joint, moving in all the ways that the joint leaves free: power of the friction −c (|ω|² + |v|²).
TEST(ForceElementsTest, ViscousFrictionTakesItsPowerFromEveryFreeVelocity) {
  constexpr double c = 0.4;
  for (const JointType type :
       {JointType::kSpherical, JointType::kFree, JointType::kPointOnLine, JointType::kPointOnPlane}) {
    ModelSpec spec;
    spec.name = "braked";
    spec.bodies = {box_body("body", {0.3, 0.2, 0.1}, {1, 0.6, 0.4}, 2)};
    spec.joints = {joint(type, "J", "ground", "body", {0, 0, 0})};
    add_viscous(spec.joints[0], c);
    EngineProbe engine(spec);
    const State state = engine.wandered(3);
    engine.evaluate(state);
    const FramePair frames = engine.system->frame_pair(JointId(0));
    const RelativeMotion motion = compute_relative_motion(frames, engine.eq.pos, engine.eq.vel);
    EXPECT_GT(motion.w.norm(), 0.01);
    EXPECT_EQ(motion.v.norm() > 0.01, type != JointType::kSpherical);
    const double power = (engine.eq.force + engine.eq.h).dot(state.v);
    EXPECT_NEAR(power, -c * (motion.w.squaredNorm() + motion.v.squaredNorm()), 1e-12) << joint_type_info(type).name;
  }
}

}  // namespace
}  // namespace ferrers::witness
