#include "ferrers/kinematics/state.h"

namespace ferrers {

State make_drawn_state(const System& system) {
  State state;
  state.q = system.drawn_q;
  state.v = VectorXd::Zero(system.nv);
  state.winding = system.drawn_winding;
  return state;
}

void compute_position_rates(const System& system, const VectorXd& q, const VectorXd& v, VectorXd& q_rate) {
  for (std::size_t i = 1; i < system.nodes.size(); ++i) {
    const Node& node = system.nodes[i];
    const int at = node.type->quaternion_at;
    if (at < 0) {
      for (int k = 0; k < node.nq; ++k) q_rate[node.q + k] = v[node.v + k];
      continue;
    }
    for (int k = 0; k < at; ++k) q_rate[node.q + k] = v[node.v + 3 + k];  // free: velocities follow ω
    // q' = ½ ω ⊗ q with ω in first-body axes.
    const double* u = q.data() + node.q + at;
    const double* w = v.data() + node.v;
    double* r = q_rate.data() + node.q + at;
    r[0] = 0.5 * (-w[0] * u[1] - w[1] * u[2] - w[2] * u[3]);
    r[1] = 0.5 * (w[0] * u[0] + w[1] * u[3] - w[2] * u[2]);
    r[2] = 0.5 * (-w[0] * u[3] + w[1] * u[0] + w[2] * u[1]);
    r[3] = 0.5 * (w[0] * u[2] - w[1] * u[1] + w[2] * u[0]);
  }
}

void displace(const System& system, const VectorXd& dv, VectorXd& q) {
  for (std::size_t i = 1; i < system.nodes.size(); ++i) {
    const Node& node = system.nodes[i];
    const int at = node.type->quaternion_at;
    if (at < 0) {
      for (int k = 0; k < node.nq; ++k) q[node.q + k] += dv[node.v + k];
      continue;
    }
    for (int k = 0; k < at; ++k) q[node.q + k] += dv[node.v + 3 + k];
    double* u = q.data() + node.q + at;
    Eigen::Quaterniond turned = quaternion_exp(dv.segment<3>(node.v)) * Eigen::Quaterniond(u[0], u[1], u[2], u[3]);
    turned.normalize();
    u[0] = turned.w();
    u[1] = turned.x();
    u[2] = turned.y();
    u[3] = turned.z();
  }
}

void normalize_quaternions(const System& system, VectorXd& q) {
  for (const Node& node : system.nodes) {
    if (node.type && node.type->quaternion_at >= 0) q.segment<4>(node.q + node.type->quaternion_at).normalize();
  }
}

}  // namespace ferrers
