#include "ferrers/redundancy/mechanism_analysis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_large.h"

namespace ferrers {
namespace {

using testing::ElementsAre;

std::shared_ptr<const System> built(const ModelSpec& spec) { return make_system(*build_model(spec).model); }

// Bricard's loop at its start: one force with its moment runs round the whole loop, known exactly.
TEST(MechanismAnalysisTest, TheSelfStressOfBricardsLoopIsTheKnownWrench) {
  const auto system = built(witness::make_bricard(witness::BricardRods::kBricks));
  const MechanismAnalysis analysis = analyze_mechanism(*system);
  const RedundancyReport& report = *analysis.redundancy;
  ASSERT_EQ(report.self_stresses.cols(), 1);
  PositionKinematics pos = make_position_kinematics(*system);
  compute_positions(*system, analysis.closure.state.q, pos);
  const auto joints = compute_joint_frame_wrenches(*system, analysis.closure.state, pos);
  const MatrixXd Z = report.self_stresses;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    Wrench w = joints[j].T * Z.col(0).segment(report.rows.first[j], report.rows.count[j]);
    w.head<3>() += joints[j].p_M.cross(w.tail<3>());  // about the origin
    const double f = w[3];
    ASSERT_GT(std::abs(f), 0.01);
    EXPECT_LE((w.tail<3>() / f - Vector3d(1, 1, 1)).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LE((w.head<3>() / f - Vector3d(-1, 0, 1)).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(MechanismAnalysisTest, AllFiveQuestionsAreAnsweredForEveryMechanismOfTheZoo) {
  for (const witness::ZooEntry& entry : witness::zoo()) {
    SCOPED_TRACE(entry.name);
    const MechanismAnalysis a = analyze_mechanism(*built(entry.spec));
    ASSERT_TRUE(a.is_assembled());
    EXPECT_EQ(a.redundancy->redundant, entry.redundant);
    EXPECT_EQ(a.redundancy->mobility, entry.mobility);
    EXPECT_TRUE(a.redundancy->decision.confident);
    ASSERT_TRUE(a.permanence && a.preload && a.releases);
    EXPECT_EQ(a.permanence->kind == Permanence::kNone, entry.redundant == 0);
    EXPECT_EQ(a.preload->status, PreloadStatus::kNone);
    if (entry.redundant == 0) {
      EXPECT_TRUE(a.releases->releases.empty());
    } else if (entry.name == "planetary2") {
      // One mesh too many: no joint type lets a gear float in one radial direction only.
      EXPECT_TRUE(a.releases->releases.empty());
      EXPECT_FALSE(a.releases->note.empty());
    } else {
      EXPECT_FALSE(a.releases->releases.empty());
    }
  }
}

TEST(UniqueResultantsTest, WhatTwoHingesGiveToADoorTogetherIsExact) {
  const MechanismAnalysis a = analyze_mechanism(*built(witness::make_door(2)));
  ASSERT_EQ(a.resultants.size(), 1U);
  EXPECT_EQ(a.resultants.front().joints.size(), 2U);
  EXPECT_EQ(a.resultants.front().unique_dimension, 6);
}

TEST(UniqueResultantsTest, WhatThreeCranksGiveToTheirPlatformTogetherIsExact) {
  const MechanismAnalysis a = analyze_mechanism(*built(witness::make_parallel_cranks()));
  ASSERT_EQ(a.resultants.size(), 1U);
  EXPECT_THAT(a.resultants.front().joints, ElementsAre("tip1", "tip2", "tip3"));
  EXPECT_EQ(a.resultants.front().on_body, "platform");
  EXPECT_EQ(a.resultants.front().unique_dimension, 6);
}

TEST(UniqueResultantsTest, NothingIsSaidWhereEveryReactionIsExact) {
  EXPECT_TRUE(analyze_mechanism(*built(witness::make_shaft_determinate())).resultants.empty());
}

TEST(LargeMotionTest, ARowOfTwoHundredFourBarsIsKnownToMoveAndToStayRedundant) {
  const int cells = 200;
  const auto system = built(witness::make_n_four_bar(cells, 0.3));
  const State state = make_drawn_state(*system);
  const PermanenceReport p = analyze_permanence(*system, state, analyze_redundancy(*system, state));
  EXPECT_EQ(p.kind, Permanence::kPermanent);
  EXPECT_EQ(p.generic_redundant, 3 * cells);
  EXPECT_EQ(p.finite_mobility, 1);
  EXPECT_EQ(p.basis, FiniteMobilityBasis::kContinuation);
}

TEST(LargeMotionTest, SmallAndLargeMethodsAgree) {
  for (const ModelSpec& spec : {witness::make_n_four_bar(3, 0.3), witness::make_lazy_tongs(4),
                                witness::make_bricard(witness::BricardRods::kBricks), witness::make_scissor_lift(2)}) {
    const auto system = built(spec);
    const State state = make_drawn_state(*system);
    const RedundancyReport report = analyze_redundancy(*system, state);
    PermanenceOptions large;
    large.largest_cluster = 0;
    const PermanenceReport a = analyze_permanence(*system, state, report);
    const PermanenceReport b = analyze_permanence(*system, state, report, large);
    EXPECT_EQ(a.kind, b.kind) << spec.name;
    EXPECT_EQ(a.generic_redundant, b.generic_redundant) << spec.name;
    EXPECT_EQ(a.finite_mobility, b.finite_mobility) << spec.name;
  }
}

TEST(LargeMotionTest, AHorizontalRowIsSingularAndItsBranchesAreNotToldApart) {
  const auto system = built(witness::make_n_four_bar(3, 1.5707963267948966));
  const State state = make_drawn_state(*system);
  PermanenceOptions large;
  large.largest_cluster = 0;
  const PermanenceReport p = analyze_permanence(*system, state, analyze_redundancy(*system, state), large);
  EXPECT_FALSE(p.all_branches);
  EXPECT_FALSE(p.second_order_done);
}

}  // namespace
}  // namespace ferrers
