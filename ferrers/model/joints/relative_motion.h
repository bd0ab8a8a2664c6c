#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <type_traits>

#include "ferrers/math/rotation.h"

namespace ferrers {

using Wrench = Eigen::Matrix<double, 6, 1>;  ///< Moment first, then force.
using Twist = Eigen::Matrix<double, 6, 1>;   ///< Angular first, then linear.

/// Motion of a frame M (on the second body) against a frame F (on the first), in world axes.
///
/// V_rel = V_2 − V_1, both taken at the point p_M, so (w, v) is the relative twist at p_M. The bias fields are the
/// relative accelerations that remain when every vdot is zero: `alpha` = α_2 − α_1, `a` = a_2 − a_1 of the two bodies'
/// material points at p_M. Producer: `compute_relative_motion` (kinematics/constraints.cc).
template <class T>
struct BasicRelativeMotion {
  using Vector = Eigen::Matrix<T, 3, 1>;
  using Matrix = Eigen::Matrix<T, 3, 3>;
  Matrix R_F = Matrix::Identity(), R_M = Matrix::Identity();
  Vector d = Vector::Zero();      ///< p_M − p_F, m.
  Vector w1 = Vector::Zero();     ///< ω of the first body, rad/s.
  Vector w2 = Vector::Zero();     ///< ω of the second body, rad/s.
  Vector w = Vector::Zero();      ///< ω_2 − ω_1.
  Vector v = Vector::Zero();      ///< v_2(p_M) − v_1(p_M), m/s.
  Vector alpha = Vector::Zero();  ///< Bias of ω̇_2 − ω̇_1, rad/s².
  Vector a = Vector::Zero();      ///< Bias of a_2(p_M) − a_1(p_M), m/s².
};
using RelativeMotion = BasicRelativeMotion<double>;

/// A scalar function f of the relative pose with its first derivative and the bias of its second:
///   f' = W · V_rel,   f'' = W · A_rel + bias,
/// where W is a wrench at p_M (moment, force) in world axes. The force of a multiplier λ on f is W λ on the second
/// body and −W λ on the first. Jets are combined by the chain rule, so each joint type writes its geometry once.
template <class T>
struct BasicJet {
  using Number = T;
  T value = 0;
  T rate = 0;
  T bias = 0;
  Eigen::Matrix<T, 6, 1> W = Eigen::Matrix<T, 6, 1>::Zero();
};
using Jet = BasicJet<double>;

/// a·d for a direction `a` fixed in the first body: how far M has moved along `a`.
template <class T>
BasicJet<T> along_first(const BasicRelativeMotion<T>& m, const typename BasicRelativeMotion<T>::Vector& a) {
  BasicJet<T> f;
  f.value = a.dot(m.d);
  f.rate = a.dot(m.v);
  f.bias = a.dot(m.a) - T(2) * a.dot(m.w1.cross(m.v));
  f.W.template tail<3>() = a;
  return f;
}

/// b·d for a direction `b` fixed in the second body.
template <class T>
BasicJet<T> along_second(const BasicRelativeMotion<T>& m, const typename BasicRelativeMotion<T>::Vector& b) {
  using Vector = typename BasicRelativeMotion<T>::Vector;
  BasicJet<T> f;
  const Vector d_rate = m.v + m.w1.cross(m.d);
  const Vector u = m.v - m.w.cross(m.d);  // velocity of p_F seen from the second body, reversed
  f.value = b.dot(m.d);
  f.rate = b.dot(u);
  f.bias = m.w2.cross(b).dot(u) + b.dot(m.a - m.w1.cross(m.v) - m.alpha.cross(m.d) - m.w.cross(d_rate));
  f.W.template head<3>() = b.cross(m.d);
  f.W.template tail<3>() = b;
  return f;
}

/// a·b for directions `a` fixed in the first body and `b` fixed in the second: an angle between axes.
template <class T>
BasicJet<T> dot(const BasicRelativeMotion<T>& m, const typename BasicRelativeMotion<T>::Vector& a,
                const typename BasicRelativeMotion<T>::Vector& b) {
  BasicJet<T> f;
  const typename BasicRelativeMotion<T>::Vector b_cross_a = b.cross(a);
  f.value = a.dot(b);
  f.rate = m.w.dot(b_cross_a);
  f.bias = m.alpha.dot(b_cross_a) + m.w.dot(m.w2.cross(b).cross(a) + b.cross(m.w1.cross(a)));
  f.W.template head<3>() = b_cross_a;
  return f;
}

template <class T>
BasicJet<T> operator-(const BasicJet<T>& f) {
  return {-f.value, -f.rate, -f.bias, -f.W};
}
template <class T>
BasicJet<T> operator+(const BasicJet<T>& f, const BasicJet<T>& g) {
  return {f.value + g.value, f.rate + g.rate, f.bias + g.bias, f.W + g.W};
}
template <class T>
BasicJet<T> operator-(const BasicJet<T>& f, const BasicJet<T>& g) {
  return f + (-g);
}
template <class T>
BasicJet<T> operator*(std::type_identity_t<T> s, const BasicJet<T>& f) {
  return {s * f.value, s * f.rate, s * f.bias, s * f.W};
}
template <class T>
BasicJet<T> operator+(const BasicJet<T>& f, std::type_identity_t<T> s) {
  return {f.value + s, f.rate, f.bias, f.W};
}

/// Chain rule for one argument: g(f), given g, g', g'' at f.
template <class T>
BasicJet<T> chain(const BasicJet<T>& f, std::type_identity_t<T> g, std::type_identity_t<T> g1,
                  std::type_identity_t<T> g2) {
  return {g, g1 * f.rate, g1 * f.bias + g2 * f.rate * f.rate, g1 * f.W};
}

template <class T>
BasicJet<T> square(const BasicJet<T>& f) {
  return chain(f, f.value * f.value, T(2) * f.value, T(2));
}

template <class T>
BasicJet<T> sqrt(const BasicJet<T>& f) {
  using std::sqrt;
  const T root = sqrt(f.value);
  return chain(f, root, T(0.5) / root, T(-0.25) / (root * f.value));
}

/// atan2(s, c), as its principal value.
template <class T>
BasicJet<T> atan2(const BasicJet<T>& s, const BasicJet<T>& c) {
  using std::atan2;
  const T n = s.value * s.value + c.value * c.value;
  const T gs = c.value / n, gc = -s.value / n;
  const T n2 = n * n;
  const T gss = T(-2) * s.value * c.value / n2;
  const T gsc = (s.value * s.value - c.value * c.value) / n2;
  BasicJet<T> f;
  f.value = atan2(s.value, c.value);
  f.rate = gs * s.rate + gc * c.rate;
  f.bias = gs * s.bias + gc * c.bias + gss * s.rate * s.rate + T(2) * gsc * s.rate * c.rate - gss * c.rate * c.rate;
  f.W = gs * s.W + gc * c.W;
  return f;
}

/// The same angle on the turn nearest to `reference`.
template <class T>
BasicJet<T> continued(BasicJet<T> angle, std::type_identity_t<T> reference) {
  using std::round;
  constexpr double kTurn = 6.283185307179586476925286766559;
  angle.value += T(kTurn) * round((reference - angle.value) / T(kTurn));
  return angle;
}

}  // namespace ferrers
