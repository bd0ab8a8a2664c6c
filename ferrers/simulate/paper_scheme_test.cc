// The run with the paper's scheme against the paper's steps one by one.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ferrers/dynamics/forward.h"
#include "ferrers/dynamics/paper_steps.h"
#include "ferrers/testing/run_probe.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {
namespace {

ModelSpec pushed_four_bar() {
  ModelSpec spec = make_driven_four_bar();
  spec.drives = {coordinate_drive("motor", "O", "", "60 + 20*t")};
  spec.initial = {initial_velocity("O", 0.5)};
  return spec;
}

/// Steps 1-4 of the paper's inverse problem, `steps` of them.
State walk(EngineProbe& probe, int steps, double dt) {
  State state = probe.start();
  probe.evaluate(state);
  const Selection s = probe.selection;
  const auto solver = make_elimination_solver(*probe.system, s);
  ForwardResult found = make_forward_result(*probe.system);
  for (int l = 0;; ++l) {
    EXPECT_TRUE(solve_dependent_positions(*probe.dynamics, s, state).closed);
    solve_dependent_velocities(*probe.dynamics, s, state);
    if (l == steps) return state;
    compute_equations(*probe.dynamics, state, probe.eq);
    solver->solve(probe.eq, found);
    state = hold_accelerations(*probe.system, s, state, found.vdot, dt);
  }
}

TEST(PaperSchemeTest, ARunOfConstantAccelerationsTakesThePapersSteps) {
  const double dt = 0.02;
  SimulationOptions options = plain_run(0.2, dt);
  options.integrator = Integrator::kConstantAcceleration;
  options.step = dt;
  const ProbedRun run = probe_run(pushed_four_bar(), options);
  ASSERT_EQ(run.summary.status, RunStatus::kFinished) << run.summary.message;
  EngineProbe probe(pushed_four_bar());
  for (const int steps : {0, 1, 2, 10}) {
    const State state = walk(probe, steps, dt);
    for (int k = 0; k < probe.system->nv; ++k) {
      const std::string column = probe.system->coordinate_names[k] + ".angle";
      EXPECT_NEAR(state.q[k], run.at(steps * dt, column), 1e-12) << column << " after " << steps;
      EXPECT_NEAR(state.v[k], run.at(steps * dt, column + ".velocity"), 1e-11) << column << " after " << steps;
    }
  }
}

TEST(PaperSchemeTest, ThePapersStepsAreOfFirstOrder) {
  const ProbedRun converged = probe_run(pushed_four_bar(), plain_run(0.2, 0.2));
  EngineProbe probe(pushed_four_bar());
  const int crank =
      static_cast<int>(std::find(probe.system->coordinate_names.begin(), probe.system->coordinate_names.end(), "O") -
                       probe.system->coordinate_names.begin());
  const auto error = [&](int steps) { return walk(probe, steps, 0.2 / steps).q[crank] - converged.last("O.angle"); };
  EXPECT_NEAR(error(80) / error(160), 2, 0.02);
}

}  // namespace
}  // namespace ferrers::witness
