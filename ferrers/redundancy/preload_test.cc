#include "ferrers/redundancy/preload.h"

#include <gtest/gtest.h>

#include <cmath>

#include "ferrers/testing/compare.h"
#include "ferrers/testing/elastic_joints.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {
namespace {

constexpr double kLength = 0.8, kTranslation = 3e6, kRotation = 5e4;

/// A rigid bar along x between two welds to ground; no mass anywhere.
ModelSpec make_clamped_bar(double k_t, double k_r) {
  ModelSpec spec;
  spec.name = "clamped-bar";
  BodySpec bar;
  bar.name = "bar";
  spec.bodies = {bar};
  spec.joints = {joint(JointType::kWeld, "left", "ground", "bar", {0, 0, 0}),
                 joint(JointType::kWeld, "right", "ground", "bar", {kLength, 0, 0})};
  for (JointSpec& j : spec.joints) set_stiffness(j, k_t, k_r);
  return spec;
}

PreloadReport preload_of(const ModelSpec& spec, const VectorXd& residual = {}) {
  const EngineProbe engine(spec);
  const State state = make_drawn_state(*engine.system);
  return analyze_preload(*engine.system, state, analyze_redundancy(*engine.system, state), residual);
}

// Two springs in series take the gap: on the bar at the seat that is off, −k/2 δ, and the opposite at the other.
TEST(PreloadTest, AGapAlongABarStretchesBothSeats) {
  ModelSpec spec = make_clamped_bar(kTranslation, kRotation);
  const double gap = 2e-4;
  set_misalignment(joint_of(spec, "right"), number3(gap, 0, 0), number3(0, 0, 0));
  const PreloadReport report = preload_of(spec);
  EXPECT_EQ(report.status, PreloadStatus::kSolved);
  EXPECT_TRUE(report.confident);
  EXPECT_NEAR(report.joints[1].value[0] / (-0.5 * kTranslation * gap), 1, 1e-12);
  EXPECT_NEAR(report.joints[0].value[0] / (0.5 * kTranslation * gap), 1, 1e-12);
  for (const JointPreload& joint : report.joints) {
    for (int k = 0; k < 6; ++k) {
      EXPECT_EQ(joint.status[k], ReactionStatus::kDistributed);
      if (k > 0) {
        EXPECT_NEAR(joint.value[k], 0, 1e-10);
      }
    }
  }
}

// The bar turns by θ = −k_t d L / (k_t L² + 4 k_r) where its two ends pull across and its two seats resist turning
// (least energy, by hand); the seat that is off by d then pulls with −(k_t/2)(d + θ L).
TEST(PreloadTest, AnOffsetAcrossABarBendsBothSeats) {
  ModelSpec spec = make_clamped_bar(kTranslation, kRotation);
  const double d = 1e-4;
  set_misalignment(joint_of(spec, "right"), number3(0, d, 0), number3(0, 0, 0));
  const PreloadReport report = preload_of(spec);
  const double turn = -kTranslation * d * kLength / (kTranslation * kLength * kLength + 4 * kRotation);
  const double across = -0.5 * kTranslation * (d + turn * kLength);
  EXPECT_NEAR(report.joints[1].value[1] / across, 1, 1e-11);
  EXPECT_NEAR(report.joints[0].value[1] / across, -1, 1e-11);
  EXPECT_NEAR(report.joints[1].value[5] / (-kRotation * turn), 1, 1e-11);
  EXPECT_NEAR(report.joints[0].value[5] / (-kRotation * turn), 1, 1e-11);
}

// Held on one side by a rigid seat: the second body is loaded with −K δ.
TEST(PreloadTest, AStiffJointBetweenHeldBodiesLoadsTheSecondAgainstItsMisalignment) {
  ModelSpec spec = make_clamped_bar(kTranslation, kRotation);
  joint_of(spec, "left").stiffness.reset();
  set_misalignment(joint_of(spec, "right"), number3(1e-4, -2e-4, 3e-4), number3(1e-3, 2e-3, -1e-3));
  const PreloadReport report = preload_of(spec);
  const double wanted[6] = {-kTranslation * 1e-4, kTranslation * 2e-4, -kTranslation * 3e-4,
                            -kRotation * 1e-3,    -kRotation * 2e-3,   kRotation * 1e-3};
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(report.joints[1].value[k] / wanted[k], 1, 1e-11) << k;
}

TEST(PreloadTest, RigidJointsCannotBeAssembledWithMisalignment) {
  ModelSpec spec = make_clamped_bar(kTranslation, kRotation);
  for (JointSpec& j : spec.joints)
    set_stiffness(j, number3(kRigid, kTranslation, kTranslation), number3(kRigid, kRotation, kRotation));
  set_misalignment(joint_of(spec, "right"), number3(1e-4, 0, 0), number3(0, 0, 0));
  const PreloadReport report = preload_of(spec);
  EXPECT_EQ(report.status, PreloadStatus::kContradictory);
  EXPECT_EQ(report.contradictory, (std::vector<std::string>{"left", "right"}));
  for (const JointPreload& joint : report.joints) {
    for (int k = 0; k < 6; ++k) {
      EXPECT_EQ(joint.status[k], ReactionStatus::kUndetermined);
      EXPECT_EQ(joint.value[k], 0);
    }
  }
  set_misalignment(joint_of(spec, "right"), number3(0, 1e-4, 0), number3(0, 0, 0));
  EXPECT_EQ(preload_of(spec).status, PreloadStatus::kSolved) << "across, the joints give way";
}

TEST(PreloadTest, AContradictionLeavesOtherLoopsTheirValues) {
  ModelSpec spec = make_clamped_bar(kTranslation, kRotation);
  const ModelSpec other = make_clamped_bar(kRigid, kRigid);
  spec.bodies.push_back(other.bodies[0]);
  spec.bodies.back().name = "rigid_bar";
  for (JointSpec joint : other.joints) {
    joint.name = "rigid_" + joint.name.name;
    joint.bodies[1] = NameRef("rigid_bar");
    spec.joints.push_back(joint);
  }
  const double gap = 2e-4;
  set_misalignment(joint_of(spec, "right"), number3(gap, 0, 0), number3(0, 0, 0));
  set_misalignment(joint_of(spec, "rigid_left"), number3(gap, 0, 0), number3(0, 0, 0));
  const PreloadReport report = preload_of(spec);
  EXPECT_EQ(report.status, PreloadStatus::kContradictory);
  EXPECT_EQ(report.contradictory, (std::vector<std::string>{"rigid_left", "rigid_right"}));
  EXPECT_EQ(report.joints[1].status[0], ReactionStatus::kDistributed);
  EXPECT_NEAR(report.joints[1].value[0] / (-0.5 * kTranslation * gap), 1, 1e-12);
  EXPECT_EQ(report.joints[2].status[0], ReactionStatus::kUndetermined);
}

TEST(PreloadTest, WithoutRedundancyMisalignmentLoadsNothing) {
  ModelSpec spec = make_four_bar(FourBarJoints::kSphericalCylindrical);
  set_misalignment(spec.joints[0], number3(1e-3, 1e-3, 1e-3), number3(1e-3, 0, 0));
  const PreloadReport report = preload_of(spec);
  EXPECT_EQ(report.status, PreloadStatus::kSolved);
  for (const JointPreload& joint : report.joints) {
    for (int k = 0; k < 6; ++k) {
      EXPECT_EQ(joint.status[k], ReactionStatus::kUnique);
      EXPECT_EQ(joint.value[k], 0);
    }
  }
}

// What a loop fails to close by acts like a misalignment of the joint that was cut.
TEST(PreloadTest, ALoopThatDoesNotCloseIsClosedElastically) {
  const ModelSpec spec = make_clamped_bar(kTranslation, kRotation);
  const EngineProbe engine(spec);
  ASSERT_EQ(engine.system->cuts.size(), 1u);
  const std::string cut = engine.system->joint(engine.system->cuts[0]).name;
  VectorXd residual(6);
  for (int r = 0; r < 6; ++r) residual[r] = engine.system->row_names[r] == cut + "/force_x" ? 2e-4 : 0;
  ModelSpec misaligned = spec;
  set_misalignment(joint_of(misaligned, cut), number3(2e-4, 0, 0), number3(0, 0, 0));
  const PreloadReport open = preload_of(spec, residual), wanted = preload_of(misaligned);
  ASSERT_EQ(open.status, PreloadStatus::kSolved);
  for (std::size_t j = 0; j < 2; ++j) {
    for (int k = 0; k < 6; ++k) EXPECT_NEAR(open.joints[j].value[k], wanted.joints[j].value[k], 1e-9);
  }
  EXPECT_GT(std::abs(open.joints[0].value[0]), 100);
  ModelSpec rigid = spec;
  for (JointSpec& j : rigid.joints) j.stiffness.reset();
  EXPECT_EQ(preload_of(rigid, residual).status, PreloadStatus::kContradictory);
  EXPECT_EQ(preload_of(rigid).status, PreloadStatus::kNone);
  EXPECT_EQ(preload_of(spec).status, PreloadStatus::kNone) << "elastic, but nothing is out of line";
}

}  // namespace
}  // namespace ferrers::witness
