#include "ferrers/math/traced.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <stdexcept>

#include "ferrers/math/kernel.h"
#include "ferrers/testing/needs_machine_code.h"

namespace ferrers {
namespace {

// A rotation about z and then a constant frame: what mechanisms are made of.
template <class T>
Eigen::Matrix<T, 3, 1> turned_point(const T& angle, const Eigen::Matrix<T, 3, 1>& p) {
  using std::cos, std::sin, std::sqrt;
  Eigen::Matrix<T, 3, 3> R;
  R << cos(angle), -sin(angle), 0, sin(angle), cos(angle), 0, 0, 0, 1;
  const Eigen::Matrix<T, 3, 1> q = R * (R.transpose() * p) + R * p.cross(R.col(0));
  return q / sqrt(T(1) + q.squaredNorm());
}

TEST(TracedTest, AProgramComputesWhatTheTemplateDoes) {
  NEEDS_MACHINE_CODE();
  Trace trace;
  const Traced angle = trace.input(0);
  const Eigen::Matrix<Traced, 3, 1> p(trace.input(1), trace.input(2), trace.input(3));
  const Eigen::Matrix<Traced, 3, 1> result = turned_point(angle, p);
  const std::vector<int> outputs = {trace.value_of(result[0]), trace.value_of(result[1]), trace.value_of(result[2])};
  const Kernel kernel(trace.graph(), outputs, {{0, 0, 0, 0}, {0, 0, 0}});
  Kernel::Board board = kernel.make_board();
  const double inputs[] = {0.7, 1.5, -0.4, 2.2};
  for (std::size_t i = 0; i < 4; ++i) board[static_cast<std::size_t>(kernel.inputs()[i])] = inputs[i];
  kernel.run(board);
  const Eigen::Vector3d expected = turned_point<double>(0.7, {1.5, -0.4, 2.2});
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(board[static_cast<std::size_t>(kernel.outputs()[i])], expected[static_cast<long>(i)], 1e-15);
  }
}

TEST(TracedTest, SinesAreExactToTheirLastDigits) {
  NEEDS_MACHINE_CODE();
  Trace trace;
  const std::vector<int> outputs = {trace.value_of(sin(trace.input(0))), trace.value_of(cos(trace.input(0)))};
  const Kernel kernel(trace.graph(), outputs, {{0}, {0, 0}});
  Kernel::Board board = kernel.make_board();
  double worst = 0;
  const auto check = [&](double angle) {
    board[static_cast<std::size_t>(kernel.inputs()[0])] = angle;
    kernel.run(board);
    worst = std::max(worst, std::abs(board[static_cast<std::size_t>(kernel.outputs()[0])] - std::sin(angle)));
    worst = std::max(worst, std::abs(board[static_cast<std::size_t>(kernel.outputs()[1])] - std::cos(angle)));
  };
  for (int i = -4000; i <= 4000; ++i) {
    check(i * 0.00123);                    // near 0, and some turns
    check(i * 1.5707963267948966);         // next to multiples of a quarter turn
    check(i * kFarthestAngle / 4000);      // far away
    check(std::ldexp(1.0, -60 + i % 60));  // tiny
  }
  EXPECT_LE(worst, 3e-16);
}

TEST(TracedTest, WhatConstantsMakeSuperfluousIsNoOperation) {
  Trace trace;
  const Traced x = trace.input(0);
  const std::size_t before = trace.graph().values().size();
  EXPECT_TRUE((x * 0.0).is_zero());
  EXPECT_TRUE((0.0 / x).is_zero());
  EXPECT_TRUE((x - x).is_zero());
  EXPECT_EQ(trace.value_of(x * 1.0 + 0.0 - 0.0), trace.value_of(x));
  EXPECT_EQ(trace.value_of(0.0 - -x), trace.value_of(x));
  EXPECT_EQ((Traced(2.0) * 3.0 + sqrt(Traced(4.0))).constant(), 8);
  EXPECT_EQ(trace.value_of(x * 2.0), trace.value_of(Traced(2.0) * x));
  EXPECT_LE(trace.graph().values().size(), before + 3);  // −x, 2 and 2 x
}

TEST(TracedTest, NumbersBelongToTheTraceThatLives) {
  Traced x;
  {
    Trace trace;
    x = trace.input(0);
    EXPECT_THROW(Trace(), std::invalid_argument);
  }
  EXPECT_THROW(x + x, std::invalid_argument);
}

}  // namespace
}  // namespace ferrers
