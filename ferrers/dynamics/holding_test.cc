#include "ferrers/dynamics/holding.h"

#include <gtest/gtest.h>

#include <cmath>

#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers {
namespace {

using namespace witness;  // NOLINT(google-build-using-namespace)

constexpr double kGravity = 9.81;

HoldingResult hold(const ModelSpec& spec) {
  const EngineProbe probe(spec);
  return solve_holding_efforts(*probe.dynamics, probe.start());
}

TEST(HoldingTest, TheRamOfAScissorLiftPushesAsVirtualWorkSays) {
  for (const int stages : {1, 2, 4}) {
    ModelSpec spec = make_scissor_lift(stages);
    spec.drives = {coordinate_drive("ram", "bottom_track", "0")};
    const HoldingResult held = hold(spec);
    ASSERT_EQ(held.status, HoldingStatus::kHeld) << held.message;
    double weight = 2 * stages * 30.5;  // heights over sin θ, times masses
    for (int i = 1; i <= stages; ++i) weight += 8 * (2 * i - 1);
    // F dx + dV = 0 with x = 2 cos θ, V = g weight sin θ: F = g weight cos θ / (−2 sin θ) against the way in.
    const double wanted = -kGravity * weight * std::cos(0.5) / (2 * std::sin(0.5));
    EXPECT_NEAR(held.u[0], wanted, 1e-11 * std::abs(wanted)) << stages;
    EXPECT_TRUE(held.unique[0]);
    EXPECT_EQ(held.free_motions, 0);
  }
}

TEST(HoldingTest, TwoDrivesOnOneFreedomShareTheLoadInLeastNorm) {
  ModelSpec spec = make_scissor_lift(1);
  spec.drives = {coordinate_drive("ram", "bottom_track", "0")};
  const double alone = hold(spec).u[0];
  spec.drives.push_back(coordinate_drive("upper", "top_track", "0"));  // moves alike
  const HoldingResult held = hold(spec);
  ASSERT_EQ(held.status, HoldingStatus::kHeld);
  EXPECT_NEAR(held.u[0], alone / 2, 1e-9);
  EXPECT_NEAR(held.u[1], alone / 2, 1e-9);
  EXPECT_FALSE(held.unique[0]);
  EXPECT_FALSE(held.unique[1]);
  spec.drives[1].weight = Number(3.0);  // u_1 + u_2 = alone, u_1² + 9 u_2² least: 9 to 1
  const HoldingResult weighted = hold(spec);
  EXPECT_NEAR(weighted.u[0], 0.9 * alone, 1e-9);
  EXPECT_NEAR(weighted.u[1], 0.1 * alone, 1e-9);
}

ModelSpec arm() {
  ModelSpec spec;
  spec.name = "arm";
  spec.gravity = number3(0, -kGravity, 0);
  spec.bodies = {rod_body("upper", {0, 0, 0}, {1, 0, 0}, 2), rod_body("lower", {1, 0, 0}, {2, 0, 0}, 3)};
  spec.joints = {joint(JointType::kRevolute, "shoulder", "ground", "upper", {0, 0, 0}),
                 joint(JointType::kRevolute, "elbow", "upper", "lower", {1, 0, 0})};
  return spec;
}

TEST(HoldingTest, WhatNoDriveHoldsIsNamed) {
  ModelSpec spec = arm();
  spec.drives = {coordinate_drive("motor", "shoulder", "0")};
  const HoldingResult one = hold(spec);
  EXPECT_EQ(one.status, HoldingStatus::kNotHeld);
  EXPECT_EQ(one.free_motions, 1);
  EXPECT_NE(one.message.find("elbow.angle"), std::string::npos) << one.message;
  spec.drives.push_back(coordinate_drive("second", "elbow", "0"));
  const HoldingResult both = hold(spec);
  ASSERT_EQ(both.status, HoldingStatus::kHeld);
  EXPECT_NEAR(both.u[0], kGravity * (2 * 0.5 + 3 * 1.5), 1e-12);
  EXPECT_NEAR(both.u[1], kGravity * 3 * 0.5, 1e-12);
  spec.drives.clear();
  EXPECT_EQ(hold(spec).status, HoldingStatus::kNotHeld);
  spec.gravity = number3(0, 0, -kGravity);  // nothing to hold
  const HoldingResult idle = hold(spec);
  EXPECT_EQ(idle.status, HoldingStatus::kHeld);
  EXPECT_EQ(idle.free_motions, 2);
}

TEST(HoldingTest, DrivesWithAnEffortLawAloneActByItUnlessThereIsNoOther) {
  ModelSpec spec = arm();
  spec.drives = {coordinate_drive("motor", "shoulder", "0"), coordinate_drive("second", "elbow", "0")};
  spec.drives[1].motion.clear();
  spec.drives[1].effort = {law("14.715")};  // 9.81 · 3 · 0.5
  const HoldingResult held = hold(spec);
  EXPECT_EQ(held.status, HoldingStatus::kHeld) << held.message;
  EXPECT_EQ(held.holds, (std::vector<bool>{true, false}));
  EXPECT_NEAR(held.u[1], 14.715, 1e-12);
  spec.drives[0].motion.clear();
  spec.drives[0].effort = {law("1")};
  const HoldingResult all = hold(spec);
  EXPECT_EQ(all.holds, (std::vector<bool>{true, true}));
  EXPECT_NEAR(all.u[1], 14.715, 1e-12);
}

}  // namespace
}  // namespace ferrers
