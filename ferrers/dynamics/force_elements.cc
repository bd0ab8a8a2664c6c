#include "ferrers/dynamics/equations.h"
#include "ferrers/dynamics/spring_forces.h"

namespace ferrers {
namespace {

struct Context {
  const DynamicsModel& model;
  const State& state;
  const PositionKinematics& pos;
  const VelocityKinematics& vel;
  std::vector<Wrenches>& on_nodes;
  VectorXd& efforts;
  const System& system() const { return *model.system; }
};

void add_force(const Context& c, int node, const Vector3d& p, const Vector3d& moment, const Vector3d& force) {
  c.on_nodes[node].col(0).head<3>() += moment + (p - c.pos.nodes[node].p).cross(force);
  c.on_nodes[node].col(0).tail<3>() += force;
}

void add_spring(const Context& c, const BoundSpring& s) {
  const auto first = moving_point<double>(c.pos, c.vel, s.point_1), second = moving_point(c.pos, c.vel, s.point_2);
  if (first.place == second.place) return;  // no direction: a spring between coincident points pulls nowhere
  const Vector3d tension = spring_force(s, first, second);
  add_force(c, s.point_1.node, first.place, Vector3d::Zero(), tension);
  add_force(c, s.point_2.node, second.place, Vector3d::Zero(), -tension);
}

// An effort along a coordinate: an entry of tau, or a pair of wrenches at a cut joint.
void add_effort(const Context& c, const CoordinateAccess& access, const Jet& jet, double effort) {
  if (access.in_tree) {
    c.efforts[access.v] += effort;
    return;
  }
  const FramePair& frames = c.system().cuts[access.cut].frames;
  const Vector3d p_M = point_position(c.pos, {frames.node_2, frames.X_2M.p});
  const Wrench w = jet.W * effort;
  add_force(c, frames.node_2, p_M, w.head<3>(), w.tail<3>());
  add_force(c, frames.node_1, p_M, -w.head<3>(), -w.tail<3>());
}

void add_torsion_spring(const Context& c, const BoundTorsionSpring& s) {
  const Jet jet = measure_coordinate(c.system(), s.access, c.state, c.pos, c.vel);
  add_effort(c, s.access, jet, torsion_spring_effort(s, jet.value, jet.rate));
}

// J_l⁻ᵀ(θ) m: the moment that has the power m · dθ/dt for a rotation vector θ turning with ω.
Vector3d moment_of_rotation_vector(const Vector3d& theta, const Vector3d& m) {
  const double angle = theta.norm();
  const Matrix3d X = cross_matrix(theta);
  const double half = 0.5 * angle;
  const double k = angle < 1e-4 ? 1.0 / 12 : (1 - half / std::tan(half)) / (angle * angle);
  const Matrix3d J_inverse = Matrix3d::Identity() - 0.5 * X + k * X * X;
  return J_inverse.transpose() * m;
}

void add_bushing(const Context& c, const BoundBushing& b) {
  const RelativeMotion m = compute_relative_motion(b.frames, c.pos, c.vel);
  const Matrix3d R = m.R_F.transpose();
  const Vector3d theta = rotation_log(R * m.R_M);
  const Vector3d force = -b.stiffness.head<3>().cwiseProduct(R * m.d) - b.damping.head<3>().cwiseProduct(R * m.v);
  const Vector3d moment = -moment_of_rotation_vector(theta, b.stiffness.tail<3>().cwiseProduct(theta)) -
                          b.damping.tail<3>().cwiseProduct(R * m.w);
  const Vector3d p_M = point_position(c.pos, {b.frames.node_2, b.frames.X_2M.p});
  add_force(c, b.frames.node_2, p_M, m.R_F * moment, m.R_F * force);
  add_force(c, b.frames.node_1, p_M, -(m.R_F * moment), -(m.R_F * force));
}

void add_load(const Context& c, const BoundLoad& load) {
  Vector3d value;
  for (int i = 0; i < 3; ++i) value[i] = load.components[i].evaluate(c.system(), c.state, c.pos, c.vel);
  if (load.in_body_axes) value = c.pos.nodes[load.point.node].R * (load.R_NB * value);
  const Vector3d p = point_position(c.pos, load.point);
  if (load.is_torque) {
    add_force(c, load.point.node, p, value, Vector3d::Zero());
  } else {
    add_force(c, load.point.node, p, Vector3d::Zero(), value);
  }
}

}  // namespace

void compute_force_elements(const DynamicsModel& model, const State& state, const PositionKinematics& pos,
                            const VelocityKinematics& vel, std::vector<Wrenches>& on_nodes, VectorXd& efforts,
                            ForceElements which) {
  const Context c{model, state, pos, vel, on_nodes, efforts};
  const bool all = which == ForceElements::kAll;
  if (all) {
    for (const BoundSpring& s : model.springs) add_spring(c, s);
  }
  for (const BoundTorsionSpring& s : model.torsion_springs) {
    if (all || !is_traced(s)) add_torsion_spring(c, s);
  }
  for (const BoundBushing& b : model.bushings) add_bushing(c, b);
  for (const BoundLoad& load : model.loads) add_load(c, load);
}

}  // namespace ferrers
