#include "ferrers/dynamics/momentum.h"

namespace ferrers {

Momentum compute_momentum(const DynamicsModel& model, const PositionKinematics& pos, const VelocityKinematics& vel) {
  Momentum out;
  for (std::size_t i = 1; i < model.inertias.size(); ++i) {
    const NodeInertia& body = model.inertias[i];
    const NodePoint com{static_cast<int>(i), body.com_N};
    const Matrix3d& R = pos.nodes[i].R;
    const Vector3d p = body.mass_kg * point_velocity(pos, vel, com);
    out.linear += p;
    out.angular += point_position(pos, com).cross(p) + R * (body.I_N * (R.transpose() * vel.nodes[i].w));
  }
  return out;
}

}  // namespace ferrers
