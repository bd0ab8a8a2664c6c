// Walks through the two problems of the method with one mechanism, one call of the library per step, and prints every
// intermediate figure. The page docs/method.md shows what this program prints.
//
//   method_walk MODEL decide          which rows and coordinates count
//   method_walk MODEL direct STEP     the paper's direct problem (inverse dynamics), step 1 to 5 at t = 0.3 s
//   method_walk MODEL direct table    its result at every instant
//   method_walk MODEL inverse STEP    the paper's inverse problem (forward dynamics), step 1 to 4 at the start
//   method_walk MODEL inverse table   its result over six steps, and how it depends on their length
//
// MODEL must have one drive, with a motion and an effort law, on the independent coordinate that the decision takes.

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ferrers/dynamics/equations_report.h"
#include "ferrers/dynamics/forward.h"
#include "ferrers/dynamics/initial_state.h"
#include "ferrers/dynamics/paper_steps.h"
#include "ferrers/io/model_reader.h"
#include "ferrers/simulate/simulation.h"

namespace {

using ferrers::MatrixXd;
using ferrers::State;
using ferrers::VectorXd;

constexpr double kT = 1;        // s: the direct problem's span
constexpr int kN = 10;          // its instants are t_l = l T/N
constexpr int kInstant = 3;     // l of the instant that is walked through
constexpr double kStep = 0.05;  // s: the inverse problem's step
constexpr double kUntil = 0.3;  // s: where its steps end

struct Mechanism {
  std::shared_ptr<const ferrers::DynamicsModel> dynamics;
  ferrers::RedundancyReport decision;
  State start;

  const ferrers::System& system() const { return *dynamics->system; }
  const ferrers::Selection& selection() const { return decision.selection; }
  int independent() const { return selection().independent[0]; }
};

[[noreturn]] void give_up(const std::string& why) {
  std::fprintf(stderr, "method_walk: %s\n", why.c_str());
  std::exit(1);
}

Mechanism load(const char* file) {
  ferrers::ModelReadResult read = ferrers::read_model_file(file);
  if (!read.model) give_up(std::string(file) + " has errors: see 'ferrers analyze'");
  Mechanism m;
  m.dynamics = ferrers::make_dynamics_model(ferrers::make_system(std::move(*read.model)));
  const ferrers::InitialStateResult initial = ferrers::make_initial_state(*m.dynamics);
  if (initial.status != ferrers::InitialStateStatus::kReady) give_up(initial.message);
  m.start = initial.state;
  m.decision = ferrers::analyze_redundancy(m.system(), m.start);
  const auto& drives = m.dynamics->drives;
  const bool fits = m.selection().independent.size() == 1 && drives.size() == 1 && drives[0].access.in_tree &&
                    drives[0].access.v == m.independent() && drives[0].motion && drives[0].effort;
  if (!fits) give_up("wanted: one motion, and a drive with both laws on the coordinate that is independent");
  return m;
}

// --- Printing: rounding is nothing, so that it does not show as figures ---

double shown(double value) { return std::abs(value) < 1e-13 ? 0.0 : value; }

void print_values(const char* symbol, const VectorXd& values, const std::vector<int>& which,
                  const std::vector<std::string>& names) {
  for (const int i : which) std::printf("  %-8s %-16s %.8g\n", symbol, names[i].c_str(), shown(values[i]));
}

// A matrix between the names of its columns and rows; either may be left out.
void print_matrix(const char* symbol, const MatrixXd& M, const std::vector<std::string>& rows,
                  const std::vector<std::string>& columns) {
  std::printf("  %-24s", symbol);
  for (const std::string& name : columns) std::printf(" %11s", name.c_str());
  std::printf("\n");
  for (long i = 0; i < M.rows(); ++i) {
    std::printf("  %-24s", rows.empty() ? "" : rows[static_cast<std::size_t>(i)].c_str());
    for (long k = 0; k < M.cols(); ++k) std::printf(" %11.6g", shown(M(i, k)));
    std::printf("\n");
  }
}

std::vector<std::string> chosen(const std::vector<std::string>& names, const std::vector<int>& which) {
  std::vector<std::string> out;
  for (const int i : which) out.push_back(names[i]);
  return out;
}

// Multipliers of the kept rows. Where a self-stress touches one its value means nothing by itself, which is said.
void print_multipliers(const Mechanism& m, const ferrers::Equations& eq, const VectorXd& lambda) {
  const auto status = ferrers::judge_multipliers(*m.dynamics, eq, m.selection());
  for (const int i : m.selection().rows) {
    const bool unique = status[i] == ferrers::ReactionStatus::kUnique;
    std::printf("  %-8s %-16s %.8g  %s\n", "lambda", m.system().row_names[i].c_str(), shown(lambda[i]),
                unique ? "unique" : "undetermined: one choice of many");
  }
}

void print_names(const char* what, const std::vector<int>& which, const std::vector<std::string>& names) {
  std::printf("  %-24s", what);
  for (const int i : which) std::printf(" %s", names[i].c_str());
  std::printf("\n");
}

void decide(const Mechanism& m) {
  const ferrers::RedundancyReport& d = m.decision;
  std::printf("n = %d, m = %d, r = %d, w = %d\n", d.closure_coordinates, d.closure_rows, d.closure_rank,
              d.closure_coordinates - d.closure_rank);
  print_names("independent coordinate", d.selection.independent, m.system().coordinate_names);
  print_names("dependent coordinates", d.selection.dependent, m.system().coordinate_names);
  print_names("rows kept", d.selection.rows, m.system().row_names);
  std::printf("  %-24s", "singular values");
  for (const double value : d.decision.singular_values) std::printf(" %.6g", shown(value));
  std::printf("\n  %-24s %.6g m\n", "characteristic length", d.characteristic_length_m);
}

// --- The direct problem: the motion is given, the forces are wanted ---

struct DirectInstant {
  State state;
  VectorXd vdot;
  ferrers::MotionForces forces;
};

// One instant, continued from the one before; prints the step asked for, 0: none.
DirectInstant direct_instant(const Mechanism& m, const State& before, double t, int print) {
  const ferrers::Selection& s = m.selection();
  const auto& coordinates = m.system().coordinate_names;
  DirectInstant now;
  now.state = before;
  now.state.t = t;

  // Step 1: the independent coordinate from its law.
  const ferrers::Law::Motion law = m.dynamics->drives[0].motion->motion(t);
  now.state.q[m.independent()] = law.value;
  now.state.v[m.independent()] = law.rate;
  if (print == 1) {
    std::printf("t_l = %g s\n  q_i %.8g\n  v_i %.8g\n  vdot_i %.8g\n", t, law.value, law.rate, law.acceleration);
  }

  // Step 2: (6) for the dependent coordinates.
  if (print == 2) print_values("from", now.state.q, s.dependent, coordinates);
  const ferrers::PositionSolution closed = ferrers::solve_dependent_positions(*m.dynamics, s, now.state);
  if (!closed.closed) give_up("the dependent coordinates were not found");
  if (print == 2) {
    for (std::size_t i = 0; i < closed.residuals.size() && closed.residuals[i] > 1e-9; ++i) {
      std::printf("  after %zu corrections: largest |phi_r| %.3g m\n", i, closed.residuals[i]);
    }
    print_values("q_d", now.state.q, s.dependent, coordinates);
  }

  // Step 3: (7) for the dependent velocities.
  ferrers::solve_dependent_velocities(*m.dynamics, s, now.state);
  ferrers::Equations eq = ferrers::make_equations(*m.dynamics);
  ferrers::compute_equations(*m.dynamics, now.state, eq);
  if (print == 3) {
    const auto rows = chosen(m.system().row_names, s.rows);
    print_matrix("G_d", eq.constraints.G(s.rows, s.dependent), rows, chosen(coordinates, s.dependent));
    print_matrix("G_i", eq.constraints.G(s.rows, s.independent), rows, chosen(coordinates, s.independent));
    print_values("v_d", now.state.v, s.dependent, coordinates);
  }

  // Step 4: (8) for the dependent accelerations.
  now.vdot = ferrers::solve_dependent_accelerations(eq, s, VectorXd::Constant(1, law.acceleration));
  if (print == 4) {
    print_values("gamma", eq.constraints.gamma, s.rows, m.system().row_names);
    print_values("vdot_d", now.vdot, s.dependent, coordinates);
  }

  // Step 5: (9) for the multipliers and the drive's effort.
  now.forces = ferrers::solve_multipliers_and_efforts(eq, s, now.vdot);
  if (print == 5) {
    print_matrix("M", eq.M, coordinates, coordinates);
    print_matrix("h, transposed", eq.h.transpose(), {}, coordinates);
    print_matrix("B, transposed", eq.B_transposed, {m.dynamics->drives[0].name}, coordinates);
    print_multipliers(m, eq, now.forces.lambda);
    std::printf("  u %.8g N·m\n", now.forces.u[0]);
  }
  return now;
}

void direct(const Mechanism& m, int print) {
  State state = m.start;
  if (print == 0) std::printf("t_l  q_i  u in N·m\n");
  for (int l = 0; l <= (print == 0 ? kN : kInstant); ++l) {
    const DirectInstant now = direct_instant(m, state, l * kT / kN, l == kInstant ? print : 0);
    if (print == 0) std::printf("%g  %.8g  %.8g\n", now.state.t, now.state.q[m.independent()], now.forces.u[0]);
    state = now.state;
  }
}

// --- The inverse problem: the forces are given, the motion is wanted ---

// From t_l to t_{l+1}; prints the step asked for, 0: none.
State inverse_step(const Mechanism& m, State state, double dt, int print) {
  const ferrers::Selection& s = m.selection();
  const auto& coordinates = m.system().coordinate_names;

  // Step 1: (6) for the dependent coordinates.
  if (!ferrers::solve_dependent_positions(*m.dynamics, s, state).closed) give_up("a step is too long");
  if (print == 1) {
    print_values("q_i", state.q, s.independent, coordinates);
    print_values("q_d", state.q, s.dependent, coordinates);
  }

  // Step 2: (7) for the dependent velocities.
  ferrers::solve_dependent_velocities(*m.dynamics, s, state);
  if (print == 2) {
    print_values("v_i", state.v, s.independent, coordinates);
    print_values("v_d", state.v, s.dependent, coordinates);
  }

  // Step 3: (8) and (9) together for all accelerations and the multipliers.
  ferrers::Equations eq = ferrers::make_equations(*m.dynamics);
  ferrers::compute_equations(*m.dynamics, state, eq);
  ferrers::ForwardResult found = ferrers::make_forward_result(eq);
  ferrers::make_elimination_solver(m.system(), s)->solve(eq, found);
  if (found.status != ferrers::ForwardStatus::kSolved) give_up("the accelerations were not found");
  if (print == 3) {
    std::printf("  u %.8g N·m\n", eq.u[0]);
    print_matrix("h, transposed", eq.h.transpose(), {}, coordinates);
    print_values("gamma", eq.constraints.gamma, s.rows, m.system().row_names);
    for (int k = 0; k < m.system().nv; ++k) print_values("vdot", found.vdot, {k}, coordinates);
    print_multipliers(m, eq, found.lambda);
  }

  // Step 4: the independent acceleration is held over the step.
  const State next = ferrers::hold_accelerations(m.system(), s, state, found.vdot, dt);
  if (print == 4) {
    std::printf("t_l+1 = %g s\n", next.t);
    print_values("q_i'", next.q, s.independent, coordinates);
    print_values("v_i'", next.v, s.independent, coordinates);
  }
  return next;
}

// Where the independent coordinate is at kUntil, with as many steps.
double inverse_angle(const Mechanism& m, int steps, bool print) {
  State state = m.start;
  for (int l = 0; l < steps; ++l) {
    if (print) std::printf("%g  %.8g  %.8g\n", state.t, state.q[m.independent()], state.v[m.independent()]);
    state = inverse_step(m, state, kUntil / steps, 0);
  }
  if (print) std::printf("%g  %.8g  %.8g\n", state.t, state.q[m.independent()], state.v[m.independent()]);
  return state.q[m.independent()];
}

// The same by the engine with an integrator of high order.
double converged_angle(const Mechanism& m) {
  ferrers::SimulationOptions options;
  options.grid = {.t_end = kUntil, .every = kUntil};
  options.with_reactions = false;
  ferrers::RunControl control;
  double angle = NAN;
  control.on_sample = [&](const ferrers::RunSample& sample) {
    const auto columns = ferrers::run_columns(*m.dynamics);
    const std::string wanted = m.system().coordinate_names[m.independent()] + ".angle";
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (columns[i] == wanted) angle = sample.values[i];
    }
  };
  ferrers::simulate(m.dynamics, options, control);
  return angle;
}

void inverse(const Mechanism& m, int print) {
  if (print > 0) {
    inverse_step(m, m.start, kStep, print);
    return;
  }
  std::printf("t_l  q_i  v_i\n");
  const int steps = static_cast<int>(std::lround(kUntil / kStep));
  inverse_angle(m, steps, true);
  const double exact = converged_angle(m);
  std::printf("converged: %.8g\n", exact);
  for (const int finer : {1, 2, 4, 8}) {
    const double angle = inverse_angle(m, finer * steps, false);
    std::printf("step %g s: %.8g, off by %.3g\n", kStep / finer, angle, angle - exact);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string problem = argc > 2 ? argv[2] : "", step = argc > 3 ? argv[3] : "";
  const bool known = problem == "decide" || ((problem == "direct" || problem == "inverse") && !step.empty());
  if (!known) {
    std::fputs("usage: method_walk MODEL decide | direct STEP | inverse STEP, where STEP is a number or 'table'\n",
               stderr);
    return 2;
  }
  const Mechanism m = load(argv[1]);
  const int print = step == "table" ? 0 : std::atoi(step.c_str());
  if (problem == "decide") {
    decide(m);
  } else if (problem == "direct") {
    direct(m, print);
  } else {
    inverse(m, print);
  }
  return 0;
}
