#pragma once

#include <Eigen/Core>

/// Problem: a system of any structure is given by C++ functions of its own generalized coordinates, and every verb of
/// the library is wanted for it: rank, both problems of dynamics, simulation, equilibrium, linearization.
///
/// Given: n coordinates, m constraints (m may exceed n, and they may be dependent), and functions that fill the parts
/// of the equations at a state. They go into a specification as `ModelSpec::lagrangian.system` beside the names of
/// coordinates and constraints; from there on the system is a `Model` like any other. `lagrangian_template.h` writes
/// these functions for whoever has T, V and phi only. Example: examples/cpp/own_equations.cc.
namespace ferrers {

/// The equations at one state [stepanyan, eq. (6)-(9)], to be filled in place:
///
///   phi = 0,   G v = nu,   G vdot = gamma,   M vdot + h = tau + B u + Gᵀ lambda
///
/// Everything is zero before a function is called. SI units.
struct EquationsOfMotion {
  using Vector = Eigen::Ref<Eigen::VectorXd, 0, Eigen::InnerStride<>>;
  using Rows =
      Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>, 0, Eigen::OuterStride<>>;
  using Given = Eigen::Ref<const Eigen::VectorXd>;
  double t = 0;
  Given q, v;        ///< n each.
  Given parameters;  ///< Values of the model's parameters, in their order.
  Vector phi;        ///< m: residual.
  Rows G;            ///< m × n: ∂phi/∂q.
  Vector nu;         ///< m: −∂phi/∂t; stays 0 where phi does not know the time.
  Vector gamma;      ///< m: −(∂G/∂q v) v and what time adds.
  Rows M;            ///< n × n, symmetric; both halves.
  Vector h;          ///< n: Coriolis terms and ∂V/∂q.
  Vector tau;        ///< n: applied generalized forces but for drives.
};

/// Functions are const and called from several threads at once; none may allocate if evaluations are to be fast.
class LagrangianSystem {
 public:
  virtual ~LagrangianSystem() = default;
  virtual int coordinates() const = 0;  ///< n
  virtual int constraints() const = 0;  ///< m
  /// phi, G, nu, gamma. Rows of constraints that hold for velocities only have phi = 0.
  virtual void compute_constraints(EquationsOfMotion& eq) const = 0;
  virtual void compute_inertia(EquationsOfMotion& eq) const = 0;  ///< M and h.
  virtual void compute_forces(EquationsOfMotion&) const {}        ///< tau.
  /// Kinetic and potential energy, J, for the energy column and its balance.
  virtual Eigen::Vector2d compute_energy(const EquationsOfMotion& eq) const = 0;
  virtual bool knows_time() const { return false; }  ///< Some nu is not 0.
};

}  // namespace ferrers
