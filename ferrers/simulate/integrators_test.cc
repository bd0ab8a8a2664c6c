#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ferrers/simulate/stepper.h"
#include "ferrers/testing/allocation_guard.h"
#include "ferrers/testing/closed_forms.h"
#include "ferrers/testing/finite_difference.h"
#include "ferrers/testing/run_probe.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {
namespace {

const Vector3d kBricardAt2(-0.778135373033, -0.980352683443, -0.197252670617);

double bricard_error(Integrator integrator, double step) {
  SimulationOptions options = plain_run(2, 2);
  options.integrator = integrator;
  options.step = step;
  const ProbedRun run = probe_run(make_bricard(BricardRods::kBricks), options);
  EXPECT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
  return (run.point(2, "P3") - kBricardAt2).norm();
}

// The closed form of the pendulum, by elliptic functions: Bricard's loop flatters the rule of order eight.
double pendulum_error(Integrator integrator, double step) {
  SimulationOptions options = plain_run(1, 1);
  options.integrator = integrator;
  options.step = step;
  const ProbedRun run = probe_run(make_pendulum(), options);
  EXPECT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
  return (run.point(1, "P") - Vector3d(-0.9862917511318753, -0.1650108531255412, 0)).norm();
}

struct Order {
  Integrator integrator;
  double step, low, high;
};

class IntegratorOrderTest : public ::testing::TestWithParam<Order> {};

TEST_P(IntegratorOrderTest, HalfTheStepGivesTheErrorOfTheOrder) {
  const auto [integrator, step, low, high] = GetParam();
  const auto error = integrator == Integrator::kDormandPrince8 ? pendulum_error : bricard_error;
  const double order = observed_order(error(integrator, step), error(integrator, step / 2));
  EXPECT_GT(order, low) << to_string(integrator);
  EXPECT_LT(order, high) << to_string(integrator);
}

INSTANTIATE_TEST_SUITE_P(Integrators, IntegratorOrderTest,
                         ::testing::Values(Order{Integrator::kDormandPrince8, 0.1, 7.2, 9},
                                           Order{Integrator::kDormandPrince5, 0.05, 4.6, 6.2},
                                           Order{Integrator::kRungeKutta4, 0.05, 3.7, 5},
                                           Order{Integrator::kGeneralizedAlpha, 0.01, 1.9, 2.1},
                                           Order{Integrator::kConstantAcceleration, 0.002, 0.9, 1.1}),
                         [](const auto& test) {
                           std::string name(to_string(test.param.integrator));
                           for (char& c : name) c = c == '-' ? '_' : c;
                           return name;
                         });

TEST(IntegratorsTest, NamesAreFoundAgain) {
  for (const std::string& name : integrator_names()) {
    const auto found = find_integrator(name);
    ASSERT_TRUE(found.has_value()) << name;
    EXPECT_EQ(to_string(*found), name);
  }
  EXPECT_FALSE(find_integrator("euler").has_value());
}

// Rows between the ends of long steps come from the dense output.
TEST(IntegratorsTest, DenseOutputIsAsGoodAsTheStepsThemselves) {
  for (const Integrator integrator : {Integrator::kDormandPrince8, Integrator::kDormandPrince5}) {
    SimulationOptions options = plain_run(2, 0.01);
    options.integrator = integrator;
    options.tolerance = integrator == Integrator::kDormandPrince8 ? 1e-9 : 1e-7;
    const ProbedRun run = probe_run(make_bricard(BricardRods::kBricks), options);
    ASSERT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
    EXPECT_LT(run.energy_drift(), integrator == Integrator::kDormandPrince8 ? 1e-10 : 1e-8) << to_string(integrator);
    EXPECT_LT(run.summary.max_constraint_residual, 1e-11);
    if (integrator == Integrator::kDormandPrince8) {
      EXPECT_LT(run.summary.steps, 60) << "rows, not steps, follow the grid";
    }
  }
}

// The stiff slider of the governor: an explicit rule needs short steps for stability, not for accuracy.
TEST(IntegratorsTest, AStiffGovernorNeedsFewerStepsOfGeneralizedAlphaThanOfTheDefault) {
  SimulationOptions options = plain_run(1, 0.1);
  const ProbedRun plain = probe_run(make_flyball(), options);
  options.integrator = Integrator::kGeneralizedAlpha;
  options.tolerance = 1e-6;
  const ProbedRun stiff = probe_run(make_flyball(), options);
  ASSERT_EQ(stiff.summary.status, RunStatus::kFinished) << stiff.summary.message;
  EXPECT_NEAR(stiff.at(0.5, "S.z"), 0.7432494248, 1e-6);
  EXPECT_NEAR(stiff.at(1, "S.z"), 0.5014209224, 1e-6);
  EXPECT_LT(2 * stiff.summary.steps, plain.summary.steps);
}

class ToleranceTest : public ::testing::TestWithParam<double> {};

// θ'' = (G/I) sin θ on the parallelogram branch, from upright: exact figures at t = 10 for two four-bars.
TEST_P(ToleranceTest, TwoFourBarsMeetTheToleranceThroughEverySingularPose) {
  SimulationOptions options = plain_run(10, 1);
  options.tolerance = GetParam();
  options.estimate_error = true;
  const ProbedRun run = probe_run(make_n_four_bar(2, 0, 1), options);
  ASSERT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
  const double error = (run.point(10, "B0") - Vector3d(0.3284581115408154, 0.9445185381786010, 0)).norm();
  const auto& notices = run.summary.notices;
  const bool too_tight =
      GetParam() < 1e-11 && std::any_of(notices.begin(), notices.end(), [](const std::string& notice) {
        return notice.find("the tolerance may not be reached: rounding allows") == 0;
      });
  const bool says_so = too_tight || (run.summary.error_estimate && *run.summary.error_estimate > 10 * GetParam());
  EXPECT_TRUE(error <= GetParam() || says_so) << error << " for a tolerance of " << GetParam();
  ASSERT_TRUE(run.summary.error_estimate.has_value());
  EXPECT_LE(error, 10 * *run.summary.error_estimate);
  EXPECT_GE(run.summary.singular_poses.size(), GetParam() < 1e-5 ? 10u : 1u);
}

INSTANTIATE_TEST_SUITE_P(Tolerances, ToleranceTest,
                         ::testing::Values(1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12),
                         [](const auto& test) {
                           return "1e" + std::to_string(-std::lround(-std::log10(test.param)) * -1);
                         });

TEST(SteppersTest, AnExplicitStepAllocatesNothing) {
  if (!AllocationGuard::available()) GTEST_SKIP();
  for (const ModelSpec& spec : {make_andrews(), make_bricard(BricardRods::kBricks), make_n_four_bar(10, 0.3)}) {
    const EngineProbe engine(spec);
    const State state = engine.start();
    Evaluator evaluator(engine.dynamics, recommended_formulation());
    RunSummary summary;
    evaluator.decide(state, "", summary);
    for (const Integrator integrator : {Integrator::kDormandPrince8, Integrator::kDormandPrince5}) {
      const auto stepper = make_stepper(integrator, evaluator, false);
      State next = state;
      long count = 0;
      for (int i = 0; i < 2; ++i) {  // the first one makes room
        ASSERT_EQ(evaluator.evaluate(state), ForwardStatus::kSolved);
        const AllocationGuard guard;
        ASSERT_TRUE(stepper->step(evaluator, state, 1e-5, next).finite);
        count = guard.count();
      }
      EXPECT_EQ(count, 0) << spec.name << ", " << to_string(integrator);
    }
  }
}

class FourBarsTest : public ::testing::TestWithParam<int> {};

TEST_P(FourBarsTest, TwentySecondsPassEveryHorizontalPoseAndKeepTheEnergy) {
  const ProbedRun run = probe_run(make_n_four_bar(GetParam(), 0, 1), plain_run(20, 1));
  ASSERT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
  const double scale = ((GetParam() + 1) / 2.0 + GetParam()) * 9.81;
  EXPECT_LT(run.energy_drift(), 1e-10 * scale);
  EXPECT_GE(run.summary.singular_poses.size(), 18u);
  for (const SingularPose& pose : run.summary.singular_poses) EXPECT_EQ(pose.mobility, GetParam() + 1);
}

TEST_P(FourBarsTest, EveryToleranceIsMetOrSaidToBeTooTight) {
  const Vector3d exact = parallelogram_tip(GetParam(), 20);
  for (const double tolerance : {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12}) {
    SimulationOptions options = plain_run(20, 20);
    options.tolerance = tolerance;
    options.find_singular_poses = false;
    options.estimate_error = true;
    const ProbedRun run = probe_run(make_n_four_bar(GetParam(), 0, 1), options);
    ASSERT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
    const double error = (run.point(20, "B0") - exact).norm();
    const bool said = !run.summary.notices.empty() && run.summary.notices.back().find("rounding") != std::string::npos;
    EXPECT_TRUE(error <= tolerance || said) << error << " for " << tolerance;
    EXPECT_LT(error, std::max(tolerance, 1e-10)) << tolerance;
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, FourBarsTest, ::testing::Values(1, 2, 5, 10, 40));

}  // namespace
}  // namespace ferrers::witness
