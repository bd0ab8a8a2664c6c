#include "rest_input.h"

#include "exit_code.h"

using namespace ferrers;  // NOLINT(google-build-using-namespace)

RestStart load_at_rest(const ModelOptions& options, double t) {
  RestStart start;
  start.loaded = load_model(options);
  start.exit_code = kExitModel;
  if (!start.loaded.model) return start;
  start.dynamics = make_dynamics_model(make_system(start.loaded.model));
  if (!start.dynamics->massless_bodies.empty()) {
    report_masses(start.loaded, start.dynamics->massless_bodies);
    return start;
  }
  if (!start.dynamics->unsupported.empty()) {
    report(start.loaded, "F509", {}, "not supported: " + start.dynamics->unsupported.front());
    return start;
  }
  const InitialStateResult initial = make_initial_state(*start.dynamics, {.t = t});
  start.exit_code = kExitNotAssembled;
  if (initial.status == InitialStateStatus::kNotAssembled) {
    report_open(start.loaded, initial.assembly);
    return start;
  }
  if (initial.status == InitialStateStatus::kInconsistentVelocities) {
    report(start.loaded, "F503", {}, initial.message, "leave velocities out of 'initial'");
    return start;
  }
  start.state = initial.state;
  start.exit_code = kExitDone;
  return start;
}
