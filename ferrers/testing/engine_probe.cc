#include "ferrers/testing/engine_probe.h"

#include <Eigen/LU>
#include <stdexcept>

#include "ferrers/dynamics/initial_state.h"

namespace ferrers::witness {
namespace {

Model build_or_throw(const ModelSpec& spec) {
  ModelBuildResult built = build_model(spec);
  if (built.model) return std::move(*built.model);
  const auto& items = built.diagnostics.items();
  throw std::invalid_argument("EngineProbe: " + (items.empty() ? std::string("no model") : items.front().message));
}

Vector3d velocity_of(const Model& model, const AbsoluteState& state, BodyId body, const Vector3d& at_W) {
  const Vector3d centre = state.poses[body.index()] * model.body(body).com_m;
  const Vector6d& twist = state.twists[body.index()];
  return twist.tail<3>() + twist.head<3>().cross(at_W - centre);
}

// Rotations and free motions are measured between the joint's frames; a body without a joint moves against ground.
void set_rotation(const Model& model, const Node& node, const Joint* joint, const AbsoluteState& absolute,
                  State& state) {
  const BodyId first = joint ? joint->first : kGround, second = joint ? joint->second : node.body;
  const Pose X_WF = absolute.poses[first.index()] * (joint ? joint->X_1F : node.X_PJ);
  const Pose X_WM = absolute.poses[second.index()] * (joint ? joint->X_2M : node.X_BN);
  const Matrix3d to_F = X_WF.R.transpose();
  const Eigen::Quaterniond turn(Matrix3d(to_F * X_WM.R));
  double* q = state.q.data() + node.q;
  double* v = state.v.data() + node.v;
  const double turns[] = {turn.w(), turn.x(), turn.y(), turn.z()};
  std::copy(turns, turns + 4, q + node.type->quaternion_at);
  const Vector3d spin = to_F * (absolute.twists[second.index()].head<3>() - absolute.twists[first.index()].head<3>());
  std::copy(spin.data(), spin.data() + 3, v);
  if (node.nv < 6) return;
  const Vector3d place = to_F * (X_WM.p - X_WF.p);
  const Vector3d rate =
      to_F * (velocity_of(model, absolute, second, X_WM.p) - velocity_of(model, absolute, first, X_WM.p));
  std::copy(place.data(), place.data() + 3, q);
  std::copy(rate.data(), rate.data() + 3, v + 3);
}

}  // namespace

State tree_state(const System& system, const AbsoluteState& absolute) {
  const Model& model = *system.model;
  State state = make_drawn_state(system);
  for (std::size_t i = 1; i < system.nodes.size(); ++i) {
    const Node& node = system.nodes[i];
    const JointId id = system.topology->forest.nodes[i].joint;
    if (node.type->quaternion_at >= 0) {
      set_rotation(model, node, id.valid() ? &model.joint(id) : nullptr, absolute, state);
      continue;
    }
    for (int k = 0; k < node.nv; ++k) {
      state.q[node.q + k] = coordinate_position(model, absolute.poses, {id, k});
      state.v[node.v + k] = coordinate_velocity(model, absolute, {id, k});
    }
  }
  PositionKinematics pos = make_position_kinematics(system);
  compute_positions(system, state.q, pos);
  accept_winding(system, pos, state);
  return state;
}

AbsoluteState absolute_state(const System& system, const State& state) {
  PositionKinematics pos = make_position_kinematics(system);
  VelocityKinematics vel = make_velocity_kinematics(system);
  compute_positions(system, state.q, pos);
  compute_velocities(system, pos, state.q, state.v, vel);
  AbsoluteState out = drawn_state(*system.model);
  for (std::size_t b = 1; b < out.poses.size(); ++b) {
    const BodyId body(b);
    out.poses[b] = body_pose(system, pos, body);
    const NodePoint centre = system.point(body, system.model->body(body).com_m);
    out.twists[b] << vel.nodes[centre.node].w, point_velocity(pos, vel, centre);
  }
  return out;
}

EngineProbe::EngineProbe(const ModelSpec& spec, const TopologyOptions& options)
    : system(make_system(build_or_throw(spec), options)),
      dynamics(make_dynamics_model(system)),
      scaling(system->scaling),
      eq(make_equations(*dynamics)) {}

State EngineProbe::start() const {
  InitialStateResult initial = make_initial_state(*dynamics);
  if (initial.status != InitialStateStatus::kReady) throw std::invalid_argument("EngineProbe: " + initial.message);
  return initial.state;
}

State EngineProbe::wandered(std::uint64_t seed, double distance, double speed) {
  RandomSource random(seed);
  State state = make_drawn_state(*system);
  evaluate(state);
  const auto admissible = [&](double size) {  // a random motion of the independent coordinates, the others following
    VectorXd v = VectorXd::Zero(system->nv);
    for (const int i : selection.independent) v[i] = random.between(-size, size);
    if (!selection.rows.empty()) {
      const MatrixXd G_d = eq.constraints.G(selection.rows, selection.dependent);
      const VectorXd rest = eq.constraints.G.dense_rows(selection.rows) * v;
      v(selection.dependent) = -G_d.partialPivLu().solve(rest);
    }
    return v;
  };
  constexpr int kSteps = 6;
  int iterations = 0;
  for (int i = 0; i < kSteps; ++i) {
    displace(*system, admissible(distance / kSteps), state.q);
    close_loops(*system, scaling, {}, 50, state, iterations);
    evaluate(state);
  }
  state.v = admissible(speed);
  evaluate(state);
  return state;
}

void EngineProbe::evaluate(const State& state) {
  compute_equations(*dynamics, state, eq);
  selection = select_independent(*system, scaling, eq.constraints);
}

ForwardResult EngineProbe::forward(const State& state, Formulation formulation) {
  evaluate(state);
  ForwardResult result = make_forward_result(*system);
  make_forward_solver(formulation, *system, selection)->solve(eq, result);
  return result;
}

std::vector<Vector6d> EngineProbe::body_accelerations(const VectorXd& vdot) const {
  VelocityKinematics acc = make_velocity_kinematics(*system);
  compute_accelerations(*system, eq.pos, eq.vel, vdot, acc);
  std::vector<Vector6d> out(model().bodies().size(), Vector6d::Zero());
  for (std::size_t b = 1; b < out.size(); ++b) {
    const NodePoint centre = system->point(BodyId(b), model().bodies()[b].com_m);
    out[b] << acc.nodes[centre.node].alpha, point_acceleration(eq.pos, acc, centre);
  }
  return out;
}

std::vector<JointReaction> EngineProbe::reactions(const State& state, const ForwardResult& result,
                                                  ReactionAxes axes) const {
  auto all = ReactionSolver(dynamics).solve(state, eq, selection, result.vdot, result.lambda, eq.u, axes);
  all.resize(model().coordinates_begin());
  return all;
}

}  // namespace ferrers::witness
