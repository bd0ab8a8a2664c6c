// A system of one's own: only T, V and phi are written, as templates; hyper-dual numbers give their derivatives. Two
// masses on rods that a third rod connects, in the plane, with one constraint more than is needed.
#include <array>
#include <cstdio>

#include "ferrers/model/lagrangian_template.h"
#include "ferrers/redundancy/analysis.h"
#include "ferrers/simulate/simulation.h"

struct Swing {  // (x, y) of 1 kg and of 2 kg; pivots at (0, 0) and (2, 0), rods of length 1, 2 and 1
  static constexpr int kCoordinates = 4, kConstraints = 4;
  template <class S>
  S kinetic_energy(const std::array<S, 4>&, const std::array<S, 4>& v) const {
    return 0.5 * (v[0] * v[0] + v[1] * v[1]) + v[2] * v[2] + v[3] * v[3];
  }
  template <class S>
  S potential_energy(const std::array<S, 4>& q) const {
    return 9.81 * (q[1] + 2.0 * q[3]);
  }
  template <class S>
  std::array<S, 4> constraints(const std::array<S, 4>& q) const {
    const S dx = q[2] - q[0], dy = q[3] - q[1], rx = q[2] - 2.0;
    const S left = q[0] * q[0] + q[1] * q[1] - 1.0, right = rx * rx + q[3] * q[3] - 1.0;
    return {left, dx * dx + dy * dy - 4.0, right, left - right};  // the last one follows from two others
  }
};

int main() {
  ferrers::ModelSpec spec;
  spec.lagrangian.system = ferrers::make_lagrangian_system(Swing());
  spec.lagrangian.function_constraints = {{"left"}, {"across"}, {"right"}, {"again"}};
  spec.lagrangian.coordinates = {{"x1", ferrers::kLength, 0.6},
                                 {"y1", ferrers::kLength, -0.8},
                                 {"x2", ferrers::kLength, 2.6},
                                 {"y2", ferrers::kLength, -0.8}};
  const auto model = ferrers::make_dynamics_model(ferrers::make_system(*ferrers::build_model(spec).model));
  const auto report = ferrers::analyze_redundancy(*model->system, ferrers::assemble(*model->system).state);
  std::printf("mobility %d, rank %d of %d\n", report.mobility, report.rank, report.constraint_rows);
  const auto print = [](const ferrers::RunSample& row) {
    std::printf("t = %.1f s  x1 = %.9f m  energy %.9f J\n", row.t, row.values[1], row.energy);
  };
  const auto run = ferrers::simulate(model, {.grid = {1.0, 0.5}}, {.on_sample = print});
  return run.status == ferrers::RunStatus::kFinished ? 0 : 1;
}
