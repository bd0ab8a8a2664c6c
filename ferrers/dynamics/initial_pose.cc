#include "ferrers/dynamics/initial_pose.h"

#include <algorithm>

#include "ferrers/core/checks.h"
#include "ferrers/kinematics/coordinates.h"
#include "ferrers/kinematics/floating_bodies.h"

namespace ferrers {
namespace {

std::string unused_name(const ModelSpec& spec, std::string name) {
  const auto has_name = [&](const auto& one) { return one.name.name == name; };
  while (std::any_of(spec.joints.begin(), spec.joints.end(), has_name) ||
         std::any_of(spec.couplings.begin(), spec.couplings.end(), has_name)) {
    name += "_";
  }
  return name;
}

Pose pose_of(const Joint& free, const Pose& X_WB) { return free.X_1F.inverse() * X_WB * free.X_2M; }

InitialSpec initial_guess(const std::string& joint, const double* q, int count) {
  InitialSpec initial;
  initial.joint = joint;
  initial.guess = true;
  for (int k = 0; k < count; ++k) initial.position.emplace_back(q[k]);
  return initial;
}

InitialSpec initial_pose(const Joint& free, const Pose& X_WB) {
  const Pose X_FM = pose_of(free, X_WB);
  const Eigen::Quaterniond turn(X_FM.R);
  const double q[7] = {X_FM.p.x(), X_FM.p.y(), X_FM.p.z(), turn.w(), turn.x(), turn.y(), turn.z()};
  return initial_guess(free.name, q, 7);
}

}  // namespace

ModelSpec with_initial_pose(ModelSpec spec, const System& system, const State& state) {
  PositionKinematics pos = make_position_kinematics(system);
  VelocityKinematics rest = make_velocity_kinematics(system);
  compute_positions(system, state.q, pos);
  const VectorXd still = VectorXd::Zero(system.nv);
  State at_rest = state;
  at_rest.v = still;
  compute_velocities(system, pos, at_rest.q, at_rest.v, rest);

  spec.initial.clear();
  const int given = static_cast<int>(system.model->coordinates_begin());
  for (const FloatingBody& floating : find_floating_bodies(system)) {
    JointSpec joint;
    joint.type = JointType::kFree;
    const std::string& body = system.model->body(system.nodes[static_cast<std::size_t>(floating.node)].body).name;
    joint.name = unused_name(spec, "float_" + body);
    joint.bodies = {NameRef("ground"), NameRef(body)};
    spec.joints.push_back(std::move(joint));
  }
  // Joints that carry bodies there: which ones may depend on those added.
  ModelBuildResult built = build_model(spec);
  require(built.model.has_value() && built.model->coordinates_begin() == spec.joints.size(),
          "with_initial_pose: the specification is not that of the system");
  const auto after = make_system(std::move(*built.model));
  for (std::size_t i = 1; i < after->nodes.size(); ++i) {
    const JointId id = after->topology->forest.nodes[i].joint;
    if (!id.valid() || after->nodes[i].nq == 0) continue;
    const Joint& joint = after->model->joint(id);
    if (id.index() < given || after->model->is_coordinate(id.index())) {
      const JointMotion motion =
          measure_joint(system, *system.model->find_joint(joint.name), at_rest, still, pos, rest);
      spec.initial.push_back(initial_guess(joint.name, motion.q, after->nodes[i].nq));
      continue;
    }
    const int n = system.topology->forest.node_of_body[joint.second.index()];
    const PositionKinematics::NodePosition& node = pos.nodes[static_cast<std::size_t>(n)];
    const Pose X_WN{node.R, node.p};
    spec.initial.push_back(initial_pose(joint, X_WN * system.nodes[static_cast<std::size_t>(n)].X_BN.inverse()));
  }
  return spec;
}

}  // namespace ferrers
