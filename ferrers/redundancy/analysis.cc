#include "ferrers/redundancy/analysis.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace ferrers {
namespace {

// The scaled Jacobian of one cluster, and where its rows and columns stand in the whole.
struct Block {
  std::vector<int> rows, columns;
  MatrixXd G;
  RankAnalysis analysis;
  int rank = 0;
};

std::vector<Block> cut_into_blocks(const System& system, const Scaling& scaling, const RowMatrixXd& G) {
  std::vector<Block> blocks;
  for (const Cluster& cluster : system.topology->clusters) {
    Block block;
    for (const int c : cluster.closures) {
      const Closure& closure = system.topology->closures[c];
      for (int i = 0; i < closure.row_count; ++i) block.rows.push_back(closure.row + i);
    }
    for (const int n : cluster.nodes) {
      for (int k = 0; k < system.nodes[n].nv; ++k) block.columns.push_back(system.nodes[n].v + k);
    }
    std::sort(block.columns.begin(), block.columns.end());
    block.G.resize(static_cast<int>(block.rows.size()), static_cast<int>(block.columns.size()));
    for (int i = 0; i < block.G.rows(); ++i) {
      for (int k = 0; k < block.G.cols(); ++k) {
        block.G(i, k) =
            G(block.rows[i], block.columns[k]) * scaling.rows[block.rows[i]] * scaling.columns[block.columns[k]];
      }
    }
    blocks.push_back(std::move(block));
  }
  return blocks;
}

// One decision over the singular values of all clusters; each block then keeps those above the common cut.
RankDecision decide_blocks(std::vector<Block>& blocks) {
  std::vector<double> all;
  for (Block& block : blocks) {
    block.analysis = analyze_rank(block.G, 1.0);
    const VectorXd& s = block.analysis.decision.singular_values;
    all.insert(all.end(), s.data(), s.data() + s.size());
  }
  std::sort(all.begin(), all.end(), std::greater<>());
  VectorXd values = Eigen::Map<const VectorXd>(all.data(), static_cast<long>(all.size()));
  const double scale = std::max(1.0, all.empty() ? 0.0 : all.front());
  RankDecision decision = decide_rank(values, scale);
  const double smallest_kept = decision.rank > 0 ? values[decision.rank - 1] : INFINITY;
  for (Block& block : blocks) {
    const VectorXd& s = block.analysis.decision.singular_values;
    block.rank = static_cast<int>(std::count_if(s.begin(), s.end(), [&](double v) { return v >= smallest_kept; }));
    if (block.rank != block.analysis.decision.rank) block.analysis = split_by_rank(block.G, block.rank);
  }
  return decision;
}

double smallest_pivot(const MatrixXd& block) {
  if (block.size() == 0) return 1;
  // not a rank decision: the size of the last pivot is wanted
  const Eigen::FullPivHouseholderQR<MatrixXd> qr(block);
  return std::abs(qr.matrixQR()(block.rows() - 1, block.cols() - 1));
}

// Rows first, then the coordinates that those rows determine best.
void choose_in_block(const Block& block, Selection& out, std::vector<bool>& is_dependent) {
  const std::vector<int> rows = choose_independent_rows(block.G, block.rank);
  MatrixXd kept(block.rank, block.G.cols());
  for (int i = 0; i < block.rank; ++i) kept.row(i) = block.G.row(rows[i]);
  const std::vector<int> columns = choose_independent_columns(kept, block.rank);
  MatrixXd pivot(block.rank, block.rank);
  for (int i = 0; i < block.rank; ++i) {
    pivot.col(i) = kept.col(columns[i]);
    out.rows.push_back(block.rows[rows[i]]);
    is_dependent[block.columns[columns[i]]] = true;
  }
  out.smallest_pivot = std::min(out.smallest_pivot, smallest_pivot(pivot));
}

Selection choose(const System& system, const std::vector<Block>& blocks) {
  Selection out;
  std::vector<bool> is_dependent(system.nv, false);
  for (const Block& block : blocks) choose_in_block(block, out, is_dependent);
  std::sort(out.rows.begin(), out.rows.end());
  for (int v = 0; v < system.nv; ++v) (is_dependent[v] ? out.dependent : out.independent).push_back(v);
  return out;
}

// Self-stresses over all joints' rows from those of the closure rows, orthonormal in scaled units.
MatrixXd extend_self_stresses(const System& system, const Scaling& scaling, const State& state, const AllRows& rows,
                              const std::vector<Block>& blocks) {
  int count = 0;
  for (const Block& block : blocks) count += static_cast<int>(block.analysis.left_null.cols());
  MatrixXd closure_part = MatrixXd::Zero(system.m, count);
  for (int column = 0; const Block& block : blocks) {
    const MatrixXd& null = block.analysis.left_null;
    for (std::size_t i = 0; i < block.rows.size(); ++i) {
      const int row = block.rows[i];
      closure_part.row(row).segment(column, null.cols()) = scaling.rows[row] * null.row(static_cast<int>(i));
    }
    column += static_cast<int>(null.cols());
  }
  PositionKinematics pos = make_position_kinematics(system);
  compute_positions(system, state.q, pos);
  return complete_self_stresses(system, scaling, rows, pos, compute_joint_frame_wrenches(system, state, pos),
                                closure_part);
}

std::vector<ReactionUniqueness> judge_reactions(const System& system, const AllRows& rows, const MatrixXd& Z) {
  std::vector<ReactionUniqueness> out;
  const Model& model = *system.model;
  const MatrixXd scaled = rows.scale.cwiseInverse().asDiagonal() * Z;
  for (std::size_t j = 0; j < rows.first.size(); ++j) {
    ReactionUniqueness r;
    const bool joint = j < model.joints().size();
    r.joint = joint ? model.joints()[j].name : model.couplings()[j - model.joints().size()].name;
    r.rows = rows.count[j];
    const MatrixXd block = scaled.middleRows(rows.first[j], rows.count[j]);
    for (int i = 0; i < r.rows; ++i) {
      r.unique.push_back(is_negligible(block.row(i).norm(), 1.0));
      r.participates = r.participates || !r.unique.back();
    }
    r.unique_dimension = r.rows - analyze_rank(block, 1.0).decision.rank;
    out.push_back(std::move(r));
  }
  return out;
}

ConstraintKinematics constraints_at_rest(const System& system, const State& state) {
  PositionKinematics pos = make_position_kinematics(system);
  compute_positions(system, state.q, pos);
  ConstraintKinematics constraints = make_constraint_kinematics(system);
  compute_constraints(system, state, pos, make_velocity_kinematics(system), constraints);
  return constraints;
}

double largest_contradiction(const Scaling& scaling, const std::vector<Block>& blocks, const VectorXd& phi) {
  double largest = 0;
  for (const Block& block : blocks) {
    VectorXd scaled(static_cast<long>(block.rows.size()));
    for (long i = 0; i < scaled.size(); ++i) scaled[i] = phi[block.rows[i]] * scaling.rows[block.rows[i]];
    if (block.analysis.left_null.cols() == 0) continue;
    largest = std::max(largest, (block.analysis.left_null.transpose() * scaled).cwiseAbs().maxCoeff());
  }
  return largest;
}

void fill_counts(const System& system, RedundancyReport& report) {
  const Topology& t = *system.topology;
  report.bodies = t.moving_bodies;
  report.joints = static_cast<int>(system.model->joints().size());
  report.constraint_rows = t.joint_rows;
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
                                const PositionKinematics& pos, const std::vector<JointFrameWrenches>& joints,
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

MatrixXd self_stresses_of_selection(const System& system, const Selection& selection, const RowMatrixXd& G) {
  const int r = static_cast<int>(selection.rows.size());
  const std::vector<int> excluded = selection.excluded_rows(system.m);
  MatrixXd Z = MatrixXd::Zero(system.m, static_cast<long>(excluded.size()));
  for (std::size_t e = 0; e < excluded.size(); ++e) Z(excluded[e], static_cast<long>(e)) = 1;
  if (r == 0 || excluded.empty()) return Z;
  const MatrixXd G_d = G(selection.rows, selection.dependent), G_e = G(excluded, selection.dependent);
  // G_e = C G_d, so that y_e = 1 is balanced by y_r = −Cᵀ.
  const MatrixXd C_transposed = G_d.transpose().partialPivLu().solve(G_e.transpose());
  for (int i = 0; i < r; ++i) Z.row(selection.rows[i]) = -C_transposed.row(i);
  return Z;
}

std::vector<int> Selection::excluded_rows(int m) const {
  std::vector<int> excluded;
  for (int row = 0; row < m; ++row) {
    if (!std::binary_search(rows.begin(), rows.end(), row)) excluded.push_back(row);
  }
  return excluded;
}

Selection select_independent(const System& system, const Scaling& scaling, const ConstraintKinematics& constraints,
                             RankDecision* decision) {
  std::vector<Block> blocks = cut_into_blocks(system, scaling, constraints.G);
  const RankDecision d = decide_blocks(blocks);
  if (decision) *decision = d;
  return choose(system, blocks);
}

Selection reselect(const System& system, const Scaling& scaling, const ConstraintKinematics& constraints,
                   const Selection& previous) {
  std::vector<Block> blocks = cut_into_blocks(system, scaling, constraints.G);
  for (Block& block : blocks) {
    block.rank = static_cast<int>(std::count_if(previous.rows.begin(), previous.rows.end(), [&](int row) {
      return std::find(block.rows.begin(), block.rows.end(), row) != block.rows.end();
    }));
  }
  return choose(system, blocks);
}

bool is_unique_component(const Eigen::Matrix<double, 6, 1>& direction, const JointFrameWrenches& joint,
                         const Eigen::Ref<const MatrixXd>& Z_joint, double length_m) {
  if (Z_joint.cols() == 0 || Z_joint.rows() == 0) return true;
  // Work of the direction (a twist's worth of axes) on what self-stresses put there, in scaled units.
  const Eigen::RowVectorXd work = direction.transpose() * joint.T * Z_joint;
  const double unit = direction.head<3>().norm() > direction.tail<3>().norm() ? length_m : 1.0;
  return is_negligible(work.norm() / unit, 1.0);
}

RedundancyReport analyze_redundancy(const System& system, const State& state) {
  RedundancyReport report;
  const Scaling scaling = make_scaling(system);
  const ConstraintKinematics constraints = constraints_at_rest(system, state);
  std::vector<Block> blocks = cut_into_blocks(system, scaling, constraints.G);
  report.decision = decide_blocks(blocks);
  report.characteristic_length_m = scaling.length_m;
  report.selection = choose(system, blocks);
  fill_counts(system, report);
  report.excluded_rows = report.selection.excluded_rows(system.m);
  for (const int row : report.excluded_rows) report.excluded_row_names.push_back(system.row_names[row]);
  for (const int v : report.selection.independent) {
    report.independent_coordinate_names.push_back(system.coordinate_names[v]);
  }
  report.rows = make_all_rows(system, scaling);
  const MatrixXd Z = extend_self_stresses(system, scaling, state, report.rows, blocks);
  report.self_stresses = Z.sparseView();
  report.reactions = judge_reactions(system, report.rows, Z);
  report.inconsistency = largest_contradiction(scaling, blocks, constraints.phi);
  return report;
}

}  // namespace ferrers
