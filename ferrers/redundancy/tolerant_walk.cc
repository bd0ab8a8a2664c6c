#include "ferrers/redundancy/tolerant_walk.h"

#include <algorithm>
#include <cmath>

namespace ferrers {
namespace {

constexpr int kMostIterations = 20;

}  // namespace

TolerantWalk::TolerantWalk(const System& system, double tolerance)
    : system_(system),
      tolerance_(tolerance),
      blocks_(make_constraint_blocks(system)),
      pos_(make_position_kinematics(system)),
      direction_(VectorXd::Zero(system.nv)),
      random_(1) {}

void TolerantWalk::evaluate(const State& state) {
  compute_positions(system_, state.q, pos_);
  compute_constraint_blocks(system_, state, pos_, blocks_);
  G_ = MatrixXd::Zero(system_.m, system_.nv);
  for (const ConstraintBlock& block : blocks_.blocks) {
    for (long i = 0; i < block.G.rows(); ++i) {
      const long row = block.row + i;
      for (std::size_t k = 0; k < block.columns.size(); ++k) {
        const int column = block.columns[k];
        G_(row, column) =
            block.G(i, static_cast<long>(k)) * system_.scaling.rows[row] * system_.scaling.columns[column];
      }
    }
  }
}

/// With a rank that is known already, the null spaces belong to it.
void TolerantWalk::decide(std::optional<int> rank) {
  svd_.compute(G_, Eigen::ComputeFullU | Eigen::ComputeFullV);
  decision_ = decide_rank(svd_.singularValues(), 0, tolerance_);
  if (rank) decision_.rank = *rank;
}

MatrixXd TolerantWalk::left_null() const { return svd_.matrixU().rightCols(G_.rows() - decision_.rank); }

double TolerantWalk::residual() const {
  return system_.m == 0 ? 0 : blocks_.phi.cwiseProduct(system_.scaling.rows).cwiseAbs().maxCoeff();
}

void TolerantWalk::settle(State& state, std::optional<int> rank) {
  double last = 0;
  for (int i = 0; i < kMostIterations; ++i) {
    evaluate(state);
    decide(rank);
    const int r = decision_.rank;
    const VectorXd along = svd_.matrixU().leftCols(r).transpose() * blocks_.phi.cwiseProduct(system_.scaling.rows);
    const VectorXd move = -(svd_.matrixV().leftCols(r) * along.cwiseQuotient(svd_.singularValues().head(r)));
    const double size = r == 0 ? 0 : move.norm();
    const bool stalled = i > 2 && size > 0.5 * last;
    if (size < 1e-15 * system_.scaling.length_m || (stalled && size < 1e-9 * system_.scaling.length_m)) break;
    last = size;
    displace(system_, move.cwiseProduct(system_.scaling.columns), state.q);
    compute_positions(system_, state.q, pos_);
    accept_winding(system_, pos_, state);
  }
}

bool TolerantWalk::step(double size, State& state, std::optional<int> rank) {
  if (free_directions() == 0) return false;
  const auto free = svd_.matrixV().rightCols(free_directions());
  VectorXd along = free.transpose() * direction_;
  if (along.norm() < 0.1) {
    std::normal_distribution<double> normal;
    for (long i = 0; i < along.size(); ++i) along[i] = normal(random_);
  }
  direction_ = (free * along).normalized();
  displace(system_, (size * system_.scaling.length_m) * direction_.cwiseProduct(system_.scaling.columns), state.q);
  compute_positions(system_, state.q, pos_);
  accept_winding(system_, pos_, state);
  settle(state, rank);
  return true;
}

}  // namespace ferrers
