#include "ferrers/dynamics/named_coordinates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace ferrers {
namespace {

constexpr std::size_t kMostNames = 4;
constexpr double kLeastShare = 0.1;  // of the largest part in a motion: named as well

NamedCoordinate::Unit unit_of(CoordinateKind kind) {
  if (kind == CoordinateKind::kOther) return NamedCoordinate::Unit::kNone;
  const bool angular = kind == CoordinateKind::kAngle || kind == CoordinateKind::kRotationRate;
  return angular ? NamedCoordinate::Unit::kRadian : NamedCoordinate::Unit::kMetre;
}

// Calls use(joint, type, motion) for all joints.
template <typename Use>
void for_joints(const System& system, const State& state, Use use) {
  PositionKinematics pos = make_position_kinematics(system);
  VelocityKinematics vel = make_velocity_kinematics(system);
  compute_positions(system, state.q, pos);
  compute_velocities(system, pos, state.q, state.v, vel);
  const VectorXd rest = VectorXd::Zero(system.nv);
  for (std::size_t j = 0; j < system.model->joints().size(); ++j) {
    const Joint& joint = system.model->joints()[j];
    use(joint, joint_type_info(joint.type), measure_joint(system, JointId(j), state, rest, pos, vel));
  }
}

}  // namespace

std::vector<NamedCoordinate> measure_positions(const System& system, const State& state) {
  std::vector<NamedCoordinate> all;
  for_joints(system, state, [&](const Joint& joint, const JointTypeInfo& type, const JointMotion& motion) {
    for (int i = 0; i < type.nq; ++i) {
      NamedCoordinate one{coordinate_label(joint, type.position_names[i]), NamedCoordinate::Unit::kNone, motion.q[i]};
      if (type.quaternion_at < 0) {
        one.unit = unit_of(type.coordinates[i].kind);
      } else if (i < type.quaternion_at) {
        one.unit = NamedCoordinate::Unit::kMetre;
      }
      all.push_back(std::move(one));
    }
  });
  return all;
}

std::vector<NamedCoordinate> measure_rates(const System& system, const State& state, const VectorXd& v) {
  State moving = state;
  moving.v = v;
  std::vector<NamedCoordinate> all;
  for_joints(system, moving, [&](const Joint& joint, const JointTypeInfo& type, const JointMotion& motion) {
    for (int i = 0; i < type.nv; ++i) {
      all.push_back(
          {coordinate_label(joint, type.coordinates[i].name), unit_of(type.coordinates[i].kind), motion.v[i]});
    }
  });
  return all;
}

std::vector<NamedCoordinate> name_independent(const System& system, const Selection& selection, const VectorXd& v) {
  std::vector<NamedCoordinate> all(static_cast<std::size_t>(system.nv));
  for (std::size_t i = 1; i < system.nodes.size(); ++i) {
    const Node& node = system.nodes[i];
    const JointId id = system.topology->forest.nodes[i].joint;
    for (int k = 0; k < node.nv; ++k) {
      const CoordinateInfo& info = node.type->coordinates[k];
      const std::string name = id.valid() ? coordinate_label(system.model->joint(id), info.name)
                                          : system.model->body(node.body).name + "." + std::string(info.name);
      all[node.v + k] = {name, unit_of(info.kind), v[node.v + k]};
    }
  }
  std::vector<NamedCoordinate> chosen;
  for (const int i : selection.independent) chosen.push_back(all[static_cast<std::size_t>(i)]);
  return chosen;
}

std::string name_motion(const System& system, const Scaling& scaling, const State& state, const VectorXd& v,
                        std::string_view unit_suffix) {
  std::vector<NamedCoordinate> all = measure_rates(system, state, v);
  const auto part = [&](const NamedCoordinate& one) {
    return std::abs(one.value) * (one.unit == NamedCoordinate::Unit::kRadian ? scaling.length_m : 1);
  };
  std::stable_sort(all.begin(), all.end(), [&](const auto& a, const auto& b) { return part(a) > part(b); });
  std::string text;
  for (std::size_t i = 0; i < std::min(all.size(), kMostNames); ++i) {
    if (!(part(all[i]) > kLeastShare * part(all[0]))) break;
    text += fmt::format("{}{} ({:.6g} {}{})", i > 0 ? ", " : "", all[i].name, all[i].value, to_string(all[i].unit),
                        unit_suffix);
  }
  return text;
}

std::string_view to_string(NamedCoordinate::Unit unit) {
  switch (unit) {
    case NamedCoordinate::Unit::kRadian:
      return "rad";
    case NamedCoordinate::Unit::kMetre:
      return "m";
    case NamedCoordinate::Unit::kNone:
      break;
  }
  return "";
}

}  // namespace ferrers
