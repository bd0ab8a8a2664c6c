#include "ferrers/math/pattern_matrix.h"

#include <gtest/gtest.h>

namespace ferrers {
namespace {

// 1 . 2 .
// . 3 . .
// 4 . 5 6
PatternMatrix sample() {
  PatternMatrix A({{0, 2}, {1}, {0, 2, 3}}, 4);
  A.entry(0, 0) = 1;
  A.entry(0, 2) = 2;
  A.entry(1, 1) = 3;
  A.entry(2, 0) = 4;
  A.entry(2, 2) = 5;
  A.entry(2, 3) = 6;
  return A;
}

Eigen::MatrixXd dense_sample() {
  Eigen::MatrixXd out(3, 4);
  out << 1, 0, 2, 0,  //
      0, 3, 0, 0,     //
      4, 0, 5, 6;
  return out;
}

TEST(PatternMatrixTest, IsZeroWhereThePatternHasNoPlaceAndBeforeAnyNumberIsWritten) {
  const PatternMatrix empty({{0, 2}, {}, {1}}, 3);
  EXPECT_EQ(Eigen::MatrixXd(empty), Eigen::MatrixXd::Zero(3, 3));
  EXPECT_EQ(empty.nonZeros(), 3) << "places, zero or not";
  EXPECT_EQ(Eigen::MatrixXd(sample()), dense_sample());
  EXPECT_EQ(sample()(0, 1), 0);
  EXPECT_EQ(sample()(2, 3), 6);
}

TEST(PatternMatrixTest, PartsAreThoseOfTheDenseMatrixInTheOrderAsked) {
  const std::vector<int> rows = {2, 0}, columns = {3, 0, 1};
  EXPECT_EQ(sample()(rows, columns), Eigen::MatrixXd(dense_sample()(rows, columns)));
  EXPECT_EQ(sample().dense_rows(rows), Eigen::MatrixXd(dense_sample()(rows, Eigen::all)));
  EXPECT_EQ(sample()(std::vector<int>(), columns).rows(), 0);
}

TEST(PatternMatrixTest, ProductsAreThoseOfTheDenseMatrix) {
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(4, 1, 2), y = Eigen::VectorXd::LinSpaced(3, -1, 1);
  EXPECT_LT((sample() * x - dense_sample() * x).norm(), 1e-15);
  EXPECT_LT((sample().transpose() * y - dense_sample().transpose() * y).norm(), 1e-15);
}

TEST(PatternMatrixTest, TakingARowMovesItsNumbersAndLeavesZerosBehind) {
  PatternMatrix A = sample();
  Eigen::RowVectorXd whole = Eigen::RowVectorXd::Zero(4);
  whole[0] = 7;
  whole[2] = 8;
  A.take_row(0, whole);
  EXPECT_EQ(A(0, 0), 7);
  EXPECT_EQ(A(0, 2), 8);
  EXPECT_TRUE(whole.isZero(0));
  whole[3] = 9;
  A.take_row(2, whole);
  EXPECT_EQ(A(2, 0), 0) << "what the row did not have is zero now";
  EXPECT_EQ(A(2, 3), 9);
}

}  // namespace
}  // namespace ferrers
