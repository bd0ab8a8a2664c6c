#pragma once

#include <Eigen/LU>

#include "ferrers/redundancy/cluster_system.h"

/// Problem: close the loops near a pose where rows are redundant or singular, without leaving the branch that a start
/// lies on, and fast although most of the equations are well conditioned and a few hardly exist.
///
/// Given: a pose with its null spaces N and Z, and a start near it. Wanted: a state with phi = 0 near the start.
/// Method: Lyapunov-Schmidt reduction. With orthonormal complements Y of N and U of Z, Uᵀ phi = 0 is solved for the
/// part along Y by Newton's method with a regular matrix, whatever the part along N is; what remains, Zᵀ phi = 0, is a
/// system in w unknowns only, on which Gauss-Newton steps are judged by what remains alone. At a regular pose nothing
/// remains, and the start's part along N is kept. No rank is decided. Cost: one factorization of rank² per iteration.
namespace ferrers {

class ReducedClosure {
 public:
  /// `local` must be the null spaces at the pose.
  ReducedClosure(const ClusterSystem& cluster, const LocalMotion& local);

  /// Closes from `state.q`. False where it does not close, or only with a joint turned over.
  bool close(State& state);

 private:
  void evaluate(const State& state);
  void factorize();
  bool restore(State& state);
  void linearize();
  VectorXd correction(double damping) const;
  bool improve(const VectorXd& step, double wanted, State& state);
  double remainder() const;
  void move(const VectorXd& x, State& state) const;
  bool is_any_flipped() const;

  const ClusterSystem& cluster_;
  MatrixXd N_, Z_, Y_, U_;
  PositionKinematics pos_;
  VelocityKinematics rest_;
  ConstraintKinematics constraints_;
  VectorXd phi_;  ///< Scaled.
  MatrixXd UG_, along_, J_;
  VectorXd g_;
  Eigen::PartialPivLU<MatrixXd> lu_;
};

}  // namespace ferrers
