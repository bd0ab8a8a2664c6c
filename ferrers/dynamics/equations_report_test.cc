#include "ferrers/dynamics/equations_report.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ferrers/dynamics/paper_steps.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/random_mechanism.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers {
namespace {

using namespace witness;  // NOLINT(google-build-using-namespace)
using testing::HasSubstr;

constexpr double kGravity = 9.81;

// The driven four-bar as drawn, by hand: crank O-A along x, coupler A-C upright, rocker B-C. A crank rate ω turns
// coupler and rocker by −ω/3, so that the motion has the inertia 1/3 + 2·10/9 + 2/27 + 52/27 = 41/9 kg·m² and lifts
// the weights at (1/2 + 2 + 4/2) ω = 4.5 ω kg·m/s.
constexpr double kInertia = 41.0 / 9, kLift = 4.5;

EquationsReport at_start(const ModelSpec& spec, EquationsProblem problem = EquationsProblem::kForward) {
  const EngineProbe probe(spec);
  return analyze_equations(probe.dynamics, probe.start(), problem);
}

double value_of(const EquationsReport& report, const VectorXd& values, const std::string& coordinate) {
  const auto at = std::find(report.coordinate_names.begin(), report.coordinate_names.end(), coordinate);
  EXPECT_NE(at, report.coordinate_names.end()) << coordinate;
  return values[at - report.coordinate_names.begin()];
}

void expect_satisfied(const EquationsReport& report) {
  ASSERT_EQ(report.residuals.size(), 4u);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(report.residuals[i].equation, 6 + i);
    EXPECT_LT(report.residuals[i].relative(), 1e-12) << "(" << 6 + i << ") at " << report.residuals[i].at;
  }
}

TEST(EquationsReportTest, APendulumHasTheOneEquationOfItsClosedForm) {
  const double length = 1.5, mass = 2, angle = 0.6;
  ModelSpec spec;
  spec.name = "pendulum";
  spec.gravity = number3(0, -kGravity, 0);
  spec.bodies = {rod_body("rod", Point::Zero(), length * Point(std::cos(angle), std::sin(angle), 0), mass)};
  spec.joints = {joint(JointType::kRevolute, "pivot", "ground", "rod", Point::Zero())};
  const EquationsReport report = at_start(spec);
  ASSERT_TRUE(report.solved()) << report.message;
  EXPECT_EQ(report.n, 1);
  EXPECT_EQ(report.m, 0);
  EXPECT_EQ(report.r, 0);
  EXPECT_EQ(report.w, 1);
  EXPECT_EQ(report.equation_count(), 1);
  EXPECT_NEAR(report.equations.M(0, 0), mass * length * length / 3, 1e-14);
  EXPECT_NEAR(report.equations.h[0], mass * kGravity * length / 2 * std::cos(angle), 1e-13);
  EXPECT_NEAR(report.vdot[0], -1.5 * kGravity / length * std::cos(angle), 1e-13);
  EXPECT_THAT(report.position_names, testing::ElementsAre("pivot"));
  EXPECT_THAT(report.coordinate_units, testing::ElementsAre("rad"));
  expect_satisfied(report);
}

TEST(EquationsReportTest, AFourBarThatIsLetGoFallsAsByHand) {
  const EquationsReport report = at_start(make_driven_four_bar());
  ASSERT_TRUE(report.solved()) << report.message;
  EXPECT_EQ(report.n, 3);
  EXPECT_EQ(report.m, 5);
  EXPECT_EQ(report.r, 2);
  EXPECT_EQ(report.w, 1);
  EXPECT_EQ(report.equation_count(), 9);
  EXPECT_TRUE(report.decision.confident);
  EXPECT_EQ(report.excluded_rows.size(), 3u);
  EXPECT_NEAR(value_of(report, report.vdot, "O"), -kLift * kGravity / kInertia, 1e-12);
  EXPECT_EQ(report.u, VectorXd::Zero(1));
  EXPECT_FALSE(report.effort_is_found[0]);
  expect_satisfied(report);
}

TEST(EquationsReportTest, TheInverseProblemFindsTheTorqueByHand) {
  const EquationsReport report = at_start(make_driven_four_bar(), EquationsProblem::kInverse);
  ASSERT_TRUE(report.solved()) << report.message;
  const double acceleration = 4.8;  // of 1.2 (1 − cos 2t)
  EXPECT_NEAR(value_of(report, report.vdot, "O"), acceleration, 1e-12);
  EXPECT_NEAR(report.u[0], kInertia * acceleration + kLift * kGravity, 1e-11);
  EXPECT_TRUE(report.effort_is_found[0]);
  EXPECT_FALSE(report.effort_is_shared[0]);
  expect_satisfied(report);
}

// Spatial hinges in a plane: what lies in the plane is determined, what stands out of it is not.
TEST(EquationsReportTest, OnlyMultipliersThatNoSelfStressTouchesAreUnique) {
  for (const auto problem : {EquationsProblem::kForward, EquationsProblem::kInverse}) {
    const EquationsReport report = at_start(make_driven_four_bar(), problem);
    ASSERT_EQ(report.lambda_status.size(), 5u);
    for (int i = 0; i < report.m; ++i) {
      const std::string& row = report.row_names[i];
      const bool in_plane = row.ends_with("/force_x") || row.ends_with("/force_y");
      EXPECT_EQ(report.lambda_status[i], in_plane ? ReactionStatus::kUnique : ReactionStatus::kUndetermined) << row;
    }
    for (const int row : report.excluded_rows) EXPECT_EQ(report.lambda_of_kept_rows[row], 0) << report.row_names[row];
  }
}

TEST(EquationsReportTest, AThirdCrankLeavesNoMultiplierDeterminedInTheAxesOfTheDrawing) {
  const EquationsReport report = at_start(make_parallel_cranks());
  EXPECT_EQ(report.m - report.r, 7);
  for (const ReactionStatus status : report.lambda_status) EXPECT_EQ(status, ReactionStatus::kUndetermined);
  expect_satisfied(report);
}

TEST(EquationsReportTest, RandomMechanismsSatisfyTheirEquations) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    EngineProbe probe(make_random_mechanism(seed).spec);
    const State state = probe.wandered(seed);
    const EquationsReport report = analyze_equations(probe.dynamics, state);
    if (report.status == EquationsStatus::kSingularMass) continue;
    ASSERT_TRUE(report.solved()) << report.message;
    ASSERT_EQ(report.residuals.size(), 4u);
    for (const EquationResidual& one : report.residuals) {
      EXPECT_LT(one.relative(), 1e-8) << "(" << one.equation << ") at " << one.at;
    }
    EXPECT_EQ(static_cast<int>(report.position_names.size()), probe.system->nq);
    for (const std::string& name : report.position_names) EXPECT_FALSE(name.empty());
  }
}

// Efforts that the inverse problem finds, given as laws, are answered with the motion that it was found for.
TEST(EquationsReportTest, TheTwoProblemsAreEachOthersInverse) {
  ModelSpec spec = make_driven_four_bar();
  const EngineProbe driven(spec);
  State start = driven.start();
  start.t = 0.4;
  const EquationsReport asked = analyze_equations(driven.dynamics, start, EquationsProblem::kInverse);
  ASSERT_TRUE(asked.solved()) << asked.message;
  spec.drives = {coordinate_drive("motor", "O", "", fmt::format("{:.17g}", asked.u[0]))};
  const EngineProbe forced(spec);
  const EquationsReport answered = analyze_equations(forced.dynamics, asked.state);
  ASSERT_TRUE(answered.solved()) << answered.message;
  EXPECT_GT(std::abs(asked.u[0]), 1);
  EXPECT_LT((answered.vdot - asked.vdot).cwiseAbs().maxCoeff(), 1e-11);
  for (int i = 0; i < asked.m; ++i) {
    if (asked.lambda_status[i] != ReactionStatus::kUnique) continue;
    EXPECT_NEAR(answered.lambda_of_kept_rows[i], asked.lambda_of_kept_rows[i], 1e-9) << asked.row_names[i];
  }
}

TEST(EquationsReportTest, WhatDrivesShareIsToldAsShared) {
  ModelSpec spec = make_driven_four_bar();
  spec.drives.push_back(coordinate_drive("helper", "B", ""));
  const EquationsReport report = at_start(spec, EquationsProblem::kInverse);
  ASSERT_TRUE(report.solved()) << report.message;
  EXPECT_TRUE(report.effort_is_shared[0]);
  EXPECT_TRUE(report.effort_is_shared[1]);
  const auto count = [&](ReactionStatus status) {
    return std::count(report.lambda_status.begin(), report.lambda_status.end(), status);
  };
  EXPECT_EQ(count(ReactionStatus::kUndetermined), 3);
  EXPECT_GT(count(ReactionStatus::kDistributed), 0);
  // Virtual power: the rocker turns at −1/3 of the crank's rate.
  EXPECT_NEAR(report.u[0] - report.u[1] / 3, kInertia * 4.8 + kLift * kGravity, 1e-11);
  expect_satisfied(report);
}

TEST(EquationsReportTest, ResidualsTellHowFarAndWhereTheEquationsFail) {
  const EngineProbe probe(make_driven_four_bar());
  State state = probe.start();
  EquationsReport report = analyze_equations(probe.dynamics, state);
  VectorXd v = VectorXd::Zero(3), vdot = report.vdot;
  const int crank = static_cast<int>(std::find(report.coordinate_names.begin(), report.coordinate_names.end(), "O") -
                                     report.coordinate_names.begin());
  v[crank] = 1;  // the crank alone: what hangs on it moves along, the loop opens
  vdot[crank] += 0.5;
  const auto left = measure_residuals(*probe.dynamics, report.equations, v, vdot, report.lambda_of_kept_rows, report.u);
  const RowMatrixXd& G = report.equations.constraints.G;
  EXPECT_NEAR(left[1].largest, G.col(crank).cwiseAbs().maxCoeff(), 1e-12);  // only force rows in the plane feel it
  EXPECT_NEAR(left[2].largest, 0.5 * left[1].largest, 1e-12);
  const double length = report.characteristic_length_m;
  EXPECT_NEAR(left[3].largest, 0.5 * MatrixXd(report.equations.M).col(crank).cwiseAbs().maxCoeff() / length, 1e-12);
  EXPECT_THAT(left[1].at, HasSubstr("/force_"));
  // A row left out counts as well.
  ASSERT_FALSE(report.excluded_rows.empty());
  Equations open = report.equations;
  open.constraints.phi[report.excluded_rows[0]] = 0.25;
  const EquationResidual gap = measure_residuals(*probe.dynamics, open, v, {}, {}, {})[0];
  EXPECT_EQ(gap.at, report.row_names[report.excluded_rows[0]]);
  EXPECT_GE(gap.largest, 0.25);
  EXPECT_DOUBLE_EQ(gap.size, length);
}

// The legs' lines have rank for one motion at this pose, but no motion follows: accelerations cannot close all rows.
TEST(EquationsReportTest, ARankOfThisPoseOnlyShowsInTheRowsLeftOut) {
  EngineProbe probe(make_unequal_legs());
  State state = probe.start();
  EXPECT_TRUE(analyze_equations(probe.dynamics, state).notices.empty());
  probe.evaluate(state);
  for (const int i : probe.selection.independent) state.v[i] = 1;
  solve_dependent_velocities(*probe.dynamics, probe.selection, state);
  const EquationsReport report = analyze_equations(probe.dynamics, state);
  ASSERT_EQ(report.residuals.size(), 4u);
  EXPECT_LT(report.residuals[1].relative(), 1e-12);
  EXPECT_GT(report.residuals[2].relative(), 1e-2);
  const auto names = report.excluded_rows;
  EXPECT_TRUE(std::any_of(names.begin(), names.end(),
                          [&](int row) { return report.row_names[row] == report.residuals[2].at; }));
  ASSERT_EQ(report.notices.size(), 1u);
  EXPECT_THAT(report.notices[0], HasSubstr("(8) does not hold at"));
}

TEST(EquationsReportTest, WithoutAMotionTheInverseProblemSaysWhatMoves) {
  const EquationsReport report = at_start(make_four_bar(FourBarJoints::kRevolute), EquationsProblem::kInverse);
  EXPECT_EQ(report.status, EquationsStatus::kBadMotion);
  EXPECT_FALSE(report.has_equations);
  EXPECT_FALSE(report.message.empty());
}

TEST(EquationsReportTest, AMotionWithoutInertiaHasEquationsButNoSolution) {
  ModelSpec spec;
  spec.name = "weightless";
  spec.bodies = {rod_body("rod", Point::Zero(), Point(1, 0, 0), 0)};
  spec.joints = {joint(JointType::kRevolute, "pivot", "ground", "rod", Point::Zero())};
  const EquationsReport report = at_start(spec);
  EXPECT_EQ(report.status, EquationsStatus::kSingularMass);
  EXPECT_TRUE(report.has_equations);
  EXPECT_EQ(report.vdot.size(), 0);
  EXPECT_EQ(report.lambda_of_kept_rows.size(), 0);
  EXPECT_EQ(report.residuals.size(), 2u);
}

TEST(EquationsReportTest, GroundAloneHasNothingToSolve) {
  ModelSpec spec;
  spec.name = "welded";
  spec.bodies = {rod_body("rod", Point::Zero(), Point(1, 0, 0), 1)};
  spec.joints = {joint(JointType::kWeld, "weld", "ground", "rod", Point::Zero())};
  const EquationsReport report = at_start(spec);
  EXPECT_TRUE(report.solved()) << report.message;
  EXPECT_EQ(report.n + report.m + report.r + report.w, 0);
  expect_satisfied(report);
}

TEST(EquationsReportTest, ForeignStatesAreTheCallersBug) {
  const EngineProbe probe(make_driven_four_bar());
  EXPECT_THROW(analyze_equations(nullptr, probe.start()), std::invalid_argument);
  EXPECT_THROW(analyze_equations(probe.dynamics, State()), std::invalid_argument);
}

}  // namespace
}  // namespace ferrers
