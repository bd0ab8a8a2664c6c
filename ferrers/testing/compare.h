#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

/// Comparisons of matrices that say where they differ and by how much. Use: `EXPECT_TRUE(matrices_near(a, b, 1e-12))`.
namespace ferrers::witness {

inline std::string to_text(const Eigen::MatrixXd& m) {
  std::ostringstream out;
  out << m.format(Eigen::IOFormat(10, 0, " ", "\n", "    ", "", "", ""));
  return out.str();
}

/// True when every entry differs by at most `tolerance` · (1 + largest entry of `wanted`).
/// NaN equals nothing. The message names the worst entry, and shows both matrices when they are small.
inline ::testing::AssertionResult matrices_near(const Eigen::MatrixXd& got, const Eigen::MatrixXd& wanted,
                                                double tolerance, const std::string& what = "matrix") {
  if (got.rows() != wanted.rows() || got.cols() != wanted.cols()) {
    return ::testing::AssertionFailure() << what << " is " << got.rows() << "x" << got.cols() << ", wanted "
                                         << wanted.rows() << "x" << wanted.cols();
  }
  if (got.size() == 0) return ::testing::AssertionSuccess();
  const double scale = 1 + wanted.cwiseAbs().maxCoeff();
  double worst = -1;
  Eigen::Index row = 0, column = 0;
  bool finite = true;
  for (Eigen::Index i = 0; i < got.rows(); ++i) {
    for (Eigen::Index j = 0; j < got.cols(); ++j) {
      const double error = std::abs(got(i, j) - wanted(i, j));
      if (finite && !(error <= worst)) {
        worst = error;
        row = i;
        column = j;
        finite = std::isfinite(error);
      }
    }
  }
  if (finite && worst <= tolerance * scale) return ::testing::AssertionSuccess();
  auto failure = ::testing::AssertionFailure()
                 << what << " differs most at (" << row << ", " << column << "): got " << got(row, column)
                 << ", wanted " << wanted(row, column) << ", difference " << worst << " > " << tolerance * scale;
  if (got.size() <= 144) failure << "\n  got\n" << to_text(got) << "\n  wanted\n" << to_text(wanted);
  return failure;
}

/// True when the columns of both span the same space: the largest sine of the angle between them is below `tolerance`.
inline ::testing::AssertionResult same_span(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, double tolerance) {
  if (a.rows() != b.rows() || a.cols() != b.cols()) {
    return ::testing::AssertionFailure() << "bases of " << a.cols() << " and " << b.cols() << " vectors in dimension "
                                         << a.rows() << " and " << b.rows();
  }
  if (a.cols() == 0) return ::testing::AssertionSuccess();
  const auto orthonormal = [](const Eigen::MatrixXd& m) {
    Eigen::MatrixXd q = m;
    for (Eigen::Index i = 0; i < q.cols(); ++i) {
      for (int twice = 0; twice < 2; ++twice) {
        for (Eigen::Index j = 0; j < i; ++j) q.col(i) -= q.col(j).dot(q.col(i)) * q.col(j);
      }
      q.col(i).normalize();
    }
    return q;
  };
  const Eigen::MatrixXd qa = orthonormal(a), qb = orthonormal(b);
  const double sine = (qb - qa * (qa.transpose() * qb)).colwise().norm().maxCoeff();
  if (sine < tolerance) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "spans differ: sine of an angle between them " << sine;
}

}  // namespace ferrers::witness
