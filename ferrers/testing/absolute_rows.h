#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "ferrers/model/model.h"
#include "ferrers/testing/dual.h"

/// Constraint rows of every joint type in absolute coordinates, as wrenches.
///
/// Every ideal joint constrains the relative motion of two bodies, so each of its rows is one wrench that acts on the
/// second body and its opposite on the first: a force `f` at the world point `p` and a couple `m`. The row's velocity
/// is the power of that wrench, f·(v₂(p) − v₁(p)) + m·(ω₂ − ω₁), and its Jacobian entries are the wrench itself
/// referred to the mass centres. Nothing here knows a tree, a joint coordinate as a state, or the engine's joint table.
namespace ferrers::witness {

/// Position of one body: rotation, origin of its frame and mass centre, in the world.
template <class T>
struct Placement {
  Mat3<T> R;
  Vec3<T> p;  ///< Origin of the body frame, m.
  Vec3<T> c;  ///< Mass centre, m.
};

/// A wrench: force `f` at point `p`, plus couple `m`; world axes.
template <class T>
struct RowWrench {
  Vec3<T> f = Vec3<T>::Zero();
  Vec3<T> p = Vec3<T>::Zero();
  Vec3<T> m = Vec3<T>::Zero();
};

/// Names of the rows of a joint type, in the fixed order force_x … moment_z of the constrained components.
std::vector<const char*> row_components(JointType type);

/// The frames of a joint in the world.
template <class T>
struct JointFrames {
  Mat3<T> F, M;    ///< Columns are the axes.
  Vec3<T> pF, pM;  ///< Origins, m.
};

template <class T>
JointFrames<T> joint_frames(const Joint& joint, const Placement<T>& first, const Placement<T>& second);

/// Wrenches of all the joint's rows at a position on the constraint manifold.
template <class T>
std::vector<RowWrench<T>> joint_rows(const Joint& joint, const Placement<T>& first, const Placement<T>& second);

/// The wrench whose power is velocity coordinate `index` of the joint: angle or displacement rates, and for spherical
/// and free joints ω (0..2) and the velocity of the joint's point (3..5), relative, in F axes. Throws
/// `std::invalid_argument` for an index that the joint does not have.
template <class T>
RowWrench<T> coordinate_row(const Joint& joint, int index, const Placement<T>& first, const Placement<T>& second);

extern template JointFrames<double> joint_frames(const Joint&, const Placement<double>&, const Placement<double>&);
extern template JointFrames<Dual> joint_frames(const Joint&, const Placement<Dual>&, const Placement<Dual>&);
extern template std::vector<RowWrench<double>> joint_rows(const Joint&, const Placement<double>&,
                                                          const Placement<double>&);
extern template std::vector<RowWrench<Dual>> joint_rows(const Joint&, const Placement<Dual>&, const Placement<Dual>&);
extern template RowWrench<double> coordinate_row(const Joint&, int, const Placement<double>&, const Placement<double>&);
extern template RowWrench<Dual> coordinate_row(const Joint&, int, const Placement<Dual>&, const Placement<Dual>&);

}  // namespace ferrers::witness
