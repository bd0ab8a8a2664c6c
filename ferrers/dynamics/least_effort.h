#pragma once

#include <Eigen/LU>
#include <Eigen/QR>
#include <vector>

#include "ferrers/kinematics/system.h"

/// Problem: multipliers and efforts that hold a motion, where more drives act than the motion needs.
///
///   Gᵀ lambda + Eᵀ u = b,   min Σ (weight_k u_k)²
///
/// G: r × n independent constraint rows, E: k × n rows of the drives that act, k ≥ n − r. With n − r of the drives
/// *chosen* so that A = [G; E_chosen] is regular, every other drive adds one combination of efforts that the
/// constraints balance: an *idle* effort. At a singular pose (none chosen) singular values decide what is idle.
/// Solutions are linear in b. Cost: O(n³) to set up, O(n²) per right side.
namespace ferrers {

class LeastEffort {
 public:
  struct Rows {
    MatrixXd G, E;
    VectorXd G_scale, E_scale, columns;  ///< Units: a scaled row is scale · row · columns (see kinematics/scaling.h).
    VectorXd weights;                    ///< k.
  };

  /// `chosen`: n − r indices of rows of E; or none, at a singular pose.
  LeastEffort(Rows rows, std::vector<int> chosen);

  /// Fills `lambda` (r) and `u` (k). False: nothing balances b (at a singular pose only).
  bool solve(const VectorXd& b, VectorXd& lambda, VectorXd& u) const;

  /// r × d and k × d; efforts orthonormal in scaled units (jointly with the multipliers at a singular pose).
  const MatrixXd& idle_lambda() const { return idle_lambda_; }
  const MatrixXd& idle_efforts() const { return idle_efforts_; }
  /// Per drive: some idle effort changes it.
  std::vector<bool> shared() const;

 private:
  void find_idle();
  void find_idle_at_singular_pose();

  Rows rows_;
  std::vector<int> chosen_, others_;
  Eigen::PartialPivLU<MatrixXd> lu_;  // of A
  MatrixXd scaled_transposed_;        // at a singular pose
  MatrixXd idle_lambda_, idle_efforts_;
  Eigen::HouseholderQR<MatrixXd> weighted_;  // of the weighted idle efforts
};

}  // namespace ferrers
