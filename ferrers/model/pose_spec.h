#pragma once

#include "ferrers/math/rotation.h"
#include "ferrers/model/spec.h"

namespace ferrers {

/// A pose in numbers, for a specification: position in m, quaternion (w, x, y, z). Rotations that are none are left
/// out.
inline PoseSpec pose_spec(const Pose& X, SourceRange at = {}) {
  PoseSpec spec;
  spec.position = number3(X.p.x(), X.p.y(), X.p.z());
  spec.at = at;
  if (X.R == Eigen::Matrix3d::Identity()) return spec;
  const Eigen::Quaterniond q(X.R);
  spec.rotation.emplace();
  spec.rotation->quaternion = std::array<Number, 4>{Number(q.w()), Number(q.x()), Number(q.y()), Number(q.z())};
  spec.rotation->at = at;
  return spec;
}

}  // namespace ferrers
