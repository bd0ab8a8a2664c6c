#include "ferrers/simulate/run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "ferrers/testing/run_probe.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {
namespace {

// --- Prescribed and forced together ---

TEST(DrivenTest, ADrivenFourBarFollowsItsLawAndNeedsTheEffortsOfInverseDynamics) {
  const ModelSpec spec = make_driven_four_bar();
  SimulationOptions options = plain_run(2, 0.5);
  options.driven = true;
  const ProbedRun run = probe_run(spec, options);
  ASSERT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
  const EngineProbe engine(spec);
  ProbedRun inverse;
  PrescribedOptions prescribed;
  prescribed.grid = {2, 0.5};
  const RunControl control = keep_rows(*engine.dynamics, inverse);
  inverse.summary = run_prescribed(engine.dynamics, prescribed, control);
  for (const double t : {0.0, 0.5, 1.0, 1.5, 2.0}) {
    EXPECT_NEAR(run.at(t, "O.angle"), 1.2 * (1 - std::cos(2 * t)), 1e-10) << t;
    EXPECT_NEAR(run.at(t, "motor.effort"), inverse.at(t, "motor.effort"), 1e-8) << t;
    EXPECT_NEAR(run.at(t, "B.angle.acceleration"), inverse.at(t, "B.angle.acceleration"), 1e-8) << t;
  }
  ASSERT_TRUE(run.summary.work.has_value());
  EXPECT_LT(std::abs(run.summary.balance_error), 1e-8);
  EXPECT_GT(std::abs(run.summary.work->drives), 1);
}

// A cart that is moved and carries a pendulum that is not: the pendulum is simulated.
TEST(DrivenTest, WhatIsNotPrescribedMovesFreely) {
  ModelSpec spec = make_pendulum();
  BodySpec cart;
  cart.name = "cart";
  cart.mass = Number(3);
  cart.com = number3(0, 0, 0);
  spec.bodies.push_back(cart);
  spec.joints[0].bodies = {NameRef("cart"), NameRef("bob")};
  JointSpec rail = joint(JointType::kPrismatic, "rail", "ground", "cart", {0, 0, 0});
  rail.axis.drawn = number3(1, 0, 0);
  spec.joints.push_back(rail);
  spec.drives = {coordinate_drive("pull", "rail", "0.1*t*t")};
  SimulationOptions options = plain_run(1, 0.5);
  options.driven = true;
  const ProbedRun run = probe_run(spec, options);
  ASSERT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
  // φ'' = −g cos φ + a sin φ with a = 0.2, by a fine classical rule.
  double angle = 0, rate = 0;
  const auto f = [](double x) { return -9.81 * std::cos(x) + 0.2 * std::sin(x); };
  const int n = 20000;
  const double h = 1.0 / n;
  for (int i = 0; i < n; ++i) {
    const double a1 = rate, w1 = f(angle), a2 = rate + h / 2 * w1, w2 = f(angle + h / 2 * a1);
    const double a3 = rate + h / 2 * w2, w3 = f(angle + h / 2 * a2), a4 = rate + h * w3, w4 = f(angle + h * a3);
    angle += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    rate += h / 6 * (w1 + 2 * w2 + 2 * w3 + w4);
  }
  EXPECT_NEAR(run.last("rail.displacement"), 0.1, 1e-12);
  EXPECT_NEAR(run.last("pivot.angle"), angle, 1e-9);
}

TEST(DrivenTest, MotionsThatDependOnEachOtherAreRefusedByName) {
  ModelSpec spec = make_driven_four_bar();
  spec.drives.push_back(coordinate_drive("second", "B", "0.1*t"));
  SimulationOptions options = plain_run(1, 0.5);
  options.driven = true;
  const ProbedRun run = probe_run(spec, options);
  EXPECT_EQ(run.summary.status, RunStatus::kBadMotion);
  EXPECT_FALSE(run.summary.message.empty());
}

TEST(DrivenTest, AMotionThatTheConstraintsImplyIsAcceptedAndWatched) {
  ModelSpec spec = make_pendulum();  // kept in the plane: z of its point is 0 whatever it does
  DriveSpec path;
  path.name = "hand";
  path.point = NameRef("P");
  path.motion = {law("cos(t*t)"), law("-sin(t*t)"), law("0")};
  spec.drives = {path};
  SimulationOptions options = plain_run(1, 0.25);
  options.driven = true;
  spec.joints[0].type = JointType::kPlanar;
  spec.bodies[0].inertia.kind = InertiaSpec::Kind::kTensor;
  spec.bodies[0].inertia.moments = number3(0.1, 0.1, 0.1);
  const ProbedRun run = probe_run(spec, options);
  ASSERT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
  EXPECT_LT((run.point(1, "P") - Vector3d(std::cos(1.0), -std::sin(1.0), 0)).norm(), 1e-12);
  ASSERT_EQ(run.summary.effort_is_shared.size(), 3u);
  EXPECT_EQ(run.summary.effort_is_shared, (std::vector<bool>{false, false, true}));
}

// --- Going on ---

TEST(RunTest, ARunThatGoesOnIsTheSameRun) {
  const EngineProbe engine(make_bricard(BricardRods::kBricks));
  const ProbedRun whole = probe_run(make_bricard(BricardRods::kBricks), plain_run(2, 0.5));
  State state = make_drawn_state(*engine.system);
  state.t = 1;
  const auto& joints = engine.model().joints();
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const CoordinateAccess access = engine.system->access({JointId(j), 0});
    if (!access.in_tree) continue;
    state.q[access.q] = whole.at(1, joints[j].name + ".angle");
    state.v[access.v] = whole.at(1, joints[j].name + ".angle.velocity");
  }
  SimulationOptions options = plain_run(2, 0.5);
  options.start = state;
  ProbedRun rest;
  const RunControl control = keep_rows(*engine.dynamics, rest);
  rest.summary = simulate(engine.dynamics, options, control);
  ASSERT_EQ(rest.summary.status, RunStatus::kFinished) << rest.summary.message;
  ASSERT_EQ(rest.samples.size(), 3u);
  EXPECT_EQ(rest.samples.front().t, 1);
  EXPECT_LT((rest.point(2, "P3") - whole.point(2, "P3")).norm(), 1e-11);
}

// --- Balances ---

TEST(BalanceTest, WorkOfDrivesAndSpringsExplainsTheEnergy) {
  for (const ModelSpec& spec : {make_andrews(), make_flyball()}) {
    const ProbedRun run = probe_run(spec, plain_run(0.02, 0.01));
    ASSERT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
    ASSERT_TRUE(run.summary.work.has_value());
    EXPECT_GT(std::abs(run.summary.work->drives) + std::abs(run.summary.work->others), 1e-4) << spec.name;
    EXPECT_LT(std::abs(run.summary.balance_error), 1e-10) << spec.name;
  }
}

TEST(BalanceTest, AngularMomentumAboutTheFreeShaftIsConstant) {
  const ProbedRun run = probe_run(make_flyball(), plain_run(0.5, 0.1));
  ASSERT_TRUE(run.summary.momentum.has_value());
  EXPECT_NEAR(run.summary.momentum->angular_start.z(), 53.868998658418, 1e-9);
  EXPECT_LT(run.summary.momentum->angular_change.z(), 1e-9);
}

// --- Dry friction and limits ---

TEST(RunTest, ABlockSlidesDownWithWhatFrictionLeaves) {
  ModelSpec spec;
  spec.name = "incline";
  spec.gravity = number3(5, 0, -8);  // the incline is level here, gravity is not
  BodySpec block;
  block.name = "block";
  block.mass = Number(2);
  block.com = number3(0, 0, 0);
  spec.bodies = {block};
  JointSpec slide = joint(JointType::kPrismatic, "slide", "ground", "block", {0, 0, 0});
  slide.axis.drawn = number3(1, 0, 0);
  FrictionSpec friction;
  friction.coulomb = Number(0.25);
  slide.friction = friction;
  spec.joints = {slide};
  spec.initial = {initial_velocity("slide", 1)};  // fast against the regularisation: tanh is 1
  const ProbedRun run = probe_run(spec, plain_run(1, 0.5));
  ASSERT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
  EXPECT_NEAR(run.last("slide.displacement"), 1 + 0.5 * (5 - 0.25 * 8), 1e-9);
  EXPECT_NEAR(run.summary.work->others, -0.25 * 2 * 8 * 2.5, 1e-8);
}

TEST(RunTest, ALimitThatIsCrossedIsToldWithItsTime) {
  ModelSpec spec = make_pendulum();
  spec.joints[0].limits = std::array<Number, 2>{Number(-1.0), Number(2.0)};
  const ProbedRun run = probe_run(spec, plain_run(1, 0.1));
  ASSERT_EQ(run.summary.limits.size(), 1u);
  EXPECT_FALSE(run.summary.limits[0].upper);
  EXPECT_GT(run.summary.limits[0].t, 0.3);
  EXPECT_LT(run.summary.limits[0].t, 0.5);
}

// Between steps too: the pendulum turns back at −π, where steps need not end.
TEST(RunTest, HowFarALimitIsPassedIsKnownBetweenSteps) {
  const double period = 2.367841947576237;
  ModelSpec spec = make_pendulum();
  spec.joints[0].limits = std::array<Number, 2>{Number(-3.1415), Number(2.0)};
  for (const double tolerance : {1e-5, 1e-9}) {
    SimulationOptions options = plain_run(10, 1);
    options.tolerance = tolerance;
    const ProbedRun run = probe_run(spec, options);
    ASSERT_EQ(run.summary.limits.size(), 1u);
    const LimitCrossing& crossing = run.summary.limits[0];
    EXPECT_EQ(crossing.times, 4);
    EXPECT_NEAR(crossing.excess, std::numbers::pi - 3.1415, 10 * tolerance);
    EXPECT_NEAR(crossing.t, period / 2, 0.05);
    EXPECT_LT(crossing.t, period / 2);
  }
}

// --- Turns, beginnings and ends ---

// A shaft in two bearings, one of which closes a loop: nothing but its turns tells how far it is.
TEST(RunTest, TurnsAreCountedHoweverLongTheSteps) {
  ModelSpec spec;
  spec.name = "shaft";
  spec.gravity = number3(0, 0, 0);
  spec.bodies = {bar_body("shaft", {0, 0, 0}, {0, 0, 1}, 2, 0.2)};
  spec.joints = {joint(JointType::kRevolute, "a", "ground", "shaft", {0, 0, 0}),
                 joint(JointType::kRevolute, "b", "ground", "shaft", {0, 0, 1})};
  for (JointSpec& bearing : spec.joints) bearing.axis.drawn = number3(0, 0, 1);
  spec.initial = {initial_velocity("a", 10)};
  for (const std::string& name : integrator_names()) {
    for (const bool fixed : {false, true}) {
      SimulationOptions options = plain_run(10, 1);
      options.integrator = find_integrator(name);
      if (fixed) options.step = 1;
      const ProbedRun run = probe_run(spec, options);
      ASSERT_EQ(run.summary.status, RunStatus::kFinished) << name << ": " << run.summary.message;
      EXPECT_NEAR(run.last("a.angle"), 100, 1e-9) << name << (fixed ? ", fixed" : "");
      EXPECT_NEAR(run.last("b.angle"), 100, 1e-9) << name << (fixed ? ", fixed" : "");
    }
  }
}

TEST(RunTest, ARunOfNoLengthHasOneRowAndNothingToComplainOf) {
  SimulationOptions options = plain_run(0, 0.1);
  options.estimate_error = true;
  const ProbedRun run = probe_run(make_pendulum(), options);
  EXPECT_EQ(run.summary.status, RunStatus::kFinished);
  EXPECT_EQ(run.samples.size(), 1u);
  EXPECT_TRUE(run.summary.notices.empty()) << run.summary.notices.front();
}

TEST(RunTest, ARunCannotGoOnToAnEndThatItHasPassed) {
  const EngineProbe engine(make_pendulum());
  SimulationOptions options = plain_run(0.5, 0.1);
  options.start = make_drawn_state(*engine.system);
  options.start->t = 1;
  const RunSummary summary = simulate(engine.dynamics, options, {});
  EXPECT_EQ(summary.status, RunStatus::kUnsupported);
  EXPECT_NE(summary.message.find("t = 1 s"), std::string::npos) << summary.message;
}

TEST(RunTest, AnEffortThatGrowsWithoutBoundEndsTheRunThere) {
  ModelSpec spec = make_four_bar(FourBarJoints::kRevolute);
  spec.drives = {coordinate_drive("motor", "O", "", "1/(t - 1)")};
  const ProbedRun run = probe_run(spec, plain_run(3, 0.1));
  EXPECT_EQ(run.summary.status, RunStatus::kStepTooSmall);
  EXPECT_NE(run.summary.message.find("t = 1 s"), std::string::npos) << run.summary.message;
  EXPECT_LT(run.summary.steps, 2000);
}

TEST(RunTest, AToleranceThatSaysNothingAndAStepThatIsCutAreTold) {
  SimulationOptions options = plain_run(0.2, 0.1);
  options.integrator = Integrator::kConstantAcceleration;
  options.tolerance = 1e-6;
  options.step = 0.3;
  const ProbedRun run = probe_run(make_pendulum(), options);
  ASSERT_EQ(run.summary.notices.size(), 2u);
  EXPECT_NE(run.summary.notices[0].find("tolerance"), std::string::npos);
  EXPECT_NE(run.summary.notices[1].find("0.1 s"), std::string::npos);
  EXPECT_EQ(run.summary.largest_step, 0.1);
}

// Driven through the pose where all rods lie in one line: the row there has no reactions, its neighbours have.
TEST(RunTest, ReactionsAtASingularPoseAreNoFigures) {
  ModelSpec spec = make_n_four_bar(1, 0);
  spec.drives = {coordinate_drive("motor", spec.joints[0].name.name, "-pi/2*t", "")};
  SimulationOptions options = plain_run(2, 0.5);
  options.with_reactions = options.driven = true;
  options.distribution.by = DistributionBy::kEqualStiffness;
  const ProbedRun run = probe_run(spec, options);
  ASSERT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
  for (const RunSample& sample : run.samples) {
    EXPECT_EQ(sample.reactions.empty(), std::abs(sample.t - 1) < 1e-9) << sample.t;
    for (const JointReaction& reaction : sample.reactions) {
      for (int i = 0; i < 6; ++i) EXPECT_LT(std::abs(reaction.value[i]), 1e3);
    }
  }
}

TEST(RunTest, EffortsFromTablesAreToldToBeSplinesThatGoOnBeyondTheirEnds) {
  ModelSpec spec = make_pendulum();
  LawSpec table;
  table.samples = {{0, 0.1, 0.2}, {0, 1, 3}};
  spec.drives = {coordinate_drive("motor", "pivot", "", "0")};
  spec.drives[0].effort = {table};
  const ProbedRun run = probe_run(spec, plain_run(1, 0.5));
  ASSERT_EQ(run.summary.notices.size(), 2u);
  EXPECT_NE(run.summary.notices[0].find("motor"), std::string::npos);
  EXPECT_NE(run.summary.notices[1].find("0.2"), std::string::npos) << run.summary.notices[1];
}

}  // namespace
}  // namespace ferrers::witness
