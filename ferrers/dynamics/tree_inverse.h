#pragma once

#include <memory>

#include "ferrers/dynamics/composites.h"
#include "ferrers/math/kernel.h"

/// Problem: the forces that a motion of the bodies takes, again and again.
///
///   M vdot + h
///
/// Given: a model and any state of it with accelerations. Wanted: the generalized forces of inertia and gravity along
/// the coordinates of the tree, without M. Method: accelerations outwards, wrenches inwards (recursive Newton-Euler)
/// [featherstone2008, ch. 5], in world axes; as native code where the processor runs it.
namespace ferrers {

class TreeInverse {
 public:
  /// Throws std::invalid_argument for a model with energies by formulas: those are not the bodies'.
  explicit TreeInverse(std::shared_ptr<const DynamicsModel> model);

  /// `vdot`: nv, 1/s² or m/s². Returns nv, N and N·m: what drives, springs and the closures' multipliers together must
  /// give; that of an open tree without forces is what its drives need. Allocates nothing. Cost: O(bodies).
  const VectorXd& evaluate(const State& state, const VectorXd& vdot);
  bool is_native() const { return kernel_.is_native(); }

 private:
  void make_kernel();
  void evaluate_parts(const State& state, const VectorXd& vdot);

  std::shared_ptr<const DynamicsModel> model_;
  std::vector<Matrix3d> inertias_N_;
  PositionKinematics pos_;
  VelocityKinematics vel_;
  std::vector<BasicComposite<double>> bodies_;
  VectorXd efforts_;
  Kernel kernel_;
  Kernel::Board board_;
};

}  // namespace ferrers
