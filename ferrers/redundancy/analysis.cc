#include "ferrers/redundancy/analysis.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "ferrers/kinematics/self_stress.h"
#include "ferrers/math/sparse_basis.h"
#include "ferrers/redundancy/cluster_rank.h"
#include "ferrers/redundancy/selection.h"

namespace ferrers {
namespace {

// Self-stresses while they are collected: over all rows, in scaled units.
struct Collected {
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<SelfStress> places;
};

SparseRows closure_rows(const ClusterRank& cluster, const Scaling& scaling, const SparseRank::SparseVector& vector) {
  SparseRows rows;
  for (const auto& [local, value] : vector) {
    const int row = cluster.rows[local];
    if (value != 0) rows.emplace_back(row, value * scaling.rows[row]);
  }
  return rows;
}

std::vector<int> sorted_unique(std::vector<int> values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

// One group of self-stresses, found on the same loops: as many zeros as can be had, and who is loaded.
class GroupWriter {
 public:
  GroupWriter(const System& system, const AllRows& rows, Collected& out) : rows_(rows), out_(out) {
    int loop = 0;
    for (const Closure& closure : system.topology->closures) {
      closure_of_row_.insert(closure_of_row_.end(), static_cast<std::size_t>(closure.row_count), loop++);
    }
    for (std::size_t j = 0; j < rows.count.size(); ++j) {
      joint_of_row_.insert(joint_of_row_.end(), static_cast<std::size_t>(rows.count[j]), static_cast<int>(j));
    }
  }

  void write(int cluster, const std::vector<SparseRows>& stresses) {
    std::vector<int> used;
    for (const SparseRows& stress : stresses) {
      for (const auto& [row, value] : stress) used.push_back(row);
    }
    used = sorted_unique(std::move(used));
    MatrixXd Z = MatrixXd::Zero(static_cast<long>(used.size()), static_cast<long>(stresses.size()));
    for (std::size_t k = 0; k < stresses.size(); ++k) {
      for (const auto& [row, value] : stresses[k]) {
        const auto at = std::lower_bound(used.begin(), used.end(), row) - used.begin();
        Z(at, static_cast<long>(k)) = value / rows_.scale[row];
      }
    }
    const Eigen::HouseholderQR<MatrixXd> qr(Z);
    const MatrixXd basis = make_sparse_basis(qr.householderQ() * MatrixXd::Identity(Z.rows(), Z.cols()));
    for (long k = 0; k < basis.cols(); ++k) add(cluster, used, basis.col(k));
  }

 private:
  void add(int cluster, const std::vector<int>& used, const VectorXd& vector) {
    SelfStress place{cluster, {}, {}};
    const int column = static_cast<int>(out_.places.size());
    // The largest entry is positive, so that the same stress is always told the same way.
    long largest = 0;
    vector.cwiseAbs().maxCoeff(&largest);
    const double sign = vector[largest] < 0 ? -1 : 1;
    for (std::size_t i = 0; i < used.size(); ++i) {
      const double value = vector[static_cast<long>(i)];
      if (is_surely_zero(value)) continue;
      out_.entries.emplace_back(used[i], column, sign * value * rows_.scale[used[i]]);
      if (is_negligible(value, 1.0)) continue;
      place.joints.push_back(joint_of_row_[used[i]]);
      if (const int row = rows_.closure_row[used[i]]; row >= 0) place.closures.push_back(closure_of_row_[row]);
    }
    place.joints = sorted_unique(std::move(place.joints));
    place.closures = sorted_unique(std::move(place.closures));
    out_.places.push_back(std::move(place));
  }

  const AllRows& rows_;
  Collected& out_;
  std::vector<int> closure_of_row_, joint_of_row_;
};

Collected collect_self_stresses(const System& system, const Scaling& scaling, const AllRows& rows,
                                const PositionKinematics& pos, const JointWrenches& joints,
                                const ClusterDecision& decision) {
  SelfStressExtender extender(system, scaling, rows, pos, joints);
  Collected out;
  GroupWriter writer(system, rows, out);
  for (std::size_t c = 0; c < decision.clusters.size(); ++c) {
    const ClusterRank& cluster = decision.clusters[c];
    for (const SparseRank::NullGroup& group : cluster.elimination.left_null()) {
      std::vector<SparseRows> stresses;
      for (const SparseRank::SparseVector& vector : group.vectors) {
        stresses.push_back(extender.extend(closure_rows(cluster, scaling, vector)));
      }
      writer.write(static_cast<int>(c), stresses);
    }
  }
  return out;
}

SparseMatrixXd as_matrix(const AllRows& rows, const Collected& stresses) {
  SparseMatrixXd Z(rows.size(), static_cast<long>(stresses.places.size()));
  Z.setFromTriplets(stresses.entries.begin(), stresses.entries.end());
  return Z;
}

// How far the geometry contradicts itself: what the residual does on each self-stress of the closure rows.
double largest_contradiction(const Scaling& scaling, const ClusterDecision& decision, const VectorXd& phi) {
  double largest = 0;
  for (const ClusterRank& cluster : decision.clusters) {
    for (const SparseRank::NullGroup& group : cluster.elimination.left_null()) {
      for (const SparseRank::SparseVector& vector : group.vectors) {
        double work = 0;
        for (const auto& [local, value] : vector) {
          work += value * phi[cluster.rows[local]] * scaling.rows[cluster.rows[local]];
        }
        largest = std::max(largest, std::abs(work));
      }
    }
  }
  return largest;
}

// Z_joint in scaled units, on the self-stresses that load the joint.
MatrixXd joint_block(const Eigen::SparseMatrix<double, Eigen::RowMajor>& Z, const AllRows& rows, std::size_t joint) {
  std::vector<int> columns;
  using Iterator = Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator;
  const int first = rows.first[joint], count = rows.count[joint];
  for (int i = 0; i < count; ++i) {
    for (Iterator it(Z, first + i); it; ++it) columns.push_back(static_cast<int>(it.col()));
  }
  columns = sorted_unique(std::move(columns));
  MatrixXd block = MatrixXd::Zero(count, static_cast<long>(columns.size()));
  for (int i = 0; i < count; ++i) {
    for (Iterator it(Z, first + i); it; ++it) {
      const auto at = std::lower_bound(columns.begin(), columns.end(), static_cast<int>(it.col())) - columns.begin();
      block(i, at) = it.value() / rows.scale[first + i];
    }
  }
  return block;
}

std::vector<ReactionUniqueness> judge_reactions(const System& system, const AllRows& rows, const SparseMatrixXd& Z) {
  std::vector<ReactionUniqueness> out;
  const Model& model = *system.model;
  const Eigen::SparseMatrix<double, Eigen::RowMajor> by_row = Z;
  for (std::size_t j = 0; j < rows.first.size(); ++j) {
    ReactionUniqueness r;
    const bool joint = j < model.joints().size();
    r.joint = joint ? model.joints()[j].name : model.couplings()[j - model.joints().size()].name;
    r.rows = rows.count[j];
    r.is_constraint = !joint || !model.is_coordinate(j);
    const MatrixXd block = joint_block(by_row, rows, j);
    for (int i = 0; i < r.rows; ++i) {
      r.unique.push_back(is_negligible(block.row(i).norm(), 1.0));
      r.participates = r.participates || !r.unique.back();
    }
    r.unique_basis = block.cols() == 0 ? MatrixXd::Identity(r.rows, r.rows) : analyze_rank(block, 1.0).left_null;
    r.unique_dimension = static_cast<int>(r.unique_basis.cols());
    out.push_back(std::move(r));
  }
  return out;
}

void fill_counts(const System& system, RedundancyReport& report) {
  const Topology& t = *system.topology;
  int merged = 0;  // welds; as many parts are no bodies of the model any more
  for (const Body& body : system.model->bodies()) merged += static_cast<int>(body.merged_welds.size());
  report.bodies = t.moving_bodies + merged;
  report.joints = static_cast<int>(system.model->coordinates_begin()) + merged;
  report.coordinates = t.general_coordinates;
  report.constraint_rows = t.joint_rows + 6 * merged;
  report.grubler = t.grubler();
  report.closure_coordinates = system.nv;
  report.closure_rows = system.m;
  report.closure_rank = report.decision.rank;
  report.redundant = system.m - report.closure_rank;
  report.mobility = system.nv - report.closure_rank;
  report.rank = report.constraint_rows - report.redundant;
}

}  // namespace

MatrixXd complete_self_stresses(const System& system, const Scaling& scaling, const AllRows& rows,
                                const PositionKinematics& pos, const JointWrenches& joints,
                                const MatrixXd& closure_part) {
  const int count = static_cast<int>(closure_part.cols());
  if (count == 0) return MatrixXd::Zero(rows.size(), 0);
  Loads loads = make_loads(system, count);
  loads.lambda = closure_part;
  const MatrixXd all = distribute_to_joints(system, rows, scaling, pos, joints, std::move(loads));
  const Eigen::HouseholderQR<MatrixXd> qr(rows.scale.cwiseInverse().asDiagonal() * all);
  const MatrixXd basis = qr.householderQ() * MatrixXd::Identity(rows.size(), count);
  return rows.scale.asDiagonal() * basis;
}

std::optional<SparseMatrixXd> find_self_stresses(const System& system, const Scaling& scaling, const AllRows& rows,
                                                 const PositionKinematics& pos, const JointWrenches& joints,
                                                 const ConstraintKinematics& constraints, const Selection& selection) {
  const ConstraintBlocks blocks = cut_into_blocks(system, constraints);
  ClusterDecision decision = decide_clusters(system, scaling, blocks, 0, kLargestDenseInMotion);
  for (ClusterRank& cluster : decision.clusters) {
    const auto kept = static_cast<int>(std::count_if(cluster.rows.begin(), cluster.rows.end(), [&](int row) {
      return std::binary_search(selection.rows.begin(), selection.rows.end(), row);
    }));
    if (kept < cluster.elimination.smallest_rank()) return std::nullopt;
    cluster.elimination.set_rank(std::min(kept, cluster.elimination.largest_rank()));
  }
  return as_matrix(rows, collect_self_stresses(system, scaling, rows, pos, joints, decision));
}

RedundancyReport analyze_redundancy(const System& system, const State& state, const AnalysisOptions& options) {
  RedundancyReport report;
  const Scaling& scaling = system.scaling;
  const ConstraintBlocks blocks = compute_constraint_blocks(system, state);
  const ClusterDecision decision = decide_clusters(system, scaling, blocks, options.blur);
  report.decision = decision.decision;
  report.exact_values = decision.exact;
  report.characteristic_length_m = scaling.length_m;
  report.selection = select_rows_and_coordinates(system, decision);
  fill_counts(system, report);
  report.excluded_rows = report.selection.excluded_rows(system.m);
  for (const int row : report.excluded_rows) report.excluded_row_names.push_back(system.row_names[row]);
  for (const int v : report.selection.independent) {
    report.independent_coordinate_names.push_back(system.coordinate_names[v]);
  }
  report.rows = make_all_rows(system, scaling);
  PositionKinematics pos = make_position_kinematics(system);
  compute_positions(system, state.q, pos);
  Collected stresses = collect_self_stresses(system, scaling, report.rows, pos,
                                             compute_joint_frame_wrenches(system, state, pos), decision);
  report.self_stresses = as_matrix(report.rows, stresses);
  report.self_stress_places = std::move(stresses.places);
  report.reactions = judge_reactions(system, report.rows, report.self_stresses);
  report.inconsistency = largest_contradiction(scaling, decision, blocks.phi);
  return report;
}

}  // namespace ferrers
