#include "ferrers/math/rank_sparse.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>
#include <set>

namespace ferrers {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Problem {
  int m = 0, n = 0;
  std::vector<RowBlock> blocks;

  MatrixXd dense() const {
    MatrixXd A = MatrixXd::Zero(m, n);
    for (const RowBlock& block : blocks) {
      for (std::size_t i = 0; i < block.rows.size(); ++i) {
        for (std::size_t k = 0; k < block.columns.size(); ++k) {
          A(block.rows[i], block.columns[k]) = block.A(static_cast<long>(i), static_cast<long>(k));
        }
      }
    }
    return A;
  }
};

// A chain or a tangle of blocks, each with rows that repeat and columns that depend on others.
Problem make_problem(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto pick = [&](int low, int high) { return low + static_cast<int>(random() % (high - low + 1)); };
  Problem p;
  p.n = pick(1, 40);
  const int count = pick(1, 25);
  for (int b = 0; b < count; ++b) {
    std::set<int> columns;
    const int width = std::min(p.n, pick(0, 5)), start = pick(0, p.n - 1);
    for (int k = 0; k < width; ++k) columns.insert(seed % 2 == 0 ? (start + k) % p.n : pick(0, p.n - 1));
    RowBlock block{{}, {columns.begin(), columns.end()}, {}};
    const int rows = pick(1, 6), rank = pick(0, std::min<int>(rows, static_cast<int>(columns.size())));
    MatrixXd left(rows, rank), right(rank, static_cast<long>(columns.size()));
    for (double& x : left.reshaped()) x = normal(random);
    for (double& x : right.reshaped()) x = normal(random);
    block.A = left * right;
    for (int i = 0; i < rows; ++i) block.rows.push_back(p.m++);
    p.blocks.push_back(std::move(block));
  }
  return p;
}

int decided_rank(SparseRank& analysis) {
  const RankDecision decision = decide_rank(analysis.values(), 1.0);
  EXPECT_TRUE(decision.confident);
  analysis.set_rank(decision.rank);
  return analysis.decided_rank();
}

TEST(SparseRankTest, RankAndNullSpacesAreThoseOfSingularValues) {
  int clear = 0;
  for (unsigned seed = 1; seed <= 400; ++seed) {
    const Problem p = make_problem(seed);
    const MatrixXd A = p.dense();
    const RankAnalysis reference = analyze_rank(A, 1.0);
    if (!reference.decision.confident) continue;  // a chance product of small numbers
    ++clear;
    SparseRank analysis(p.n, p.blocks);
    const int rank = decided_rank(analysis);
    ASSERT_EQ(rank, reference.decision.rank) << "seed " << seed;

    MatrixXd Z = MatrixXd::Zero(p.m, p.m - rank);
    int column = 0;
    for (const SparseRank::NullGroup& group : analysis.left_null()) {
      for (const auto& vector : group.vectors) {
        for (const auto& [row, value] : vector) Z(row, column) += value;
        ++column;
      }
    }
    ASSERT_EQ(column, p.m - rank) << "seed " << seed;
    const double size = 1 + A.norm();
    EXPECT_LT((A.transpose() * Z).norm(), 1e-11 * size) << "seed " << seed;
    EXPECT_LT((Z.transpose() * Z - MatrixXd::Identity(column, column)).norm(), 1e-12) << "seed " << seed;

    const std::vector<int> free = analysis.free_columns();
    ASSERT_EQ(static_cast<int>(free.size()), p.n - rank) << "seed " << seed;
    MatrixXd N(p.n, p.n - rank);
    for (int k = 0; k < N.cols(); ++k) N.col(k) = analysis.null_vector(VectorXd::Unit(N.cols(), k));
    if (N.cols() > 0) {
      EXPECT_LT((A * N).norm(), 1e-9 * size * (1 + N.norm())) << "seed " << seed;
      EXPECT_EQ(analyze_rank(N).decision.rank, N.cols()) << "seed " << seed;
      EXPECT_EQ(analyze_rank(N(free, Eigen::all)).decision.rank, N.cols()) << "free columns are independent, " << seed;
    }
  }
  EXPECT_GT(clear, 300);
}

TEST(SparseRankTest, TheSmallestKeptValueIsEstimatedWithinAFactor) {
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const Problem p = make_problem(seed);
    const RankAnalysis reference = analyze_rank(p.dense(), 1.0);
    if (!reference.decision.confident || reference.decision.rank == 0) continue;
    SparseRank analysis(p.n, p.blocks);
    const int rank = decided_rank(analysis);
    const double exact = reference.decision.singular_values[rank - 1], told = analysis.values()[rank - 1];
    EXPECT_LT(told, 3 * exact) << "seed " << seed;
    EXPECT_GT(told, exact / 100) << "seed " << seed;
  }
}

TEST(SparseRankTest, WhatIsNeitherHealthyNorZeroIsLeftToTheCore) {
  for (const double small : {1e-4, 1e-6, 1e-8, 1e-9}) {
    MatrixXd A(3, 3);
    A << 1, 1, 0, 1, 1 + small, 0, 0, 1, 1;
    A.row(2) = A.row(0) + A.row(1);
    A(2, 2) = 0;
    SparseRank analysis(3, {{{0, 1}, {0, 1}, A.topLeftCorner(2, 2)}, {{2}, {0, 1, 2}, A.bottomRows(1)}});
    EXPECT_EQ(analysis.smallest_rank(), 1);
    EXPECT_EQ(analysis.largest_rank(), 2);
    for (const int rank : {1, 2}) {  // either reading has null spaces of the right dimension
      analysis.set_rank(rank);
      std::size_t left = 0;
      for (const auto& group : analysis.left_null()) left += group.vectors.size();
      EXPECT_EQ(left, static_cast<std::size_t>(3 - rank));
      EXPECT_EQ(analysis.free_columns().size(), static_cast<std::size_t>(3 - rank));
    }
  }
}

TEST(SparseRankTest, AVectorOfTheLeftNullSpaceTouchesItsOwnBlockOnly) {
  // A chain in which every block repeats one of its rows.
  std::vector<RowBlock> blocks;
  const int count = 50;
  for (int b = 0; b < count; ++b) {
    MatrixXd A(3, 2);
    A << 1, 2, 1, -1, 2, 1;
    blocks.push_back({{3 * b, 3 * b + 1, 3 * b + 2}, {b, b + 1}, A});
  }
  SparseRank analysis(count + 1, blocks);
  analysis.set_rank(decided_rank(analysis));
  std::size_t found = 0, local = 0;
  for (const auto& group : analysis.left_null()) {
    for (const auto& vector : group.vectors) {
      ++found;
      if (vector.back().first / 3 == vector.front().first / 3) ++local;
    }
  }
  EXPECT_EQ(found, static_cast<std::size_t>(3 * count - (count + 1)));
  EXPECT_EQ(local, static_cast<std::size_t>(count));
}

TEST(SparseRankTest, RowsWithoutColumnsAndColumnsWithoutRowsAreNull) {
  SparseRank analysis(2, {{{0, 1}, {}, MatrixXd(2, 0)}});
  EXPECT_EQ(decided_rank(analysis), 0);
  EXPECT_EQ(analysis.left_null().front().vectors.size(), 2U);
  EXPECT_EQ(analysis.free_columns(), (std::vector<int>{0, 1}));
}

}  // namespace
}  // namespace ferrers
