#include "ferrers/redundancy/distribution.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "ferrers/core/checks.h"

namespace ferrers {
namespace {

constexpr std::array<std::pair<DistributionBy, std::string_view>, 3> kDistributions = {
    {{DistributionBy::kJointStiffness, "stiffness"},
     {DistributionBy::kEqualStiffness, "equal"},
     {DistributionBy::kNothing, "none"}}};

// The axes in which a joint's stiffness is given. Teeth give way along their line of action, wherever their gears are.
Matrix3d stiffness_axes(const Joint& joint, const JointFrameWrenches& frame) {
  if (joint.type != JointType::kGearMesh) return frame.motion.R_F;
  const Vector3d line = frame.T.col(0).tail<3>().normalized();
  const Vector3d axis = frame.motion.R_F.col(2);
  Matrix3d axes;
  axes << line, axis.cross(line), axis;
  return axes;
}

// The orthogonal complement of orthonormal columns.
MatrixXd complement(const MatrixXd& columns) {
  if (columns.cols() == 0) return MatrixXd::Identity(columns.rows(), columns.rows());
  const Eigen::HouseholderQR<MatrixXd> qr(columns);
  const MatrixXd all = qr.householderQ() * MatrixXd::Identity(columns.rows(), columns.rows());
  return all.rightCols(columns.rows() - columns.cols());
}

// R of A = Q R: the same singular values and null space as A, in fewer rows.
MatrixXd triangular_factor(const MatrixXd& A) {
  const MatrixXd R = Eigen::HouseholderQR<MatrixXd>(A).matrixQR().topRows(A.cols());
  return R.triangularView<Eigen::Upper>();
}

// True where springs surely fix every self-stress: already 1/|R⁻¹|, which no singular value is below, is surely
// nonzero. Spares the singular values in the usual case; false says nothing.
bool is_surely_fixed(const MatrixXd& R, RankDecision& decision) {
  if (R.cols() == 0) return true;
  if (R.rows() != R.cols() || (R.diagonal().array() == 0).any()) return false;
  const MatrixXd inverse = R.triangularView<Eigen::Upper>().solve(MatrixXd::Identity(R.rows(), R.cols()));
  const RankDecision bound = decide_rank(Eigen::Vector2d(1, 1 / inverse.norm()), 1.0);
  if (!bound.full || !bound.confident) return false;
  decision = bound;
  decision.rank = decision.other_rank = static_cast<int>(R.cols());
  decision.singular_values.resize(0);
  return true;
}

// What each spring takes of each column of Z.
MatrixXd work_of(const std::vector<SpringComponent>& springs, const AllRows& rows,
                 const std::vector<ComponentMap>& maps, const MatrixXd& Z) {
  MatrixXd work(static_cast<long>(springs.size()), Z.cols());
  for (std::size_t i = 0; i < springs.size(); ++i) {
    const int j = springs[i].joint;
    work.row(static_cast<long>(i)) = maps[j].row(springs[i].component) * Z.middleRows(rows.first[j], rows.count[j]);
  }
  return work;
}

// Springs that some self-stress loads, by the rule that also tells unique components.
std::vector<SpringComponent> loaded_springs(const AllRows& rows, const std::vector<ComponentMap>& maps,
                                            const JointSprings& springs, const MatrixXd& Z, double length_m) {
  std::vector<SpringComponent> loaded;
  for (std::size_t j = 0; j < maps.size(); ++j) {
    const MatrixXd taken = maps[j] * Z.middleRows(rows.first[j], rows.count[j]);
    for (int k = 0; k < 6; ++k) {
      const double compliance = springs.compliance[j][k];
      if (compliance > 0 && !is_negligible(taken.row(k).norm() / component_unit(k, length_m), 1.0)) {
        loaded.push_back({static_cast<int>(j), k, compliance});
      }
    }
  }
  return loaded;
}

// Joints and couplings that a self-stress works on.
std::vector<int> touched_owners(const AllRows& rows, const VectorXd& stress) {
  std::vector<int> touched;
  const VectorXd scaled = stress.cwiseQuotient(rows.scale);
  for (std::size_t j = 0; j < rows.first.size(); ++j) {
    const double share = scaled.segment(rows.first[j], rows.count[j]).norm();
    if (!is_negligible(share, scaled.norm())) touched.push_back(static_cast<int>(j));
  }
  return touched;
}

// Those that self-stresses tie to `seeds`, directly or through others: the projector on the self-stresses, which does
// not depend on their basis, has a block for the two.
std::vector<int> tied_owners(const ForceMethod& method, const AllRows& rows, std::vector<int> seeds) {
  MatrixXd all(rows.size(), method.fixed.cols() + method.remaining.cols());
  all << method.fixed, method.remaining;
  all = rows.scale.cwiseInverse().asDiagonal() * all;
  const auto block = [&](int j) { return all.middleRows(rows.first[j], rows.count[j]); };
  std::vector<bool> seen(rows.first.size(), false);
  for (const int j : seeds) seen[static_cast<std::size_t>(j)] = true;
  for (std::size_t next = 0; next < seeds.size(); ++next) {
    const MatrixXd here = block(seeds[next]);
    for (std::size_t j = 0; j < seen.size(); ++j) {
      if (seen[j] || is_negligible((here * block(static_cast<int>(j)).transpose()).norm(), 1.0)) continue;
      seen[j] = true;
      seeds.push_back(static_cast<int>(j));
    }
  }
  return seeds;
}

// The y that minimizes |A y + b|² + 2 dᵀy, where A has full column rank and rows of very different size: these are
// sorted and columns pivoted, which keeps small rows accurate beside large ones.
VectorXd minimize(const MatrixXd& A, const VectorXd& b, const VectorXd& d) {
  std::vector<int> order(static_cast<std::size_t>(A.rows()));
  std::iota(order.begin(), order.end(), 0);
  const VectorXd sizes = A.rowwise().lpNorm<Eigen::Infinity>();
  std::stable_sort(order.begin(), order.end(), [&](int i, int k) { return sizes[i] > sizes[k]; });
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(A(order, Eigen::all));
  const long k = A.cols();
  const auto R = qr.matrixQR().topRows(k).triangularView<Eigen::Upper>();
  const VectorXd turned = (qr.householderQ().adjoint() * b(order)).head(k);
  const VectorXd preload = R.transpose().solve(qr.colsPermutation().transpose() * d);
  return -(qr.colsPermutation() * R.solve(turned + preload));
}

}  // namespace

std::string_view to_string(ReactionStatus status) {
  switch (status) {
    case ReactionStatus::kUnique:
      return "unique";
    case ReactionStatus::kDistributed:
      return "distributed";
    case ReactionStatus::kUndetermined:
      break;
  }
  return "undetermined";
}

std::string_view to_string(DistributionBy by) {
  for (const auto& [value, name] : kDistributions) {
    if (value == by) return name;
  }
  return "";
}

std::optional<DistributionBy> find_distribution(std::string_view name) {
  for (const auto& [value, text] : kDistributions) {
    if (text == name) return value;
  }
  return std::nullopt;
}

JointSprings make_joint_springs(const System& system, DistributionBy by, double length_m) {
  JointSprings springs;
  for (const Joint& joint : system.model->joints()) {
    Vector6d compliance = Vector6d::Zero(), misalignment = Vector6d::Zero();
    if (by == DistributionBy::kEqualStiffness) {
      compliance << Vector3d::Ones(), Vector3d::Constant(1 / (length_m * length_m));
      springs.any = true;
    } else if (by == DistributionBy::kJointStiffness) {
      if (joint.stiffness) compliance = joint.stiffness->cwiseInverse();  // rigid: 1/∞ = 0
      if (joint.misalignment) misalignment = *joint.misalignment;
      springs.any = springs.any || joint.stiffness || joint.misalignment;
    }
    springs.compliance.push_back(compliance);
    springs.misalignment.push_back(misalignment);
  }
  return springs;
}

std::vector<ComponentMap> compute_component_maps(const System& system, const JointWrenches& joints) {
  std::vector<ComponentMap> maps(joints.size());
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const JointFrameWrenches& frame = joints[j];
    maps[j].resize(6, frame.T.cols());
    if (frame.T.cols() == 0) continue;
    const Joint& joint = system.model->joints()[j];
    const Matrix3d to_axes = stiffness_axes(joint, frame).transpose();
    const Matrix3d lever = cross_matrix(-reaction_point_from_M(joint, frame.motion));
    maps[j].topRows<3>() = to_axes * frame.T.bottomRows<3>();
    maps[j].bottomRows<3>() = to_axes * (frame.T.topRows<3>() + lever * frame.T.bottomRows<3>());
  }
  return maps;
}

ForceMethod make_force_method(const AllRows& rows, const std::vector<ComponentMap>& maps, const JointSprings& springs,
                              const MatrixXd& Z, double length_m) {
  require_size(Z.rows(), rows.size(), "make_force_method: Z");
  require_size(static_cast<long>(springs.compliance.size()), static_cast<long>(maps.size()),
               "make_force_method: springs");
  ForceMethod method;
  method.length_m = length_m;
  method.springs = loaded_springs(rows, maps, springs, Z, length_m);
  const MatrixXd work = work_of(method.springs, rows, maps, Z);
  MatrixXd pattern = work;
  for (long i = 0; i < pattern.rows(); ++i) {
    pattern.row(i) /= component_unit(method.springs[static_cast<std::size_t>(i)].component, length_m);
  }
  if (pattern.cols() > 0 && pattern.rows() >= pattern.cols()) pattern = triangular_factor(pattern);
  if (is_surely_fixed(pattern, method.decision)) {
    method.fixed = Z;
    method.work = work;
    method.remaining.resize(Z.rows(), 0);
    return method;
  }
  const RankAnalysis analysis = analyze_rank(pattern, 1.0);
  method.decision = analysis.decision;
  const MatrixXd taken = complement(analysis.right_null);
  method.fixed = Z * taken;
  method.work = work * taken;
  method.remaining = Z * analysis.right_null;
  return method;
}

VectorXd spring_loads(const ForceMethod& method, const AllRows& rows, const std::vector<ComponentMap>& maps,
                      const VectorXd& lambda) {
  return work_of(method.springs, rows, maps, lambda);
}

VectorXd misalignment_of_rows(const AllRows& rows, const std::vector<ComponentMap>& maps, const JointSprings& springs) {
  VectorXd delta = VectorXd::Zero(rows.size());
  for (std::size_t j = 0; j < maps.size(); ++j) {
    delta.segment(rows.first[j], rows.count[j]) = maps[j].transpose() * springs.misalignment[j];
  }
  return delta;
}

DistributionResult solve_distribution(const ForceMethod& method, const AllRows& rows,
                                      const std::vector<ComponentMap>& maps, const VectorXd& lambda_p,
                                      const VectorXd& delta) {
  require_size(lambda_p.size(), rows.size(), "solve_distribution: lambda_p");
  require_size(delta.size(), rows.size(), "solve_distribution: delta");
  DistributionResult out;
  out.valid.assign(rows.first.size(), true);
  // Work of the free self-stresses (of unit size in newtons) on delta, in metres.
  const VectorXd gap = method.remaining.transpose() * delta;
  const double size = rows.scale.cwiseProduct(delta).norm();
  if (gap.size() > 0 && !is_negligible(gap.norm(), size)) {
    out.contradictory = touched_owners(rows, method.remaining * gap.normalized());
    for (const int j : tied_owners(method, rows, out.contradictory)) out.valid[static_cast<std::size_t>(j)] = false;
  }
  out.lambda = lambda_p;
  if (method.fixed.cols() == 0) return out;
  VectorXd root(static_cast<long>(method.springs.size()));
  for (long i = 0; i < root.size(); ++i) root[i] = std::sqrt(method.springs[static_cast<std::size_t>(i)].compliance);
  const VectorXd loads = spring_loads(method, rows, maps, lambda_p);
  out.lambda += method.fixed *
                minimize(root.asDiagonal() * method.work, root.cwiseProduct(loads), method.fixed.transpose() * delta);
  return out;
}

ReactionStatus judge_component(const Eigen::RowVectorXd& row, double unit, const Eigen::Ref<const MatrixXd>& Z_joint,
                               const Eigen::Ref<const MatrixXd>& remaining_joint) {
  const auto untouched = [&](const Eigen::Ref<const MatrixXd>& stresses) {
    return row.cols() == 0 || stresses.cols() == 0 || is_negligible((row * stresses).norm() / unit, 1.0);
  };
  if (untouched(Z_joint)) return ReactionStatus::kUnique;
  return untouched(remaining_joint) ? ReactionStatus::kDistributed : ReactionStatus::kUndetermined;
}

const std::string& owner_name(const Model& model, int joint_or_coupling) {
  const auto j = static_cast<std::size_t>(joint_or_coupling), joints = model.joints().size();
  return j < joints ? model.joints()[j].name : model.couplings()[j - joints].name;
}

}  // namespace ferrers
