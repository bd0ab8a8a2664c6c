#include "ferrers/kinematics/motion.h"

#include "ferrers/kinematics/constants.h"

namespace ferrers {

template <class T>
BasicPositionKinematics<T> make_basic_position_kinematics(const System& system) {
  BasicPositionKinematics<T> out;
  out.nodes.resize(system.nodes.size());
  out.S.assign(static_cast<std::size_t>(system.nv), Eigen::Matrix<T, 6, 1>::Zero());
  return out;
}

template <class T>
BasicVelocityKinematics<T> make_basic_velocity_kinematics(const System& system) {
  BasicVelocityKinematics<T> out;
  out.nodes.resize(system.nodes.size());
  return out;
}

PositionKinematics make_position_kinematics(const System& system) {
  return make_basic_position_kinematics<double>(system);
}
VelocityKinematics make_velocity_kinematics(const System& system) {
  return make_basic_velocity_kinematics<double>(system);
}

template <class T>
void compute_positions(const System& system, const Eigen::Matrix<T, Eigen::Dynamic, 1>& q,
                       BasicPositionKinematics<T>& out) {
  using Vector = Eigen::Matrix<T, 3, 1>;
  using Matrix = Eigen::Matrix<T, 3, 3>;
  using AnyTwist = Eigen::Matrix<T, 6, 1>;
  const auto& no_velocity = q;  // S does not read v
  AnyTwist S_F[6], ignored;
  BasicPose<T> X_FM;
  for (int i = 1; i < system.body_nodes; ++i) {
    const Node& node = system.nodes[i];
    const auto& parent = out.nodes[node.parent];
    auto& here = out.nodes[i];
    const Matrix R_J = turned(parent.R, node.X_PJ.R);
    const Vector p_J = parent.p + parent.R * as_constants<T>(node.X_PJ.p);
    node.type->motion(node.constants, q.data() + node.q, X_FM);
    node.type->subspace(node.constants, q.data() + node.q, no_velocity.data(), S_F, ignored);
    if (node.forward) {
      here.R_F = R_J;
      here.R.noalias() = R_J * X_FM.R;
      here.p = p_J + R_J * X_FM.p;
      for (int k = 0; k < node.nv; ++k) {
        AnyTwist& S = out.S[node.v + k];
        S.template head<3>().noalias() = R_J * S_F[k].template head<3>();
        S.template tail<3>().noalias() = R_J * S_F[k].template tail<3>();
      }
      continue;
    }
    // The parent carries M: this node's frame is F, and its twist is −S v shifted from p_M to p_F.
    here.R.noalias() = R_J * X_FM.R.transpose();
    here.R_F = here.R;
    here.lever = -(here.R * X_FM.p);
    here.p = p_J + here.lever;
    for (int k = 0; k < node.nv; ++k) {
      AnyTwist& S = out.S[node.v + k];
      const Vector angular = here.R * S_F[k].template head<3>();
      S.template head<3>() = -angular;
      S.template tail<3>() = -(here.R * S_F[k].template tail<3>()) - angular.cross(here.lever);
    }
  }
}

namespace {

// Ṡ v of the inboard joint in world axes (angular, linear at p_M).
template <class T>
Eigen::Matrix<T, 6, 1> subspace_rate(const Node& node, const Eigen::Matrix<T, 3, 3>& R_F,
                                     const Eigen::Matrix<T, Eigen::Dynamic, 1>& q,
                                     const Eigen::Matrix<T, Eigen::Dynamic, 1>& v) {
  Eigen::Matrix<T, 6, 1> S_F[6], rate, world;
  node.type->subspace(node.constants, q.data() + node.q, v.data() + node.v, S_F, rate);
  world.template head<3>() = R_F * rate.template head<3>();
  world.template tail<3>() = R_F * rate.template tail<3>();
  return world;
}

}  // namespace

template <class T>
void compute_velocities(const System& system, const BasicPositionKinematics<T>& pos,
                        const Eigen::Matrix<T, Eigen::Dynamic, 1>& q, const Eigen::Matrix<T, Eigen::Dynamic, 1>& v,
                        BasicVelocityKinematics<T>& out) {
  using Vector = Eigen::Matrix<T, 3, 1>;
  for (int i = 1; i < system.body_nodes; ++i) {
    const Node& node = system.nodes[i];
    const auto& parent = out.nodes[node.parent];
    auto& here = out.nodes[i];
    Vector w_J = Vector::Zero(), v_J = Vector::Zero();  // S v
    for (int k = 0; k < node.nv; ++k) {
      w_J += pos.S[node.v + k].template head<3>() * v[node.v + k];
      v_J += pos.S[node.v + k].template tail<3>() * v[node.v + k];
    }
    const Vector r = pos.nodes[i].p - pos.nodes[node.parent].p;
    here.w = parent.w + w_J;
    here.v = parent.v + parent.w.cross(r) + v_J;
    Eigen::Matrix<T, 6, 1> rate = Eigen::Matrix<T, 6, 1>::Zero();
    if (!node.type->constant_subspace) rate = subspace_rate<T>(node, pos.nodes[i].R_F, q, v);
    if (node.forward) {
      here.alpha = parent.alpha + parent.w.cross(w_J) + rate.template head<3>();
      here.a = parent.a + parent.alpha.cross(r) + parent.w.cross(parent.w.cross(r)) + T(2) * parent.w.cross(v_J) +
               rate.template tail<3>();
      continue;
    }
    // Relative motion is seen from this (first) body: subtract it as it is seen from here, then go from p_M to p_F.
    const Vector& lever = pos.nodes[i].lever;
    const Vector r_M = r - lever;
    const Vector v_M = v_J - w_J.cross(lever);
    here.alpha = parent.alpha + here.w.cross(w_J) - rate.template head<3>();
    here.a = parent.a + parent.alpha.cross(r_M) + parent.w.cross(parent.w.cross(r_M)) + T(2) * here.w.cross(v_M) -
             rate.template tail<3>() + here.alpha.cross(lever) + here.w.cross(here.w.cross(lever));
  }
}

template BasicPositionKinematics<Traced> make_basic_position_kinematics(const System&);
template BasicVelocityKinematics<Traced> make_basic_velocity_kinematics(const System&);
template void compute_positions(const System&, const VectorXd&, PositionKinematics&);
template void compute_positions(const System&, const Eigen::VectorX<Traced>&, BasicPositionKinematics<Traced>&);
template void compute_velocities(const System&, const PositionKinematics&, const VectorXd&, const VectorXd&,
                                 VelocityKinematics&);
template void compute_velocities(const System&, const BasicPositionKinematics<Traced>&, const Eigen::VectorX<Traced>&,
                                 const Eigen::VectorX<Traced>&, BasicVelocityKinematics<Traced>&);

void compute_accelerations(const System& system, const PositionKinematics& pos, const VelocityKinematics& vel,
                           const VectorXd& vdot, VelocityKinematics& out) {
  out.nodes[0] = vel.nodes[0];
  // Only the part that vdot adds is propagated: it is linear, like a velocity.
  for (int i = 1; i < system.body_nodes; ++i) {
    const Node& node = system.nodes[i];
    const Vector3d r = pos.nodes[i].p - pos.nodes[node.parent].p;
    VelocityKinematics::NodeVelocity& here = out.nodes[i];
    const Vector3d alpha_parent = out.nodes[node.parent].alpha - vel.nodes[node.parent].alpha;
    const Vector3d a_parent = out.nodes[node.parent].a - vel.nodes[node.parent].a;
    Vector3d alpha = alpha_parent, a = a_parent + alpha_parent.cross(r);
    for (int k = 0; k < node.nv; ++k) {
      alpha += pos.S[node.v + k].head<3>() * vdot[node.v + k];
      a += pos.S[node.v + k].tail<3>() * vdot[node.v + k];
    }
    here.w = vel.nodes[i].w;
    here.v = vel.nodes[i].v;
    here.alpha = vel.nodes[i].alpha + alpha;
    here.a = vel.nodes[i].a + a;
  }
}

Pose body_pose(const System& system, const PositionKinematics& pos, BodyId body) {
  const int i = system.topology->forest.node_of_body.at(body.index());
  return Pose(pos.nodes[i].R, pos.nodes[i].p) * system.nodes[i].X_BN.inverse();
}

Vector3d point_position(const PositionKinematics& pos, const NodePoint& point) {
  return pos.nodes[point.node].p + pos.nodes[point.node].R * point.p_N;
}

Vector3d point_velocity(const PositionKinematics& pos, const VelocityKinematics& vel, const NodePoint& point) {
  const VelocityKinematics::NodeVelocity& n = vel.nodes[point.node];
  return n.v + n.w.cross(pos.nodes[point.node].R * point.p_N);
}

Vector3d point_acceleration(const PositionKinematics& pos, const VelocityKinematics& acc, const NodePoint& point) {
  const VelocityKinematics::NodeVelocity& n = acc.nodes[point.node];
  const Vector3d r = pos.nodes[point.node].R * point.p_N;
  return n.a + n.alpha.cross(r) + n.w.cross(n.w.cross(r));
}

}  // namespace ferrers
