#include <Eigen/SVD>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "ferrers/testing/absolute_internal.h"

namespace ferrers::witness {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// Angle from x_F to x_M about z_F.
double angle_about_z(const JointFrames<double>& f) {
  return std::atan2(f.M.col(0).dot(f.F.col(1)), f.M.col(0).dot(f.F.col(0)));
}

/// The value of smallest size among value + i a + j b with |i|, |j| at most three turns.
double nearest(double value, double a, double b) {
  double best = value;
  for (int i = -3; i <= 3; ++i) {
    for (int j = -3; j <= 3; ++j) {
      const double candidate = value + i * a + j * b;
      if (std::abs(candidate) < std::abs(best)) best = candidate;
    }
  }
  return best;
}

/// Integral of the mesh row: with φ the direction of the line of centres, D its length, Δ = ρ₁ − ρ₂ and body angles θ,
///   ∫ s dD + ρ₂ (θ₂ − φ) − ρ₁ (θ₁ − φ),   ∫ s dD = ± (√(D² − Δ²) − Δ acos(Δ/D)),
/// which does not change as the teeth roll. The frames' angles relative to the line of centres stand for θ − φ.
double mesh_integral(const Joint& joint, const Pose& first, const Pose& second) {
  const JointConstants& k = joint.constants;
  const Pose F = first * joint.X_1F, M = second * joint.X_2M;
  const Vector3d z = F.R.col(2);
  Vector3d e = M.p - F.p;
  e -= z * z.dot(e);
  const double D = e.norm(), delta = k.base_radius_1_m - k.base_radius_2_m;
  const double turn_1 = -std::atan2(e.dot(F.R.col(1)), e.dot(F.R.col(0)));
  const double turn_2 = -std::atan2(e.dot(M.R.col(1)), e.dot(M.R.col(0)));
  const double stretch = k.mesh_side * (std::sqrt(D * D - delta * delta) - delta * std::acos(delta / D));
  return stretch + k.base_radius_2_m * turn_2 - k.base_radius_1_m * turn_1;
}

double mesh_residual(const Model& model, const Joint& joint, const std::vector<Pose>& poses,
                     const JointFrames<double>& f) {
  const JointConstants& k = joint.constants;
  if (k.mesh_holds_as_drawn_only) {
    const Pose drawn = model.body(joint.second).X_WB.inverse() * model.body(joint.first).X_WB * joint.X_1F;
    const Vector3d on_first = f.pF + f.F * k.pitch_point_F_m;
    const Vector3d on_second = poses[joint.second.index()] * (drawn * k.pitch_point_F_m);
    return (f.F * k.line_of_action_F).dot(on_second - on_first);
  }
  const double now = mesh_integral(joint, poses[joint.first.index()], poses[joint.second.index()]);
  const double drawn = mesh_integral(joint, model.body(joint.first).X_WB, model.body(joint.second).X_WB);
  return nearest(now - drawn, kTurn * k.base_radius_1_m, kTurn * k.base_radius_2_m);
}

/// Tilt of z_M against z_F (both small-angle components), completed by the turn about z where that is constrained.
Vector3d misalignment_of(const Joint& joint, const JointFrames<double>& f) {
  if (joint.type == JointType::kWeld || joint.type == JointType::kPrismatic) {
    return rotation_log(f.F.transpose() * f.M);
  }
  return f.F.transpose() * f.F.col(2).cross(f.M.col(2));
}

double residual_of(const Model& model, const Joint& joint, const std::string& component, const std::vector<Pose>& poses,
                   const JointFrames<double>& f) {
  if (joint.type == JointType::kDistance) return (f.pM - f.pF).norm() - joint.constants.length_m;
  if (joint.type == JointType::kGearMesh) return mesh_residual(model, joint, poses, f);
  if (joint.type == JointType::kUniversal && component == "moment_y") return -f.F.col(2).dot(f.M.col(0));
  const int axis = component.back() - 'x';
  if (component.front() == 'm') return misalignment_of(joint, f)[axis];
  const double offset = f.F.col(axis).dot(f.pM - f.pF);
  if (joint.type == JointType::kScrew && component == "force_z") {
    const double lead = joint.constants.lead_m;
    const double left = offset - lead / kTurn * angle_about_z(f);
    return left - lead * std::round(left / lead);
  }
  return offset;
}

double coupling_residual(const Model& model, const Coupling& coupling, const std::vector<Pose>& poses) {
  double sum = 0;
  double turns[2] = {0, 0};
  int angles = 0;
  for (std::size_t i = 0; i < coupling.scalars.size(); ++i) {
    const JointCoordinate coordinate = coupling.scalars[i].coordinate;
    sum += coupling.coefficients[i] * coordinate_position(model, poses, coordinate);
    const JointType type = model.joint(coordinate.joint).type;
    const bool length = type == JointType::kPrismatic || (type == JointType::kCylindrical && coordinate.index == 1) ||
                        (type == JointType::kPlanar && coordinate.index < 2);
    if (!length && angles < 2) turns[angles++] = kTurn * coupling.coefficients[i];
  }
  return nearest(sum, turns[0], turns[1]);
}

/// Position and velocity as plain numbers in a linear space: 9 of R, 3 of the mass centre and 6 of the twist a body.
Eigen::VectorXd ambient(const Model& model, const AbsoluteState& state) {
  Eigen::VectorXd y(18 * static_cast<long>(state.poses.size()));
  for (std::size_t i = 0; i < state.poses.size(); ++i) {
    const long at = 18 * static_cast<long>(i);
    y.segment<9>(at) = state.poses[i].R.reshaped();
    y.segment<3>(at + 9) = state.poses[i] * model.bodies()[i].com_m;
    y.segment<6>(at + 12) = state.twists[i];
  }
  return y;
}

/// The nearest state on the constraints.
AbsoluteState projected(const Model& model, const Eigen::VectorXd& y) {
  AbsoluteState state = drawn_state(model);
  for (std::size_t i = 1; i < state.poses.size(); ++i) {
    const long at = 18 * static_cast<long>(i);
    const Matrix3d R = y.segment<9>(at).reshaped(3, 3);
    const Eigen::JacobiSVD<Matrix3d> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
    state.poses[i].R = svd.matrixU() * svd.matrixV().transpose();
    state.poses[i].p = y.segment<3>(at + 9) - state.poses[i].R * model.bodies()[i].com_m;
    state.twists[i] = y.segment<6>(at + 12);
  }
  project_poses(model, state.poses);
  project_twists(model, state);
  return state;
}

/// dy/dt at the projection of y: a smooth field on the whole space that agrees with the motion on the constraints, so
/// that a Runge-Kutta method keeps its order.
Eigen::VectorXd rate_of(const Model& model, const Eigen::VectorXd& y, double t_s) {
  const AbsoluteState state = projected(model, y);
  const AbsoluteMotion motion = solve_absolute(model, state, applied_wrenches(model, state, t_s));
  Eigen::VectorXd rate = Eigen::VectorXd::Zero(y.size());
  for (std::size_t i = 1; i < state.poses.size(); ++i) {
    const long at = 18 * static_cast<long>(i);
    const Matrix3d dR = cross_matrix(state.twists[i].head<3>()) * state.poses[i].R;
    rate.segment<9>(at) = dR.reshaped();
    rate.segment<3>(at + 9) = state.twists[i].tail<3>();
    rate.segment<6>(at + 12) = motion.accelerations[i];
  }
  return rate;
}

}  // namespace

Eigen::VectorXd absolute_residual(const Model& model, const std::vector<Pose>& poses) {
  const std::vector<Placement<double>> places = placements(model, poses);
  std::vector<double> values;
  for (const Joint& joint : model.joints()) {
    const JointFrames<double> f = joint_frames(joint, places[joint.first.index()], places[joint.second.index()]);
    for (const char* component : row_components(joint.type)) {
      values.push_back(residual_of(model, joint, component, poses, f));
    }
  }
  for (const Coupling& coupling : model.couplings()) values.push_back(coupling_residual(model, coupling, poses));
  return Eigen::Map<Eigen::VectorXd>(values.data(), static_cast<long>(values.size()));
}

std::vector<Pose> displaced(const Model& model, const std::vector<Pose>& poses, const Eigen::VectorXd& dV) {
  std::vector<Pose> moved = poses;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Vector6d d = dV.segment<6>(6 * (static_cast<long>(i) - 1));
    const Vector3d com = poses[i] * model.bodies()[i].com_m + d.tail<3>();
    moved[i].R = quaternion_exp(d.head<3>()).normalized().toRotationMatrix() * poses[i].R;
    moved[i].R = Eigen::Quaterniond(moved[i].R).normalized().toRotationMatrix();
    moved[i].p = com - moved[i].R * model.bodies()[i].com_m;
  }
  return moved;
}

double project_poses(const Model& model, std::vector<Pose>& poses, double tolerance) {
  double last = absolute_residual(model, poses).norm();
  for (int i = 0; i < 30 && last > 1e-15; ++i) {
    const AbsoluteState still{poses, std::vector<Vector6d>(poses.size(), Vector6d::Zero())};
    const AbsoluteConstraints c = absolute_constraints(model, still);
    // A redundant set gains false rank off the constraints, of the size of the residual: stay above it.
    const ScaledSvd svd = scaled_svd(model, poses, c, std::max(tolerance, 10 * last));
    std::vector<Pose> next = displaced(model, poses, -svd.solve(absolute_residual(model, poses)));
    const double residual = absolute_residual(model, next).norm();
    if (residual >= last) break;
    poses = std::move(next);
    last = residual;
  }
  return last;
}

void project_twists(const Model& model, AbsoluteState& state, double tolerance) {
  const AbsoluteConstraints c = absolute_constraints(model, state);
  const ScaledSvd svd = scaled_svd(model, state.poses, c, tolerance);
  const Eigen::VectorXd V = stacked(state.twists);
  state.twists = unstacked(V - svd.solve(c.G * V));
}

Eigen::MatrixXd admissible_twists(const Model& model, const std::vector<Pose>& poses, double tolerance) {
  const AbsoluteState still{poses, std::vector<Vector6d>(poses.size(), Vector6d::Zero())};
  return scaled_svd(model, poses, absolute_constraints(model, still), tolerance).null_space();
}

AbsoluteState step_absolute(const Model& model, const AbsoluteState& state, double t_s, double step_s) {
  const double h = step_s;
  const Eigen::VectorXd y = ambient(model, state);
  const Eigen::VectorXd k1 = rate_of(model, y, t_s);
  const Eigen::VectorXd k2 = rate_of(model, y + h / 2 * k1, t_s + h / 2);
  const Eigen::VectorXd k3 = rate_of(model, y + h / 2 * k2, t_s + h / 2);
  const Eigen::VectorXd k4 = rate_of(model, y + h * k3, t_s + h);
  return projected(model, y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4));
}

}  // namespace ferrers::witness
