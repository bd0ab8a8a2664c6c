#pragma once

#include <array>
#include <memory>
#include <utility>

#include "ferrers/math/hyper_dual.h"
#include "ferrers/model/lagrangian_system.h"

/// Problem: only T, V and phi are at hand, as templates on their scalar; the equations want their derivatives.
///
/// Given: a class
///
///     struct Pendulum {
///       static constexpr int kCoordinates = 2, kConstraints = 1;
///       template <class S> S kinetic_energy(const std::array<S, 2>& q, const std::array<S, 2>& v) const;
///       template <class S> S potential_energy(const std::array<S, 2>& q) const;
///       template <class S> std::array<S, 1> constraints(const std::array<S, 2>& q) const;
///     };
///
/// that calls functions without `std::` (they are found for hyper-dual numbers too). Wanted: its `LagrangianSystem`.
/// Derivatives are exact, by hyper-dual numbers [fike2011]. Allocates nothing. Cost: n (n + 1)/2 + 2 n evaluations of
/// T, n of V, n + 1 of phi. This is the one public header that is a template.
namespace ferrers {

template <class System>
class LagrangianByDuals final : public LagrangianSystem {
 public:
  explicit LagrangianByDuals(System system) : system_(std::move(system)) {}

  int coordinates() const override { return kN; }
  int constraints() const override { return kM; }

  void compute_constraints(EquationsOfMotion& eq) const override {
    if constexpr (kM > 0) {
      Point x = point(eq);
      for (int j = 0; j < kN; ++j) {  // ∂phi/∂q_j
        x.q[j].b = 1;
        const auto phi = system_.template constraints<HyperDual>(x.q);
        for (int i = 0; i < kM; ++i) eq.G(i, j) = phi[i].b;
        x.q[j].b = 0;
      }
      for (int j = 0; j < kN; ++j) x.q[j].b = x.q[j].c = eq.v[j];  // twice along v
      const auto phi = system_.template constraints<HyperDual>(x.q);
      for (int i = 0; i < kM; ++i) {
        eq.phi[i] = phi[i].a;
        eq.gamma[i] = -phi[i].d;
      }
    }
  }

  void compute_inertia(EquationsOfMotion& eq) const override {
    Point x = point(eq);
    for (int i = 0; i < kN; ++i) {
      x.v[i].b = 1;
      for (int j = i; j < kN; ++j) {  // ∂²T/∂v_i∂v_j
        x.v[j].c = 1;
        eq.M(i, j) = eq.M(j, i) = system_.template kinetic_energy<HyperDual>(x.q, x.v).d;
        x.v[j].c = 0;
      }
      for (int j = 0; j < kN; ++j) x.q[j].c = eq.v[j];  // ∂²T/∂v_i∂q_j v_j
      eq.h[i] = system_.template kinetic_energy<HyperDual>(x.q, x.v).d;
      for (int j = 0; j < kN; ++j) x.q[j].c = 0;
      x.v[i].b = 0;
      x.q[i].b = 1;
      eq.h[i] +=
          system_.template potential_energy<HyperDual>(x.q).b - system_.template kinetic_energy<HyperDual>(x.q, x.v).b;
      x.q[i].b = 0;
    }
  }

  Eigen::Vector2d compute_energy(const EquationsOfMotion& eq) const override {
    std::array<double, kN> q, v;
    for (int i = 0; i < kN; ++i) {
      q[i] = eq.q[i];
      v[i] = eq.v[i];
    }
    return {system_.template kinetic_energy<double>(q, v), system_.template potential_energy<double>(q)};
  }

 private:
  static constexpr int kN = System::kCoordinates, kM = System::kConstraints;
  struct Point {
    std::array<HyperDual, kN> q, v;
  };
  static Point point(const EquationsOfMotion& eq) {
    Point x;
    for (int i = 0; i < kN; ++i) {
      x.q[i] = HyperDual(eq.q[i]);
      x.v[i] = HyperDual(eq.v[i]);
    }
    return x;
  }

  System system_;
};

template <class System>
std::shared_ptr<const LagrangianSystem> make_lagrangian_system(System system) {
  return std::make_shared<const LagrangianByDuals<System>>(std::move(system));
}

}  // namespace ferrers
