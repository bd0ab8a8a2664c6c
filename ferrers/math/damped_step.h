#pragma once

#include <Eigen/Core>

namespace ferrers {

/// The step that minimizes |J x + r|² + μ² |x|², by QR of [J; μ I]: as accurate as J allows, whatever its rank; no rank
/// is decided. `mu` > 0. Shapes: J m × n, r m, result n. Cost: O((m + n) n²).
Eigen::VectorXd compute_damped_step(const Eigen::MatrixXd& J, const Eigen::VectorXd& r, double mu);

}  // namespace ferrers
