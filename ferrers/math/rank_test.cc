#include "ferrers/math/rank.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "ferrers/testing/compare.h"
#include "ferrers/testing/random_source.h"

namespace ferrers {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using witness::matrices_near;
using witness::RandomSource;

VectorXd values(std::initializer_list<double> list) {
  VectorXd v(static_cast<long>(list.size()));
  std::copy(list.begin(), list.end(), v.data());
  return v;
}

MatrixXd random_matrix(RandomSource& random, int m, int n) {
  MatrixXd A(m, n);
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j < n; ++j) A(i, j) = random.between(-1, 1);
  }
  return A;
}

MatrixXd random_orthogonal(RandomSource& random, int n) {
  const Eigen::HouseholderQR<MatrixXd> qr(random_matrix(random, n, n));
  return qr.householderQ() * MatrixXd::Identity(n, n);
}

/// A matrix with the given singular values and random singular vectors.
MatrixXd with_spectrum(RandomSource& random, int m, int n, const VectorXd& s) {
  MatrixXd D = MatrixXd::Zero(m, n);
  for (long i = 0; i < s.size(); ++i) D(i, i) = s[i];
  return random_orthogonal(random, m) * D * random_orthogonal(random, n).transpose();
}

TEST(RankTest, AClearGapIsConfident) {
  const RankDecision d = decide_rank(values({3, 1, 0.2, 1e-14, 1e-15}));
  EXPECT_EQ(d.rank, 3);
  EXPECT_TRUE(d.confident);
  EXPECT_FALSE(d.full);
  EXPECT_EQ(d.other_rank, 3);
  EXPECT_NEAR(d.gap / (0.2 / 1e-14), 1, 1e-12);
}

TEST(RankTest, FullRankHasTheLargestGap) {
  const RankDecision d = decide_rank(values({3, 1, 0.2}));
  EXPECT_EQ(d.rank, 3);
  EXPECT_TRUE(d.full);
  EXPECT_TRUE(d.confident);
  EXPECT_EQ(d.gap, 1e16);
}

TEST(RankTest, AValueBetweenTheBoundsIsInDoubtWithBothReadings) {
  const RankDecision high = decide_rank(values({1, 0.5, 1e-6, 1e-16}));  // nearer to the sure ones
  EXPECT_EQ(high.rank, 3);
  EXPECT_FALSE(high.confident);
  EXPECT_EQ(high.other_rank, 2);
  const RankDecision low = decide_rank(values({1, 0.5, 1e-9, 1e-10 * 0.5}));  // nearer to the zeros
  EXPECT_EQ(low.rank, 2);
  EXPECT_FALSE(low.confident);
  EXPECT_EQ(low.other_rank, 3);
}

TEST(RankTest, SpectraWithoutAGapAreInDoubt) {
  VectorXd s(12);
  for (int i = 0; i < 12; ++i) s[i] = std::pow(10.0, -i);
  const RankDecision d = decide_rank(s);
  EXPECT_FALSE(d.confident);
  EXPECT_GE(d.rank, 5);
  EXPECT_LE(d.rank, 10);
  EXPECT_NE(d.rank, d.other_rank);
}

TEST(RankTest, AValueJustAboveTheUpperBoundWithASmallGapIsNotConfident) {
  const RankDecision d = decide_rank(values({1, 2e-5, 0.9e-10}));
  EXPECT_EQ(d.rank, 2);
  EXPECT_TRUE(d.confident);  // 2e5 apart
  EXPECT_FALSE(decide_rank(values({1, 2e-5, 3e-9})).confident);
}

TEST(RankTest, ZeroMatricesHaveRankZeroForAnyScale) {
  for (const double scale : {0.0, 1.0, 1e6}) {
    const RankDecision d = decide_rank(VectorXd::Zero(4), scale);
    EXPECT_EQ(d.rank, 0) << scale;
    EXPECT_TRUE(d.confident) << scale;
    EXPECT_FALSE(d.full) << scale;
    EXPECT_EQ(d.gap, 1e16) << scale;
    EXPECT_EQ(d.other_rank, 0) << scale;
  }
}

TEST(RankTest, NoValuesAreFullRankZero) {
  for (const double scale : {0.0, 1.0}) {
    const RankDecision d = decide_rank(VectorXd(), scale);
    EXPECT_EQ(d.rank, 0);
    EXPECT_TRUE(d.full);
    EXPECT_TRUE(d.confident);
    EXPECT_EQ(d.gap, 1e16);
  }
}

TEST(RankTest, NoiseBesideAKnownScaleIsZero) {
  const RankDecision d = decide_rank(values({1e-14, 1e-15}), 1.0);
  EXPECT_EQ(d.rank, 0);
  EXPECT_TRUE(d.confident);
  EXPECT_EQ(decide_rank(values({1e-14, 1e-15})).rank, 2);  // without it, it is a small matrix
}

TEST(RankTest, AMisclosureHidesWhatIsNotLargerThanIt) {
  const RankDecision sharp = decide_rank(values({1, 0.3, 2e-5}));
  EXPECT_EQ(sharp.rank, 3);
  EXPECT_TRUE(sharp.confident);
  const RankDecision blurred = decide_rank(values({1, 0.3, 2e-7}), 0, 5e-7);
  EXPECT_EQ(blurred.rank, 2);
  EXPECT_TRUE(blurred.confident);
  EXPECT_NEAR(blurred.gap / (0.3 / 5e-6), 1, 1e-12);  // above what the misclosure hides, not above 2e-7
  const RankDecision near_it = decide_rank(values({1, 0.3, 2e-5}), 0, 5e-7);
  EXPECT_FALSE(near_it.confident);
  EXPECT_NE(near_it.rank, near_it.other_rank);
  const RankDecision coarse = decide_rank(values({1, 0.3, 2e-3}), 0, 5e-3);
  EXPECT_EQ(coarse.rank, 2);
  EXPECT_FALSE(coarse.confident);
  EXPECT_NE(coarse.rank, coarse.other_rank);
}

TEST(RankTest, AMisclosureThatMayBeRoundedInputLeavesEveryZeroInDoubt) {
  for (const double blur : {2e-11, 1e-10, 1e-9, 9e-9}) {
    const RankDecision d = decide_rank(values({1, 0.3, 0.4 * blur}), 0, blur);
    EXPECT_EQ(d.rank, 2) << blur;
    EXPECT_FALSE(d.confident) << blur;
    EXPECT_EQ(d.other_rank, 3) << blur;
    const RankDecision full = decide_rank(values({1, 0.3, 0.1}), 0, blur);
    EXPECT_EQ(full.rank, 3) << blur;
    EXPECT_TRUE(full.confident) << blur;
  }
  EXPECT_TRUE(decide_rank(values({1, 0.3, 1e-12}), 0, 5e-12).confident);
  EXPECT_EQ(judge_misclosure(0), Misclosure::kNone);
  EXPECT_EQ(judge_misclosure(5e-12), Misclosure::kNone);
  EXPECT_EQ(judge_misclosure(5e-11), Misclosure::kDoubtful);
  EXPECT_EQ(judge_misclosure(5e-8), Misclosure::kSure);
}

TEST(RankTest, DecisionsAreTheSameWithAMisclosureOfRounding) {
  RandomSource random(7);
  for (int i = 0; i < 500; ++i) {
    VectorXd s(1 + random.below(8));
    for (double& value : s) value = std::pow(10.0, random.between(-16, 0));
    std::sort(s.data(), s.data() + s.size(), std::greater<>());
    const RankDecision a = decide_rank(s, 1.0), b = decide_rank(s, 1.0, 1e-15);
    EXPECT_EQ(a.rank, b.rank);
    EXPECT_EQ(a.confident, b.confident);
  }
}

TEST(RankTest, DecisionsDoNotDependOnTheUnit) {
  for (const double unit : {1e-6, 1.0, 1e6}) {
    const RankDecision d = decide_rank(unit * values({2, 1, 1e-3, 1e-7, 1e-12}));
    EXPECT_EQ(d.rank, 4);
    EXPECT_FALSE(d.confident);
  }
}

TEST(RankTest, NegligibleAndWornAreRelative) {
  EXPECT_TRUE(is_negligible(1e-9, 1));
  EXPECT_TRUE(is_negligible(-1e-6, 1e3));
  EXPECT_FALSE(is_negligible(-1e-6, 1));
  EXPECT_TRUE(is_negligible(0, 0));
  EXPECT_TRUE(is_worn_pivot(1e-4, 1));
  EXPECT_FALSE(is_worn_pivot(-0.01, 1));
  EXPECT_TRUE(is_worn_pivot(NAN, 1));
}

class RankSpectrumTest : public ::testing::TestWithParam<int> {};

TEST_P(RankSpectrumTest, NullSpacesAndChoicesBelongToTheConstructedRank) {
  RandomSource random(GetParam());
  const int m = 1 + random.below(12), n = 1 + random.below(12), least = std::min(m, n);
  const int rank = random.below(least + 1);
  VectorXd s = VectorXd::Zero(least);
  for (int i = 0; i < rank; ++i) s[i] = random.between(0.01, 3);
  std::sort(s.data(), s.data() + least, std::greater<>());
  const MatrixXd A = with_spectrum(random, m, n, s);
  const RankAnalysis analysis = analyze_rank(A, 1.0);
  ASSERT_EQ(analysis.decision.rank, rank);
  EXPECT_TRUE(analysis.decision.confident);
  EXPECT_EQ(analysis.decision.full, rank == least);
  EXPECT_TRUE(matrices_near(analysis.decision.singular_values, s, 1e-13));
  ASSERT_EQ(analysis.left_null.cols(), m - rank);
  ASSERT_EQ(analysis.right_null.cols(), n - rank);
  EXPECT_LT((A.transpose() * analysis.left_null).norm(), 1e-13);
  EXPECT_LT((A * analysis.right_null).norm(), 1e-13);
  EXPECT_TRUE(matrices_near(analysis.left_null.transpose() * analysis.left_null, MatrixXd::Identity(m - rank, m - rank),
                            1e-13));
  EXPECT_TRUE(matrices_near(analysis.right_null.transpose() * analysis.right_null,
                            MatrixXd::Identity(n - rank, n - rank), 1e-13));
}

// Jacobians of mechanisms repeat many singular values exactly; some decompositions go wrong on that.
TEST_P(RankSpectrumTest, RepeatedSingularValuesAreFoundAndSpanTheRightSpaces) {
  RandomSource random(300 + GetParam());
  const int n = 16 + random.below(24), m = n + random.below(12), rank = n - random.below(6);
  const double levels[] = {2, std::sqrt(2.0), 1, 1, 0.02};
  VectorXd s = VectorXd::Zero(n);
  for (int i = 0; i < rank; ++i) s[i] = levels[random.below(5)];
  std::sort(s.data(), s.data() + n, std::greater<>());
  const MatrixXd A = with_spectrum(random, m, n, s);
  const RankAnalysis analysis = analyze_rank(A);
  ASSERT_EQ(analysis.decision.rank, rank);
  EXPECT_TRUE(matrices_near(analysis.decision.singular_values, s, 1e-13));
  EXPECT_LT((A.transpose() * analysis.left_null).norm(), 1e-12);
  EXPECT_LT((A * analysis.right_null).norm(), 1e-12);
}

// The loop Jacobian of a chain of links: entries 0 and ±1 in a few diagonals.
TEST_P(RankSpectrumTest, SparseMatricesOfSmallIntegersHaveExactNullSpaces) {
  RandomSource random(400 + GetParam());
  const int n = 18 + random.below(15), m = n + 5;
  MatrixXd A = MatrixXd::Zero(m, n);
  for (int i = 0; i < m; ++i) {
    for (int k = 0; k < 3; ++k) A(i, random.below(n)) = random.below(3) - 1;
  }
  for (int k = 0; k < 4; ++k) A.row(m - 1 - k) = A.row(k) - A.row(k + 4);
  const RankAnalysis analysis = analyze_rank(A);
  EXPECT_EQ(analysis.decision.rank, Eigen::FullPivLU<MatrixXd>(A).rank());
  EXPECT_LT((A.transpose() * analysis.left_null).norm(), 1e-12);
  EXPECT_LT((A * analysis.right_null).norm(), 1e-12);
  EXPECT_NEAR(analysis.decision.singular_values.norm(), A.norm(), 1e-12 * A.norm());
}

TEST_P(RankSpectrumTest, ChosenRowsAndColumnsSpanEverything) {
  RandomSource random(100 + GetParam());
  const int m = 2 + random.below(10), n = 2 + random.below(10), rank = 1 + random.below(std::min(m, n));
  const MatrixXd A = random_matrix(random, m, rank) * random_matrix(random, rank, n);
  const std::vector<int> rows = choose_independent_rows(A, rank), columns = choose_independent_columns(A, rank);
  ASSERT_EQ(static_cast<int>(rows.size()), rank);
  EXPECT_TRUE(std::is_sorted(rows.begin(), rows.end()));
  EXPECT_TRUE(std::is_sorted(columns.begin(), columns.end()));
  EXPECT_EQ(std::adjacent_find(rows.begin(), rows.end()), rows.end());
  const MatrixXd of_rows = A(rows, Eigen::all), of_columns = A(Eigen::all, columns);
  EXPECT_EQ(analyze_rank(of_rows).decision.rank, rank);
  EXPECT_EQ(analyze_rank(of_columns).decision.rank, rank);
}

TEST_P(RankSpectrumTest, LeastNormSolutionsAreThePseudoinverse) {
  RandomSource random(200 + GetParam());
  const int m = 1 + random.below(9), n = 1 + random.below(9), rank = 1 + random.below(std::min(m, n));
  VectorXd s = VectorXd::Zero(std::min(m, n));
  for (int i = 0; i < rank; ++i) s[i] = random.between(0.1, 2);
  const MatrixXd A = with_spectrum(random, m, n, s);
  const VectorXd b = random_matrix(random, m, 1);
  const LeastNormResult result = solve_least_norm(A, b);
  EXPECT_EQ(result.decision.rank, rank);
  const VectorXd residual = A * result.x - b;
  EXPECT_LT((A.transpose() * residual).norm(), 1e-12);                           // least squares
  EXPECT_LT((analyze_rank(A).right_null.transpose() * result.x).norm(), 1e-12);  // least norm
  EXPECT_NEAR(result.residual, residual.norm(), 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RankSpectrumTest, ::testing::Range(0, 40));

TEST(RankTest, EmptyMatricesHaveWholeNullSpaces) {
  const RankAnalysis no_columns = analyze_rank(MatrixXd(3, 0), 1.0), no_rows = analyze_rank(MatrixXd(0, 2));
  EXPECT_EQ(no_columns.decision.rank, 0);
  EXPECT_TRUE(matrices_near(no_columns.left_null, MatrixXd::Identity(3, 3), 0));
  EXPECT_TRUE(matrices_near(no_rows.right_null, MatrixXd::Identity(2, 2), 0));
  EXPECT_EQ(no_rows.left_null.size(), 0);
  const LeastNormResult x = solve_least_norm(MatrixXd(2, 0), values({3, 4}));
  EXPECT_EQ(x.x.size(), 0);
  EXPECT_NEAR(x.residual, 5, 1e-15);
  EXPECT_TRUE(choose_independent_rows(MatrixXd::Zero(3, 2), 0).empty());
}

TEST(RankTest, AMatrixOfZerosSolvesToZero) {
  const LeastNormResult x = solve_least_norm(MatrixXd::Zero(2, 3), values({3, 4}));
  EXPECT_TRUE(matrices_near(x.x, VectorXd::Zero(3), 0));
  EXPECT_NEAR(x.residual, 5, 1e-15);
}

TEST(RankTest, IndependentRowsAvoidNearlyParallelOnes) {
  MatrixXd A(3, 2);
  A << 1, 0, 1, 1e-3, 0, 1;
  EXPECT_EQ(choose_independent_rows(A, 2), (std::vector<int>{1, 2}));  // 1 is a hair longer than 0; never both of them
}

}  // namespace
}  // namespace ferrers
