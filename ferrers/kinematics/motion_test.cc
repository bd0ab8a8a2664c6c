#include "ferrers/kinematics/motion.h"

#include <gtest/gtest.h>

#include "ferrers/testing/compare.h"
#include "ferrers/testing/finite_difference.h"
#include "ferrers/testing/joint_chains.h"
#include "ferrers/testing/random_mechanism.h"
#include "ferrers/testing/zoo.h"

namespace ferrers {
namespace {

using witness::differentiate;
using witness::JointChains;
using witness::make_joint_chains;
using witness::matrices_near;
using witness::RandomSource;

/// Positions, velocities and bias accelerations of one state, and complete ones for `vdot`.
struct Motion {
  PositionKinematics pos;
  VelocityKinematics vel, acc;

  Motion(const System& system, const VectorXd& q, const VectorXd& v, const VectorXd& vdot)
      : pos(make_position_kinematics(system)), vel(make_velocity_kinematics(system)), acc(vel) {
    compute_positions(system, q, pos);
    compute_velocities(system, pos, q, v, vel);
    compute_accelerations(system, pos, vel, vdot, acc);
  }
};

/// A system whose tree holds every type, forward and reversed, in a random state with random accelerations.
struct Case {
  std::shared_ptr<const System> system;
  State state;
  VectorXd vdot;
  RandomSource random;

  explicit Case(int seed) : random(900 + seed) {
    const JointChains chains = make_joint_chains(seed, JointType::kPointOnPlane);
    system = make_system(*build_model(chains.spec).model, {.cut = chains.cut});
    state = random_state(*system, random, 2.0);
    vdot.resize(system->nv);
    for (double& x : vdot) x = random.between(-1, 1);
  }

  /// The motion at time t on a path with these velocities and accelerations at t = 0.
  Motion at(double t) const {
    VectorXd q = state.q;
    displace(*system, t * state.v + 0.5 * t * t * vdot, q);
    return {*system, q, state.v + t * vdot, vdot};
  }
};

class TreeMotionTest : public ::testing::TestWithParam<int> {};

TEST_P(TreeMotionTest, TwistsAreTheRatesOfThePoses) {
  const Case c(GetParam());
  const Motion now = c.at(0);
  for (std::size_t i = 1; i < c.system->nodes.size(); ++i) {
    const auto p = [&](double t) { return c.at(t).pos.nodes[i].p; };
    const auto R = [&](double t) { return c.at(t).pos.nodes[i].R; };
    EXPECT_TRUE(matrices_near(now.vel.nodes[i].v, differentiate(p, 0.0, 2e-3), 1e-10));
    EXPECT_TRUE(
        matrices_near(cross_matrix(now.vel.nodes[i].w) * now.pos.nodes[i].R, differentiate(R, 0.0, 2e-3), 1e-10));
  }
}

TEST_P(TreeMotionTest, AccelerationsAreTheRatesOfTheTwists) {
  const Case c(GetParam());
  const Motion now = c.at(0);
  for (std::size_t i = 1; i < c.system->nodes.size(); ++i) {
    const auto v = [&](double t) { return c.at(t).vel.nodes[i].v; };
    const auto w = [&](double t) { return c.at(t).vel.nodes[i].w; };
    EXPECT_TRUE(matrices_near(now.acc.nodes[i].a, differentiate(v, 0.0, 2e-3), 1e-9)) << c.system->nodes[i].type->name;
    EXPECT_TRUE(matrices_near(now.acc.nodes[i].alpha, differentiate(w, 0.0, 2e-3), 1e-9));
  }
}

TEST_P(TreeMotionTest, BiasAccelerationsRemainAtZeroVdot) {
  const Case c(GetParam());
  const Motion now(*c.system, c.state.q, c.state.v, VectorXd::Zero(c.system->nv));
  for (std::size_t i = 0; i < c.system->nodes.size(); ++i) {
    EXPECT_EQ(now.acc.nodes[i].a, now.vel.nodes[i].a);
    EXPECT_EQ(now.acc.nodes[i].alpha, now.vel.nodes[i].alpha);
  }
  const Motion still(*c.system, c.state.q, VectorXd::Zero(c.system->nv), c.vdot);
  for (std::size_t i = 0; i < c.system->nodes.size(); ++i) {  // and vanish at rest
    EXPECT_EQ(still.vel.nodes[i].a.norm() + still.vel.nodes[i].alpha.norm(), 0);
  }
}

TEST_P(TreeMotionTest, PointsMoveWithTheirBodies) {
  const Case c(GetParam());
  const Motion now = c.at(0);
  RandomSource random(GetParam());
  for (std::size_t b = 0; b < c.system->model->bodies().size(); ++b) {
    const Vector3d p_B = random.vector(1);
    const NodePoint point = c.system->point(BodyId(b), p_B);
    EXPECT_TRUE(matrices_near(point_position(now.pos, point), body_pose(*c.system, now.pos, BodyId(b)) * p_B, 1e-13));
    const auto p = [&](double t) { return point_position(c.at(t).pos, point); };
    const auto v = [&](double t) {
      const Motion m = c.at(t);
      return point_velocity(m.pos, m.vel, point);
    };
    EXPECT_TRUE(matrices_near(point_velocity(now.pos, now.vel, point), differentiate(p, 0.0, 2e-3), 1e-10));
    EXPECT_TRUE(matrices_near(point_acceleration(now.pos, now.acc, point), differentiate(v, 0.0, 2e-3), 1e-9));
  }
}

TEST_P(TreeMotionTest, PositionRatesAreTheDerivativeOfTheDisplacement) {
  const Case c(GetParam());
  VectorXd rate(c.system->nq);
  compute_position_rates(*c.system, c.state.q, c.state.v, rate);
  const auto q = [&](double t) {
    VectorXd moved = c.state.q;
    displace(*c.system, t * c.state.v, moved);
    return moved;
  };
  EXPECT_TRUE(matrices_near(rate, differentiate(q, 0.0), 1e-12));
}

TEST_P(TreeMotionTest, QuaternionsStayOnTheUnitSphere) {
  const Case c(GetParam());
  VectorXd q = c.state.q;
  displace(*c.system, 3 * c.state.v, q);
  VectorXd normal = q;
  normalize_quaternions(*c.system, normal);
  EXPECT_TRUE(matrices_near(q, normal, 1e-15));
  VectorXd long_ones = q;
  int quaternions = 0;
  for (const Node& node : c.system->nodes) {
    if (!node.type || node.type->quaternion_at < 0) continue;
    long_ones.segment<4>(node.q + node.type->quaternion_at) *= 1.5;
    ++quaternions;
  }
  EXPECT_EQ(quaternions, 2);  // spherical and free
  normalize_quaternions(*c.system, long_ones);
  EXPECT_TRUE(matrices_near(long_ones, q, 1e-14));
}

INSTANTIATE_TEST_SUITE_P(Seeds, TreeMotionTest, ::testing::Range(0, 20));

TEST(DrawnStateTest, BodiesStandAsDrawn) {
  for (int seed = 0; seed < 40; ++seed) {
    const witness::RandomMechanism mechanism = witness::make_random_mechanism(seed);
    const auto system = make_system(*build_model(mechanism.spec).model);
    PositionKinematics pos = make_position_kinematics(*system);
    compute_positions(*system, make_drawn_state(*system).q, pos);
    for (std::size_t b = 0; b < system->model->bodies().size(); ++b) {
      const Pose X = body_pose(*system, pos, BodyId(b)), wanted = system->model->bodies()[b].X_WB;
      EXPECT_TRUE(matrices_near(X.R, wanted.R, 1e-13)) << seed << ": " << mechanism.description;
      EXPECT_TRUE(matrices_near(X.p, wanted.p, 1e-13)) << seed << ": " << mechanism.description;
    }
  }
}

// A body that no tree joint reaches floats: six velocities at its mass centre.
TEST(FloatingBodyTest, ABodyOnARodOnlyFloatsAtItsMassCentre) {
  ModelSpec spec;
  spec.name = "tethered";
  spec.bodies = {witness::box_body("box", {1, 2, 3}, {0.1, 0.2, 0.3}, 2)};
  spec.joints = {witness::distance_joint("rod", "ground", "box", {0, 0, 0}, {1, 2, 3})};
  const auto system = make_system(*build_model(spec).model);
  EXPECT_EQ(system->nv, 6);
  EXPECT_EQ(system->nq, 7);
  EXPECT_EQ(system->m, 1);
  EXPECT_EQ(system->coordinate_names[0], "box.omega_x");
  State state = make_drawn_state(*system);
  state.v << 0, 0, 2, 0.5, 0, 0;
  const Motion m(*system, state.q, state.v, VectorXd::Zero(6));
  const NodePoint centre = system->point(BodyId(1), {1, 2, 3}), corner = system->point(BodyId(1), {2, 2, 3});
  EXPECT_TRUE(matrices_near(point_velocity(m.pos, m.vel, centre), Vector3d(0.5, 0, 0), 1e-14));
  EXPECT_TRUE(matrices_near(point_velocity(m.pos, m.vel, corner), Vector3d(0.5, 2, 0), 1e-14));
  EXPECT_TRUE(matrices_near(point_acceleration(m.pos, m.acc, corner), Vector3d(-4, 0, 0), 1e-14));
}

}  // namespace
}  // namespace ferrers
