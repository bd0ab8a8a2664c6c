#include "ferrers/simulate/singular_poses.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "ferrers/simulate/simulation.h"
#include "ferrers/testing/zoo.h"

namespace ferrers {
namespace {

RunSummary run(const ModelSpec& spec, double end, double tolerance) {
  const auto model = make_dynamics_model(make_system(*build_model(spec).model));
  SimulationOptions options;
  options.grid = {end, 0.1};
  options.tolerance = tolerance;
  options.with_reactions = false;
  return simulate(model, options, {});
}

// All cranks turn alike: I θ'' = Q sin θ (θ from upright, clockwise), thin rods of 1 m and 1 kg. For two loops, three
// cranks: I = 3·1/3 + 2 = 3, Q = g (3·1/2 + 2) = 3.5 g, so θ'² = ω² + 2 Q/I (1 − cos θ).
double time_to_horizontal(double speed, int loops) {
  const double inertia = (loops + 1) / 3.0 + loops, moment = 9.81 * ((loops + 1) / 2.0 + loops);
  const int n = 20000;  // Simpson's rule
  double sum = 0;
  for (int i = 0; i <= n; ++i) {
    const double angle = std::numbers::pi / 2 * i / n;
    const double rate = std::sqrt(speed * speed + 2 * moment / inertia * (1 - std::cos(angle)));
    sum += (i == 0 || i == n ? 1 : (i % 2 ? 4 : 2)) / rate;
  }
  return sum * std::numbers::pi / 2 / n / 3;
}

TEST(SingularPosesTest, TwoParallelogramsCrossTheHorizontalWhenTheClosedFormSays) {
  const RunSummary summary = run(witness::make_n_four_bar(2, 0, 1), 1, 1e-10);
  ASSERT_EQ(summary.status, RunStatus::kFinished) << summary.message;
  ASSERT_GE(summary.singular_poses.size(), 1u);
  const SingularPose& pose = summary.singular_poses.front();
  EXPECT_NEAR(pose.t, time_to_horizontal(1, 2), 1e-8);
  EXPECT_EQ(pose.mobility, 3);
  EXPECT_EQ(pose.redundant, 8);
  EXPECT_EQ(pose.rank, 2);
  EXPECT_EQ(pose.rank_around, 4);
  EXPECT_EQ(pose.all_rank, 27);  // of 35 rows
  EXPECT_EQ(pose.all_rank_around, 29);
}

TEST(SingularPosesTest, EveryCrossingOfTheHorizontalIsFound) {
  const RunSummary summary = run(witness::make_n_four_bar(2, 0, 1), 4, 1e-10);
  ASSERT_EQ(summary.status, RunStatus::kFinished) << summary.message;
  // The energy lets it turn over: past the upright again the times repeat with the period of a whole turn.
  const std::vector<SingularPose>& poses = summary.singular_poses;
  ASSERT_GE(poses.size(), 4u);
  EXPECT_NEAR(poses[2].t - poses[0].t, poses[3].t - poses[1].t, 1e-6);
  for (const SingularPose& pose : poses) EXPECT_EQ(pose.mobility, 3);
}

TEST(SingularPosesTest, AMotionWithoutSingularPosesHasNone) {
  const RunSummary summary = run(witness::make_bricard(witness::BricardRods::kBricks), 1, 1e-8);
  EXPECT_EQ(summary.status, RunStatus::kFinished) << summary.message;
  EXPECT_GT(summary.steps, 5);
  EXPECT_TRUE(summary.singular_poses.empty());
}

}  // namespace
}  // namespace ferrers
