#pragma once

#include <Eigen/Core>
#include <vector>

#include "ferrers/core/checks.h"
#include "ferrers/testing/absolute_rows.h"
#include "ferrers/testing/absolute_solver.h"

/// Shared by the parts of the absolute solver; not for tests.
namespace ferrers::witness {

std::vector<Placement<double>> placements(const Model& model, const std::vector<Pose>& poses);

/// Placements with their time derivatives along the twists.
std::vector<Placement<Dual>> moving_placements(const Model& model, const AbsoluteState& state);

Eigen::VectorXd stacked(const std::vector<Vector6d>& twists);        ///< Without ground.
std::vector<Vector6d> unstacked(const Eigen::VectorXd& velocities);  ///< With ground, zero.

/// Singular values of S_row G S_col, where all entries are pure numbers, and solves with the rank they give.
struct ScaledSvd {
  Eigen::VectorXd row_scale, column_scale, values;
  Eigen::MatrixXd U, V;  ///< Full.
  int rank = 0;
  double length_m = 1;

  Eigen::VectorXd solve(const Eigen::VectorXd& rhs) const;             ///< Least-norm x with G x ≈ rhs.
  Eigen::VectorXd solve_transposed(const Eigen::VectorXd& rhs) const;  ///< Least-norm y with Gᵀ y ≈ rhs.
  Eigen::MatrixXd null_space() const;                                  ///< Columns with G x = 0.
};

ScaledSvd scaled_svd(const Model& model, const std::vector<Pose>& poses, const AbsoluteConstraints& constraints,
                     double tolerance);

}  // namespace ferrers::witness
