#include "ferrers/model/state_program.h"

#include <algorithm>
#include <utility>

#include "ferrers/model/lagrangian_system.h"

namespace ferrers {
namespace {

// One call of a system's function: the inputs of a program as a state, and a place for whatever is not filled.
class Call {
 public:
  Call(const double* inputs, int n, const std::vector<double>& parameters)
      : inputs_(inputs), n_(n), parameters_(parameters) {}

  // Views of `rows` entries each, `stride` apart.
  EquationsOfMotion constraints(double* out, int m) const {
    const long stride = n_ + 3;
    return make({out, m, stride}, {out + 3, m, n_, stride}, {out + 1, m, stride}, {out + 2, m, stride}, {}, {}, {});
  }
  EquationsOfMotion inertia(double* M, double* h) const {
    return make({}, {}, {}, {}, {M, n_, n_, n_}, {h, n_, 1}, {});
  }
  EquationsOfMotion forces(double* tau) const { return make({}, {}, {}, {}, {}, {}, {tau, n_, 1}); }
  EquationsOfMotion nothing() const { return make({}, {}, {}, {}, {}, {}, {}); }

 private:
  struct VectorPlace {
    double* data = nullptr;
    long size = 0, stride = 1;
  };
  struct RowsPlace {
    double* data = nullptr;
    long rows = 0, columns = 0, stride = 1;
  };
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  static Eigen::Map<Eigen::VectorXd, 0, Eigen::InnerStride<>> view(const VectorPlace& p) {
    return {p.data, p.size, Eigen::InnerStride<>(p.stride)};
  }
  static Eigen::Map<RowMajor, 0, Eigen::OuterStride<>> view(const RowsPlace& p) {
    return {p.data, p.rows, p.columns, Eigen::OuterStride<>(p.stride)};
  }

  EquationsOfMotion make(const VectorPlace& phi, const RowsPlace& G, const VectorPlace& nu, const VectorPlace& gamma,
                         const RowsPlace& M, const VectorPlace& h, const VectorPlace& tau) const {
    using Given = Eigen::Map<const Eigen::VectorXd>;
    return {.t = inputs_[2 * n_],
            .q = Given(inputs_, n_),
            .v = Given(inputs_ + n_, n_),
            .parameters = Given(parameters_.data(), static_cast<long>(parameters_.size())),
            .phi = view(phi),
            .G = view(G),
            .nu = view(nu),
            .gamma = view(gamma),
            .M = view(M),
            .h = view(h),
            .tau = view(tau)};
  }

  const double* inputs_;
  int n_;
  const std::vector<double>& parameters_;
};

}  // namespace

StateProgram make_constraint_program(std::shared_ptr<const LagrangianSystem> system, int coordinates, int constraints,
                                     std::vector<double> parameters) {
  const int outputs = constraints * (coordinates + 3);
  return {[=, system = std::move(system), parameters = std::move(parameters)](const double* inputs, double* out) {
            std::fill(out, out + outputs, 0.0);
            EquationsOfMotion eq = Call(inputs, coordinates, parameters).constraints(out, constraints);
            system->compute_constraints(eq);
            eq.nu = -eq.nu;
            eq.gamma = -eq.gamma;
          },
          outputs};
}

StateProgram make_inertia_program(std::shared_ptr<const LagrangianSystem> system, int coordinates,
                                  std::vector<double> parameters) {
  const int entries = coordinates * (coordinates + 1) / 2, outputs = entries + coordinates + coordinates * coordinates;
  return {[=, system = std::move(system), parameters = std::move(parameters)](const double* inputs, double* out) {
            std::fill(out, out + outputs, 0.0);
            double* const M = out + entries + coordinates;
            EquationsOfMotion eq = Call(inputs, coordinates, parameters).inertia(M, out + entries);
            system->compute_inertia(eq);
            for (int k = 0; k < coordinates; ++k) {
              for (int l = k; l < coordinates; ++l) *out++ = M[k * coordinates + l];
            }
          },
          outputs};
}

StateProgram make_force_program(std::shared_ptr<const LagrangianSystem> system, int coordinates,
                                std::vector<double> parameters) {
  return {[=, system = std::move(system), parameters = std::move(parameters)](const double* inputs, double* out) {
            std::fill(out, out + coordinates, 0.0);
            EquationsOfMotion eq = Call(inputs, coordinates, parameters).forces(out);
            system->compute_forces(eq);
          },
          coordinates};
}

StateProgram make_energy_program(std::shared_ptr<const LagrangianSystem> system, int coordinates,
                                 std::vector<double> parameters) {
  return {[=, system = std::move(system), parameters = std::move(parameters)](const double* inputs, double* out) {
            const Eigen::Vector2d energy = system->compute_energy(Call(inputs, coordinates, parameters).nothing());
            out[0] = energy[0];
            out[1] = energy[1];
            out[2] = 0;
          },
          3};
}

}  // namespace ferrers
