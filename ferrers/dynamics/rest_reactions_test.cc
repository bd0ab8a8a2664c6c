#include "ferrers/dynamics/rest_reactions.h"

#include <gtest/gtest.h>

#include "ferrers/dynamics/holding.h"
#include "ferrers/dynamics/inverse.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers {
namespace {

using namespace witness;  // NOLINT(google-build-using-namespace)

// Two cranks of a parallelogram that turn alike, each with a motor; at rest they hold what they move with in motion.
ModelSpec two_motors(double weight) {
  ModelSpec spec = make_n_four_bar(1, 0.4);
  spec.drives = {coordinate_drive("left_motor", "foot0", "0*t"), coordinate_drive("right_motor", "foot1", "0*t")};
  spec.drives[1].weight = Number(weight);
  return spec;
}

TEST(RestReactionsTest, HoldingMarksWhatDependsOnTheSharingOfTheEffortsAsInverseDynamicsDoes) {
  const EngineProbe probe(two_motors(2));
  const HoldingResult held = solve_holding_efforts(*probe.dynamics, probe.start());
  ASSERT_EQ(held.status, HoldingStatus::kHeld) << held.message;
  const auto at_rest = compute_rest_reactions(probe.dynamics, held, ReactionAxes::kWorld, {});
  PrescribedMotion motion(probe.dynamics, probe.start());
  const PrescribedResult moved = motion.solve(0);
  ASSERT_EQ(moved.status, PrescribedStatus::kSolved) << moved.message;
  EXPECT_LT((held.u - moved.u).norm(), 1e-11 * moved.u.norm());
  const auto wanted =
      ReactionSolver(probe.dynamics)
          .solve(moved.state, motion.equations(), motion.selection(), moved.vdot, moved.lambda, moved.u);
  int distributed = 0;
  for (std::size_t j = 0; j < wanted.size(); ++j) {
    for (int k = 0; k < 6; ++k) {
      EXPECT_EQ(at_rest[j].status[k], wanted[j].status[k]) << j << " " << k;
      distributed += wanted[j].status[k] == ReactionStatus::kDistributed ? 1 : 0;
    }
  }
  EXPECT_GT(distributed, 0);
}

TEST(RestReactionsTest, IdleEffortsMoveNothingAndAreBalancedByTheirMultipliers) {
  const EngineProbe probe(two_motors(1));
  const HoldingResult held = solve_holding_efforts(*probe.dynamics, probe.start());
  Equations eq = make_equations(*probe.dynamics);
  compute_equations(*probe.dynamics, held.state, eq);
  ASSERT_EQ(held.idle_efforts.cols(), 1);
  EXPECT_GT(held.idle_efforts.norm(), 0.1);
  const MatrixXd left =
      eq.B_transposed.transpose() * held.idle_efforts + eq.constraints.G.transpose() * held.idle_lambda;
  EXPECT_LT(left.norm(), 1e-12);
}

}  // namespace
}  // namespace ferrers
