#pragma once

#include <Eigen/Core>

namespace ferrers {

/// R X, for a frame X that is fixed in its body: most are drawn along the body's axes, where this is R itself.
inline Eigen::Matrix3d turned(const Eigen::Matrix3d& R, const Eigen::Matrix3d& X) {
  const double* x = X.data();
  const bool as_drawn =
      x[0] == 1 && x[4] == 1 && x[8] == 1 && x[1] == 0 && x[2] == 0 && x[3] == 0 && x[5] == 0 && x[6] == 0 && x[7] == 0;
  if (as_drawn) return R;
  return R * X;
}

}  // namespace ferrers
