#include "ferrers/simulate/run.h"

#include <gtest/gtest.h>

#include <algorithm>
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

// --- Prescribed motions and friction, implied motions, laws without a value ---

SimulationOptions driven_run(double t_end, double every) {
  SimulationOptions options = plain_run(t_end, every);
  options.driven = options.with_reactions = true;
  return options;
}

ProbedRun probe_inverse(const ModelSpec& spec, double t_end, double every) {
  const EngineProbe engine(spec);
  ProbedRun run;
  PrescribedOptions options;
  options.grid = {t_end, every};
  const RunControl control = keep_rows(*engine.dynamics, run);
  run.summary = run_prescribed(engine.dynamics, options, control);
  return run;
}

// What simulation of prescribed motion and inverse dynamics must share: efforts, reactions and how certain they are.
void expect_as_inverse(const ModelSpec& spec, double t_end, double every, double bound) {
  const ProbedRun run = probe_run(spec, driven_run(t_end, every));
  const ProbedRun inverse = probe_inverse(spec, t_end, every);
  ASSERT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
  ASSERT_EQ(inverse.summary.status, RunStatus::kFinished) << inverse.summary.message;
  ASSERT_EQ(run.samples.size(), inverse.samples.size());
  for (std::size_t i = 0; i < run.samples.size(); ++i) {
    for (const auto& [name, column] : run.columns) {
      if (name.find(".effort") == std::string::npos) continue;
      EXPECT_NEAR(run.samples[i].values[column], inverse.samples[i].values[column], bound) << name;
    }
    for (std::size_t j = 0; j < run.samples[i].reactions.size(); ++j) {
      const JointReaction &a = run.samples[i].reactions[j], &b = inverse.samples[i].reactions[j];
      for (int k = 0; k < 6; ++k) {
        EXPECT_EQ(a.status[k], b.status[k]) << "joint " << j << ", component " << k;
        EXPECT_NEAR(a.value[k], b.value[k], bound) << "joint " << j << ", component " << k;
      }
    }
  }
}

void add_dry_friction(JointSpec& joint) {
  FrictionSpec friction;
  friction.coulomb = Number(0.1);
  friction.radius = Number(0.01);
  joint.friction = friction;
}

// Without redundancy nothing is left open by a prescribed coordinate, in the tree or not.
TEST(DrivenTest, FrictionInADeterminedMechanismIsThatOfInverseDynamics) {
  for (const char* driven : {"O", "guide"}) {
    ModelSpec spec = make_slider_crank(SliderCrankJoints::kSphericalCylindrical);
    for (JointSpec& one : spec.joints) {
      if (one.name.name == "O") add_dry_friction(one);
    }
    spec.initial.clear();
    spec.drives = {coordinate_drive("motor", driven, "0.02*t")};
    if (driven == std::string("guide")) spec.drives[0].coordinate->coordinate = "displacement";
    expect_as_inverse(spec, 0.5, 0.25, 1e-7);
  }
}

TEST(DrivenTest, StiffnessDividesWhatPressesInAPrescribedMotion) {
  ModelSpec spec = make_slider_crank(SliderCrankJoints::kRevolutePrismatic);
  spec.initial.clear();
  spec.drives = {coordinate_drive("motor", "O", "0.5*t")};
  add_dry_friction(spec.joints[0]);
  const ProbedRun refused = probe_run(spec, driven_run(0.5, 0.25));
  EXPECT_EQ(refused.summary.status, RunStatus::kUnsupported);
  EXPECT_NE(refused.summary.message.find("give stiffness"), std::string::npos) << refused.summary.message;
  StiffnessSpec stiffness;
  stiffness.force = number3(1e6, 1e6, 1e6);
  stiffness.moment = number3(1e4, 1e4, 1e4);
  for (JointSpec& one : spec.joints) one.stiffness = stiffness;
  expect_as_inverse(spec, 0.5, 0.25, 1e-7);
}

// An arm in the plane whose tip follows a path in space.
ModelSpec make_arm_on_a_path(const std::string& z) {
  ModelSpec spec;
  spec.name = "arm-on-a-path";
  spec.gravity = number3(0, -9.81, 0);
  spec.bodies = {rod_body("upper", {0, 0, 0}, {0.8, 0.6, 0}, 2), rod_body("lower", {0.8, 0.6, 0}, {0.8, -0.2, 0}, 1)};
  spec.joints = {joint(JointType::kRevolute, "shoulder", "ground", "upper", {0, 0, 0}),
                 joint(JointType::kRevolute, "elbow", "upper", "lower", {0.8, 0.6, 0})};
  spec.records = {record("tip", "lower", {0.8, -0.2, 0})};
  DriveSpec path;
  path.name = "path";
  path.point = NameRef("tip");
  path.motion = {law("0.8 + 0.2*sin(t)"), law("-0.2 + 0.1*t"), law(z)};
  spec.drives = {path};
  return spec;
}

TEST(DrivenTest, WhatAnImpliedDriveCouldLoadIsNotUnique) {
  const ModelSpec spec = make_arm_on_a_path("0");
  expect_as_inverse(spec, 0.5, 0.25, 1e-8);
  const ProbedRun run = probe_run(spec, driven_run(0.25, 0.25));
  // A force along z at the tip is taken by both joints: as force z, and as moments about x and y.
  for (const RunSample& sample : run.samples) {
    EXPECT_EQ(sample.reactions[0].status[2], ReactionStatus::kDistributed);
    EXPECT_EQ(sample.reactions[0].status[0], ReactionStatus::kUnique);
    EXPECT_EQ(sample.reactions[1].status[3], ReactionStatus::kDistributed);
  }
}

TEST(DrivenTest, AnImpliedMotionThatContradictsTheConstraintsIsToldAtOnce) {
  for (const char* z : {"0.001*t^2", "0.001*t", "0.001", "0.001*t^4"}) {
    const ProbedRun run = probe_run(make_arm_on_a_path(z), driven_run(0.2, 0.01));
    EXPECT_EQ(run.summary.status, RunStatus::kBadMotion) << z << ": " << run.summary.message;
    EXPECT_NE(run.summary.message.find("'path.z' contradicts the constraints"), std::string::npos)
        << run.summary.message;
    // An acceleration that begins with t² is seen when it is a ten-thousandth of the others.
    EXPECT_LE(run.summary.t_reached, std::string(z) == "0.001*t^4" ? 0.06 : 0) << z;
  }
}

TEST(DrivenTest, ALawWithoutAFiniteValueIsToldWithItsDriveAndTime) {
  ModelSpec spec = make_pendulum();
  const std::vector<std::pair<std::string, std::string>> laws = {{"sqrt(t)", "no finite rate at t = 0 s"},
                                                                 {"log(t)", "no finite position at t = 0 s"},
                                                                 {"sqrt((0.5 - t)^7)", "at t = 0.5 s"}};
  for (const auto& [formula, words] : laws) {
    spec.drives = {coordinate_drive("crank", "pivot", formula)};
    const ProbedRun run = probe_run(spec, driven_run(1, 0.1));
    EXPECT_EQ(run.summary.status, RunStatus::kBadMotion) << formula << ": " << run.summary.message;
    EXPECT_NE(run.summary.message.find("motion law of drive 'crank'"), std::string::npos) << run.summary.message;
    EXPECT_NE(run.summary.message.find(words), std::string::npos) << run.summary.message;
  }
}

// --- Viscous friction ---

// About a principal axis: J dω/dt = −c ω.
TEST(RunTest, ASpinInASphericalJointDecaysWithItsViscousFriction) {
  constexpr double c = 0.5, J = 0.2, w = 5;
  ModelSpec spec;
  spec.name = "ball";
  spec.gravity = number3(0, 0, 0);
  spec.bodies = {tensor_body("body", {0, 0, 0}, Eigen::Vector3d(0.1, J, 0.28).asDiagonal(), 1)};
  spec.joints = {joint(JointType::kSpherical, "s", "ground", "body", {0, 0, 0})};
  FrictionSpec friction;
  friction.viscous = Number(c);
  spec.joints[0].friction = friction;
  InitialSpec spin;
  spin.joint = NameRef("s");
  spin.velocity = {Number(0.0), Number(w), Number(0.0)};
  spec.initial = {spin};
  const ProbedRun run = probe_run(spec, plain_run(1, 0.5));
  ASSERT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
  for (const double t : {0.5, 1.0}) EXPECT_NEAR(run.at(t, "s.omega_y.velocity"), w * std::exp(-c * t / J), 1e-9) << t;
  ASSERT_TRUE(run.summary.work.has_value());
  EXPECT_NEAR(run.summary.work->others, 0.5 * J * w * w * (std::exp(-2 * c / J) - 1), 1e-9);
  EXPECT_LT(std::abs(run.summary.balance_error), 1e-9);
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
// After many turns an angle itself is only known to its rounding: steps that try to be better never end.
TEST(RunTest, ACrankThatTurnsFastForLongKeepsItsTolerance) {
  ModelSpec spec = make_slider_crank(SliderCrankJoints::kRevolutePrismatic, 0.785);
  spec.initial = {initial_velocity("O", 60)};
  SimulationOptions options = plain_run(10, 5);
  const ProbedRun run = probe_run(spec, options);
  ASSERT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
  EXPECT_LT(run.summary.steps, 20000);
  EXPECT_LT(run.energy_drift(), 1e-9 * run.summary.energy_start);
  EXPECT_GT(run.last("O.angle"), 300) << "rad";
}

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

TEST(RunTest, TheBalanceOfARunThatEndsBetweenRowsIsThatOfWhereItEnded) {
  ModelSpec spec = make_four_bar(FourBarJoints::kRevolute);
  spec.drives = {coordinate_drive("motor", "O", "", "10/(t - 0.55)")};
  const ProbedRun run = probe_run(spec, plain_run(1, 0.2));
  EXPECT_EQ(run.summary.status, RunStatus::kStepTooSmall);
  EXPECT_NEAR(run.summary.t_reached, 0.4, 1e-12);
  EXPECT_GT(std::abs(run.summary.work->drives), 1);
  EXPECT_NEAR(run.summary.balance_error, 0, 1e-6 * std::abs(run.summary.work->drives));
}

TEST(DrivenTest, AMotionThatBeginsElsewhereThanAnExactInitialPoseIsTold) {
  for (const bool guess : {false, true}) {
    ModelSpec spec = make_pendulum();
    spec.drives = {coordinate_drive("motor", "pivot", "0.1 + t", "")};
    InitialSpec initial;
    initial.joint = "pivot";
    initial.position = {Number(0.5)};
    initial.guess = guess;
    spec.initial = {initial};
    SimulationOptions options = plain_run(0.1, 0.1);
    options.driven = true;
    const ProbedRun run = probe_run(spec, options);
    EXPECT_NEAR(run.samples.front().values[run.columns.at("pivot.angle")], 0.1, 1e-12);
    const auto& notices = run.summary.notices;
    const bool told = std::any_of(notices.begin(), notices.end(), [](const std::string& notice) {
      return notice.find("begin elsewhere") != std::string::npos;
    });
    EXPECT_EQ(told, !guess);
  }
}

// Its rate becomes infinite where the law ends.
TEST(DrivenTest, AMotionThatEndsInAnInfiniteRateEndsTheRun) {
  ModelSpec spec = make_pendulum();
  spec.drives = {coordinate_drive("motor", "pivot", "sqrt(0.5 - t)", "")};
  SimulationOptions options = plain_run(1, 0.1);
  options.driven = true;
  const ProbedRun run = probe_run(spec, options);
  EXPECT_NE(run.summary.status, RunStatus::kFinished);
  EXPECT_NEAR(run.summary.t_reached, 0.4, 0.11);
  EXPECT_LT(run.summary.steps, 5000);
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
