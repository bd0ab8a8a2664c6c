#include <gtest/gtest.h>

#include "ferrers/dynamics/equilibrium.h"
#include "ferrers/dynamics/holding.h"
#include "ferrers/dynamics/linearization.h"
#include "ferrers/testing/run_probe.h"
#include "ferrers/testing/zoo_parts.h"

/// Mechanisms without a single coordinate: every question has an answer, and the joints carry their weight.
namespace ferrers::witness {
namespace {

constexpr double kMass = 2.5, kGravity = 9.81;

// A bracket on one weld, on two (six redundant rows, no columns), and with a drive that has nothing to move.
ModelSpec bracket(int welds, bool with_drive) {
  ModelSpec spec;
  spec.name = "bracket";
  spec.gravity = number3(0, 0, -kGravity);
  spec.bodies = {box_body("bracket", {0.5, 0, 0}, {1, 0.1, 0.2}, kMass)};
  for (int i = 0; i < welds; ++i) {
    spec.joints.push_back(joint(JointType::kWeld, numbered("weld", i), "ground", "bracket", {1.0 * i, 0, 0}));
  }
  if (with_drive) {
    DriveSpec ram;
    ram.name = "ram";
    ram.bodies = {NameRef("ground"), NameRef("bracket")};
    ram.points = {number3(0, 0, -1), number3(0.5, 0, 0)};
    spec.drives = {ram};
  }
  return spec;
}

class ImmovableTest : public ::testing::TestWithParam<std::tuple<int, bool>> {
 protected:
  ModelSpec spec_ = bracket(std::get<0>(GetParam()), std::get<1>(GetParam()));
  bool unique_ = std::get<0>(GetParam()) == 1 && !std::get<1>(GetParam());

  void expect_reactions(const std::vector<JointReaction>& reactions) const {
    double carried = 0;
    for (const JointReaction& one : reactions) carried += one.value[2];
    const bool with_drive = std::get<1>(GetParam());
    EXPECT_TRUE(with_drive || std::abs(carried - kMass * kGravity) < 1e-12) << carried;
    EXPECT_EQ(reactions[0].status[2] == ReactionStatus::kUnique, unique_);
  }
};

TEST_P(ImmovableTest, EveryFormulationSimulatesIt) {
  for (const Formulation formulation : kFormulations) {
    SCOPED_TRACE(to_string(formulation));
    SimulationOptions options = plain_run(0.1, 0.05);
    options.with_reactions = true;
    options.formulation = formulation;
    const ProbedRun run = probe_run(spec_, options);
    EXPECT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
    ASSERT_EQ(run.samples.size(), 3u);
    EXPECT_EQ(run.samples.back().reactions.size(), spec_.joints.size());
  }
}

TEST_P(ImmovableTest, InverseDynamicsAndKinematicsGoThroughTheirInstants) {
  const EngineProbe probe(spec_);
  for (const bool with_efforts : {true, false}) {
    PrescribedOptions options;
    options.grid = {0.1, 0.05};
    options.with_efforts = with_efforts;
    const RunSummary summary = run_prescribed(probe.dynamics, options, {});
    EXPECT_EQ(summary.status, RunStatus::kFinished) << summary.message;
    EXPECT_EQ(summary.steps, 3);
  }
}

TEST_P(ImmovableTest, ItIsAtRestAndHeldAndHasNoModes) {
  const EngineProbe probe(spec_);
  const EquilibriumResult rest = solve_equilibrium(*probe.dynamics, probe.start());
  EXPECT_EQ(rest.status, EquilibriumStatus::kFound) << rest.message;
  const HoldingResult held = solve_holding_efforts(*probe.dynamics, probe.start());
  EXPECT_EQ(held.status, HoldingStatus::kHeld) << held.message;
  expect_reactions(compute_rest_reactions(probe.dynamics, held, ReactionAxes::kWorld, {}));
  const Linearization linear = linearize(*probe.dynamics, probe.start());
  EXPECT_EQ(linear.status, LinearizationStatus::kDone) << linear.message;
  EXPECT_TRUE(linear.modal.modes.empty());
}

INSTANTIATE_TEST_SUITE_P(Brackets, ImmovableTest, ::testing::Combine(::testing::Values(1, 2), ::testing::Bool()));

}  // namespace
}  // namespace ferrers::witness
