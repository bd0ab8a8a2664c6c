#include "ferrers/redundancy/consistent_geometry.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "ferrers/kinematics/assembly.h"
#include "ferrers/kinematics/self_stress.h"
#include "ferrers/model/joints/joint_type.h"
#include "ferrers/model/pose_spec.h"
#include "ferrers/redundancy/contradiction.h"
#include "ferrers/redundancy/tolerant_walk.h"

namespace ferrers {
namespace {

constexpr int kPoses = 8, kProofPoses = 3, kMostRounds = 4, kMostIterations = 15;
constexpr double kStep = 0.08;          // between poses, two of them; in characteristic lengths and rad
constexpr double kOpen = 300;           // a misclosure of so many tolerances is none that the tolerance explains
constexpr double kParallel = 1e-10;     // rad: what rounding leaves of parallel axes
constexpr double kNearlyParallel = 10;  // tolerances
constexpr double kTurnWeight = 100;     // a seat is rather moved than turned, or axes made parallel would not stay so
constexpr double kRounding = 1e-15;     // relative: the loops are as closed as they can be
constexpr double kBlurredConditions = 1e-8;  // relative: a condition this weak belongs to a neighbouring geometry
constexpr double kNoMove = 1e-14;            // relative; rad

bool has_free_seats(const Joint& joint) {
  const PlacementRule rule = joint_type_info(joint.type).placement;
  return rule != PlacementRule::kTwoPoints && rule != PlacementRule::kMesh && joint_type_info(joint.type).carries_body;
}

/// A small displacement of a frame, (translation, rotation) along its own axes.
Pose displaced(const Pose& X, const Vector6d& move) {
  return {X.R * quaternion_exp(move.tail<3>()).toRotationMatrix(), X.p + X.R * move.head<3>()};
}

/// The seats of all joints, and the mechanism that they make.
class Seats {
 public:
  explicit Seats(const Model& model) : model_(model), spec_(model.spec()) {
    for (const Joint& joint : model.joints()) frames_.push_back({joint.X_1F, joint.X_2M});
    system_ = make_system(std::make_shared<const Model>(model));
  }

  const System& system() const { return *system_; }
  const ModelSpec& spec() const { return spec_; }
  std::size_t count() const { return frames_.size(); }

  /// `moves`: 12 numbers per joint, first F then M; angles times `length`. False where no model comes of it.
  bool move(const VectorXd& moves, double length) {
    for (std::size_t j = 0; j < frames_.size(); ++j) {
      if (!has_free_seats(model_.joints()[j])) continue;
      for (std::size_t side = 0; side < 2; ++side) {
        Vector6d one = moves.segment<6>(static_cast<long>(12 * j + 6 * side));
        if (one.isZero(0)) continue;
        one.tail<3>() /= length;
        frames_[j][side] = displaced(frames_[j][side], one);
        place(spec_.joints[model_.spec_index(JointId(j))], j);
      }
    }
    ModelBuildResult built = build_model(spec_, model_.overrides());
    if (!built.model) return false;
    system_ = make_system(std::make_shared<const Model>(std::move(*built.model)));
    return true;
  }

  std::vector<SeatMove> moves(double length) const {
    std::vector<SeatMove> all;
    for (std::size_t j = 0; j < frames_.size(); ++j) {
      const Joint& joint = model_.joints()[j];
      SeatMove one{joint.name};
      const std::array<Pose, 2> before = {joint.X_1F, joint.X_2M};
      for (std::size_t side = 0; side < 2; ++side) {
        one.distance_m = std::max(one.distance_m, (frames_[j][side].p - before[side].p).norm());
        one.angle_rad = std::max(one.angle_rad, rotation_log(before[side].R.transpose() * frames_[j][side].R).norm());
      }
      if (one.distance_m > kNoMove * length || one.angle_rad > kNoMove) all.push_back(one);
    }
    std::sort(all.begin(), all.end(), [length](const SeatMove& a, const SeatMove& b) {
      return std::max(a.distance_m, a.angle_rad * length) > std::max(b.distance_m, b.angle_rad * length);
    });
    return all;
  }

 private:
  void place(JointSpec& joint, std::size_t index) const {
    joint.place = joint.axis = joint.axis2 = {};
    joint.x.reset();
    const auto on_part = [&](std::size_t side) {
      return pose_spec(model_.part(joint.bodies[side].name).X_BP.inverse() * frames_[index][side], joint.name.at);
    };
    joint.frames = {on_part(0), on_part(1)};
  }

  const Model& model_;
  ModelSpec spec_;
  std::vector<std::array<Pose, 2>> frames_;
  std::shared_ptr<const System> system_;
};

bool has_axis(const Joint& joint) {
  const PlacementRule rule = joint_type_info(joint.type).placement;
  return rule == PlacementRule::kPointAxis || rule == PlacementRule::kPointNormal;
}

double angle_between_lines(const Vector3d& a, const Vector3d& b) { return std::asin(std::min(1.0, a.cross(b).norm())); }

/// Joints whose axes (z of F) are parallel within `angle` to that of the first of their group, at one pose.
std::vector<std::vector<std::size_t>> parallel_groups(const std::vector<Joint>& joints, const JointWrenches& at,
                                                      double angle) {
  const auto axis = [&](std::size_t j) -> Vector3d { return at[j].motion.R_F.col(2); };
  std::vector<bool> taken(joints.size(), false);
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (taken[i] || !has_axis(joints[i])) continue;
    std::vector<std::size_t> group = {i};
    for (std::size_t j = i + 1; j < joints.size(); ++j) {
      if (taken[j] || !has_axis(joints[j]) || angle_between_lines(axis(i), axis(j)) > angle) continue;
      group.push_back(j);
      taken[j] = true;
    }
    if (group.size() > 1) groups.push_back(std::move(group));
  }
  return groups;
}

JointWrenches joints_at(const System& system, const State& state) {
  PositionKinematics pos = make_position_kinematics(system);
  compute_positions(system, state.q, pos);
  return compute_joint_frame_wrenches(system, state, pos);
}

/// The rotation that turns z of a frame along `n`, given in the world, the short way.
Vector3d turn_to(const Matrix3d& R, const Vector3d& n) {
  Vector3d wanted = R.transpose() * n;
  if (wanted.z() < 0) wanted = -wanted;
  return rotation_log(Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), wanted).toRotationMatrix());
}

/// What makes axes parallel that nearly are. Without it the nearest geometry of a planar mechanism would be a spherical
/// one, its axes meeting a million diameters away.
VectorXd aligning_moves(const System& system, const State& state, double angle) {
  const auto& joints = system.model->joints();
  const JointWrenches at = joints_at(system, state);
  VectorXd moves = VectorXd::Zero(static_cast<long>(12 * joints.size()));
  for (const std::vector<std::size_t>& group : parallel_groups(joints, at, angle)) {
    const Vector3d first = at[group[0]].motion.R_F.col(2);
    Vector3d mean = Vector3d::Zero();
    for (const std::size_t j : group) {
      for (const Vector3d& z : {Vector3d(at[j].motion.R_F.col(2)), Vector3d(at[j].motion.R_M.col(2))}) {
        mean += z.dot(first) < 0 ? Vector3d(-z) : z;
      }
    }
    mean.normalize();
    for (const std::size_t j : group) {
      auto move = moves.segment<12>(static_cast<long>(12 * j));
      move.segment<3>(3) = system.scaling.length_m * turn_to(at[j].motion.R_F, mean);
      move.segment<3>(9) = system.scaling.length_m * turn_to(at[j].motion.R_M, mean);
    }
  }
  return moves;
}

/// What the self-stresses of one pose feel: rows of A x = b in the seats' displacements.
void add_conditions(const System& system, const State& state, const TolerantWalk& walk, std::vector<VectorXd>& A,
                    std::vector<double>& b) {
  const double length = system.scaling.length_m;
  PositionKinematics pos = make_position_kinematics(system);
  compute_positions(system, state.q, pos);
  const AllRows rows = make_all_rows(system, system.scaling);
  const JointWrenches joints = joints_at(system, state);
  SelfStressExtender extender(system, system.scaling, rows, pos, joints);
  const MatrixXd null = walk.left_null();
  for (long s = 0; s < null.cols(); ++s) {
    SparseRows closure;
    double misclosure = 0;
    for (int row = 0; row < system.m; ++row) {
      closure.emplace_back(row, null(row, s) * system.scaling.rows[row]);
      misclosure += closure.back().second * walk.phi()[row];
    }
    VectorXd z = VectorXd::Zero(rows.size());
    for (const auto& [row, value] : extender.extend(closure)) z[row] = value;
    VectorXd felt = VectorXd::Zero(static_cast<long>(12 * joints.size()));
    for (std::size_t j = 0; j < joints.size(); ++j) {
      if (!has_free_seats(system.model->joints()[j]) || rows.count[j] == 0) continue;
      const JointFrameWrenches& joint = joints[j];
      const Wrench w = joint.T * z.segment(rows.first[j], rows.count[j]);  // moment, force at p_M, on the second body
      const Vector3d force = w.tail<3>(), moment_M = w.head<3>();
      const Vector3d moment_F = moment_M + joint.motion.d.cross(force);
      auto at = felt.segment<12>(static_cast<long>(12 * j));
      at.segment<3>(0) = -(joint.motion.R_F.transpose() * force);
      at.segment<3>(3) = -(joint.motion.R_F.transpose() * moment_F) / (kTurnWeight * length);
      at.segment<3>(6) = joint.motion.R_M.transpose() * force;
      at.segment<3>(9) = joint.motion.R_M.transpose() * moment_M / (kTurnWeight * length);
    }
    const double size = felt.norm();
    if (size == 0) continue;
    A.push_back(felt / size);
    b.push_back(-misclosure / size);
  }
}

/// The least x that does A x = b as far as the error of A, about |b|, lets it be known.
VectorXd least_displacements(const std::vector<VectorXd>& rows, const std::vector<double>& right, double length) {
  MatrixXd A(static_cast<long>(rows.size()), rows.front().size());
  for (std::size_t i = 0; i < rows.size(); ++i) A.row(static_cast<long>(i)) = rows[i].transpose();
  const VectorXd b = Eigen::Map<const VectorXd>(right.data(), static_cast<long>(right.size()));
  const Eigen::BDCSVD<MatrixXd> svd(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const VectorXd& sigma = svd.singularValues();
  const double blur = sigma[0] * std::max(kBlurredConditions, 10 * b.cwiseAbs().maxCoeff() / length);
  const VectorXd share = sigma.array() / (sigma.array().square() + blur * blur);
  VectorXd x = svd.matrixV() * share.cwiseProduct(svd.matrixU().transpose() * b);
  for (long at = 3; at < x.size(); at += 6) x.segment<3>(at) /= kTurnWeight;
  return x;
}

class Search {
 public:
  Search(const Model& model, double tolerance, ConsistentGeometry& out)
      : seats_(model), tolerance_(tolerance), out_(out), length_(seats_.system().scaling.length_m) {}

  void run() {
    const System& system = seats_.system();
    if (system.m == 0) return;
    if (system.m > kMostRowsMadeConsistent || system.nv > kMostCoordinatesMadeConsistent) {
      out_.verdict = GeometryVerdict::kTooLarge;
      return;
    }
    State start = assemble(system).state;
    if (!read_as_written(start)) return;
    if (!seats_.move(aligning_moves(system, start, kNearlyParallel * tolerance_), length_)) return;
    collect_poses(start);
    for (int round = 0; round < kMostRounds; ++round) {
      if (!correct()) break;
      if (proves()) {
        out_.verdict = GeometryVerdict::kFound;
        out_.spec = seats_.spec();
        out_.model = seats_.system().model;
        out_.moves = seats_.moves(length_);
        out_.poses = static_cast<int>(poses_.size());
        return;
      }
    }
    out_.verdict = GeometryVerdict::kNotFound;
  }

  const std::vector<State>& poses() const { return poses_; }
  const System& system() const { return seats_.system(); }

 private:
  /// Whether there is anything to do, and what the numbers say as they stand.
  bool read_as_written(State& start) {
    const System& system = seats_.system();
    TolerantWalk walk(system, tolerance_);
    walk.settle(start);
    out_.misclosure_m = walk.residual();
    if (out_.misclosure_m > kOpen * tolerance_ * length_) {
      out_.verdict = GeometryVerdict::kOpen;
      return false;
    }
    out_.treated = walk.decision();
    out_.as_written = decide_rank(out_.treated.singular_values);
    const bool closes = out_.misclosure_m < closed_tolerance(system.scaling);
    if (closes && out_.as_written.rank == out_.treated.rank && out_.as_written.confident) return false;
    if (walk.left_null().cols() == 0) return false;
    rank_ = out_.treated.rank;
    return true;
  }

  /// Poses of the largest rank on a walk there and back; only the first where it does not stay nearly closed.
  void collect_poses(const State& start) {
    poses_ = {start};
    const System& system = seats_.system();
    std::vector<State> reached;
    for (int half = 0; half < 2; ++half) {
      TolerantWalk walk(system, tolerance_);
      State state = start;
      walk.settle(state);
      if (half == 1) walk.turn_back();
      for (int i = 0; i < kPoses / 2; ++i) {
        const bool moved = walk.step(half == 0 ? kStep : -kStep, state) && walk.step(half == 0 ? kStep : -kStep, state);
        if (!moved || walk.residual() > kOpen * tolerance_ * length_) break;
        reached.push_back(state);
        rank_ = std::max(rank_, walk.decision().rank);
      }
    }
    TolerantWalk walk(system, tolerance_);
    for (State& state : reached) {
      walk.settle(state);
      if (walk.decision().rank == rank_) poses_.push_back(state);
    }
    walk.settle(poses_.front());
    if (walk.decision().rank != rank_ && poses_.size() > 1) poses_.erase(poses_.begin());
  }

  /// Gauss-Newton on all poses at once. False where it does not come to closing.
  bool correct() {
    double best = HUGE_VAL;
    for (int i = 0; i < kMostIterations; ++i) {
      std::vector<VectorXd> A;
      std::vector<double> b;
      double worst = 0;
      TolerantWalk walk(seats_.system(), tolerance_);
      for (State& pose : poses_) {
        walk.settle(pose, rank_);
        worst = std::max(worst, walk.residual());
        add_conditions(seats_.system(), pose, walk, A, b);
      }
      const double closed = closed_tolerance(seats_.system().scaling);
      if (worst < kRounding * length_) return true;
      if (worst < closed && worst > 0.5 * best) return worst < 0.1 * closed;  // rounding allows no more
      if (A.empty() || (i > 5 && worst > best)) return worst < closed;
      best = std::min(best, worst);
      if (!seats_.move(least_displacements(A, b, length_), length_)) return false;
    }
    return false;
  }

  /// Whether the mechanism closes at further poses as well; those where it does not are taken among the others.
  bool proves() {
    const System& system = seats_.system();
    bool proven = true;
    TolerantWalk walk(system, tolerance_);
    State state = poses_.back();
    walk.settle(state, rank_);
    for (int i = 0; i < kProofPoses; ++i) {
      if (!walk.step(1.7 * kStep, state, rank_)) break;
      const RankDecision exact = decide_rank(walk.decision().singular_values);
      if (walk.residual() < closed_tolerance(system.scaling) && exact.rank <= rank_) continue;
      poses_.push_back(state);
      proven = false;
    }
    return proven;
  }

  Seats seats_;
  double tolerance_;
  ConsistentGeometry& out_;
  double length_;
  int rank_ = 0;
  std::vector<State> poses_;
};

/// Groups of axes that are parallel now, with what they were as written at the same coordinates.
std::vector<ParallelAxes> find_parallel_axes(const System& before, const System& after, const State& pose) {
  const JointWrenches was = joints_at(before, pose);
  const auto& joints = after.model->joints();
  std::vector<ParallelAxes> groups;
  for (const std::vector<std::size_t>& members : parallel_groups(joints, joints_at(after, pose), kParallel)) {
    ParallelAxes group;
    for (const std::size_t a : members) {
      group.joints.push_back(joints[a].name);
      for (const std::size_t b : members) {
        group.angle_rad =
            std::max(group.angle_rad, angle_between_lines(was[a].motion.R_F.col(2), was[b].motion.R_F.col(2)));
      }
    }
    if (group.angle_rad > kParallel) groups.push_back(std::move(group));
  }
  return groups;
}

std::string words(const ConsistentGeometry& g) {
  const std::string within = fmt::format("within the geometric tolerance of {:.2g}", g.tolerance);
  switch (g.verdict) {
    case GeometryVerdict::kExact:
      return "";
    case GeometryVerdict::kTooLarge:
      return fmt::format(
          "the mechanism is too large to look for a consistent geometry {}: its numbers are taken "
          "at their word",
          within);
    case GeometryVerdict::kOpen:
      return fmt::format(
          "the loops stay open by {}, more than the geometric tolerance of {:.2g} explains: the numbers "
          "are taken at their word",
          length_text(g.misclosure_m), g.tolerance);
    case GeometryVerdict::kNotFound:
      return fmt::format(
          "no geometry was found {} that moves as this one nearly does: its numbers are taken at their "
          "word",
          within);
    case GeometryVerdict::kFound:
      break;
  }
  std::string text =
      fmt::format("the numbers are taken as exact {}: {} redundant, mobility {}", within, g.redundant, g.mobility);
  if (g.redundant != g.redundant_as_written || !g.as_written.confident) {
    text += fmt::format(" (as written: {} redundant, mobility {}{})", g.redundant_as_written, g.mobility_as_written,
                        g.as_written.confident ? "" : ", in doubt");
  }
  if (!g.moves.empty()) {
    const SeatMove& most = g.moves.front();
    text += fmt::format("; for this the seats of {} joint{} move on their bodies, most of all '{}' by {} and {}",
                        g.moves.size(), g.moves.size() == 1 ? "" : "s", most.joint, length_text(most.distance_m),
                        angle_text(most.angle_rad));
  }
  return text;
}

}  // namespace

std::string_view to_string(GeometryVerdict verdict) {
  switch (verdict) {
    case GeometryVerdict::kExact:
      return "exact";
    case GeometryVerdict::kFound:
      return "made consistent";
    case GeometryVerdict::kOpen:
      return "open";
    case GeometryVerdict::kNotFound:
      return "not found";
    case GeometryVerdict::kTooLarge:
      return "too large";
  }
  return "";
}

ConsistentGeometry find_consistent_geometry(const Model& model, double tolerance) {
  ConsistentGeometry out;
  out.tolerance = tolerance;
  if (tolerance <= 0) return out;
  Search search(model, tolerance, out);
  const std::shared_ptr<const System> written = make_system(std::make_shared<const Model>(model));
  search.run();
  const int n = written->nv, m = written->m;
  out.mobility = n - out.treated.rank;
  out.redundant = m - out.treated.rank;
  out.mobility_as_written = n - out.as_written.rank;
  out.redundant_as_written = m - out.as_written.rank;
  if (out.verdict == GeometryVerdict::kFound) {
    out.parallel = find_parallel_axes(*written, search.system(), search.poses().front());
  }
  out.text = words(out);
  return out;
}

}  // namespace ferrers
