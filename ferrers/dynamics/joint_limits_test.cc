#include "ferrers/dynamics/joint_limits.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/zoo.h"

namespace ferrers::witness {
namespace {

/// A link that swings as q(t) = sin t about its hinge, limited to `low` … `high`, seen every `every` seconds.
std::vector<LimitCrossing> crossings_of_a_swing(double low, double high, double every, double end) {
  ModelSpec spec = make_pendulum();
  spec.joints[0].limits = {Number(low), Number(high)};
  EngineProbe engine(spec);
  LimitWatch watch(engine.dynamics);
  EXPECT_TRUE(watch.any());
  State state = make_drawn_state(*engine.system);
  for (int i = 0; i * every <= end; ++i) {
    state.t = i * every;
    state.q[0] = std::sin(state.t);
    state.v[0] = std::cos(state.t);
    compute_kinematics(*engine.dynamics, state, engine.eq);
    watch.observe(state, engine.eq.pos, engine.eq.vel);
  }
  return watch.crossings();
}

TEST(LimitWatchTest, ACrossingIsTimedBetweenStates) {
  const auto found = crossings_of_a_swing(-2, 0.8, 0.05, 3);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(found[0].upper);
  EXPECT_EQ(found[0].times, 1);
  EXPECT_NEAR(found[0].t, std::asin(0.8), 1e-7);
  EXPECT_NEAR(found[0].excess, 0.2, 1e-7);
  EXPECT_NEAR(found[0].excess_t, std::numbers::pi / 2, 1e-4);  // between two states
}

TEST(LimitWatchTest, BothLimitsAndTheirRepetitionsAreCounted) {
  const auto found = crossings_of_a_swing(-0.5, 0.5, 0.02, 20);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_FALSE(found[0].upper);
  EXPECT_EQ(found[0].times, 3);
  EXPECT_EQ(found[1].times, 4);
  EXPECT_NE(describe(found[1]).find("upper"), std::string::npos);
}

TEST(LimitWatchTest, AJointThatStartsBeyondIsToldAtItsFirstState) {
  const auto found = crossings_of_a_swing(0.1, 2, 0.05, 1);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_FALSE(found[0].upper);
  EXPECT_EQ(found[0].t, 0);
  EXPECT_NEAR(found[0].excess, 0.1, 1e-11);
}

TEST(LimitWatchTest, WhatStaysWithinOrRestsOnALimitIsNotTold) {
  EXPECT_TRUE(crossings_of_a_swing(-1.1, 1.1, 0.05, 10).empty());
  EXPECT_TRUE(crossings_of_a_swing(0, 2, 0.05, 1).empty());
}

}  // namespace
}  // namespace ferrers::witness
