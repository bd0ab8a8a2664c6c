#include <cmath>
#include <stdexcept>

#include "ferrers/testing/absolute_internal.h"

namespace ferrers::witness {
namespace {

/// Everything an applied force reads, and where it adds its wrenches.
struct Context {
  const Model& model;
  const AbsoluteState& state;
  double t_s;
  std::vector<Placement<double>> places;
  std::vector<Vector6d>& wrenches;

  Vector3d point(BodyId body, const Vector3d& in_body) const { return state.poses[body.index()] * in_body; }

  Vector3d velocity(BodyId body, const Vector3d& at_W) const {
    const Vector6d& twist = state.twists[body.index()];
    return twist.tail<3>() + twist.head<3>().cross(at_W - places[body.index()].c);
  }

  void add(BodyId body, const Vector3d& force, const Vector3d& at_W, const Vector3d& couple = Vector3d::Zero()) {
    Vector6d& w = wrenches[body.index()];
    w.head<3>() += couple + (at_W - places[body.index()].c).cross(force);
    w.tail<3>() += force;
  }

  void add_pair(BodyId first, BodyId second, const Vector3d& force, const Vector3d& at_W,
                const Vector3d& couple = Vector3d::Zero()) {
    add(second, force, at_W, couple);
    add(first, -force, at_W, -couple);
  }

  void effort(JointCoordinate coordinate, double value) {
    const Joint& joint = model.joint(coordinate.joint);
    const RowWrench<double> w =
        coordinate_row<double>(joint, coordinate.index, places[joint.first.index()], places[joint.second.index()]);
    add_pair(joint.first, joint.second, value * w.f, w.p, value * w.m);
  }

  double law(const Law& l) const {
    std::vector<double> values;
    for (const LawInput& input : l.inputs()) {
      switch (input.kind) {
        case LawInput::Kind::kTime:
          values.push_back(t_s);
          break;
        case LawInput::Kind::kPosition:
          values.push_back(coordinate_position(model, state.poses, input.scalar.coordinate));
          break;
        case LawInput::Kind::kVelocity:
          values.push_back(coordinate_velocity(model, state, input.scalar.coordinate));
          break;
      }
    }
    return l.value(values.data());
  }
};

void apply(const Spring& spring, Context& c) {
  const Vector3d a = c.point(spring.first, spring.point_1_m), b = c.point(spring.second, spring.point_2_m);
  const double length = (b - a).norm();
  const Vector3d u = (b - a) / length;
  const double rate = u.dot(c.velocity(spring.second, b) - c.velocity(spring.first, a));
  const double pull = spring.stiffness * (length - spring.free_length_m) + spring.damping * rate;
  c.add(spring.second, -pull * u, b);
  c.add(spring.first, pull * u, a);
}

void apply(const TorsionSpring& spring, Context& c) {
  const double angle = coordinate_position(c.model, c.state.poses, spring.coordinate);
  const double rate = coordinate_velocity(c.model, c.state, spring.coordinate);
  c.effort(spring.coordinate, -spring.stiffness * (angle - spring.free_angle) - spring.damping * rate);
}

void apply(const JointDamping& damping, Context& c) {
  c.effort(damping.coordinate, -damping.damping * coordinate_velocity(c.model, c.state, damping.coordinate));
}

/// A bushing as two diagonal laws in F axes, its pair of opposite wrenches acting at M's origin.
void apply(const Bushing& bushing, Context& c) {
  const Pose X_WF = c.state.poses[bushing.first.index()] * bushing.X_1F;
  const Pose X_WM = c.state.poses[bushing.second.index()] * bushing.X_2M;
  const Vector3d stretch = X_WF.R.transpose() * (X_WM.p - X_WF.p);
  const Vector3d turn = rotation_log(X_WF.R.transpose() * X_WM.R);
  const Vector3d rate = X_WF.R.transpose() * (c.velocity(bushing.second, X_WM.p) - c.velocity(bushing.first, X_WM.p));
  const Vector3d spin = X_WF.R.transpose() * (c.state.twists[bushing.second.index()].head<3>() -
                                              c.state.twists[bushing.first.index()].head<3>());
  const Vector3d force =
      bushing.stiffness.head<3>().cwiseProduct(stretch) + bushing.damping.head<3>().cwiseProduct(rate);
  const Vector3d couple = bushing.stiffness.tail<3>().cwiseProduct(turn) + bushing.damping.tail<3>().cwiseProduct(spin);
  c.add_pair(bushing.first, bushing.second, -X_WF.R * force, X_WM.p, -X_WF.R * couple);
}

void apply(const Load& load, Context& c) {
  Vector3d value(c.law(load.components[0]), c.law(load.components[1]), c.law(load.components[2]));
  if (load.in_body_axes) value = c.state.poses[load.body.index()].R * value;
  const Vector3d at = c.point(load.body, load.point_m);
  if (load.is_torque) {
    c.add(load.body, Vector3d::Zero(), at, value);
  } else {
    c.add(load.body, value, at);
  }
}

void apply_drive(const Drive& drive, Context& c) {
  if (drive.effort.empty()) return;
  switch (drive.kind) {
    case Drive::Kind::kCoordinate:
      c.effort(drive.coordinate, c.law(drive.effort[0]));
      break;
    case Drive::Kind::kDistance: {
      const Vector3d a = c.point(drive.first, drive.point_1_m), b = c.point(drive.second, drive.point_2_m);
      const Vector3d push = c.law(drive.effort[0]) * (b - a).normalized();
      c.add(drive.second, push, b);
      c.add(drive.first, -push, a);
      break;
    }
    case Drive::Kind::kPoint:
      c.add(drive.second, Vector3d(c.law(drive.effort[0]), c.law(drive.effort[1]), c.law(drive.effort[2])),
            c.point(drive.second, drive.point_2_m));
      break;
    case Drive::Kind::kFormula:
      throw std::invalid_argument("the witness has no drives by formulas");
  }
}

void apply_viscous_friction(const Joint& joint, int index, Context& c) {
  if (!joint.friction || joint.friction->viscous == 0) return;
  const int coordinates = 6 - static_cast<int>(row_components(joint.type).size());
  for (int i = 0; i < coordinates; ++i) {
    const JointCoordinate coordinate{JointId(index), i};
    c.effort(coordinate, -joint.friction->viscous * coordinate_velocity(c.model, c.state, coordinate));
  }
}

double spring_energy(const Spring& spring, const std::vector<Pose>& poses) {
  const Vector3d a = poses[spring.first.index()] * spring.point_1_m,
                 b = poses[spring.second.index()] * spring.point_2_m;
  const double stretch = (b - a).norm() - spring.free_length_m;
  return 0.5 * spring.stiffness * stretch * stretch;
}

double bushing_energy(const Bushing& bushing, const std::vector<Pose>& poses) {
  const Pose X_FM =
      (poses[bushing.first.index()] * bushing.X_1F).inverse() * (poses[bushing.second.index()] * bushing.X_2M);
  const Vector3d turn = rotation_log(X_FM.R);
  return 0.5 * (X_FM.p.dot(bushing.stiffness.head<3>().cwiseProduct(X_FM.p)) +
                turn.dot(bushing.stiffness.tail<3>().cwiseProduct(turn)));
}

}  // namespace

double coordinate_position(const Model& model, const std::vector<Pose>& poses, JointCoordinate coordinate) {
  const Joint& joint = model.joint(coordinate.joint);
  const Pose X_FM = (poses[joint.first.index()] * joint.X_1F).inverse() * (poses[joint.second.index()] * joint.X_2M);
  const double about_z = std::atan2(X_FM.R(1, 0), X_FM.R(0, 0));
  switch (joint.type) {
    case JointType::kRevolute:
    case JointType::kScrew:
      return about_z;
    case JointType::kPrismatic:
      return X_FM.p.z();
    case JointType::kCylindrical:
      return coordinate.index == 0 ? about_z : X_FM.p.z();
    case JointType::kUniversal:
      return coordinate.index == 0 ? about_z : std::atan2(X_FM.R(2, 1), X_FM.R(2, 2));
    case JointType::kPlanar:
      return coordinate.index == 2 ? about_z : X_FM.p[coordinate.index];
    default:
      throw std::invalid_argument("coordinate_position: joint '" + joint.name + "' has no scalar coordinate");
  }
}

double coordinate_velocity(const Model& model, const AbsoluteState& state, JointCoordinate coordinate) {
  const Joint& joint = model.joint(coordinate.joint);
  const std::vector<Placement<double>> places = placements(model, state.poses);
  const Placement<double>& first = places[joint.first.index()];
  const Placement<double>& second = places[joint.second.index()];
  const RowWrench<double> w = coordinate_row<double>(joint, coordinate.index, first, second);
  const Vector6d& a = state.twists[joint.first.index()];
  const Vector6d& b = state.twists[joint.second.index()];
  const Vector3d va = a.tail<3>() + a.head<3>().cross(w.p - first.c);
  const Vector3d vb = b.tail<3>() + b.head<3>().cross(w.p - second.c);
  return w.m.dot(b.head<3>() - a.head<3>()) + w.f.dot(vb - va);
}

void add_coordinate_effort(const Model& model, const std::vector<Pose>& poses, JointCoordinate coordinate,
                           double effort, std::vector<Vector6d>& wrenches) {
  require_size(static_cast<long>(wrenches.size()), static_cast<long>(poses.size()), "wrenches");
  const AbsoluteState state{poses, std::vector<Vector6d>(poses.size(), Vector6d::Zero())};
  Context c{model, state, 0, placements(model, poses), wrenches};
  c.effort(coordinate, effort);
}

std::vector<Vector6d> applied_wrenches(const Model& model, const AbsoluteState& state, double t_s,
                                       const AppliedForcesOptions& options) {
  std::vector<Vector6d> wrenches(state.poses.size(), Vector6d::Zero());
  Context c{model, state, t_s, placements(model, state.poses), wrenches};
  if (options.gravity) {
    for (std::size_t i = 1; i < wrenches.size(); ++i) {
      wrenches[i].tail<3>() += model.bodies()[i].mass_kg * model.gravity();
    }
  }
  if (options.elements) {
    for (const ForceElement& force : model.forces()) {
      std::visit([&](const auto& element) { apply(element, c); }, force.element);
    }
    for (int j = 0; j < static_cast<int>(model.joints().size()); ++j) apply_viscous_friction(model.joints()[j], j, c);
  }
  if (options.drive_efforts) {
    for (const Drive& drive : model.drives()) apply_drive(drive, c);
  }
  return wrenches;
}

double total_energy(const Model& model, const AbsoluteState& state) {
  const Eigen::VectorXd V = stacked(state.twists);
  double energy = 0.5 * V.dot(absolute_mass_matrix(model, state.poses) * V);
  const std::vector<Placement<double>> places = placements(model, state.poses);
  for (std::size_t i = 1; i < places.size(); ++i) {
    energy -= model.bodies()[i].mass_kg * model.gravity().dot(places[i].c);
  }
  for (const ForceElement& force : model.forces()) {
    if (const auto* spring = std::get_if<Spring>(&force.element)) energy += spring_energy(*spring, state.poses);
    if (const auto* bushing = std::get_if<Bushing>(&force.element)) energy += bushing_energy(*bushing, state.poses);
    if (const auto* torsion = std::get_if<TorsionSpring>(&force.element)) {
      const double turn = coordinate_position(model, state.poses, torsion->coordinate) - torsion->free_angle;
      energy += 0.5 * torsion->stiffness * turn * turn;
    }
  }
  return energy;
}

}  // namespace ferrers::witness
