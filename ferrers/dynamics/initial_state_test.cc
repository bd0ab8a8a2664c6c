#include "ferrers/dynamics/initial_state.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/random_mechanism.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {
namespace {

InitialStateResult initial(const EngineProbe& engine) { return make_initial_state(*engine.dynamics); }

double velocity(const EngineProbe& engine, const State& state, const std::string& joint) {
  return coordinate_velocity(engine.model(), absolute_state(*engine.system, state),
                             {*engine.model().find_joint(joint), 0});
}

TEST(InitialStateTest, WithoutVelocitiesEverythingRests) {
  const EngineProbe engine(make_bricard(BricardRods::kBricks));
  const InitialStateResult result = initial(engine);
  ASSERT_EQ(result.status, InitialStateStatus::kReady);
  EXPECT_EQ(result.state.v.norm(), 0);
  EXPECT_EQ(result.state.t, 0);
}

TEST(InitialStateTest, OneVelocityMovesTheWholeLoop) {
  EngineProbe engine(make_n_four_bar(2, 0.4, 1));
  const InitialStateResult result = initial(engine);
  ASSERT_EQ(result.status, InitialStateStatus::kReady);
  engine.evaluate(result.state);
  EXPECT_LT(engine.eq.constraints.rate.norm(), 1e-13);
  for (const char* foot : {"foot0", "foot1", "foot2"}) EXPECT_NEAR(velocity(engine, result.state, foot), -1, 1e-13);
}

TEST(InitialStateTest, AVelocityMayBeGivenInACutJoint) {
  const ModelSpec base = make_slider_crank(SliderCrankJoints::kRevolutePrismatic, 0.8);
  for (const char* joint : {"O", "A", "B", "guide"}) {
    ModelSpec spec = base;
    spec.initial = {initial_velocity(joint, 0.7)};
    for (std::size_t cut = 0; cut < 4; ++cut) {
      TopologyOptions options;
      options.cut.assign(4, false);
      options.cut[cut] = true;
      const EngineProbe engine(spec, options);
      const InitialStateResult result = initial(engine);
      ASSERT_EQ(result.status, InitialStateStatus::kReady) << joint << cut;
      EXPECT_NEAR(velocity(engine, result.state, joint), 0.7, 1e-12) << joint << cut;
    }
  }
}

// Gauss: the velocity found is orthogonal, in the mass metric, to every admissible motion that keeps the given ones.
TEST(InitialStateTest, VelocitiesNotGivenAreTheLeastInTheMassMetric) {
  int checked = 0;
  for (int seed = 0; seed < 60; ++seed) {
    ModelSpec spec = make_random_mechanism(seed).spec;
    EngineProbe drawn(spec);
    drawn.evaluate(make_drawn_state(*drawn.system));
    if (drawn.selection.independent.size() < 2) continue;
    std::string joint;  // give one revolute joint that can move
    for (const int v : drawn.selection.independent) {
      const std::string& name = drawn.system->coordinate_names[v];
      const std::optional<JointId> id = drawn.model().find_joint(name);
      if (id && drawn.model().joint(*id).type == JointType::kRevolute) joint = name;
    }
    if (joint.empty()) continue;
    ++checked;
    spec.initial = {initial_velocity(joint, 1)};
    EngineProbe engine(spec);
    const InitialStateResult result = initial(engine);
    ASSERT_EQ(result.status, InitialStateStatus::kReady) << seed;
    engine.evaluate(result.state);
    EXPECT_NEAR(velocity(engine, result.state, joint), 1, 1e-10) << seed;
    EXPECT_LT(engine.eq.constraints.rate.norm(), 1e-10) << seed;
    const Selection& s = engine.selection;
    const VectorXd momentum = engine.eq.M * result.state.v;
    const CoordinateAccess given = engine.system->access({*engine.model().find_joint(joint), 0});
    ASSERT_TRUE(given.in_tree) << seed;
    for (const int i : s.independent) {
      VectorXd n = VectorXd::Unit(engine.system->nv, i);
      if (!s.rows.empty()) {
        const MatrixXd G_d = engine.eq.constraints.G(s.rows, s.dependent);
        const VectorXd rest = engine.eq.constraints.G.dense_rows(s.rows) * n;
        n(s.dependent) = -G_d.partialPivLu().solve(rest);
      }
      n -= n[given.v] * result.state.v;  // leaves the given velocity alone
      EXPECT_NEAR(momentum.dot(n), 0, 1e-9 * (1 + momentum.norm() * n.norm())) << seed;
    }
  }
  EXPECT_GE(checked, 10);
}

TEST(InitialStateTest, VelocitiesThatAgreeMayBeGivenTwice) {
  ModelSpec spec = make_n_four_bar(1, 0.4);
  spec.initial = {initial_velocity("foot0", -1), initial_velocity("foot1", -1)};
  EXPECT_EQ(initial(EngineProbe(spec)).status, InitialStateStatus::kReady);
}

TEST(InitialStateTest, VelocitiesThatContradictTheLoopsAreReported) {
  ModelSpec spec = make_n_four_bar(1, 0.4);
  spec.initial = {initial_velocity("foot0", -1), initial_velocity("foot1", 2)};
  const InitialStateResult result = initial(EngineProbe(spec));
  EXPECT_EQ(result.status, InitialStateStatus::kInconsistentVelocities);
  EXPECT_GT(result.residual, 0.1);
  EXPECT_FALSE(result.message.empty());
}

TEST(InitialStateTest, AVelocityOfAJointThatCannotMoveIsReported) {
  ModelSpec spec = make_door(1);
  spec.joints.push_back(joint(JointType::kWeld, "lock", "ground", "door", {0.9, 0, 0}));
  spec.initial = {initial_velocity("hinge1", 1)};
  EXPECT_EQ(initial(EngineProbe(spec)).status, InitialStateStatus::kInconsistentVelocities);
}

TEST(InitialStateTest, PositionsAreAssembledBeforeVelocities) {
  ModelSpec spec = make_driven_four_bar();
  InitialSpec given = initial_velocity("O", 2);
  given.position = {Number(0.5)};
  spec.initial = {given};
  EngineProbe engine(spec);
  const InitialStateResult result = initial(engine);
  ASSERT_EQ(result.status, InitialStateStatus::kReady) << result.message;
  engine.evaluate(result.state);
  EXPECT_LT(engine.eq.constraints.phi.norm(), 1e-12);
  const AbsoluteState absolute = absolute_state(*engine.system, result.state);
  EXPECT_NEAR(coordinate_position(engine.model(), absolute.poses, {*engine.model().find_joint("O"), 0}), 0.5, 1e-12);
  EXPECT_NEAR(velocity(engine, result.state, "O"), 2, 1e-12);
}

TEST(InitialStateTest, MasslessBodiesDoNotStopIt) {
  ModelSpec spec = make_driven_four_bar();
  spec.bodies[1].mass = Number(0);
  spec.bodies[1].inertia = InertiaSpec();
  spec.initial = {initial_velocity("O", 2)};
  EngineProbe engine(spec);
  const InitialStateResult result = initial(engine);
  ASSERT_EQ(result.status, InitialStateStatus::kReady);
  EXPECT_NEAR(velocity(engine, result.state, "O"), 2, 1e-9);
}

}  // namespace
}  // namespace ferrers::witness
