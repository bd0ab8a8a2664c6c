#pragma once

#include <Eigen/Core>

namespace ferrers {

class Model;
struct System;

/// What makes rows and columns of mixed units comparable: a characteristic length L.
///
/// Forces and displacements keep their unit; moment rows and their residuals are multiplied by L, angle columns divided
/// by L, so that G's scaled entries are pure numbers of order one in any system of units.
struct Scaling {
  double length_m = 1;
  Eigen::VectorXd rows;     ///< m: multiplies rows of G and phi; a multiplier is `rows` times its scaled value.
  Eigen::VectorXd columns;  ///< nv: multiplies columns of G; a velocity is `columns` times its scaled value.
};

/// Mean over the moving bodies of the largest distance between two joint places on the body; mass-free. Falls back to
/// the largest distance between any two joint places, else 1 m. Independent of orientation, place and order of the
/// model.
double characteristic_length(const Model& model);

/// That of a system which is laid out otherwise: once, by `make_system`.
Scaling make_scaling(const System& system);

}  // namespace ferrers
