#include "ferrers/redundancy/idle_freedoms.h"

#include <Eigen/QR>
#include <algorithm>
#include <numeric>

namespace ferrers {
namespace {

// Representative of the bodies that each body is welded to; ground's is 0.
std::vector<int> weld_roots(const Model& model) {
  std::vector<int> root(model.bodies().size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  for (const Joint& joint : model.joints()) {
    if (joint.type != JointType::kWeld) continue;
    const int a = find(joint.first.index()), b = find(joint.second.index());
    root[std::max(a, b)] = std::min(a, b);
  }
  for (std::size_t i = 0; i < root.size(); ++i) root[i] = find(static_cast<int>(i));
  return root;
}

// Power of a wrench at p on a twist taken at o: (moment about o, force).
Eigen::Matrix<double, 1, 6> moved(const Wrench& W, const Vector3d& p, const Vector3d& o) {
  Eigen::Matrix<double, 1, 6> row;
  row << (W.head<3>() + (p - o).cross(W.tail<3>())).transpose(), W.tail<3>().transpose();
  return row;
}

}  // namespace

SpinAnalyzer::SpinAnalyzer(const System& system, const State& state, const RedundancyReport& report)
    : system_(system), report_(report) {
  pos_ = make_position_kinematics(system);
  compute_positions(system, state.q, pos_);
  wrenches_ = compute_joint_frame_wrenches(system, state, pos_);
  const Model& model = *system.model;
  const std::vector<int> root = weld_roots(model);
  joints_of_.resize(model.bodies().size());
  extra_of_.resize(model.bodies().size());
  for (const Body& body : model.bodies()) name_of_.push_back(body.name);
  for (std::size_t j = 0; j < model.joints().size(); ++j) {
    const int a = root[model.joints()[j].first.index()], b = root[model.joints()[j].second.index()];
    bodies_of_.emplace_back(a, b);
    if (a == b) continue;
    joints_of_[a].push_back(static_cast<int>(j));
    joints_of_[b].push_back(static_cast<int>(j));
  }
  add_extra_rows();
}

void SpinAnalyzer::add_extra_rows() {
  const Model& model = *system_.model;
  const auto add_part = [&](ExtraRow& row, std::pair<int, int> bodies, const Vector3d& p, const Wrench& W) {
    row.parts.push_back({bodies, p, W});
    for (const int body : {bodies.first, bodies.second}) extra_of_[body].push_back(static_cast<int>(extra_.size()));
  };
  const std::vector<int> root = weld_roots(model);
  const auto add_scalar = [&](ExtraRow& row, const StateScalar& scalar, double coefficient) {
    if (scalar.is_point()) {
      const RecordedPoint& point = model.records()[scalar.point];
      Wrench W = Wrench::Zero();
      W.tail<3>() = coefficient * Vector3d::Unit(scalar.axis);
      add_part(row, {ground_, root[point.body.index()]}, point_position(pos_, system_.point(point.body, point.point_m)),
               W);
      return;
    }
    const int j = scalar.coordinate.joint.index();
    add_part(row, bodies_of_[j], wrenches_[j].p_M,
             coefficient * effort_wrench(system_, scalar.coordinate, wrenches_[j]));
  };
  for (std::size_t c = 0; c < model.couplings().size(); ++c) {
    ExtraRow row;
    for (std::size_t i = 0; i < model.couplings()[c].scalars.size(); ++i) {
      add_scalar(row, model.couplings()[c].scalars[i], wrenches_.coupling_coefficients[c][i]);
    }
    extra_.push_back(std::move(row));
  }
  for (const Drive& drive : model.drives()) {
    if (drive.kind != Drive::Kind::kCoordinate) continue;
    ExtraRow row;
    add_scalar(row, {drive.coordinate}, 1);
    extra_.push_back(std::move(row));
  }
}

MatrixXd SpinAnalyzer::spins(int body, const std::vector<std::pair<int, const MatrixXd*>>& released,
                             Vector3d& p) const {
  const std::vector<int>& joints = joints_of_[body];
  std::vector<int> neighbours;
  for (const int j : joints) {
    neighbours.push_back(bodies_of_[j].first == body ? bodies_of_[j].second : bodies_of_[j].first);
  }
  std::sort(neighbours.begin(), neighbours.end());
  const auto distinct = std::unique(neighbours.begin(), neighbours.end()) - neighbours.begin();
  if (is_fixed(body) || distinct < 2) return MatrixXd(6, 0);
  p = wrenches_[joints.front()].p_M;
  const double L = report_.characteristic_length_m;
  MatrixXd A(0, 6);
  const auto append = [&A](const MatrixXd& rows) {
    A.conservativeResize(A.rows() + rows.rows(), Eigen::NoChange);
    A.bottomRows(rows.rows()) = rows;
  };
  for (const int j : joints) {
    const JointFrameWrenches& joint = wrenches_[j];
    MatrixXd rows(joint.T.cols(), 6);
    for (int i = 0; i < joint.T.cols(); ++i) {
      rows.row(i) = report_.rows.scale[report_.rows.first[j] + i] * moved(joint.T.col(i), joint.p_M, p);
    }
    for (const auto& [changed, free] : released) {
      if (changed != j) continue;
      const MatrixXd full = free->householderQr().householderQ();
      rows = full.rightCols(full.cols() - free->cols()).transpose() * rows;
    }
    append(rows);
    MatrixXd held(3, 6);  // velocity of the joint's point
    held << -cross_matrix(joint.p_M - p), Matrix3d::Identity();
    append(held);
  }
  for (const int e : extra_of_[body]) {
    MatrixXd row = MatrixXd::Zero(1, 6);
    for (const auto& [bodies, at, W] : extra_[e].parts) {
      const double side = (bodies.second == body ? 1 : 0) - (bodies.first == body ? 1 : 0);
      row += side * moved(W, at, p);
    }
    row.leftCols<3>() /= L;
    const double size = row.norm();
    row.leftCols<3>() *= L;
    if (size > 0) append(row / size);
  }
  A.leftCols<3>() /= L;
  MatrixXd spins = analyze_rank(A, 1.0).right_null;
  spins.topRows<3>() /= L;
  for (int c = 0; c < spins.cols(); ++c) spins.col(c) /= spins.col(c).head<3>().norm();
  return spins;
}

std::vector<IdleFreedom> SpinAnalyzer::find() const {
  std::vector<IdleFreedom> found;
  for (int body = 0; body < body_count(); ++body) {
    Vector3d p = Vector3d::Zero();
    const MatrixXd twists = spins(body, {}, p);
    for (int c = 0; c < twists.cols(); ++c) {
      IdleFreedom one{.body = name_of_[body], .joints = {}, .axis = twists.col(c).head<3>(), .point_m = p};
      for (const int j : joints_of_[body]) one.joints.push_back(system_.model->joints()[j].name);
      found.push_back(std::move(one));
    }
  }
  return found;
}

std::vector<IdleFreedom> idle_freedoms(const System& system, const State& state, const RedundancyReport& report) {
  return SpinAnalyzer(system, state, report).find();
}

}  // namespace ferrers
