#include "ferrers/testing/absolute_solver.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "ferrers/testing/absolute_internal.h"

namespace ferrers::witness {
namespace {

/// Writes one wrench, acting on `second` and oppositely on `first`, as a row over body velocities.
/// Works on duals too, where the row's derivative is wanted.
template <class T>
void add_row(const RowWrench<T>& w, BodyId first, BodyId second, const std::vector<Placement<T>>& places, double factor,
             Eigen::Matrix<T, 1, Eigen::Dynamic>& row) {
  const auto add = [&](BodyId body, double sign) {
    if (body == kGround) return;
    const Vec3<T> arm = w.p - places[body.index()].c;
    const int at = 6 * (body.index() - 1);
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      row[at + i] += T(sign * factor) * (w.m[i] + arm[j] * w.f[k] - arm[k] * w.f[j]);
      row[at + 3 + i] += T(sign * factor) * w.f[i];
    }
  };
  add(second, 1);
  add(first, -1);
}

struct Target {
  AbsoluteConstraints& out;
  const Eigen::VectorXd& V;
  int row = 0;
};

using DualRow = Eigen::Matrix<Dual, 1, Eigen::Dynamic>;

/// Stores value and gamma = −(dG/dt) V of one row, plus a prescribed acceleration.
void store(Target& target, const DualRow& row, const std::string& label, double acceleration = 0) {
  double drift = 0;
  for (int i = 0; i < row.size(); ++i) {
    target.out.G(target.row, i) = row[i].a;
    drift += row[i].b * target.V[i];
  }
  target.out.gamma[target.row] = acceleration - drift;
  target.out.labels.push_back(label);
  ++target.row;
}

void store_drive(const Model& model, const Drive& drive, double t, const std::vector<Placement<Dual>>& places,
                 Target& target) {
  const int columns = static_cast<int>(target.out.G.cols());
  for (int i = 0; i < static_cast<int>(drive.motion.size()); ++i) {
    DualRow row = DualRow::Zero(columns);
    RowWrench<Dual> w;
    BodyId first = drive.first, second = drive.second;
    if (drive.kind == Drive::Kind::kCoordinate) {
      const Joint& joint = model.joint(drive.coordinate.joint);
      first = joint.first;
      second = joint.second;
      w = coordinate_row<Dual>(joint, drive.coordinate.index, places[first.index()], places[second.index()]);
    } else {
      const Placement<Dual>& b = places[second.index()];
      w.p = b.p + b.R * drive.point_2_m.cast<Dual>();
      if (drive.kind == Drive::Kind::kPoint) {
        first = kGround;
        w.f[i] = 1;
      } else {
        const Placement<Dual>& a = places[first.index()];
        const Vec3<Dual> u = w.p - (a.p + a.R * drive.point_1_m.cast<Dual>());
        const Dual length = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
        for (int k = 0; k < 3; ++k) w.f[k] = u[k] / length;
      }
    }
    add_row(w, first, second, places, 1, row);
    store(target, row, drive.name + "/motion", drive.motion[i].motion(t).acceleration);
  }
}

/// Root-mean-square distance of the joints' points from their middle: the size of the mechanism.
double size_of(const Model& model, const std::vector<Pose>& poses) {
  std::vector<Vector3d> points;
  for (const Joint& joint : model.joints()) {
    points.push_back(poses[joint.first.index()] * joint.X_1F.p);
    points.push_back(poses[joint.second.index()] * joint.X_2M.p);
  }
  for (int i = 1; i < static_cast<int>(poses.size()); ++i) points.push_back(poses[i] * model.bodies()[i].com_m);
  Vector3d middle = Vector3d::Zero();
  for (const Vector3d& p : points) middle += p / static_cast<double>(points.size());
  double sum = 0;
  for (const Vector3d& p : points) sum += (p - middle).squaredNorm() / static_cast<double>(points.size());
  return sum > 0 ? std::sqrt(sum) : 1.0;
}

/// Diagonal scales that make rows and columns pure numbers: S_row G S_col. Force rows count metres (divided by L),
/// moment rows radians; a coupling or drive row is made a unit row, which is safe since its coefficients are given
/// numbers.
void scales_of(const AbsoluteConstraints& c, double L, Eigen::VectorXd& rows, Eigen::VectorXd& columns) {
  columns.resize(c.G.cols());
  for (int i = 0; i < columns.size(); ++i) columns[i] = i % 6 < 3 ? 1.0 : L;
  rows.resize(c.G.rows());
  for (int i = 0; i < rows.size(); ++i) {
    const std::string& label = c.labels[i];
    const auto slash = label.rfind('/');
    if (slash != std::string::npos && label.compare(slash, 7, "/moment") == 0) {
      rows[i] = 1;
    } else if (slash != std::string::npos && label.compare(slash, 6, "/force") == 0) {
      rows[i] = 1 / L;
    } else {
      const double norm = c.G.row(i).cwiseProduct(columns.transpose()).norm();
      rows[i] = norm > 0 ? 1 / norm : 1;
    }
  }
}

void find_unique(const AbsoluteConstraints& c, const Eigen::MatrixXd& Z, AbsoluteVerdict& verdict) {
  constexpr double kTouched = 1e-7;  // Z is orthonormal in scaled rows
  verdict.unique_rows.resize(c.G.rows());
  for (int i = 0; i < c.G.rows(); ++i) {
    verdict.unique_rows[i] = Z.cols() == 0 || Z.row(i).norm() < kTouched;
    verdict.unique += verdict.unique_rows[i];
  }
  for (std::size_t j = 0; j + 1 < c.first_row.size(); ++j) {
    const int first = c.first_row[j], count = c.first_row[j + 1] - first;
    int touched = 0;
    if (Z.cols() > 0 && count > 0) {
      const Eigen::JacobiSVD<Eigen::MatrixXd> svd(Z.middleRows(first, count));
      touched = static_cast<int>((svd.singularValues().array() > kTouched).count());
    }
    verdict.unique_dimensions.push_back(count - touched);
    verdict.unique_dimension += count - touched;
  }
}

}  // namespace

std::vector<Placement<double>> placements(const Model& model, const std::vector<Pose>& poses) {
  require_size(static_cast<long>(poses.size()), static_cast<long>(model.bodies().size()), "poses");
  std::vector<Placement<double>> places;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    places.push_back({poses[i].R, poses[i].p, poses[i] * model.bodies()[i].com_m});
  }
  return places;
}

std::vector<Placement<Dual>> moving_placements(const Model& model, const AbsoluteState& state) {
  require_size(static_cast<long>(state.twists.size()), static_cast<long>(state.poses.size()), "twists");
  const std::vector<Placement<double>> still = placements(model, state.poses);
  std::vector<Placement<Dual>> places(still.size());
  for (std::size_t i = 0; i < still.size(); ++i) {
    const Vector3d w = state.twists[i].head<3>(), v = state.twists[i].tail<3>();
    const Matrix3d dR = cross_matrix(w) * still[i].R;
    const Vector3d dp = v - w.cross(still[i].c - still[i].p);
    for (int r = 0; r < 3; ++r) {
      for (int k = 0; k < 3; ++k) places[i].R(r, k) = Dual(still[i].R(r, k), dR(r, k));
      places[i].p[r] = Dual(still[i].p[r], dp[r]);
      places[i].c[r] = Dual(still[i].c[r], v[r]);
    }
  }
  return places;
}

Eigen::VectorXd stacked(const std::vector<Vector6d>& twists) {
  Eigen::VectorXd V(6 * (static_cast<long>(twists.size()) - 1));
  for (std::size_t i = 1; i < twists.size(); ++i) V.segment<6>(6 * (static_cast<long>(i) - 1)) = twists[i];
  return V;
}

std::vector<Vector6d> unstacked(const Eigen::VectorXd& V) {
  std::vector<Vector6d> twists(1 + V.size() / 6, Vector6d::Zero());
  for (std::size_t i = 1; i < twists.size(); ++i) twists[i] = V.segment<6>(6 * (static_cast<long>(i) - 1));
  return twists;
}

ScaledSvd scaled_svd(const Model& model, const std::vector<Pose>& poses, const AbsoluteConstraints& c,
                     double tolerance) {
  ScaledSvd s;
  s.length_m = size_of(model, poses);
  scales_of(c, s.length_m, s.row_scale, s.column_scale);
  const Eigen::MatrixXd A = s.row_scale.asDiagonal() * c.G * s.column_scale.asDiagonal();
  if (A.rows() == 0) {
    s.U.resize(0, 0);
    s.V = Eigen::MatrixXd::Identity(A.cols(), A.cols());
    return s;
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeFullU | Eigen::ComputeFullV);
  s.values = svd.singularValues();
  s.U = svd.matrixU();
  s.V = svd.matrixV();
  const double largest = s.values.size() > 0 ? s.values[0] : 0;
  s.rank = largest > 0 ? static_cast<int>((s.values.array() > tolerance * largest).count()) : 0;
  return s;
}

Eigen::VectorXd ScaledSvd::solve(const Eigen::VectorXd& rhs) const {
  if (rank == 0) return Eigen::VectorXd::Zero(column_scale.size());
  const Eigen::VectorXd b = U.leftCols(rank).transpose() * row_scale.cwiseProduct(rhs);
  return column_scale.cwiseProduct(V.leftCols(rank) * b.cwiseQuotient(values.head(rank)));
}

Eigen::VectorXd ScaledSvd::solve_transposed(const Eigen::VectorXd& rhs) const {
  if (rank == 0) return Eigen::VectorXd::Zero(row_scale.size());
  const Eigen::VectorXd b = V.leftCols(rank).transpose() * column_scale.cwiseProduct(rhs);
  return row_scale.cwiseProduct(U.leftCols(rank) * b.cwiseQuotient(values.head(rank)));
}

Eigen::MatrixXd ScaledSvd::null_space() const { return column_scale.asDiagonal() * V.rightCols(V.cols() - rank); }

AbsoluteState drawn_state(const Model& model) {
  AbsoluteState state;
  for (const Body& body : model.bodies()) {
    state.poses.push_back(body.X_WB);
    state.twists.push_back(Vector6d::Zero());
  }
  return state;
}

AbsoluteConstraints absolute_constraints(const Model& model, const AbsoluteState& state,
                                         std::optional<double> driven_at_s) {
  const std::vector<Placement<Dual>> places = moving_placements(model, state);
  const Eigen::VectorXd V = stacked(state.twists);
  int rows = static_cast<int>(model.couplings().size());
  for (const Joint& joint : model.joints()) rows += static_cast<int>(row_components(joint.type).size());
  if (driven_at_s) {
    for (const Drive& drive : model.drives()) rows += static_cast<int>(drive.motion.size());
  }
  AbsoluteConstraints out;
  out.G.setZero(rows, V.size());
  out.gamma.setZero(rows);
  Target target{out, V};
  for (const Joint& joint : model.joints()) {
    out.first_row.push_back(target.row);
    const auto wrenches = joint_rows<Dual>(joint, places[joint.first.index()], places[joint.second.index()]);
    const auto components = row_components(joint.type);
    for (std::size_t i = 0; i < wrenches.size(); ++i) {
      DualRow row = DualRow::Zero(V.size());
      add_row(wrenches[i], joint.first, joint.second, places, 1, row);
      store(target, row, joint.name + "/" + components[i]);
    }
  }
  for (const Coupling& coupling : model.couplings()) {
    out.first_row.push_back(target.row);
    DualRow row = DualRow::Zero(V.size());
    for (std::size_t i = 0; i < coupling.scalars.size(); ++i) {
      const Joint& joint = model.joint(coupling.scalars[i].coordinate.joint);
      const auto w = coordinate_row<Dual>(joint, coupling.scalars[i].coordinate.index, places[joint.first.index()],
                                          places[joint.second.index()]);
      add_row(w, joint.first, joint.second, places, coupling.coefficients[i], row);
    }
    store(target, row, coupling.name);
  }
  out.first_row.push_back(target.row);
  if (driven_at_s) {
    for (const Drive& drive : model.drives()) store_drive(model, drive, *driven_at_s, places, target);
  }
  return out;
}

AbsoluteVerdict analyze_absolute(const Model& model, const std::vector<Pose>& poses, double tolerance) {
  const AbsoluteState state{poses, std::vector<Vector6d>(poses.size(), Vector6d::Zero())};
  const AbsoluteConstraints c = absolute_constraints(model, state);
  const ScaledSvd svd = scaled_svd(model, poses, c, tolerance);
  AbsoluteVerdict verdict;
  verdict.bodies = static_cast<int>(model.bodies().size()) - 1;
  verdict.rows = static_cast<int>(c.G.rows());
  verdict.rank = svd.rank;
  verdict.mobility = 6 * verdict.bodies - svd.rank;
  verdict.redundant = verdict.rows - svd.rank;
  verdict.singular_values = svd.values;
  verdict.length_m = svd.length_m;
  const Eigen::MatrixXd Z = svd.U.rightCols(verdict.redundant);
  verdict.Z = svd.row_scale.asDiagonal() * Z;
  find_unique(c, Z, verdict);
  return verdict;
}

Eigen::MatrixXd absolute_mass_matrix(const Model& model, const std::vector<Pose>& poses) {
  const int n = static_cast<int>(model.bodies().size()) - 1;
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(6 * n, 6 * n);
  for (int i = 0; i < n; ++i) {
    const Body& body = model.bodies()[i + 1];
    const Matrix3d& R = poses[i + 1].R;
    M.block<3, 3>(6 * i, 6 * i) = R * body.inertia_kgm2 * R.transpose();
    M.block<3, 3>(6 * i + 3, 6 * i + 3) = body.mass_kg * Matrix3d::Identity();
  }
  return M;
}

AbsoluteMotion solve_absolute(const Model& model, const AbsoluteState& state, const std::vector<Vector6d>& wrenches,
                              std::optional<double> driven_at_s, double tolerance) {
  require_size(static_cast<long>(wrenches.size()), static_cast<long>(model.bodies().size()), "wrenches");
  AbsoluteMotion motion;
  motion.constraints = absolute_constraints(model, state, driven_at_s);
  const AbsoluteConstraints& c = motion.constraints;
  const ScaledSvd svd = scaled_svd(model, state.poses, c, tolerance);
  const Eigen::MatrixXd M = absolute_mass_matrix(model, state.poses);
  Eigen::VectorXd force = stacked(wrenches);
  for (std::size_t i = 1; i < state.twists.size(); ++i) {
    const long at = 6 * (static_cast<long>(i) - 1);
    const Vector3d w = state.twists[i].head<3>();
    force.segment<3>(at) -= w.cross(Vector3d(M.block<3, 3>(at, at) * w));
  }
  const Eigen::VectorXd particular = svd.solve(c.gamma);
  motion.inconsistency = (c.G * particular - c.gamma).norm() / (1 + c.gamma.norm());
  const Eigen::MatrixXd N = svd.null_space();
  Eigen::VectorXd a = particular;
  if (N.cols() > 0) {
    const Eigen::MatrixXd inertia = N.transpose() * M * N;
    const Eigen::JacobiSVD<Eigen::MatrixXd> dense(inertia, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Eigen::VectorXd& values = dense.singularValues();
    motion.inertia_regular = values[values.size() - 1] > 1e-12 * std::max(values[0], 1e-300);
    a += N * dense.solve(N.transpose() * (force - M * particular));
  }
  motion.lambda = svd.solve_transposed(M * a - force);
  motion.accelerations = unstacked(a);
  return motion;
}

Vector6d joint_reaction(const Model& model, const std::vector<Pose>& poses, JointId id,
                        const Eigen::VectorXd& lambda_joint, const Vector3d& point_W) {
  const std::vector<Placement<double>> places = placements(model, poses);
  const Joint& joint = model.joint(id);
  const auto rows = joint_rows<double>(joint, places[joint.first.index()], places[joint.second.index()]);
  require_size(lambda_joint.size(), static_cast<long>(rows.size()), "lambda_joint");
  Vector6d reaction = Vector6d::Zero();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double value = lambda_joint[static_cast<long>(i)];
    reaction.head<3>() += value * (rows[i].m + (rows[i].p - point_W).cross(rows[i].f));
    reaction.tail<3>() += value * rows[i].f;
  }
  return reaction;
}

std::array<bool, 6> unique_world_components(const Model& model, const std::vector<Pose>& poses, JointId id,
                                            const AbsoluteVerdict& verdict, const Vector3d& point_W) {
  const int rows = static_cast<int>(row_components(model.joint(id).type).size());
  int first = 0;
  for (int j = 0; j < id.index(); ++j) first += static_cast<int>(row_components(model.joints()[j].type).size());
  Eigen::MatrixXd W(6, verdict.Z.cols());
  for (int k = 0; k < W.cols(); ++k) {
    W.col(k) = joint_reaction(model, poses, id, verdict.Z.col(k).segment(first, rows), point_W);
  }
  std::array<bool, 6> unique{};
  for (int i = 0; i < 6; ++i) {
    const double touched = W.cols() == 0 ? 0 : W.row(i).norm() * (i < 3 ? 1.0 : verdict.length_m);
    unique[i] = touched < 1e-7;
  }
  return unique;
}

}  // namespace ferrers::witness
