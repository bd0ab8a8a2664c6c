#include "ferrers/testing/zoo.h"

#include <gtest/gtest.h>

#include <numbers>

#include "ferrers/testing/absolute_solver.h"

namespace ferrers::witness {
namespace {

Model built(const ModelSpec& spec) {
  ModelBuildResult result = build_model(spec);
  for (const Diagnostic& d : result.diagnostics.items()) {
    if (d.severity == Severity::kError) ADD_FAILURE() << spec.name << ": " << d.code << " " << d.message;
  }
  if (!result.model) throw std::runtime_error("no model " + spec.name);
  return *std::move(result.model);
}

/// `A4/moment_x ...`: what a failed count should be compared with.
std::string touched_rows(const Model& model, const AbsoluteVerdict& verdict) {
  const AbsoluteConstraints c = absolute_constraints(model, drawn_state(model));
  std::string text = "rows that a self-stress touches:";
  for (std::size_t i = 0; i < c.labels.size(); ++i) {
    if (!verdict.unique_rows[i]) text += " " + c.labels[i];
  }
  return text;
}

class ZooTest : public ::testing::TestWithParam<ZooEntry> {};

TEST_P(ZooTest, SingularValuesInAbsoluteCoordinatesGiveTheFigures) {
  const ZooEntry& entry = GetParam();
  const Model model = built(entry.spec);
  const AbsoluteState drawn = drawn_state(model);
  const AbsoluteVerdict verdict = analyze_absolute(model, drawn.poses);
  EXPECT_LT(absolute_residual(model, drawn.poses).norm(), 1e-12);
  EXPECT_EQ(verdict.bodies, entry.bodies);
  EXPECT_EQ(verdict.rows, entry.rows);
  EXPECT_EQ(verdict.rank, entry.rank) << verdict.singular_values.transpose();
  EXPECT_EQ(verdict.mobility, entry.mobility);
  EXPECT_EQ(verdict.redundant, entry.redundant);
  if (entry.unique) {
    EXPECT_EQ(verdict.unique, *entry.unique) << touched_rows(model, verdict);
  }
  if (entry.unique_dimension) {
    EXPECT_EQ(verdict.unique_dimension, *entry.unique_dimension);
  }
}

TEST_P(ZooTest, TheRankIsClearOfTheTolerance) {
  const Model model = built(GetParam().spec);
  const AbsoluteVerdict verdict = analyze_absolute(model, drawn_state(model).poses);
  const double largest = verdict.singular_values[0];
  EXPECT_GT(verdict.singular_values[verdict.rank - 1], 1e-4 * largest);
  if (verdict.rank < verdict.singular_values.size()) {
    EXPECT_LT(verdict.singular_values[verdict.rank], 1e-12 * largest);
  }
}

TEST_P(ZooTest, FiguresAreConsistent) {
  const ZooEntry& e = GetParam();
  EXPECT_EQ(e.rank + e.mobility, 6 * e.bodies);
  EXPECT_EQ(e.rows - e.rank, e.redundant);
  EXPECT_EQ(e.name, e.spec.name);
  EXPECT_EQ(static_cast<int>(e.spec.bodies.size()), e.bodies);
}

TEST_P(ZooTest, ConstraintsAgreeOnAnAcceleration) {
  const Model model = built(GetParam().spec);
  AbsoluteState state = drawn_state(model);
  for (std::size_t i = 1; i < state.twists.size(); ++i)
    state.twists[i] = Vector6d::LinSpaced(0.3, 1.7) * (1.0 + 0.1 * i);
  project_twists(model, state);
  const AbsoluteMotion motion = solve_absolute(model, state, applied_wrenches(model, state, 0));
  const bool singular_pose = GetParam().name == "n_four_bar2_horizontal" || GetParam().name == "sarrus_extended";
  if (!singular_pose) {
    EXPECT_LT(motion.inconsistency, 1e-9);
  }
  EXPECT_TRUE(motion.inertia_regular);
}

std::string test_name(const ::testing::TestParamInfo<ZooEntry>& info) { return info.param.name; }
INSTANTIATE_TEST_SUITE_P(Zoo, ZooTest, ::testing::ValuesIn(zoo()), test_name);

TEST(ZooFamiliesTest, EveryLoopOfAnNFourBarRepeatsThreeRowsAtAnyGenericPose) {
  for (const int loops : {1, 3, 5}) {
    for (const double angle : {-2.1, -0.7, 0.0, 1.2, 2.5}) {
      const Model model = built(make_n_four_bar(loops, angle));
      const AbsoluteVerdict verdict = analyze_absolute(model, drawn_state(model).poses);
      EXPECT_EQ(verdict.redundant, 3 * loops) << angle;
      EXPECT_EQ(verdict.mobility, 1) << angle;
    }
  }
}

TEST(ZooFamiliesTest, AHorizontalNFourBarGainsOneFreedomALoop) {
  for (const int loops : {1, 2, 4}) {
    const Model model = built(make_n_four_bar(loops, -std::numbers::pi / 2));
    EXPECT_EQ(analyze_absolute(model, drawn_state(model).poses).mobility, loops + 1);
  }
}

TEST(ZooFamiliesTest, EveryHingeBeyondTheFirstRepeatsFiveRows) {
  for (int hinges = 1; hinges <= 5; ++hinges) {
    const Model model = built(make_door(hinges));
    EXPECT_EQ(analyze_absolute(model, drawn_state(model).poses).redundant, 5 * (hinges - 1));
  }
}

TEST(ZooFamiliesTest, EveryPlanetBeyondTheFirstRepeatsOneRow) {
  for (int planets = 1; planets <= 5; ++planets) {
    const Model model = built(make_planetary(planets));
    EXPECT_EQ(analyze_absolute(model, drawn_state(model).poses).redundant, planets - 1);
  }
}

}  // namespace
}  // namespace ferrers::witness
