#include "ferrers/redundancy/permanence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <numbers>

#include "ferrers/testing/random_mechanism.h"
#include "ferrers/testing/random_source.h"
#include "ferrers/testing/transforms.h"
#include "ferrers/testing/zoo.h"

namespace ferrers {
namespace {

using witness::LegEnds;
using witness::ZooEntry;

constexpr double kRightAngle = std::numbers::pi / 2;

PermanenceReport analyze(const ModelSpec& spec, const std::vector<bool>& cut = {}) {
  const auto system = make_system(*build_model(spec).model, {.cut = cut});
  const State drawn = make_drawn_state(*system);
  return analyze_permanence(*system, drawn, analyze_redundancy(*system, drawn));
}

/// What does not depend on how a mechanism is described.
struct Verdict {
  Permanence kind;
  std::optional<int> generic_mobility, generic_redundant, finite_mobility;
  FiniteMobilityBasis basis;
  bool is_shaky;
  std::vector<std::array<int, 3>> branches;  ///< Dimension, mobility, redundant; sorted.
  bool operator==(const Verdict&) const = default;
};

Verdict verdict_of(const PermanenceReport& r) {
  Verdict v{r.kind, r.generic_mobility, r.generic_redundant, r.finite_mobility, r.basis, r.is_shaky, {}};
  for (const BranchReport& b : r.branches) v.branches.push_back({b.dimension, b.mobility, b.redundant});
  std::sort(v.branches.begin(), v.branches.end());
  return v;
}

std::ostream& operator<<(std::ostream& out, const Verdict& v) {
  out << to_string(v.kind) << ", generic " << v.generic_mobility.value_or(-1) << "/" << v.generic_redundant.value_or(-1)
      << ", finite " << v.finite_mobility.value_or(-1) << " by " << to_string(v.basis) << (v.is_shaky ? ", shaky" : "");
  for (const auto& b : v.branches) out << " [" << b[0] << " " << b[1] << " " << b[2] << "]";
  return out;
}

void expect_same_however_described(const ModelSpec& spec) {
  const Verdict wanted = verdict_of(analyze(spec));
  witness::RandomSource random(7);
  EXPECT_EQ(verdict_of(analyze(witness::rotated(spec, random.rotation()))), wanted) << "turned";
  EXPECT_EQ(verdict_of(analyze(witness::shifted(spec, 10 * random.direction()))), wanted) << "moved";
  EXPECT_EQ(verdict_of(analyze(witness::permuted(spec, 3))), wanted) << "in another order";
  EXPECT_EQ(verdict_of(analyze(witness::scaled(spec, 1e-3))), wanted) << "small";
  EXPECT_EQ(verdict_of(analyze(witness::scaled(spec, 1e3))), wanted) << "large";
  for (int i = 0; i < 4; ++i) {
    std::vector<bool> cut(spec.joints.size());
    for (std::size_t j = 0; j < cut.size(); ++j) cut[j] = random.chance(0.3);
    EXPECT_EQ(verdict_of(analyze(spec, cut)), wanted) << ::testing::PrintToString(cut);
  }
}

class ZooPermanenceTest : public ::testing::TestWithParam<ZooEntry> {};

TEST_P(ZooPermanenceTest, MobilityIsFiniteAndRedundancyPermanentButAtTheTwoSingularPoses) {
  const ZooEntry& entry = GetParam();
  const PermanenceReport r = analyze(entry.spec);
  const bool is_singular = entry.name == "n_four_bar2_horizontal" || entry.name == "sarrus_extended";
  EXPECT_TRUE(r.confident);
  EXPECT_FALSE(r.is_shaky);
  ASSERT_TRUE(r.finite_mobility && r.generic_redundant && r.generic_mobility);
  if (is_singular) {
    EXPECT_EQ(r.kind, Permanence::kMixed);
    EXPECT_EQ(*r.finite_mobility, 1);
    EXPECT_EQ(*r.generic_mobility, 1);
    EXPECT_EQ(r.basis, FiniteMobilityBasis::kContinuation);
    return;
  }
  EXPECT_EQ(r.kind, entry.redundant > 0 ? Permanence::kPermanent : Permanence::kNone);
  EXPECT_EQ(*r.finite_mobility, entry.mobility);
  EXPECT_EQ(*r.generic_mobility, entry.mobility);
  EXPECT_EQ(*r.generic_redundant, entry.redundant);
  EXPECT_EQ(r.basis, entry.redundant > 0 ? FiniteMobilityBasis::kContinuation : FiniteMobilityBasis::kFirstOrder);
  EXPECT_EQ(r.branches.size(), 1u);
}

TEST_P(ZooPermanenceTest, TheVerdictDoesNotDependOnTheDescription) { expect_same_however_described(GetParam().spec); }

std::string test_name(const ::testing::TestParamInfo<ZooEntry>& info) { return info.param.name; }
INSTANTIATE_TEST_SUITE_P(Zoo, ZooPermanenceTest, ::testing::ValuesIn(witness::zoo()), test_name);

TEST(PermanenceTest, RandomMechanismsMoveAsTheirRankTells) {
  int moved = 0;
  for (int seed = 0; seed < 60; ++seed) {
    const witness::RandomMechanism m = witness::make_random_mechanism(seed);
    const PermanenceReport r = analyze(m.spec);
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + m.description);
    ASSERT_TRUE(r.finite_mobility);
    EXPECT_EQ(*r.finite_mobility, m.verdict.mobility);
    EXPECT_EQ(*r.generic_redundant, m.verdict.redundant);
    moved += r.basis == FiniteMobilityBasis::kContinuation ? 1 : 0;
  }
  EXPECT_GT(moved, 20);
}

// --- Shaky: rank leaves a mobility, second order takes it ---

TEST(PermanenceTest, ThreeParallelLegsOfUnequalLengthAreShaky) {
  const PermanenceReport r = analyze(witness::make_unequal_legs());
  EXPECT_EQ(r.finite_mobility, 0);
  EXPECT_EQ(r.basis, FiniteMobilityBasis::kSecondOrder);
  EXPECT_TRUE(r.is_shaky);
  EXPECT_TRUE(r.confident);
  EXPECT_EQ(r.generic_mobility, 1) << "the pose is isolated: it is its own generic configuration";
  EXPECT_TRUE(r.branches.empty());
  expect_same_however_described(witness::make_unequal_legs());
}

TEST(PermanenceTest, ThreeParallelLegsOfEqualLengthMove) {
  const PermanenceReport r = analyze(witness::make_parallel_cranks(kRightAngle));
  EXPECT_EQ(r.finite_mobility, 1);
  EXPECT_EQ(r.basis, FiniteMobilityBasis::kContinuation);
  EXPECT_FALSE(r.is_shaky);
}

// Pins fall by u²/2l: a middle leg with 1/l between its neighbours' in proportion to x follows to second order too.
TEST(PermanenceTest, LegsThatAgreeAtSecondOrderAreNotProvenRigid) {
  const double agreeing = 1 / (1 + (1 / 1.1 - 1) / 2.2);
  const PermanenceReport r = analyze(witness::make_unequal_legs(agreeing));
  EXPECT_EQ(r.basis, FiniteMobilityBasis::kNotEstablished);
  EXPECT_FALSE(r.finite_mobility);
  EXPECT_FALSE(r.generic_redundant);
  EXPECT_EQ(r.kind, Permanence::kUnknown);
}

TEST(PermanenceTest, TwoBarsInLineAreShakyAndBentOnesRigid) {
  const PermanenceReport line = analyze(witness::make_two_bars(0));
  EXPECT_EQ(line.finite_mobility, 0);
  EXPECT_EQ(line.basis, FiniteMobilityBasis::kSecondOrder);
  EXPECT_TRUE(line.is_shaky);
  const PermanenceReport bent = analyze(witness::make_two_bars(0.1));
  EXPECT_EQ(bent.finite_mobility, 0);
  EXPECT_EQ(bent.basis, FiniteMobilityBasis::kFirstOrder);
  EXPECT_FALSE(bent.is_shaky);
  expect_same_however_described(witness::make_two_bars(0));
}

// --- Where branches meet ---

using Branches = std::vector<std::array<int, 3>>;

TEST(PermanenceTest, AFlatParallelogramIsAlsoAFoldedOne) {
  const PermanenceReport r = analyze(witness::make_n_four_bar(1, kRightAngle));
  EXPECT_EQ(verdict_of(r).branches, (Branches{{1, 1, 3}, {1, 1, 3}}));
  ASSERT_EQ(r.branches.size(), 2u);
  // On one the cranks turn alike, on the other the first one stands still.
  std::vector<std::vector<std::string>> movers;
  for (const BranchReport& b : r.branches) {
    movers.emplace_back();
    for (const auto& [name, value] : b.direction) movers.back().push_back(name);
  }
  std::sort(movers.begin(), movers.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  EXPECT_EQ(movers[0], (std::vector<std::string>{"foot0", "foot1", "left1"}));
  EXPECT_EQ(movers[1], (std::vector<std::string>{"foot1", "left1"}));
  EXPECT_NEAR(r.branches[0].share + r.branches[1].share, 1, 1e-12);
}

// With the tips at angles a0, a1, a2 each loop asks for (a1 − a0) a0 = 0: three lines, the last one double, so that the
// rank on it is too low everywhere.
TEST(PermanenceTest, TwoFlatParallelogramsHaveThreeBranchesOneOfThemSingularAllAlong) {
  const PermanenceReport r = analyze(witness::make_n_four_bar(2, kRightAngle));
  EXPECT_EQ(verdict_of(r).branches, (Branches{{1, 1, 6}, {1, 1, 6}, {1, 2, 7}}));
  EXPECT_EQ(r.generic_redundant, 6);
  EXPECT_EQ(r.finite_mobility, 1);
  EXPECT_TRUE(r.all_branches);
}

TEST(PermanenceTest, AnExtendedSarrusLinkageFoldsInTwoWays) {
  const PermanenceReport r = analyze(witness::make_sarrus(kRightAngle));
  EXPECT_EQ(verdict_of(r).branches, (Branches{{1, 1, 1}, {1, 1, 1}}));
}

TEST(PermanenceTest, SixEqualParallelLegsTranslateOrScrew) {
  const PermanenceReport rods = analyze(witness::make_six_legs(LegEnds::kRods));
  EXPECT_EQ(verdict_of(rods).branches, (Branches{{1, 3, 3}, {2, 3, 3}}));
  EXPECT_EQ(rods.finite_mobility, 2);
  EXPECT_EQ(rods.kind, Permanence::kPermanent) << "the legs' lines have rank 3 all along";
  const PermanenceReport universal = analyze(witness::make_six_legs(LegEnds::kSphericalUniversal));
  EXPECT_EQ(universal.finite_mobility, 2);
  EXPECT_EQ(verdict_of(universal).branches, (Branches{{1, 3, 3}, {2, 3, 3}}));
}

// --- A second-order flex is no motion ---

TEST(PermanenceTest, ACuspMovesOneWay) {
  const PermanenceReport r = analyze(witness::make_cusp());
  EXPECT_EQ(r.finite_mobility, 1);
  EXPECT_EQ(r.basis, FiniteMobilityBasis::kContinuation);
  EXPECT_EQ(verdict_of(r).branches, (Branches{{1, 1, 6}}));
  EXPECT_EQ(r.kind, Permanence::kMixed);
}

TEST(PermanenceTest, WhatOnlyFourthOrderHoldsIsNotEstablished) {
  const PermanenceReport rigid = analyze(witness::make_touching(false));
  EXPECT_EQ(rigid.basis, FiniteMobilityBasis::kNotEstablished);
  EXPECT_FALSE(rigid.finite_mobility);
  EXPECT_FALSE(rigid.is_shaky) << "nothing is proven";
  EXPECT_EQ(rigid.kind, Permanence::kUnknown);
  const PermanenceReport moving = analyze(witness::make_touching(true));
  EXPECT_EQ(moving.basis, FiniteMobilityBasis::kContinuation);
  EXPECT_EQ(moving.finite_mobility, 1);
}

TEST(PermanenceTest, SingularPosesAreToldHoweverTheMechanismIsDescribed) {
  for (const ModelSpec& spec :
       {witness::make_n_four_bar(1, kRightAngle), witness::make_n_four_bar(3, kRightAngle), witness::make_cusp(),
        witness::make_touching(false), witness::make_touching(true), witness::make_six_legs(LegEnds::kRods)}) {
    SCOPED_TRACE(spec.name);
    expect_same_however_described(spec);
  }
}

TEST(PermanenceTest, ManyLoopsStayAffordable) {
  const auto begin = std::chrono::steady_clock::now();
  const PermanenceReport r = analyze(witness::make_n_four_bar(40, 0.4));
  EXPECT_EQ(r.finite_mobility, 1);
  EXPECT_EQ(r.generic_redundant, 120);
  const PermanenceReport flat = analyze(witness::make_n_four_bar(40, kRightAngle));
  EXPECT_FALSE(flat.second_order_done);
  EXPECT_FALSE(flat.all_branches);
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
  EXPECT_LT(spent.count(), 10) << "bounded also on a slow machine without optimization";
}

}  // namespace
}  // namespace ferrers
