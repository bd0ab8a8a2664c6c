#include "ferrers/dynamics/free_motions.h"

#include <gtest/gtest.h>

#include "ferrers/math/rank.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {
namespace {

/// Free motions of a mechanism without drives, at its drawn pose.
FreeMotions free_motions(const ModelSpec& spec) {
  EngineProbe engine(spec);
  const State state = make_drawn_state(*engine.system);
  engine.evaluate(state);
  const MatrixXd G = engine.scaling.rows.asDiagonal() * engine.eq.constraints.G * engine.scaling.columns.asDiagonal();
  const MatrixXd free = G.rows() > 0 ? analyze_rank(G, 1.0).right_null
                                     : MatrixXd(MatrixXd::Identity(engine.system->nv, engine.system->nv));
  return find_free_motions(*engine.system, engine.scaling, state, engine.eq.pos, engine.eq.vel, free);
}

TEST(FreeMotionsTest, AChainOfTwoHingesMovesInBoth) {
  ModelSpec spec;
  spec.bodies = {box_body("a", {0.5, 0, 0}, {1, 0.1, 0.1}, 1), box_body("b", {1.5, 0, 0}, {1, 0.1, 0.1}, 1)};
  spec.joints = {joint(JointType::kRevolute, "first", "ground", "a", {0, 0, 0}),
                 joint(JointType::kRevolute, "second", "a", "b", {1, 0, 0})};
  const FreeMotions found = free_motions(spec);
  EXPECT_EQ(found.count, 2);
  EXPECT_EQ(found.moving.size(), 2U);
  EXPECT_EQ(found.to_drive.size(), 2U);
  EXPECT_NE(found.message.find("still moving: first second"), std::string::npos) << found.message;
  EXPECT_NE(found.message.find("would determine them"), std::string::npos) << found.message;
}

TEST(FreeMotionsTest, WhatTurnsInABallTakesDrivesOnPoints) {
  ModelSpec spec;
  spec.bodies = {box_body("a", {0.5, 0, 0}, {1, 0.1, 0.1}, 1)};
  spec.joints = {joint(JointType::kSpherical, "ball", "ground", "a", {0, 0, 0})};
  const FreeMotions found = free_motions(spec);
  EXPECT_EQ(found.count, 3);
  EXPECT_TRUE(found.moving.empty());
  EXPECT_TRUE(found.to_drive.empty());
  EXPECT_NE(found.message.find("ball.omega_x"), std::string::npos) << found.message;
  EXPECT_NE(found.message.find("drives on points"), std::string::npos) << found.message;
}

}  // namespace
}  // namespace ferrers::witness
