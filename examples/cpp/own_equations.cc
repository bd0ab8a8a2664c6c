// A system of one's own in C++: only T, V and phi are written, as templates; their derivatives come by hyper-dual
// numbers. Two masses on rods that a third rod connects, in the plane, with one constraint more than is needed.

#include <array>
#include <cstdio>

#include "ferrers/model/lagrangian_template.h"
#include "ferrers/redundancy/analysis.h"
#include "ferrers/simulate/simulation.h"

struct Swing {  // (x, y) of both masses; pivots at (0, 0) and (2, 0), rods of length 1, 2 and 1
  static constexpr int kCoordinates = 4, kConstraints = 4;

  template <class S>
  S kinetic_energy(const std::array<S, 4>&, const std::array<S, 4>& v) const {
    return 0.5 * (v[0] * v[0] + v[1] * v[1]) + 1.0 * (v[2] * v[2] + v[3] * v[3]);  // 1 kg and 2 kg
  }
  template <class S>
  S potential_energy(const std::array<S, 4>& q) const {
    return 9.81 * (q[1] + 2.0 * q[3]);
  }
  template <class S>
  std::array<S, 4> constraints(const std::array<S, 4>& q) const {
    const S dx = q[2] - q[0], dy = q[3] - q[1], rx = q[2] - 2.0;
    const S first = q[0] * q[0] + q[1] * q[1] - 1.0, third = rx * rx + q[3] * q[3] - 1.0;
    return {first, dx * dx + dy * dy - 4.0, third, first - third};  // the last one follows from two others
  }
};

int main() {
  ferrers::ModelSpec spec;
  spec.name = "swing";
  const std::array<double, 4> start = {0.6, -0.8, 2.6, -0.8};
  const std::array<const char*, 4> names = {"x1", "y1", "x2", "y2"}, rods = {"left", "across", "right", "again"};
  for (int i = 0; i < 4; ++i) spec.lagrangian.coordinates.push_back({names[i], ferrers::kLength, start[i], {}});
  for (const char* rod : rods) spec.lagrangian.function_constraints.push_back({rod});
  spec.lagrangian.system = ferrers::make_lagrangian_system(Swing());
  const auto model = ferrers::make_dynamics_model(ferrers::make_system(*ferrers::build_model(spec).model));

  const auto assembled = ferrers::assemble(*model->system);
  const auto report = ferrers::analyze_redundancy(*model->system, assembled.state);
  std::printf("mobility %d, rank %d of %d\n", report.mobility, report.rank, report.constraint_rows);
  ferrers::RunControl control;
  control.on_sample = [](const ferrers::RunSample& row) {
    std::printf("t = %.1f s  x1 = %.9f m  energy %.9f J\n", row.t, row.values[1], row.energy);
  };
  ferrers::SimulationOptions options;
  options.grid = {1.0, 0.5};
  return ferrers::simulate(model, options, control).status == ferrers::RunStatus::kFinished ? 0 : 1;
}
