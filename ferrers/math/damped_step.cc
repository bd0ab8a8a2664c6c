#include "ferrers/math/damped_step.h"

#include <Eigen/QR>

namespace ferrers {

Eigen::VectorXd compute_damped_step(const Eigen::MatrixXd& J, const Eigen::VectorXd& r, double mu) {
  const long m = J.rows(), n = J.cols();
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(m + n, n);
  A.topRows(m) = J;
  A.bottomRows(n).diagonal().setConstant(mu);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(m + n);
  b.head(m) = -r;
  return A.householderQr().solve(b);
}

}  // namespace ferrers
