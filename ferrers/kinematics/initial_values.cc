#include "ferrers/kinematics/initial_values.h"

#include <algorithm>
#include <cmath>

#include "ferrers/kinematics/assembly.h"
#include "ferrers/kinematics/coordinates.h"
#include "ferrers/math/rank.h"

namespace ferrers {
namespace {

// Position entries of a joint: scalars one by one, a quaternion as one.
void add_tree_targets(const Node& node, const InitialValue& initial, std::vector<InitialValues::TreeTarget>& out) {
  const int at = node.type->quaternion_at;
  const int scalars = at < 0 ? node.nq : at;
  if (!initial.whole_joint) {
    InitialValues::TreeTarget target;
    target.q = node.q + initial.coordinate.index;
    target.v = node.v + initial.coordinate.index;
    target.value[0] = initial.position.front();
    out.push_back(target);
    return;
  }
  for (int i = 0; i < scalars; ++i) {
    InitialValues::TreeTarget target;
    target.q = node.q + i;
    target.v = node.v + (at < 0 ? i : 3 + i);
    target.value[0] = initial.position[i];
    out.push_back(target);
  }
  if (at < 0) return;
  InitialValues::TreeTarget rotation;
  rotation.q = node.q + at;
  rotation.v = node.v;
  rotation.rotation = true;
  const Eigen::Vector4d u = Eigen::Map<const Eigen::Vector4d>(initial.position.data() + at).normalized();
  for (int i = 0; i < 4; ++i) rotation.value[i] = u[i];
  out.push_back(rotation);
}

// Spherical and free joints have no scalar coordinates: their pose is given as a whole.
void add_cut_pose(const System& system, const InitialValue& initial, std::vector<InitialValues::CutPose>& out) {
  const JointTypeInfo& type = joint_type_info(system.model->joint(initial.coordinate.joint).type);
  if (!initial.whole_joint || type.quaternion_at < 0) return;
  InitialValues::CutPose target;
  target.cut = system.topology->closure_of_joint[initial.coordinate.joint.index()];
  target.position = type.quaternion_at == 3;
  const Eigen::Vector4d u =
      Eigen::Map<const Eigen::Vector4d>(initial.position.data() + type.quaternion_at).normalized();
  target.X_FM.R = quaternion_matrix(u.data());
  if (target.position) target.X_FM.p = Eigen::Map<const Vector3d>(initial.position.data());
  out.push_back(target);
}

// What is missing to a cut joint's pose, along F's axes, with its rows: lengths, rotations times L. Returns the next
// row.
int add_pose_rows(const System& system, const InitialValues::CutPose& target, double length,
                  const PositionKinematics& pos, const VelocityKinematics& rest, int row, RowMatrixXd& A, VectorXd& b) {
  const FramePair& frames = system.cuts[target.cut].frames;
  const RelativeMotion m = compute_relative_motion(frames, pos, rest);
  const Matrix3d R_FM = m.R_F.transpose() * m.R_M;
  const Vector3d turn = rotation_log(target.X_FM.R * R_FM.transpose());
  const Vector3d shift = target.X_FM.p - m.R_F.transpose() * m.d;
  const double limit = 0.1 * length;
  for (int i = 0; i < 3; ++i, ++row) {
    Wrench W = Wrench::Zero();
    W.head<3>() = m.R_F.col(i);
    add_jet_row(system, frames, pos, W, length, A.row(row));
    b[row] = std::clamp(length * turn[i], -limit, limit);
  }
  for (int i = 0; target.position && i < 3; ++i, ++row) {
    add_jet_row(system, frames, pos, along_first(m, m.R_F.col(i)).W, 1, A.row(row));
    b[row] = std::clamp(shift[i], -limit, limit);
  }
  return row;
}

}  // namespace

InitialValues read_initial_values(const System& system) {
  InitialValues values;
  for (const InitialValue& initial : system.model->initial()) {
    if (initial.position.empty()) continue;
    const int node = system.topology->node_of_joint[initial.coordinate.joint.index()];
    if (node >= 0) {
      add_tree_targets(system.nodes[node], initial, initial.guess ? values.guesses : values.exact);
      continue;
    }
    if (initial.guess) continue;  // a cut joint's coordinate cannot start a search in tree coordinates
    for (std::size_t i = 0; i < initial.position.size(); ++i) {
      const int index = initial.whole_joint ? static_cast<int>(i) : initial.coordinate.index;
      if (joint_type_info(system.model->joint(initial.coordinate.joint).type).coordinate_jets == nullptr) {
        add_cut_pose(system, initial, values.cut_poses);
        break;
      }
      values.cut.push_back({system.access({initial.coordinate.joint, index}), initial.position[i]});
    }
  }
  for (const InitialValues::TreeTarget& target : values.exact) {
    for (int k = 0; k < (target.rotation ? 3 : 1); ++k) values.held.push_back(target.v + k);
  }
  return values;
}

State make_guessed_state(const System& system) {
  State state = make_drawn_state(system);
  const InitialValues values = read_initial_values(system);
  values.apply_guesses(system, state);
  values.apply_exact(state, 1, state);
  return state;
}

void InitialValues::apply_guesses(const System&, State& state) const {
  for (const TreeTarget& target : guesses) {
    for (int i = 0; i < (target.rotation ? 4 : 1); ++i) state.q[target.q + i] = target.value[i];
  }
}

int InitialValues::steps(const Scaling& scaling, const State& from) const {
  double largest = 0;
  for (const TreeTarget& target : exact) {
    if (target.rotation) {
      largest = std::max(largest, 3.2);
    } else {
      largest = std::max(largest,
                         std::abs(target.value[0] - from.q[target.q]) / (scaling.columns[target.v] * scaling.length_m));
    }
  }
  return std::clamp(static_cast<int>(std::ceil(largest / 0.1)), 1, 400);
}

void InitialValues::apply_exact(const State& from, double fraction, State& state) const {
  for (const TreeTarget& target : exact) {
    if (!target.rotation) {
      state.q[target.q] =
          fraction >= 1 ? target.value[0] : from.q[target.q] + fraction * (target.value[0] - from.q[target.q]);
      continue;
    }
    const Eigen::Vector4d a = from.q.segment<4>(target.q), b = Eigen::Map<const Eigen::Vector4d>(target.value);
    const Eigen::Quaterniond qa(a[0], a[1], a[2], a[3]), qb(b[0], b[1], b[2], b[3]);
    const Eigen::Quaterniond q = fraction >= 1 ? qb : qa.slerp(fraction, qb);
    state.q.segment<4>(target.q) << q.w(), q.x(), q.y(), q.z();
  }
}

bool InitialValues::meet_cut_targets(const System& system, const Scaling& scaling, State& state,
                                     int& iterations) const {
  if (cut.empty() && cut_poses.empty()) return true;
  PositionKinematics pos = make_position_kinematics(system);
  const VelocityKinematics rest = make_velocity_kinematics(system);
  ConstraintKinematics constraints = make_constraint_kinematics(system);
  const int m = system.m, k = static_cast<int>(cut.size());
  int pose_rows = 0;
  for (const CutPose& target : cut_poses) pose_rows += target.position ? 6 : 3;
  for (int i = 0; i < 200; ++i, ++iterations) {
    compute_positions(system, state.q, pos);
    accept_winding(system, pos, state);
    compute_constraints(system, state, pos, rest, constraints);
    RowMatrixXd A = RowMatrixXd::Zero(m + k + pose_rows, system.nv);
    VectorXd b(m + k + pose_rows);
    A.topRows(m) = scaling.rows.asDiagonal() * constraints.G;
    b.head(m) = -constraints.phi.cwiseProduct(scaling.rows);
    for (const int v : system.velocity_rows) A.row(v).setZero();
    for (int j = 0; j < k; ++j) {
      const Jet jet = measure_coordinate(system, cut[j].access, state, pos, rest);
      add_coordinate_row(system, cut[j].access, pos, jet, 1, A.row(m + j));
      const double scale = cut[j].access.winding >= 0 ? scaling.length_m : 1.0;
      b[m + j] =
          scale * std::clamp(cut[j].value - jet.value, -0.1 / scale * scaling.length_m, 0.1 / scale * scaling.length_m);
      A.row(m + j) *= scale;
    }
    int row = m + k;
    for (const CutPose& target : cut_poses) {
      row = add_pose_rows(system, target, scaling.length_m, pos, rest, row, A, b);
    }
    if (b.cwiseAbs().maxCoeff() <= 1e-3 * closed_tolerance(scaling)) return true;
    for (const int v : held) A.col(v).setZero();
    MatrixXd scaled = A * scaling.columns.asDiagonal();
    VectorXd step = scaling.columns.cwiseProduct(solve_least_norm(scaled, b).x);
    displace(system, step, state.q);
    if (i > 60 && b.cwiseAbs().maxCoeff() <= closed_tolerance(scaling)) return true;
  }
  return false;
}

}  // namespace ferrers
