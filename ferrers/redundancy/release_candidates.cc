#include "ferrers/redundancy/release_candidates.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <numeric>
#include <set>

namespace ferrers {
namespace {

using T = JointType;

constexpr int kForceZ[] = {2};
constexpr int kAxialAndTilt[] = {2, 3, 4};
constexpr int kTilt[] = {3, 4};
constexpr int kMomentZ[] = {5};
constexpr int kMoments[] = {3, 4, 5};
constexpr int kRadial[] = {0, 1};
constexpr int kForces[] = {0, 1, 2};
constexpr int kCrossMoment[] = {4};
constexpr int kAll[] = {0, 1, 2, 3, 4, 5};

// Where no change of type will do.
constexpr ReleaseKind left_out(JointType from) {
  return {.from = from,
          .to = T::kFree,
          .components = kAll,
          .preference = 0.3,
          .count = 3,
          .says = "left out altogether: what it carried, others carry"};
}

constexpr ReleaseKind kKinds[] = {
    {.from = T::kRevolute,
     .to = T::kCylindrical,
     .components = kForceZ,
     .preference = 0.9,
     .says = "free to slide along its axis: carries no axial force any more, which another bearing must take"},
    {.from = T::kRevolute,
     .to = T::kSpherical,
     .components = kTilt,
     .says = "a self-aligning bearing or ball joint instead of a plain one: carries no tilting moment any more"},
    {.from = T::kRevolute,
     .to = T::kUniversal,
     .components = kTilt,
     .one_of = true,
     .preference = 0.5,
     .says = "a cross pin added: carries the tilting moment about one axis only"},
    {.from = T::kRevolute,
     .to = T::kPointOnLine,
     .components = kAxialAndTilt,
     .preference = 0.8,
     .says = "a self-aligning bearing that may slide (sphere in a cylinder): carries radial forces only"},
    {.from = T::kRevolute,
     .to = T::kPlanar,
     .components = kRadial,
     .preference = 0.9,
     .says = "a member that floats radially: its other contacts alone hold it sideways and share the load evenly"},
    {.from = T::kRevolute,
     .to = T::kPointOnLine,
     .components = kRadial,
     .one_of = true,
     .also = kTilt,
     .preference = 0.4,
     .says = "a ball in a slot across the axis: carries no force along the slot and no tilting moment any more"},
    {.from = T::kPrismatic,
     .to = T::kCylindrical,
     .components = kMomentZ,
     .is_bearing = false,
     .says = "a round guide instead of a keyed one: may turn about its axis and carries no torque any more"},
    {.from = T::kPrismatic,
     .to = T::kPointOnLine,
     .components = kMoments,
     .preference = 0.8,
     .is_bearing = false,
     .says = "a ball in the guide instead of a long slide: carries forces across the guide only, no moment"},
    {.from = T::kCylindrical,
     .to = T::kPointOnLine,
     .components = kTilt,
     .preference = 0.9,
     .says = "a sphere in the cylinder: carries no tilting moment any more"},
    {.from = T::kUniversal,
     .to = T::kSpherical,
     .components = kCrossMoment,
     .says = "a ball joint instead of a cross: passes no torque on any more"},
    {.from = T::kSpherical,
     .to = T::kPointOnLine,
     .components = kForces,
     .one_of = true,
     .preference = 0.9,
     .says = "a ball that may slide along a line: carries no force along it any more"},
    {.from = T::kPlanar,
     .to = T::kPointOnPlane,
     .components = kTilt,
     .preference = 0.9,
     .says = "a ball foot instead of a flat one: carries no tilting moment any more"},
    {.from = T::kPointOnLine,
     .to = T::kPointOnPlane,
     .components = kRadial,
     .one_of = true,
     .preference = 0.8,
     .says = "a ball on a flat instead of in a bore: carries force in one direction only"},
    {.from = T::kScrew,
     .to = T::kCylindrical,
     .components = kForceZ,
     .preference = 0.4,
     .says = "the thread left out: turns no thrust into torque any more"},
    {.from = T::kWeld,
     .to = T::kRevolute,
     .components = kMoments,
     .one_of = true,
     .preference = 0.6,
     .says = "a pin instead of a weld: carries no moment about the pin any more"},
    {.from = T::kWeld,
     .to = T::kPrismatic,
     .components = kForces,
     .one_of = true,
     .preference = 0.5,
     .says = "a slide instead of a weld: carries no force along it any more"},
    {.from = T::kWeld,
     .to = T::kSpherical,
     .components = kMoments,
     .preference = 0.6,
     .says = "a ball joint instead of a weld: carries no moment any more"},
    left_out(T::kRevolute),
    left_out(T::kCylindrical),
    left_out(T::kPrismatic),
    left_out(T::kUniversal),
    left_out(T::kSpherical),
    left_out(T::kWeld),
};

constexpr double kNotCentred = 0.3;    // of a floating member that no contacts centre
constexpr double kOnGround = 0.8;      // preference of a ground bearing beside a joint between moving bodies
constexpr double kDropped = 1e-12;     // entries of Z that are rounding
constexpr double kNearlyEqual = 1e-6;  // principal values that are the same but for rounding

int component_of_row(JointType type, int row) { return joint_type_info(type).row_components[row]; }

// A member that floats takes along what hangs on it. Contacts (meshes, points on lines and planes, rods) carry nothing
// along.
class Hangers {
 public:
  explicit Hangers(const Model& model) : model_(model), joints_of_(model.bodies().size()) {
    for (std::size_t j = 0; j < model.joints().size(); ++j) {
      for (const BodyId body : {model.joints()[j].first, model.joints()[j].second}) {
        if (body != kGround) joints_of_[body.index()].push_back(static_cast<int>(j));
      }
    }
  }
  /// How well one of the joint's bodies would float: centred by contacts, and alone.
  double floating_preference(int joint) const {
    const Joint& j = model_.joints()[joint];
    double best = 0;
    for (const BodyId body : {j.first, j.second}) {
      if (body == kGround) continue;
      const bool centred = std::any_of(joints_of_[body.index()].begin(), joints_of_[body.index()].end(),
                                       [&](int other) { return !carries(model_.joints()[other].type); });
      best = std::max(best, (centred ? 1.0 : kNotCentred) / (1 + reach(body, joint)));
    }
    return best;
  }

 private:
  static bool carries(JointType type) {
    return joint_type_info(type).row_count() >= 3 && type != T::kGearMesh && type != T::kDistance;
  }
  int reach(BodyId from, int without) const {
    constexpr int kMany = 64;  // no need to count further
    std::set<int> seen = {from.index()};
    std::vector<int> open = {from.index()};
    while (!open.empty() && static_cast<int>(seen.size()) <= kMany) {
      const int body = open.back();
      open.pop_back();
      for (const int j : joints_of_[body]) {
        const Joint& joint = model_.joints()[j];
        if (j == without || !carries(joint.type)) continue;
        const int other = joint.first.index() == body ? joint.second.index() : joint.first.index();
        if (other != 0 && seen.insert(other).second) open.push_back(other);
      }
    }
    return static_cast<int>(seen.size()) - 1;
  }
  const Model& model_;
  std::vector<std::vector<int>> joints_of_;
};

// Z by rows, scaled, without rounding dust.
std::vector<std::vector<std::pair<int, double>>> rows_of(const RedundancyReport& report) {
  std::vector<std::vector<std::pair<int, double>>> rows(report.rows.size());
  const SparseMatrixXd& Z = report.self_stresses;
  for (int c = 0; c < Z.outerSize(); ++c) {
    for (SparseMatrixXd::InnerIterator it(Z, c); it; ++it) {
      const double value = it.value() / report.rows.scale[it.row()];
      if (std::abs(value) > kDropped) rows[it.row()].emplace_back(c, value);
    }
  }
  return rows;
}

class GroupFinder {
 public:
  GroupFinder(const System& system, const State& state, const RedundancyReport& report)
      : model_(*system.model), report_(report), uses_(model_.spec()), hangers_(model_), rows_(rows_of(report)) {
    PositionKinematics pos = make_position_kinematics(system);
    compute_positions(system, state.q, pos);
    wrenches_ = compute_joint_frame_wrenches(system, state, pos);
  }

  std::vector<ReleaseGroup> find(std::vector<ReleaseObstacle>& obstacles) {
    std::vector<ReleaseGroup> groups = connect();
    for (ReleaseGroup& group : groups) {
      metric_ = group.size() <= kLargestOrthonormal ? triangular_factor(group) : MatrixXd();
      for (const int joint : group.joints) add_candidates(joint, group, obstacles);
    }
    return groups;
  }

 private:
  // Columns that load the same joint (or coupling) belong together.
  std::vector<ReleaseGroup> connect() {
    const int count = static_cast<int>(report_.self_stresses.cols());
    std::vector<int> root(count);
    std::iota(root.begin(), root.end(), 0);
    const auto find = [&](int i) {
      while (root[i] != i) i = root[i] = root[root[i]];
      return i;
    };
    std::vector<int> column_of_joint(report_.rows.first.size(), -1);
    for (std::size_t j = 0; j < column_of_joint.size(); ++j) {
      for (int i = 0; i < report_.rows.count[j]; ++i) {
        for (const auto& [column, value] : rows_[report_.rows.first[j] + i]) {
          if (column_of_joint[j] < 0) column_of_joint[j] = column;
          const int a = find(column), b = find(column_of_joint[j]);
          root[std::max(a, b)] = std::min(a, b);
        }
      }
    }
    std::vector<ReleaseGroup> groups;
    std::vector<int> group_of(count, -1);
    local_.assign(count, 0);
    for (int c = 0; c < count; ++c) {
      int& group = group_of[find(c)];
      if (group < 0) {
        group = static_cast<int>(groups.size());
        groups.emplace_back();
      }
      local_[c] = groups[group].size();
      groups[group].columns.push_back(c);
    }
    for (std::size_t j = 0; j < column_of_joint.size(); ++j) {
      if (column_of_joint[j] < 0) continue;
      ReleaseGroup& group = groups[group_of[find(column_of_joint[j])]];
      if (j < model_.joints().size()) group.joints.push_back(static_cast<int>(j));
      for (int i = 0; i < report_.rows.count[j]; ++i) {
        auto& row = rows_[report_.rows.first[j] + i];
        for (auto& [column, value] : row) column = local_[column];
        if (!row.empty()) group.rows.emplace_back(report_.rows.first[j] + i, row);
      }
    }
    return groups;
  }

  void add_candidates(int joint, ReleaseGroup& group, std::vector<ReleaseObstacle>& obstacles) {
    const Joint& definition = model_.joints()[joint];
    for (int kind = 0; kind < static_cast<int>(std::size(kKinds)); ++kind) {
      const ReleaseKind& change = kKinds[kind];
      if (change.from != definition.type) continue;
      std::vector<ReleaseCandidate> found;
      for (const MatrixXd& rows : choices(joint, change)) {
        ReleaseCandidate one{.joint = joint, .kind = kind, .direction = {}, .rows = rows, .preference = 1, .block = {}};
        if (rows.cols() == 0 || !fill_block(one)) continue;
        one.direction = direction(joint, change, rows);
        one.preference = preference(joint, change);
        found.push_back(std::move(one));
      }
      if (found.empty()) continue;
      std::string obstacle = uses_.obstacle(definition.name, change.to);
      if (obstacle.empty() && change.to == T::kUniversal && !definition.drawn && uses_.any(definition.name)) {
        obstacle = "the angle of '" + definition.name + "' is used and would start from another zero";
      }
      if (obstacle.empty()) {
        for (ReleaseCandidate& one : found) group.candidates.push_back(std::move(one));
      } else if (change.count == 1) {
        obstacles.push_back({definition.name, change.to, std::move(obstacle)});
      }
    }
  }

  // The combinations of a joint's rows that a kind may release: all its components, or each principal direction of
  // what the self-stresses put there.
  std::vector<MatrixXd> choices(int joint, const ReleaseKind& change) const {
    const int first = report_.rows.first[joint], count = report_.rows.count[joint];
    std::vector<int> rows;
    for (int i = 0; i < count; ++i) {
      const int component = component_of_row(change.from, i);
      if (std::find(change.components.begin(), change.components.end(), component) != change.components.end()) {
        rows.push_back(i);
      }
    }
    MatrixXd unit = MatrixXd::Zero(count, static_cast<long>(rows.size()));
    for (std::size_t i = 0; i < rows.size(); ++i) unit(rows[i], static_cast<long>(i)) = 1;
    if (!change.one_of) return {unit};
    MatrixXd also = MatrixXd::Zero(count, static_cast<long>(change.also.size()));
    for (int i = 0, c = 0; i < count; ++i) {
      const int component = component_of_row(change.from, i);
      if (std::find(change.also.begin(), change.also.end(), component) != change.also.end()) also(i, c++) = 1;
    }
    std::vector<std::vector<std::pair<int, double>>> lines;
    for (const int row : rows) lines.push_back(rows_[first + row]);
    MatrixXd gram(unit.cols(), unit.cols());
    if (metric_.size() > 0) {
      const MatrixXd B = orthonormal_rows(lines, metric_);
      gram = B * B.transpose();
    } else {
      for (std::size_t a = 0; a < rows.size(); ++a) {
        for (std::size_t b = 0; b < rows.size(); ++b) gram(a, b) = dot(lines[a], lines[b]);
      }
    }
    std::vector<MatrixXd> out;
    for (const VectorXd& axis : principal_axes(gram)) {
      MatrixXd choice(count, 1 + also.cols());
      choice << unit * axis, also;
      out.push_back(std::move(choice));
    }
    return out;
  }

  static double dot(const std::vector<std::pair<int, double>>& a, const std::vector<std::pair<int, double>>& b) {
    double sum = 0;
    for (std::size_t i = 0, k = 0; i < a.size() && k < b.size();) {
      if (a[i].first == b[k].first)
        sum += a[i++].second * b[k++].second;
      else if (a[i].first < b[k].first)
        ++i;
      else
        ++k;
    }
    return sum;
  }

  // Eigenvectors, largest first, of definite sign; where values are equal the frame's own axes are as good.
  static std::vector<VectorXd> principal_axes(const MatrixXd& gram) {
    const int n = static_cast<int>(gram.cols());
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(gram);
    const VectorXd& values = eigen.eigenvalues();
    const bool round = values[0] > (1 - kNearlyEqual) * values[n - 1];
    std::vector<VectorXd> axes;
    for (int i = n - 1; i >= 0; --i) {
      VectorXd axis = round ? VectorXd(VectorXd::Unit(n, n - 1 - i)) : VectorXd(eigen.eigenvectors().col(i));
      int largest = 0;
      axis.cwiseAbs().maxCoeff(&largest);
      axes.push_back(axis[largest] < 0 ? VectorXd(-axis) : axis);
    }
    return axes;
  }

  // Rows of Z that are released; false where they do not have full rank: their release would add a motion.
  bool fill_block(ReleaseCandidate& one) const {
    const int first = report_.rows.first[one.joint];
    MatrixXd gram = MatrixXd::Zero(one.k(), one.k());
    for (int c = 0; c < one.k(); ++c) {
      std::vector<std::pair<int, double>> sum;
      for (int i = 0; i < one.rows.rows(); ++i) {
        if (one.rows(i, c) == 0) continue;
        for (const auto& [column, value] : rows_[first + i]) sum.emplace_back(column, one.rows(i, c) * value);
      }
      std::sort(sum.begin(), sum.end());
      std::vector<std::pair<int, double>> merged;
      for (const auto& [column, value] : sum) {
        if (!merged.empty() && merged.back().first == column)
          merged.back().second += value;
        else
          merged.emplace_back(column, value);
      }
      one.block.push_back(std::move(merged));
    }
    for (int a = 0; a < one.k(); ++a) {
      for (int b = 0; b < one.k(); ++b) gram(a, b) = dot(one.block[a], one.block[b]);
    }
    const double least = Eigen::SelfAdjointEigenSolver<MatrixXd>(gram, Eigen::EigenvaluesOnly).eigenvalues()[0];
    return !is_negligible(std::max(0.0, least), 1.0);
  }

  Vector3d direction(int joint, const ReleaseKind& change, const MatrixXd& rows) const {
    if (!change.one_of) return Vector3d::Zero();
    Vector3d in_F = Vector3d::Zero();  // of the released force or moment
    for (int i = 0; i < rows.rows(); ++i) in_F[component_of_row(change.from, i) % 3] += rows(i, 0);
    const RelativeMotion& m = wrenches_[joint].motion;
    if (change.to == T::kPointOnPlane) return Vector3d::UnitZ().cross(in_F).normalized();
    if (change.to != T::kUniversal) return in_F.normalized();
    Vector3d in_M = m.R_M.transpose() * (m.R_F * in_F);
    in_M.z() = 0;
    return in_M.normalized();
  }

  double preference(int joint, const ReleaseKind& change) const {
    const Joint& definition = model_.joints()[joint];
    double value = change.preference;
    const bool on_ground = definition.first == kGround || definition.second == kGround;
    if (change.to == T::kPlanar) return value * hangers_.floating_preference(joint);
    return on_ground && change.is_bearing ? value * kOnGround : value;
  }

  const Model& model_;
  const RedundancyReport& report_;
  CoordinateUses uses_;
  Hangers hangers_;
  std::vector<std::vector<std::pair<int, double>>> rows_;
  std::vector<int> local_;
  MatrixXd metric_;  // of the group at hand
  JointWrenches wrenches_;
};

}  // namespace

std::span<const ReleaseKind> release_kinds() { return kKinds; }

MatrixXd triangular_factor(const ReleaseGroup& group) {
  MatrixXd Z = MatrixXd::Zero(static_cast<long>(group.rows.size()), group.size());
  for (long i = 0; i < Z.rows(); ++i) {
    for (const auto& [column, value] : group.rows[i].second) Z(i, column) = value;
  }
  return Z.householderQr().matrixQR().topRows(Z.cols()).triangularView<Eigen::Upper>();
}

MatrixXd orthonormal_rows(const std::vector<std::vector<std::pair<int, double>>>& rows, const MatrixXd& U) {
  MatrixXd transposed = MatrixXd::Zero(U.cols(), static_cast<long>(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const auto& [column, value] : rows[i]) transposed(column, static_cast<long>(i)) = value;
  }
  return U.transpose().triangularView<Eigen::Lower>().solve(transposed).transpose();
}

std::vector<ReleaseGroup> find_release_groups(const System& system, const State& state, const RedundancyReport& report,
                                              std::vector<ReleaseObstacle>& obstacles) {
  return GroupFinder(system, state, report).find(obstacles);
}

}  // namespace ferrers
