#include "ferrers/testing/random_mechanism.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <set>

#include "ferrers/testing/compare.h"
#include "ferrers/testing/random_source.h"
#include "ferrers/testing/transforms.h"
#include "ferrers/testing/zoo.h"

namespace ferrers::witness {
namespace {

constexpr int kSeeds = 120;

Model built(const ModelSpec& spec) { return build_model(spec).model.value(); }

TEST(RandomMechanismTest, ManyAreRedundantAllMoveAndNoneHasMoreThanFiveLoops) {
  int redundant = 0;
  std::set<JointType> types;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const RandomMechanism m = make_random_mechanism(seed);
    redundant += m.verdict.redundant > 0;
    EXPECT_GE(m.verdict.mobility, 1) << m.description;
    EXPECT_LE(m.loops, 5) << m.description;
    for (const JointSpec& joint : m.spec.joints) types.insert(joint.type);
  }
  EXPECT_GE(3 * redundant, kSeeds);
  EXPECT_LE(redundant, kSeeds - 10);  // some are not
  EXPECT_EQ(types.size(), 13u);       // every joint type
}

TEST(RandomMechanismTest, TheSameSeedGivesTheSameMechanism) {
  const RandomMechanism a = make_random_mechanism(7), b = make_random_mechanism(7);
  EXPECT_EQ(a.description, b.description);
  EXPECT_TRUE(matrices_near(a.verdict.singular_values, b.verdict.singular_values, 0));
  EXPECT_NE(a.spec.bodies[0].mass->value, make_random_mechanism(8).spec.bodies[0].mass->value);
}

TEST(RandomMechanismTest, RedundancyLastsAlongTheMotion) {
  for (int seed = 0; seed < 40; ++seed) {
    const RandomMechanism m = make_random_mechanism(seed);
    const Model model = built(m.spec);
    const AbsoluteState state = wandered(model, seed);
    EXPECT_LT(absolute_residual(model, state.poses).norm(), 1e-11) << m.description;
    const AbsoluteVerdict verdict = analyze_absolute(model, state.poses);
    EXPECT_EQ(verdict.redundant, m.verdict.redundant) << seed << ": " << m.description;
  }
}

/// What is physics of a model: singular values of the scaled Jacobian, unique dimensions, accelerations under gravity.
struct Physics {
  AbsoluteVerdict verdict;
  std::vector<Vector6d> accelerations;
  explicit Physics(const Model& model) : verdict(analyze_absolute(model, drawn_state(model).poses)) {
    const AbsoluteState state = drawn_state(model);
    accelerations = solve_absolute(model, state, applied_wrenches(model, state, 0)).accelerations;
  }
};

class TransformsTest : public ::testing::TestWithParam<int> {
 protected:
  ModelSpec spec() const {
    if (GetParam() < 20) return make_random_mechanism(GetParam()).spec;
    static const std::vector<ZooEntry> entries = zoo();
    return entries[(GetParam() - 20) % entries.size()].spec;
  }
};

TEST_P(TransformsTest, AResultTurnsWithTheMechanism) {
  const ModelSpec before = spec();
  const Eigen::Matrix3d R = RandomSource(GetParam()).rotation();
  const Physics a(built(before)), b(built(rotated(before, R)));
  EXPECT_TRUE(matrices_near(b.verdict.singular_values, a.verdict.singular_values, 1e-11));
  EXPECT_EQ(b.verdict.unique_dimensions, a.verdict.unique_dimensions);
  for (std::size_t i = 0; i < a.accelerations.size(); ++i) {
    Vector6d turned;
    turned << R * a.accelerations[i].head<3>(), R * a.accelerations[i].tail<3>();
    EXPECT_TRUE(matrices_near(b.accelerations[i], turned, 1e-7));
  }
}

TEST_P(TransformsTest, APlaceInSpaceChangesNothing) {
  const ModelSpec before = spec();
  const Physics a(built(before)), b(built(shifted(before, {3, -2, 5})));
  EXPECT_TRUE(matrices_near(b.verdict.singular_values, a.verdict.singular_values, 1e-11));
  EXPECT_EQ(b.verdict.unique_rows, a.verdict.unique_rows);
  for (std::size_t i = 0; i < a.accelerations.size(); ++i) {
    EXPECT_TRUE(matrices_near(b.accelerations[i], a.accelerations[i], 1e-7));
  }
}

TEST_P(TransformsTest, ALargerMechanismAcceleratesInProportion) {
  const ModelSpec before = spec();
  const Physics a(built(before)), b(built(scaled(before, 1000)));
  EXPECT_TRUE(matrices_near(b.verdict.singular_values, a.verdict.singular_values, 1e-10));
  EXPECT_EQ(b.verdict.unique_rows, a.verdict.unique_rows);
  for (std::size_t i = 0; i < a.accelerations.size(); ++i) {
    EXPECT_TRUE(matrices_near(b.accelerations[i].head<3>(), a.accelerations[i].head<3>(), 1e-7));
    EXPECT_TRUE(matrices_near(b.accelerations[i].tail<3>() / 1000, a.accelerations[i].tail<3>(), 1e-7));
  }
}

TEST_P(TransformsTest, TheOrderOfTheFileChangesNothing) {
  const ModelSpec before = spec();
  const Model first = built(before), second = built(permuted(before, GetParam() + 1));
  const Physics a(first), b(second);
  EXPECT_TRUE(matrices_near(b.verdict.singular_values, a.verdict.singular_values, 1e-11));
  EXPECT_EQ(b.verdict.unique, a.verdict.unique);
  for (std::size_t i = 1; i < a.accelerations.size(); ++i) {
    const BodyId other = *second.find_body(first.bodies()[i].name);
    EXPECT_TRUE(matrices_near(b.accelerations[other.index()], a.accelerations[i], 1e-7));
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, TransformsTest, ::testing::Range(0, 49));

}  // namespace
}  // namespace ferrers::witness
