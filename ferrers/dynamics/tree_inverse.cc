#include "ferrers/dynamics/tree_inverse.h"

#include <utility>

#include "ferrers/core/checks.h"
#include "ferrers/dynamics/equations.h"
#include "ferrers/math/traced.h"

namespace ferrers {
namespace {

// Adds to the bias accelerations what `vdot` gives, node by node outwards.
template <class T>
void add_accelerations(const System& system, const BasicPositionKinematics<T>& pos,
                       const Eigen::Matrix<T, Eigen::Dynamic, 1>& vdot, std::vector<BasicComposite<T>>& work,
                       BasicVelocityKinematics<T>& vel) {
  using Vector = Eigen::Matrix<T, 3, 1>;
  for (int i = 1; i < system.body_nodes; ++i) {
    const Node& node = system.nodes[i];
    Vector alpha = Vector::Zero(), a = Vector::Zero();
    if (node.parent > 0) {  // kept in the parent's composite until it is loaded
      const Vector r = pos.nodes[i].p - pos.nodes[node.parent].p;
      alpha = work[node.parent].moment;
      a = work[node.parent].force + alpha.cross(r);
    }
    for (int k = node.v; k < node.v + node.nv; ++k) {
      alpha += pos.S[k].template head<3>() * vdot[k];
      a += pos.S[k].template tail<3>() * vdot[k];
    }
    work[i].moment = alpha;
    work[i].force = a;
    vel.nodes[i].alpha += alpha;
    vel.nodes[i].a += a;
  }
}

/// `write(k, effort)` for every coordinate of the tree. `pos` and `vel` are filled, `bodies` are used up.
template <class T, class Write>
void sweep_wrenches(const DynamicsModel& model, const std::vector<Matrix3d>& inertias_N,
                    const Eigen::Matrix<T, Eigen::Dynamic, 1>& q, const Eigen::Matrix<T, Eigen::Dynamic, 1>& v,
                    const Eigen::Matrix<T, Eigen::Dynamic, 1>& vdot, BasicPositionKinematics<T>& pos,
                    BasicVelocityKinematics<T>& vel, std::vector<BasicComposite<T>>& bodies, Write write) {
  using Vector = Eigen::Matrix<T, 3, 1>;
  const System& system = *model.system;
  compute_positions(system, q, pos);
  compute_velocities(system, pos, q, v, vel);
  add_accelerations<T>(system, pos, vdot, bodies, vel);
  load_composites<T>(model, inertias_N, pos, &vel, bodies);
  for (int i = system.body_nodes - 1; i > 0; --i) {
    const Node& node = system.nodes[i];
    const BasicComposite<T>& body = bodies[i];
    for (int k = node.v; k < node.v + node.nv; ++k) {
      write(k, body.moment.dot(pos.S[k].template head<3>()) + body.force.dot(pos.S[k].template tail<3>()));
    }
    if (node.parent <= 0) continue;
    const Vector r = pos.nodes[i].p - pos.nodes[node.parent].p;
    bodies[node.parent].moment += body.moment + r.cross(body.force);
    bodies[node.parent].force += body.force;
  }
}

}  // namespace

TreeInverse::TreeInverse(std::shared_ptr<const DynamicsModel> model)
    : model_(std::move(model)),
      inertias_N_(inertias_about_origins(*model_)),
      pos_(make_position_kinematics(*model_->system)),
      vel_(make_velocity_kinematics(*model_->system)),
      bodies_(model_->system->nodes.size()),
      efforts_(VectorXd::Zero(model_->system->nv)) {
  require(model_->lagrangian.scalars.empty(), "TreeInverse: energies by formulas are not the bodies'");
  if (has_machine_code()) make_kernel();
}

void TreeInverse::make_kernel() {
  const System& system = *model_->system;
  Trace trace;
  KernelTags tags;
  Eigen::VectorX<Traced> q(system.nq), v(system.nv), vdot(system.nv);
  const auto add_inputs = [&](Eigen::VectorX<Traced>& values, int Node::*first, int Node::*count) {
    const auto begin = static_cast<int>(tags.inputs.size());
    tags.inputs.resize(tags.inputs.size() + static_cast<std::size_t>(values.size()), 0);
    for (const Node& node : system.nodes) {
      for (int i = node.*first; i < node.*first + node.*count; ++i) tags.inputs[begin + i] = node.v;
    }
    for (int i = 0; i < values.size(); ++i) values[i] = trace.input(begin + i);
  };
  add_inputs(q, &Node::q, &Node::nq);
  add_inputs(v, &Node::v, &Node::nv);
  add_inputs(vdot, &Node::v, &Node::nv);
  auto pos = make_basic_position_kinematics<Traced>(system);
  auto vel = make_basic_velocity_kinematics<Traced>(system);
  std::vector<BasicComposite<Traced>> bodies(system.nodes.size());
  std::vector<int> outputs(static_cast<std::size_t>(system.nv), trace.value_of(Traced(0)));
  sweep_wrenches<Traced>(*model_, inertias_N_, q, v, vdot, pos, vel, bodies,
                         [&](int k, const Traced& effort) { outputs[k] = trace.value_of(effort); });
  tags.outputs.resize(outputs.size());
  for (const Node& node : system.nodes) {
    for (int k = node.v; k < node.v + node.nv; ++k) tags.outputs[k] = node.v;
  }
  kernel_ = Kernel(trace.graph(), outputs, tags);
  if (kernel_.is_native()) board_ = kernel_.make_board();
}

const VectorXd& TreeInverse::evaluate(const State& state, const VectorXd& vdot) {
  const bool reaches = !(state.q.size() > 0 && state.q.cwiseAbs().maxCoeff() > kFarthestAngle);
  if (!kernel_.is_native() || !reaches) {
    evaluate_parts(state, vdot);
    return efforts_;
  }
  double* const numbers = board_.data();
  const int* place = kernel_.inputs().data();
  for (const VectorXd* values : {&state.q, &state.v, &vdot}) {
    for (const double value : *values) {
      if (*place >= 0) numbers[*place] = value;
      ++place;
    }
  }
  kernel_.run(board_);
  for (long k = 0; k < efforts_.size(); ++k) efforts_[k] = numbers[kernel_.outputs()[static_cast<std::size_t>(k)]];
  return efforts_;
}

void TreeInverse::evaluate_parts(const State& state, const VectorXd& vdot) {
  efforts_.setZero();
  sweep_wrenches<double>(*model_, inertias_N_, state.q, state.v, vdot, pos_, vel_, bodies_,
                         [this](int k, double effort) { efforts_[k] = effort; });
}

}  // namespace ferrers
