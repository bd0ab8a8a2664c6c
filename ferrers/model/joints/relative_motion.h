#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "ferrers/math/rotation.h"

namespace ferrers {

using Wrench = Eigen::Matrix<double, 6, 1>;  ///< Moment first, then force.
using Twist = Eigen::Matrix<double, 6, 1>;   ///< Angular first, then linear.

/// Motion of a frame M (on the second body) against a frame F (on the first), in world axes.
///
/// V_rel = V_2 − V_1, both taken at the point p_M, so (w, v) is the relative twist at p_M. The bias fields are the
/// relative accelerations that remain when every vdot is zero: `alpha` = α_2 − α_1, `a` = a_2 − a_1 of the two bodies'
/// material points at p_M. Producer: `compute_relative_motion` (kinematics/constraints.cc).
struct RelativeMotion {
  Eigen::Matrix3d R_F = Eigen::Matrix3d::Identity(), R_M = Eigen::Matrix3d::Identity();
  Eigen::Vector3d d = Eigen::Vector3d::Zero();      ///< p_M − p_F, m.
  Eigen::Vector3d w1 = Eigen::Vector3d::Zero();     ///< ω of the first body, rad/s.
  Eigen::Vector3d w2 = Eigen::Vector3d::Zero();     ///< ω of the second body, rad/s.
  Eigen::Vector3d w = Eigen::Vector3d::Zero();      ///< ω_2 − ω_1.
  Eigen::Vector3d v = Eigen::Vector3d::Zero();      ///< v_2(p_M) − v_1(p_M), m/s.
  Eigen::Vector3d alpha = Eigen::Vector3d::Zero();  ///< Bias of ω̇_2 − ω̇_1, rad/s².
  Eigen::Vector3d a = Eigen::Vector3d::Zero();      ///< Bias of a_2(p_M) − a_1(p_M), m/s².
};

/// A scalar function f of the relative pose with its first derivative and the bias of its second:
///   f' = W · V_rel,   f'' = W · A_rel + bias,
/// where W is a wrench at p_M (moment, force) in world axes. The force of a multiplier λ on f is W λ on the second
/// body and −W λ on the first. Jets are combined by the chain rule, so each joint type writes its geometry once.
struct Jet {
  double value = 0;
  double rate = 0;
  double bias = 0;
  Wrench W = Wrench::Zero();
};

/// a·d for a direction `a` fixed in the first body: how far M has moved along `a`.
inline Jet along_first(const RelativeMotion& m, const Eigen::Vector3d& a) {
  Jet f;
  f.value = a.dot(m.d);
  f.rate = a.dot(m.v);
  f.bias = a.dot(m.a) - 2 * a.dot(m.w1.cross(m.v));
  f.W.tail<3>() = a;
  return f;
}

/// b·d for a direction `b` fixed in the second body.
inline Jet along_second(const RelativeMotion& m, const Eigen::Vector3d& b) {
  Jet f;
  const Eigen::Vector3d d_rate = m.v + m.w1.cross(m.d);
  const Eigen::Vector3d u = m.v - m.w.cross(m.d);  // velocity of p_F seen from the second body, reversed
  f.value = b.dot(m.d);
  f.rate = b.dot(u);
  f.bias = m.w2.cross(b).dot(u) + b.dot(m.a - m.w1.cross(m.v) - m.alpha.cross(m.d) - m.w.cross(d_rate));
  f.W.head<3>() = b.cross(m.d);
  f.W.tail<3>() = b;
  return f;
}

/// a·b for directions `a` fixed in the first body and `b` fixed in the second: an angle between axes.
inline Jet dot(const RelativeMotion& m, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  Jet f;
  const Eigen::Vector3d b_cross_a = b.cross(a);
  f.value = a.dot(b);
  f.rate = m.w.dot(b_cross_a);
  f.bias = m.alpha.dot(b_cross_a) + m.w.dot(m.w2.cross(b).cross(a) + b.cross(m.w1.cross(a)));
  f.W.head<3>() = b_cross_a;
  return f;
}

inline Jet operator-(const Jet& f) { return {-f.value, -f.rate, -f.bias, -f.W}; }
inline Jet operator+(const Jet& f, const Jet& g) {
  return {f.value + g.value, f.rate + g.rate, f.bias + g.bias, f.W + g.W};
}
inline Jet operator-(const Jet& f, const Jet& g) { return f + (-g); }
inline Jet operator*(double s, const Jet& f) { return {s * f.value, s * f.rate, s * f.bias, s * f.W}; }
inline Jet operator+(const Jet& f, double s) { return {f.value + s, f.rate, f.bias, f.W}; }

/// Chain rule for one argument: g(f), given g, g', g'' at f.
inline Jet chain(const Jet& f, double g, double g1, double g2) {
  return {g, g1 * f.rate, g1 * f.bias + g2 * f.rate * f.rate, g1 * f.W};
}

inline Jet square(const Jet& f) { return chain(f, f.value * f.value, 2 * f.value, 2); }

inline Jet sqrt(const Jet& f) {
  const double root = std::sqrt(f.value);
  return chain(f, root, 0.5 / root, -0.25 / (root * f.value));
}

/// atan2(s, c), as its principal value.
inline Jet atan2(const Jet& s, const Jet& c) {
  const double n = s.value * s.value + c.value * c.value;
  const double gs = c.value / n, gc = -s.value / n;
  const double n2 = n * n;
  const double gss = -2 * s.value * c.value / n2;
  const double gsc = (s.value * s.value - c.value * c.value) / n2;
  Jet f;
  f.value = std::atan2(s.value, c.value);
  f.rate = gs * s.rate + gc * c.rate;
  f.bias = gs * s.bias + gc * c.bias + gss * s.rate * s.rate + 2 * gsc * s.rate * c.rate - gss * c.rate * c.rate;
  f.W = gs * s.W + gc * c.W;
  return f;
}

/// The same angle on the turn nearest to `reference`.
inline Jet continued(Jet angle, double reference) {
  constexpr double kTurn = 6.283185307179586476925286766559;
  angle.value += kTurn * std::round((reference - angle.value) / kTurn);
  return angle;
}

}  // namespace ferrers
