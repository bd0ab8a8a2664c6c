#include "ferrers/simulate/simulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "ferrers/testing/run_probe.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {
namespace {

TEST(SimulationTest, OneStepOfConstantAccelerationIsThePapersFormula) {
  SimulationOptions options = plain_run(0.01, 0.01);
  options.integrator = Integrator::kConstantAcceleration;
  options.step = 0.01;
  const ProbedRun run = probe_run(make_pendulum(), options);
  // From the horizontal at rest: acceleration −g/l; q' = q + v h + vdot h²/2, v' = v + vdot h.
  EXPECT_NEAR(run.at(0.01, "pivot.angle"), -9.81 * 0.01 * 0.01 / 2, 1e-16);
  EXPECT_NEAR(run.at(0.01, "pivot.angle.velocity"), -9.81 * 0.01, 1e-15);
}

TEST(SimulationTest, TheIntegratorThatIsTakenIsTheFirstByNameUnlessAnotherIsAskedFor) {
  SimulationOptions options = plain_run(0.01, 0.01);
  EXPECT_EQ(to_string(integrator_of(options)), integrator_names().front());
  EXPECT_EQ(probe_run(make_pendulum(), options).summary.method.rfind(integrator_names().front() + ",", 0), 0u);
  options.integrator = Integrator::kRungeKutta4;
  EXPECT_EQ(integrator_of(options), Integrator::kRungeKutta4);
}

TEST(SimulationTest, ATighterToleranceIsMoreAccurate) {
  const auto error = [](double tolerance) {
    SimulationOptions options = plain_run(2, 2);
    options.tolerance = tolerance;
    const ProbedRun run = probe_run(make_bricard(BricardRods::kBricks), options);
    return (run.point(2, "P3") - Vector3d(-0.778135373033, -0.980352683443, -0.197252670617)).norm();
  };
  const double loose = error(1e-5), tight = error(1e-9);
  EXPECT_LT(tight, 1e-6);
  EXPECT_LT(tight, 0.1 * loose);
}

TEST(SimulationTest, AllFormulationsRunTheSame) {
  SimulationOptions options = plain_run(1, 0.25);
  const ProbedRun a = probe_run(make_bricard(BricardRods::kBricks), options);
  for (const Formulation formulation : kFormulations) {
    options.formulation = formulation;
    const ProbedRun b = probe_run(make_bricard(BricardRods::kBricks), options);
    ASSERT_EQ(b.summary.status, RunStatus::kFinished) << to_string(formulation) << ": " << b.summary.message;
    for (const double t : {0.25, 0.5, 1.0}) {
      EXPECT_LT((a.point(t, "P3") - b.point(t, "P3")).norm(), 1e-10) << t << ", " << to_string(formulation);
    }
  }
}

// What is made of the equations is a matter of time, not of the motion. A run that is long enough changes over to
// native code by itself.
TEST(SimulationTest, NativeCodeRunsTheSameFromTheStartFromLaterOnOrNever) {
  for (const ModelSpec& spec : {make_bricard(BricardRods::kBricks), make_parallel_cranks()}) {
    SimulationOptions options = plain_run(8, 2);
    std::vector<RunSummary> runs;
    std::vector<std::vector<double>> ends;
    for (const NativeCode code : {NativeCode::kNever, NativeCode::kWhenItPays, NativeCode::kAlways}) {
      options.native_code = code;
      const ProbedRun run = probe_run(spec, options);
      ASSERT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
      runs.push_back(run.summary);
      ends.push_back(run.samples.back().values);
    }
    EXPECT_GT(runs[1].evaluations, 2000) << "so that it changes over";
    for (std::size_t k = 1; k < ends.size(); ++k) {
      for (std::size_t i = 0; i < ends[k].size(); ++i) {
        EXPECT_NEAR(ends[k][i], ends[0][i], 1e-8 * (1 + std::abs(ends[0][i]))) << k << ", column " << i;
      }
    }
  }
}

TEST(SimulationTest, RowsDoNotDependOnHowOftenTheyAreAsked) {
  const ProbedRun coarse = probe_run(make_bricard(BricardRods::kBricks), plain_run(1, 0.5));
  const ProbedRun fine = probe_run(make_bricard(BricardRods::kBricks), plain_run(1, 0.01));
  for (const double t : {0.5, 1.0}) EXPECT_LT((coarse.point(t, "P3") - fine.point(t, "P3")).norm(), 1e-9) << t;
  EXPECT_NEAR(coarse.at(0.5, "J1.angle.acceleration"), fine.at(0.5, "J1.angle.acceleration"), 1e-8);
}

// --- Output grid ---

TEST(OutputGridTest, RowsAreMultiplesOfTheSpacingAndTheEnd) {
  const std::vector<double> even = OutputGrid{1, 0.1}.times();
  ASSERT_EQ(even.size(), 11u);
  for (int k = 0; k <= 10; ++k) EXPECT_EQ(even[k], k * 0.1);
  const std::vector<double> uneven = OutputGrid{1, 0.3}.times();
  ASSERT_EQ(uneven.size(), 5u);
  EXPECT_EQ(uneven[3], 3 * 0.3);
  EXPECT_EQ(uneven[4], 1.0);
}

TEST(OutputGridTest, AnEndOnTheGridToRoundingGivesNoExtraRow) {
  EXPECT_EQ((OutputGrid{0.3, 0.1}.times().size()), 4u);  // 0.3 / 0.1 is 2.9999999999999996
  EXPECT_EQ((OutputGrid{0.3 + 2e-11, 0.1}.times().size()), 4u);
  EXPECT_EQ((OutputGrid{0.3 + 1e-8, 0.1}.times().size()), 5u);
}

TEST(OutputGridTest, ARunOfNoTimeHasOneRow) {
  EXPECT_EQ((OutputGrid{0, 0.1}.times()), std::vector<double>{0});
  EXPECT_EQ((OutputGrid{0.05, 0.1}.times()), (std::vector<double>{0, 0.05}));
}

TEST(OutputGridTest, ASpacingMustBePositive) {
  EXPECT_THROW((OutputGrid{1, 0}.times()), std::invalid_argument);
  EXPECT_THROW((OutputGrid{-1, 0.1}.times()), std::invalid_argument);
}

TEST(SimulationTest, ARunShowsExactlyTheGridInOrder) {
  const ProbedRun run = probe_run(make_pendulum(), plain_run(0.35, 0.1));
  ASSERT_EQ(run.samples.size(), 5u);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(run.samples[k].t, static_cast<double>(k) * 0.1);
  EXPECT_EQ(run.samples[4].t, 0.35);
  for (const RunSample& sample : run.samples) EXPECT_EQ(sample.values.front(), sample.t);
  EXPECT_EQ(run.summary.t_reached, 0.35);
}

// --- How a run ends ---

TEST(SimulationTest, AStopFlagEndsTheRunWithWhatIsKnown) {
  const EngineProbe engine(make_pendulum());
  std::atomic<bool> stop{false};
  int rows = 0;
  RunControl control;
  control.stop = &stop;
  control.on_sample = [&](const RunSample&) {
    if (++rows == 4) stop = true;
  };
  const RunSummary summary = simulate(engine.dynamics, plain_run(1000, 1), control);
  EXPECT_EQ(summary.status, RunStatus::kStopped);
  EXPECT_LT(summary.t_reached, 20);
  EXPECT_GE(rows, 4);
  EXPECT_FALSE(summary.message.empty());
}

TEST(SimulationTest, MasslessBodiesRunWhereOthersCarryThem) {
  ModelSpec spec = make_driven_four_bar();
  spec.drives.clear();
  spec.bodies[1].mass = Number(0);
  spec.bodies[1].inertia = InertiaSpec();
  const ProbedRun run = probe_run(spec, plain_run(1, 0.1));
  EXPECT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
  EXPECT_LT(run.energy_drift(), 1e-8);
  EXPECT_GT(std::abs(run.last("O.angle")), 0.1);
}

TEST(SimulationTest, AMotionThatMovesNoMassIsReported) {
  ModelSpec spec = make_pendulum();
  spec.bodies[0].mass = Number(0);
  const ProbedRun run = probe_run(spec, plain_run(1, 0.1));
  EXPECT_EQ(run.summary.status, RunStatus::kSingularMass);
  EXPECT_NE(run.summary.message.find("mass"), std::string::npos);
}

TEST(SimulationTest, AnOpenLoopGivesNoRun) {
  ModelSpec spec = make_driven_four_bar();
  InitialSpec initial;
  initial.joint = "O";
  initial.position = {Number(std::numbers::pi)};  // the crank end is 5 m from the rocker's pivot: reach is 5.6 m
  spec.initial = {initial};
  InitialSpec other;
  other.joint = "B";
  other.position = {Number(1.5)};
  spec.initial.push_back(other);
  const ProbedRun run = probe_run(spec, plain_run(1, 0.1));
  EXPECT_EQ(run.summary.status, RunStatus::kNotAssembled);
  EXPECT_FALSE(run.summary.message.empty());
  EXPECT_TRUE(run.samples.empty());
}

TEST(SimulationTest, ContradictingVelocitiesGiveNoRun) {
  ModelSpec spec = make_four_bar(FourBarJoints::kRevolute);
  spec.initial = {initial_velocity("O", 1), initial_velocity("C", 5)};
  const ProbedRun run = probe_run(spec, plain_run(1, 0.1));
  EXPECT_EQ(run.summary.status, RunStatus::kInconsistentVelocities);
}

// Fully extended, the Sarrus linkage has one constraint less than elsewhere: decisions taken there do not last.
TEST(SimulationTest, ARedundancyThatOnlyTheStartingPoseHasEndsTheRun) {
  ModelSpec sarrus = make_sarrus(std::numbers::pi / 2);
  sarrus.gravity = number3(2, 1, -9.81);  // straight down it would stand still
  for (const ModelSpec& spec : {sarrus, make_n_four_bar(1, std::numbers::pi / 2)}) {
    const ProbedRun run = probe_run(spec, plain_run(5, 0.1));
    EXPECT_EQ(run.summary.status, RunStatus::kRedundancyEnded) << spec.name << ": " << run.summary.message;
    EXPECT_LT(run.summary.t_reached, 5) << spec.name;
    EXPECT_FALSE(run.summary.message.empty());
  }
}

TEST(SimulationTest, ADriveWithoutAnEffortLawIsNoticed) {
  const ProbedRun run = probe_run(make_driven_four_bar(), plain_run(0.1, 0.1));
  EXPECT_EQ(run.summary.status, RunStatus::kFinished);
  ASSERT_FALSE(run.summary.notices.empty());
  EXPECT_NE(run.summary.notices.front().find("motor"), std::string::npos);
}

}  // namespace
}  // namespace ferrers::witness
