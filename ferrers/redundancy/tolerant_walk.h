#pragma once

#include <Eigen/SVD>
#include <optional>
#include <random>

#include "ferrers/kinematics/constraint_blocks.h"
#include "ferrers/math/rank.h"

/// Problem: to move a mechanism whose loops close within a tolerance only.
///
/// Given: a system, and by how much it may miss closing. Wanted: poses nearest to closing, along its motion.
/// Method: singular values below the tolerance count as zero, so the poses move along what is free then; they are
/// brought nearest to closing by Gauss-Newton in the other directions. Cost: a dense decomposition of G per step.
namespace ferrers {

class TolerantWalk {
 public:
  /// `tolerance`: relative to the characteristic length; 0 takes the numbers at their word.
  TolerantWalk(const System& system, double tolerance);

  /// Brings `state` nearest to closing, with the rank that it has there or the one that is given. Keeps the decision.
  void settle(State& state, std::optional<int> rank = std::nullopt);
  /// A step along what is free at a pose that was settled, going on in the direction of the step before; then settles.
  /// `size`: in characteristic lengths, and rad. False where nothing is free.
  bool step(double size, State& state, std::optional<int> rank = std::nullopt);
  /// Starts in another direction.
  void turn_back() { direction_ = -direction_; }

  const RankDecision& decision() const { return decision_; }
  int free_directions() const { return static_cast<int>(G_.cols()) - decision_.rank; }
  MatrixXd left_null() const;                          ///< m × (m − r), of the scaled G.
  const VectorXd& phi() const { return blocks_.phi; }  ///< m, SI.
  double residual() const;                             ///< Largest scaled entry of phi, m.

 private:
  void evaluate(const State& state);
  void decide(std::optional<int> rank);

  const System& system_;
  double tolerance_;
  ConstraintBlocks blocks_;
  PositionKinematics pos_;
  MatrixXd G_;  ///< Scaled.
  Eigen::BDCSVD<MatrixXd> svd_;
  RankDecision decision_;
  VectorXd direction_;  ///< Of the last step, scaled.
  std::mt19937 random_;
};

}  // namespace ferrers
