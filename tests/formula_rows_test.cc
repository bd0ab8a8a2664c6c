// Rows of constraints by formulas against differences: over tree joints, joints that close a loop, generalized
// coordinates, points and time.

#include "ferrers/kinematics/formula_rows.h"

#include <gtest/gtest.h>

#include "ferrers/io/model_reader.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/finite_difference.h"

namespace ferrers::witness {
namespace {

ModelSpec linkage(const std::string& constraint) {
  const std::string text = R"(ferrers: 1
bodies:
  a: {mass: 1, inertia: {shape: rod, from: [0, 0, 0], to: [0.3, 0.9, 0]}}
  b: {mass: 1, inertia: {shape: rod, from: [0.3, 0.9, 0], to: [2, 1.5, 0]}}
  c: {mass: 1, inertia: {shape: rod, from: [1.8, 0, 0], to: [2, 1.5, 0]}}
joints:
  A: {type: revolute, bodies: [ground, a], at: [0, 0, 0], axis: [0.1, 0.2, 1]}
  B: {type: spherical, bodies: [a, b], at: [0.3, 0.9, 0]}
  C: {type: cylindrical, bodies: [b, c], at: [2, 1.5, 0], axis: [0, 0.3, 1]}
  D: {type: revolute, bodies: [ground, c], at: [1.8, 0, 0], axis: z}
lagrangian: {coordinates: {s: m}, kinetic_energy: "= s.velocity^2"}
record: {P: {body: b, at: [1, 1.2, 0.1]}}
constraints:
  one: )" + constraint + "\n";
  const ModelReadResult read = read_model_text(text, "linkage.yaml");
  if (!read.model) throw std::runtime_error(read.diagnostics.items().front().message);
  return read.spec;
}

State moved(const System& system, const State& from, double time) {
  State to = from;
  displace(system, time * from.v, to.q);
  to.t = from.t + time;
  return to;
}

class FormulaRowsTest : public ::testing::TestWithParam<const char*> {};

// phi of the row, its rate and the rate of its rate along q' = v with v held.
TEST_P(FormulaRowsTest, GradientAndBiasAreThoseOfDifferencesAlongTheMotion) {
  EngineProbe engine(linkage(GetParam()));
  const System& system = *engine.system;
  const int row = system.couplings.front().row;
  for (std::uint64_t seed = 1; seed < 12; ++seed) {
    State state = engine.wandered(seed, 0.4);
    state.t = 0.3;
    engine.evaluate(state);
    const ConstraintKinematics at = engine.eq.constraints;
    const auto value = [&](double s, bool of_rate) {
      const State there = moved(system, state, s);
      compute_kinematics(*engine.dynamics, there, engine.eq);
      const ConstraintKinematics& c = engine.eq.constraints;
      return of_rate ? c.rate[row] - c.nu[row] : c.phi[row];
    };
    const double size = 1 + at.G.row(row).norm() * state.v.norm();
    const bool on_velocities = !system.velocity_rows.empty();
    const double rate = differentiate([&](double s) { return value(s, false); }, 0.0);
    if (!on_velocities) {
      EXPECT_NEAR(at.rate[row] - at.nu[row], rate, 1e-8 * size);
    }
    EXPECT_NEAR(at.G.row(row).dot(state.v), at.rate[row], 1e-12 * size);
    const double rate_of_rate = differentiate([&](double s) { return value(s, true); }, 0.0);
    EXPECT_NEAR(-at.gamma[row], rate_of_rate, 1e-7 * size * (1 + state.v.norm()));
  }
}

INSTANTIATE_TEST_SUITE_P(Scalars, FormulaRowsTest,
                         ::testing::Values("\"= sin(A.position) - s^2*D.position\"",      // joints and a coordinate
                                           "\"= C.angle*C.displacement + cos(s)\"",       // of a joint with two
                                           "\"= P.x^2 + P.y*P.z - s\"",                   // a point in space
                                           "\"= hypot(P.x - t, P.y) - 0.1*sin(3*t)*s\"",  // and time
                                           "{velocity: \"= P.x.velocity*s - A.velocity + t\"}",  // rolling
                                           "{velocity: \"= sin(C.angle)*s.velocity + P.z*D.velocity\"}"));

}  // namespace
}  // namespace ferrers::witness
