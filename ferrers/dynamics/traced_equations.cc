#include "ferrers/dynamics/traced_equations.h"

#include <algorithm>
#include <utility>

#include "ferrers/dynamics/composites.h"
#include "ferrers/dynamics/equations.h"
#include "ferrers/dynamics/spring_forces.h"

namespace ferrers {
namespace {

bool in_tree(const std::vector<CoordinateAccess>& accesses) {
  return std::all_of(accesses.begin(), accesses.end(), [](const CoordinateAccess& one) { return one.in_tree; });
}

}  // namespace

bool has_untraced_forces(const DynamicsModel& model) {
  return !model.bushings.empty() || !model.loads.empty() || model.lagrangian.has_forces ||
         !std::all_of(model.torsion_springs.begin(), model.torsion_springs.end(), is_traced);
}

bool other_forces_read_poses(const DynamicsModel& model) {
  if (has_untraced_forces(model) || !model.frictions.empty()) return true;
  return std::any_of(model.drives.begin(), model.drives.end(), [](const DriveComponent& drive) {
    return drive.acts && (drive.kind != Drive::Kind::kCoordinate || !drive.access.in_tree ||
                          (drive.effort && !in_tree(drive.effort->accesses)));
  });
}

std::vector<int> tags_of_coordinates(const System& system) {
  std::vector<int> tags(static_cast<std::size_t>(system.nv));
  for (const Node& node : system.nodes) std::fill_n(tags.begin() + node.v, node.nv, node.v);
  return tags;
}

std::vector<int> tags_of_rows(const System& system) {
  std::vector<int> tags(static_cast<std::size_t>(system.m), system.nv);
  for (const CutJoint& cut : system.cuts) {
    std::fill_n(tags.begin() + cut.row, cut.type->row_count(), system.nv + 1 + cut.row);
  }
  return tags;
}

namespace {

std::vector<int> tags_of_inputs(const System& system) {
  std::vector<int> tags(static_cast<std::size_t>(system.nq + system.nv + system.winding_count));
  for (const Node& node : system.nodes) {
    std::fill_n(tags.begin() + node.q, node.nq, node.v);
    std::fill_n(tags.begin() + system.nq + node.v, node.nv, node.v);
  }
  for (const CutJoint& cut : system.cuts) {
    std::fill(tags.begin() + system.nq + system.nv + cut.winding, tags.end(), system.nv + 1 + cut.row);
  }
  return tags;
}

}  // namespace

TracedEquations trace_equations(const DynamicsModel& model, Trace& trace) {
  const System& system = *model.system;
  TracedEquations out;
  Eigen::VectorX<Traced> q(system.nq), v(system.nv), winding(system.winding_count);
  int inputs = 0;
  for (auto* vector : {&q, &v, &winding}) {
    for (Traced& input : *vector) input = trace.input(inputs++);
  }
  out.input_tags = tags_of_inputs(system);
  auto pos = make_basic_position_kinematics<Traced>(system);
  auto vel = make_basic_velocity_kinematics<Traced>(system);
  compute_positions(system, q, pos);
  compute_velocities(system, pos, q, v, vel);

  for (int i = 1; i < system.body_nodes; ++i) {
    out.places.push_back(pos.nodes[i].p.squaredNorm());
    out.speeds.push_back(vel.nodes[i].v.squaredNorm());
    out.turns.push_back(vel.nodes[i].w.squaredNorm());
  }

  std::vector<BasicComposite<Traced>> composites(system.nodes.size());
  load_composites<Traced>(model, inertias_about_origins(model), pos, &vel, composites);
  const auto pull = [&](const MovingPoint<Traced>& point, int node, const Eigen::Matrix<Traced, 3, 1>& force) {
    composites[node].force -= force;
    composites[node].moment -= point.arm.cross(force);
    out.power += force.dot(point.rate);
  };
  for (const BoundSpring& spring : model.springs) {
    const auto first = moving_point(pos, vel, spring.point_1), second = moving_point(pos, vel, spring.point_2);
    const Eigen::Matrix<Traced, 3, 1> force = spring_force(spring, first, second);
    pull(first, spring.point_1.node, force);
    pull(second, spring.point_2.node, -force);
  }
  const auto add = [](int index, const Traced& value, std::vector<TracedEquations::Number>& to) {
    if (!value.is_zero()) to.push_back({index, value});
  };
  sweep_composites<Traced>(
      system, pos, composites,
      [&](int k, int column, const Traced& value) {
        if (!value.is_zero() && k <= column) out.M.push_back({k, column, value});
      },
      [&](int k, const Traced& value) { add(k, value, out.h); });
  for (const BoundTorsionSpring& spring : model.torsion_springs) {
    if (!is_traced(spring)) continue;
    const Traced effort = torsion_spring_effort(spring, q[spring.access.q], v[spring.access.v]);
    add(spring.access.v, -effort, out.h);
    out.power += effort * v[spring.access.v];
  }
  for (const CutJoint& cut : system.cuts) {
    const BasicRelativeMotion<Traced> motion = compute_relative_motion(cut.frames, pos, vel);
    BasicJet<Traced> rows[6];
    cut.type->rows(cut.constants, motion, winding.data() + cut.winding, rows);
    for (int i = 0; i < cut.type->row_count(); ++i) {
      add(cut.row + i, rows[i].value, out.phi);
      add(cut.row + i, rows[i].rate, out.rate);
      add(cut.row + i, -rows[i].bias, out.gamma);
    }
    for_each_entry(system, cut, pos, rows, [&](int i, int k, const Traced& value) {
      if (!value.is_zero()) out.G.push_back({cut.row + i, k, value});
    });
  }
  return out;
}

}  // namespace ferrers
