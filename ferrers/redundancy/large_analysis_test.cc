#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "ferrers/kinematics/assembly.h"
#include "ferrers/redundancy/analysis.h"
#include "ferrers/redundancy/joint_jacobian.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_large.h"

namespace ferrers {
namespace {

struct Analysed {
  std::shared_ptr<const System> system;
  State state;
  RedundancyReport report;
};

Analysed analysed(ModelSpec spec) {
  Analysed out{make_system(*build_model(std::move(spec)).model), {}, {}};
  out.state = make_drawn_state(*out.system);
  out.report = analyze_redundancy(*out.system, out.state);
  return out;
}

// The rows left out are as many as they should be, and the others as independent as all of them.
void expect_selection_spans(const Analysed& a) {
  PositionKinematics pos = make_position_kinematics(*a.system);
  compute_positions(*a.system, a.state.q, pos);
  ConstraintKinematics c = make_constraint_kinematics(*a.system);
  compute_constraints(*a.system, a.state, pos, make_velocity_kinematics(*a.system), c);
  const Scaling& scaling = a.system->scaling;
  const MatrixXd G = scaling.rows.asDiagonal() * c.G * scaling.columns.asDiagonal();
  const Selection& s = a.report.selection;
  ASSERT_EQ(static_cast<int>(s.rows.size()), a.report.closure_rank);
  const Eigen::ColPivHouseholderQR<MatrixXd> kept(G(s.rows, s.dependent));
  EXPECT_GT(std::abs(kept.matrixQR()(a.report.closure_rank - 1, a.report.closure_rank - 1)), 1e-4);
}

void expect_self_stresses_balance(const Analysed& a) {
  const RedundancyReport& r = a.report;
  ASSERT_EQ(r.self_stresses.cols(), r.redundant);
  const MatrixXd G = compute_scaled_joint_jacobian(*a.system, a.state, r.rows, r.characteristic_length_m);
  const MatrixXd Z = r.rows.scale.cwiseInverse().asDiagonal() * MatrixXd(r.self_stresses);
  EXPECT_LT((G.transpose() * Z).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_EQ(Eigen::ColPivHouseholderQR<MatrixXd>(Z).rank(), r.redundant);
}

TEST(LargeAnalysisTest, ATangleOfAHundredLoopsHasTheRankOfAllJointsRows) {
  const auto check = [](const ModelSpec& spec) {
    const Analysed a = analysed(spec);
    SCOPED_TRACE(spec.name);
    const MatrixXd G =
        compute_scaled_joint_jacobian(*a.system, a.state, a.report.rows, a.report.characteristic_length_m);
    EXPECT_EQ(a.report.rank, Eigen::ColPivHouseholderQR<MatrixXd>(G).rank());
    EXPECT_TRUE(a.report.decision.confident);
    expect_selection_spans(a);
    expect_self_stresses_balance(a);
  };
  check(witness::make_ball_tangle(60, 100));
  check(witness::make_spherical_tangle(60, 100));
  check(witness::make_spherical_tangle(140, 100));
}

TEST(LargeAnalysisTest, EveryLoopOfALongRowOfFourBarsRepeatsThreeRowsOfItsOwn) {
  const int cells = 1000;
  const Analysed a = analysed(witness::make_n_four_bar(cells, 0.3));
  const RedundancyReport& r = a.report;
  EXPECT_EQ(r.mobility, 1);
  EXPECT_EQ(r.redundant, 3 * cells);
  EXPECT_EQ(r.rank, 6 * r.bodies - 1);
  EXPECT_TRUE(r.decision.confident);
  EXPECT_FALSE(r.exact_values);
  for (const SelfStress& stress : r.self_stress_places) {
    EXPECT_EQ(stress.closures.size(), 1U);
    EXPECT_LE(stress.joints.size(), 4U);
  }
  for (const ReactionUniqueness& reaction : r.reactions) EXPECT_EQ(reaction.unique_dimension, 2) << reaction.joint;
}

TEST(LargeAnalysisTest, LazyTongsOfTwoThousandBarsHaveTwoFreedoms) {
  const int cells = 1000;
  const Analysed a = analysed(witness::make_lazy_tongs(cells));
  EXPECT_EQ(a.report.mobility, 2);  // they open, and turn about their base
  EXPECT_EQ(a.report.redundant, 3 * (cells - 1));
  EXPECT_TRUE(a.report.decision.confident);
}

TEST(LargeAnalysisTest, LargeAndSmallMethodsAgreeOnTheSameRow) {
  for (const int cells : {10, 60, 80}) {  // the second is judged by singular values, the third is not
    const Analysed a = analysed(witness::make_n_four_bar(cells, 0.3));
    EXPECT_EQ(a.report.redundant, 3 * cells);
    EXPECT_EQ(a.report.exact_values, 2 * cells + 1 <= 128);
    expect_selection_spans(a);
    expect_self_stresses_balance(a);
  }
}

TEST(LargeAnalysisTest, ALongRowThatWasPushedApartCloses) {
  const auto system = make_system(*build_model(witness::make_n_four_bar(500, 0.3)).model);
  const Scaling& scaling = system->scaling;
  State state = make_drawn_state(*system);
  VectorXd push(system->nv);
  for (int v = 0; v < system->nv; ++v) push[v] = 0.05 * std::sin(1.3 * v);
  displace(*system, push, state.q);
  int iterations = 0;
  EXPECT_LT(close_loops(*system, scaling, {}, 60, state, iterations), closed_tolerance(scaling));
  EXPECT_LT(iterations, 20);
}

}  // namespace
}  // namespace ferrers
