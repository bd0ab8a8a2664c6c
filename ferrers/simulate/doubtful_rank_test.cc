#include <gtest/gtest.h>

#include <algorithm>

#include "ferrers/dynamics/equilibrium.h"
#include "ferrers/dynamics/holding.h"
#include "ferrers/dynamics/linearization.h"
#include "ferrers/testing/run_probe.h"
#include "ferrers/testing/zoo_parts.h"

/// Whichever verb takes the decision: where it is in doubt, that is said, and in the same words.
namespace ferrers::witness {
namespace {

constexpr const char* kDoubt = "the rank at t = 0.000000 s is in doubt: 2 or 3";

// A disc on two spherical joints turns about their line; a rod from a point 1e-8 m beside that line hardly hinders it.
ModelSpec hardly_hindered() {
  ModelSpec spec;
  spec.name = "hardly_hindered";
  spec.gravity = number3(0, 0, -9.81);
  spec.bodies = {box_body("disc", {0.5, 0, 0}, {1, 0.1, 0.1}, 10)};
  spec.joints = {joint(JointType::kSpherical, "a", "ground", "disc", {0, 0, 0}),
                 joint(JointType::kSpherical, "b", "ground", "disc", {0, 0, 1}),
                 distance_joint("c", "ground", "disc", {0, 1e-8, 2}, {1, 0, 0.5})};
  return spec;
}

int count(const std::vector<std::string>& notices) {
  return static_cast<int>(std::count(notices.begin(), notices.end(), kDoubt));
}

TEST(DoubtfulRankTest, EveryVerbThatDecidesSaysSo) {
  const EngineProbe probe(hardly_hindered());
  const State start = probe.start();
  EXPECT_EQ(count(solve_equilibrium(*probe.dynamics, start).notices), 1);
  EXPECT_EQ(count(linearize(*probe.dynamics, start).notices), 1);
  const HoldingResult held = solve_holding_efforts(*probe.dynamics, start);
  EXPECT_EQ(count(held.notices), 1);
  EXPECT_FALSE(held.confident);
  EXPECT_EQ(count(run_prescribed(probe.dynamics, {}, {}).notices), 1);
  EXPECT_EQ(count(probe_run(hardly_hindered(), plain_run(0.01, 0.01)).summary.notices), 1);
}

TEST(DoubtfulRankTest, AClearRankNeedsNoWords) {
  ModelSpec spec = hardly_hindered();
  spec.joints.pop_back();
  const EngineProbe probe(spec);
  const State start = probe.start();
  EXPECT_TRUE(solve_equilibrium(*probe.dynamics, start).notices.empty());
  EXPECT_TRUE(linearize(*probe.dynamics, start).notices.empty());
  EXPECT_TRUE(solve_holding_efforts(*probe.dynamics, start).notices.empty());
  EXPECT_TRUE(run_prescribed(probe.dynamics, {}, {}).notices.empty());
}

}  // namespace
}  // namespace ferrers::witness
