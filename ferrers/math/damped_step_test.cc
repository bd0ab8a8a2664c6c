#include "ferrers/math/damped_step.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

namespace ferrers {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST(DampedStepTest, FulfilsTheNormalEquationsWhateverTheRank) {
  MatrixXd J(4, 3);
  J << 1, 2, 3, 2, 4, 6, 0, 1, 1, 1, 1, 2;  // rank 2
  const VectorXd r = VectorXd::LinSpaced(4, -1, 2);
  for (const double mu : {1e-3, 1.0}) {
    const VectorXd x = compute_damped_step(J, r, mu);
    EXPECT_LT((J.transpose() * (J * x + r) + mu * mu * x).norm(), 1e-12);
  }
}

TEST(DampedStepTest, IsNewtonsStepWhereDampingIsSmallAndTheMatrixRegular) {
  MatrixXd J(2, 2);
  J << 2, 1, 0, 3;
  const VectorXd r = VectorXd::Constant(2, 6);
  EXPECT_LT((J * compute_damped_step(J, r, 1e-9) + r).norm(), 1e-12);
}

}  // namespace
}  // namespace ferrers
