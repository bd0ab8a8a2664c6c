// Systems given by energies and constraints as formulas: against bodies that do the same, closed forms, and independent
// integrations.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <string>

#include "ferrers/dynamics/equilibrium.h"
#include "ferrers/dynamics/inverse.h"
#include "ferrers/dynamics/linearization.h"
#include "ferrers/io/model_reader.h"
#include "ferrers/kinematics/assembly.h"
#include "ferrers/redundancy/mechanism_analysis.h"
#include "ferrers/testing/run_probe.h"

namespace ferrers::witness {
namespace {

ModelSpec example(const std::string& name, std::vector<std::string> edits = {}) {
  ReadModelOptions options;
  options.edits = std::move(edits);
  const ModelReadResult read =
      read_model_file(std::string(FERRERS_SOURCE_DIR) + "/examples/" + name + "/model.yaml", options);
  if (!read.model) throw std::runtime_error(name + ": " + read.diagnostics.items().front().message);
  return read.spec;
}

ModelSpec from_text(const std::string& text) {
  const ModelReadResult read = read_model_text("ferrers: 1\n" + text, "test.yaml");
  if (!read.model) throw std::runtime_error(read.diagnostics.items().front().message);
  return read.spec;
}

/// The drives of another text, put on a model.
ModelSpec with_drives(ModelSpec spec, const std::string& drives) {
  ReadModelOptions options;
  spec.drives = read_model_text("ferrers: 1\nbodies: {}\n" + drives, "drives.yaml", options).spec.drives;
  return spec;
}

ProbedRun probe_prescribed(const ModelSpec& spec, double t_end, double every) {
  const EngineProbe engine(spec);
  ProbedRun run;
  PrescribedOptions options;
  options.grid = {t_end, every};
  run.summary = run_prescribed(engine.dynamics, options, keep_rows(*engine.dynamics, run));
  return run;
}

#define EXPECT_FINISHED(run) EXPECT_EQ((run).summary.status, RunStatus::kFinished) << (run).summary.message

// ---------------------------------------------------------------------------------------------------------------------
// Formulas against bodies

TEST(LagrangianTest, AndrewsSqueezerInAnglesMovesAsItsBodiesDo) {
  const ProbedRun bodies = probe_run(example("andrews-a03"), plain_run(0.03, 0.005));
  const ProbedRun angles = probe_run(example("andrews-angles"), plain_run(0.03, 0.005));
  EXPECT_FINISHED(bodies);
  EXPECT_FINISHED(angles);
  for (const char* name : {"beta", "Theta", "gamma", "Phi", "delta", "Omega", "epsilon"}) {
    const std::string joint = std::string(name) + ".angle";
    const double start = angles.at(0, name);
    for (const double t : {0.005, 0.01, 0.015, 0.02, 0.025, 0.03}) {
      EXPECT_NEAR(angles.at(t, name), start + bodies.at(t, joint), 1e-9) << name << " at " << t;
    }
    const double rate = bodies.at(0.03, joint + ".velocity");
    EXPECT_NEAR(angles.at(0.03, std::string(name) + ".velocity"), rate, 1e-7 * std::max(1.0, std::abs(rate))) << name;
  }
}

TEST(LagrangianTest, AFourBarInPointsAnglesAndBodiesIsOneMechanism) {
  const ProbedRun bodies = probe_run(example("four-bar"), plain_run(2, 0.25));
  for (const char* name : {"four-bar-angles", "four-bar-points"}) {
    const ProbedRun run = probe_run(example(name), plain_run(2, 0.25));
    EXPECT_FINISHED(run);
    for (double t = 0; t < 2.1; t += 0.25) {
      EXPECT_NEAR(run.at(t, "x"), bodies.at(t, "M.x"), 1e-9) << name << " at " << t;
      EXPECT_NEAR(run.at(t, "y"), bodies.at(t, "M.y"), 1e-9) << name << " at " << t;
    }
  }
}

TEST(LagrangianTest, AFourBarInPointsAnglesAndBodiesWantsTheSameDriveEffort) {
  // In points no coordinate is the crank's angle: the drive is on a formula of two of them.
  const std::string law = "motion: \"= atan2(0.9, 0.3) + 0.7*sin(2*t)\"}}";
  const ProbedRun bodies =
      probe_prescribed(with_drives(example("four-bar"), "drives: {m: {joint: O, motion: = 0.7*sin(2*t)}}"), 1.5, 0.25);
  const ProbedRun angles =
      probe_prescribed(with_drives(example("four-bar-angles"), "drives: {m: {joint: crank, " + law), 1.5, 0.25);
  const ProbedRun points = probe_prescribed(
      with_drives(example("four-bar-points"), "drives: {m: {quantity: \"= atan2(y1, x1)\", " + law), 1.5, 0.25);
  EXPECT_FINISHED(bodies);
  EXPECT_FINISHED(angles);
  EXPECT_FINISHED(points);
  for (double t = 0; t < 1.6; t += 0.25) {
    const double effort = bodies.at(t, "m.effort");
    EXPECT_NEAR(angles.at(t, "m.effort"), effort, 1e-9 * (1 + std::abs(effort))) << t;
    EXPECT_NEAR(points.at(t, "m.effort"), effort, 1e-9 * (1 + std::abs(effort))) << t;
    EXPECT_NEAR(points.at(t, "x"), bodies.at(t, "M.x"), 1e-10) << t;
  }
}

TEST(LagrangianTest, MultipliersAcrossTheCranksAreTheTransverseForcesOfSpatialHinges) {
  SimulationOptions options = plain_run(0.3, 0.1);
  options.with_reactions = true;
  const ProbedRun bodies = probe_run(example("three-cranks"), options);
  const ProbedRun plane = probe_run(example("cranks-in-plane"), options);
  EXPECT_FINISHED(bodies);
  EXPECT_FINISHED(plane);
  for (double t = 0; t < 0.31; t += 0.1) {
    EXPECT_NEAR(plane.at(t, "x"), bodies.at(t, "T.x"), 1e-9);
    EXPECT_NEAR(plane.at(t, "y"), bodies.at(t, "T.y"), 1e-9);
  }
  // The spatial model has no unique component in the drawing's axes; drawn with its cranks along x it has.
  ModelSpec turned =
      example("three-cranks", {"parameters.theta=0 rad", "gravity=[= -9.81*sin(0.7), = -9.81*cos(0.7), 0]"});
  EngineProbe spatial(turned);
  State state = make_drawn_state(*spatial.system);
  const ForwardResult forward = spatial.forward(state);
  const auto reactions = spatial.reactions(state, forward);
  const auto at = [&](const char* joint) { return reactions[spatial.model().find_joint(joint)->index()]; };
  EngineProbe formulas(example("cranks-in-plane"));
  State start = formulas.start();
  const ForwardResult solved = formulas.forward(start);
  const auto multipliers =
      ReactionSolver(formulas.dynamics)
          .solve(start, formulas.eq, formulas.selection, solved.vdot, solved.lambda, formulas.eq.u);
  const auto multiplier = [&](const std::string& name) {
    for (std::size_t c = 0; c < formulas.model().couplings().size(); ++c) {
      if (formulas.model().couplings()[c].name == name) return multipliers.at(c);  // it has no joints
    }
    throw std::out_of_range(name);
  };
  for (const char* joint : {"high1", "high2", "high3", "low1", "low2", "low3"}) {
    const JointReaction m = multiplier(std::string(joint) + "_across");
    ASSERT_EQ(at(joint).status[1], ReactionStatus::kUnique) << joint;
    ASSERT_EQ(m.status[0], ReactionStatus::kUnique) << joint;
    EXPECT_NEAR(m.value[0], at(joint).value[1], 1e-9) << joint;
    EXPECT_EQ(multiplier(std::string(joint) + "_along").status[0], ReactionStatus::kUndetermined) << joint;
    EXPECT_EQ(at(joint).status[0], ReactionStatus::kUndetermined) << joint;
  }
}

// ---------------------------------------------------------------------------------------------------------------------
// Constraints on velocities

using Vec = std::vector<double>;
/// Runge and Kutta's rule with steps of h; the last one meets t.
Vec integrate(const std::function<Vec(const Vec&)>& rate, Vec y, double t, double h) {
  const auto moved = [](const Vec& a, const Vec& b, double by) {
    Vec out = a;
    for (std::size_t i = 0; i < a.size(); ++i) out[i] += by * b[i];
    return out;
  };
  const int steps = static_cast<int>(std::ceil(t / h));
  h = t / steps;
  for (int n = 0; n < steps; ++n) {
    const Vec a = rate(y), b = rate(moved(y, a, h / 2)), c = rate(moved(y, b, h / 2)), d = rate(moved(y, c, h));
    for (std::size_t i = 0; i < y.size(); ++i) y[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
  }
  return y;
}

TEST(LagrangianTest, ARollingDiskStaysInItsSteadyTurn) {
  const ProbedRun run = probe_run(example("rolling-disk"), plain_run(5, 0.5));
  EXPECT_FINISHED(run);
  EXPECT_LT(run.energy_drift(), 1e-9);
  const double R = 0.5, turn = -1.5, roll = run.at(0, "roll.velocity"), spin = roll + turn * std::sin(0.3);
  for (double t = 0; t < 5.1; t += 0.5) {
    EXPECT_NEAR(run.at(t, "lean"), 0.3, 1e-9);
    const double y = run.at(t, "contact_y") - R * spin / turn;
    EXPECT_NEAR(std::hypot(run.at(t, "contact_x"), y), std::abs(R * roll / turn), 1e-8);
  }
}

/// The disk's own equations, contact force eliminated by hand: y = (x, y, ψ, θ, roll, θ', ψ', Ω) with heading ψ, lean θ
/// and spin Ω about the axis.
///   (A + m R²) θ'' = (C + m R²) Ω ψ' cos θ − A ψ'² sin θ cos θ + m g R sin θ
///   A (ψ'' cos θ − 2 ψ' θ' sin θ) + C Ω θ' = 0,    (C + m R²) Ω' = −m R² ψ' θ' cos θ
Vec disk_rate(const Vec& y) {
  const double m = 2, R = 0.5, g = 9.81, A = m * R * R / 4, C = m * R * R / 2, inertia = C + m * R * R;
  const double heading = y[2], s = std::sin(y[3]), c = std::cos(y[3]), rate = y[5], turn = y[6], spin = y[7];
  const double along = R * spin, side = R * rate * c;  // velocity of the mass centre along the track, and to its right
  return {along * std::cos(heading) + side * std::sin(heading),
          along * std::sin(heading) - side * std::cos(heading),
          turn,
          rate,
          spin - turn * s,
          (inertia * spin * turn * c - A * turn * turn * s * c + m * g * R * s) / (A + m * R * R),
          (2 * A * turn * rate * s - C * spin * rate) / (A * c),
          -m * R * R * turn * rate * c / inertia};
}

TEST(LagrangianTest, AWobblingDiskAgreesWithAnIndependentIntegration) {
  const ProbedRun run = probe_run(
      example("rolling-disk", {"initial.lean.velocity=0.4", "initial.heading.velocity=-1", "initial.roll.velocity=4"}),
      plain_run(2, 0.5));
  EXPECT_FINISHED(run);
  EXPECT_LT(run.energy_drift(), 1e-8);
  const Vec start = {0, 0, 0, 0.3, 0, 0.4, -1, 4 - std::sin(0.3)};
  for (const double t : {0.5, 1.0, 2.0}) {
    const Vec y = integrate(disk_rate, start, t, 1e-4);
    const char* names[] = {"x", "y", "heading", "lean", "roll"};
    for (int i = 0; i < 5; ++i) EXPECT_NEAR(run.at(t, names[i]), y[i], 1e-8) << names[i] << " at " << t;
  }
}

TEST(LagrangianTest, AVerticalDiskRollsInACircle) {
  // [bloch2003, sec. 1.4]: x = (Ω/ω) R sin ωt, y = (Ω/ω) R (1 − cos ωt) with constant rates of roll and heading.
  const ProbedRun run = probe_run(from_text(R"--(
gravity: [0, 0, 0]
bodies: {}
lagrangian:
  coordinates: {x: m, y: m, heading: rad, roll: rad}
  kinetic_energy: "= 1/2*3*(x.velocity^2 + y.velocity^2) + 1/2*0.2*heading.velocity^2 + 1/2*0.4*roll.velocity^2"
constraints:
  roll_x: {velocity: "= x.velocity - 0.4*cos(heading)*roll.velocity"}
  roll_y: {velocity: "= y.velocity - 0.4*sin(heading)*roll.velocity"}
initial: {heading: {velocity: 0.7}, roll: {velocity: 2.5}}
)--"),
                                  plain_run(4, 1));
  EXPECT_FINISHED(run);
  for (const double t : {1.0, 2.0, 3.0, 4.0}) {
    EXPECT_NEAR(run.at(t, "x"), 2.5 / 0.7 * 0.4 * std::sin(0.7 * t), 1e-9);
    EXPECT_NEAR(run.at(t, "y"), 2.5 / 0.7 * 0.4 * (1 - std::cos(0.7 * t)), 1e-9);
    EXPECT_NEAR(run.at(t, "roll"), 2.5 * t, 1e-9);
  }
}

TEST(LagrangianTest, AChaplyginSleighTurnsStraight) {
  // [bloch2003, sec. 1.7]: with u along the blade, v' ... m u' = m a ω², (I + m a²) ω' = −m a u ω; ω² (I + m a²) + m u²
  // is kept, and in time ω = ω₀ sech(c t), u = u∞ tanh(c t) from u = 0.
  const double m = 2, I = 0.3, a = 0.4, omega = 1.5;
  const ProbedRun run = probe_run(from_text(R"--(
gravity: [0, 0, 0]
bodies: {}
lagrangian:
  coordinates: {x: m, y: m, angle: rad}   # of the blade; the mass centre is 0.4 m ahead
  kinetic_energy: >-
    = 1/2*2*((x.velocity - 0.4*sin(angle)*angle.velocity)^2 + (y.velocity + 0.4*cos(angle)*angle.velocity)^2)
    + 1/2*0.3*angle.velocity^2
constraints:
  blade: {velocity: "= -sin(angle)*x.velocity + cos(angle)*y.velocity"}
initial: {angle: {velocity: 1.5}, x: {velocity: 0}}
record: {along: "= cos(angle)*x.velocity + sin(angle)*y.velocity"}
)--"),
                                  plain_run(3, 0.5));
  EXPECT_FINISHED(run);
  const double J = I + m * a * a, end = omega * std::sqrt(J / m), c = m * a * end / J;
  for (double t = 0; t < 3.1; t += 0.5) {
    EXPECT_NEAR(run.at(t, "angle.velocity"), omega / std::cosh(c * t), 1e-9) << t;
    EXPECT_NEAR(run.at(t, "along"), end * std::tanh(c * t), 1e-9) << t;
  }
}

// ---------------------------------------------------------------------------------------------------------------------
// Constraints between bodies

/// Watt's linkage of bodies, until 0.338 s, where the middle alone could also go on by another coupler; the rocker on
/// the right and its hinges, or Watt's curve for the coupler's middle.
ModelSpec watt(bool curve) {
  const std::string rocker = curve ? "" : R"--(
  C: {type: revolute, bodies: [coupler, rocker2], at: [= x2, = y2, 0], axis: z}
  D: {type: revolute, bodies: [ground, rocker2], at: [= a, 0, 0], axis: z})--";
  const std::string law = R"--(
constraints:
  curve: >-
    = (P.x^2 + P.y^2)*(P.x^2 + P.y^2 - a^2 - b^2 + c^2)^2 + 4*a^2*P.y^2*(P.x^2 + P.y^2 - b^2)
)--";
  return from_text(R"--(
gravity: [0, -9.81, 0]
parameters: {a: 1 m, b: 1.1 m, c: 0.5 m, x1: -0.3 m, x2: "= 0.679052283439742705", y1: "= sqrt(b^2 - (x1 + a)^2)", y2: "= sqrt(b^2 - (x2 - a)^2)"}
bodies:
  rocker1: {mass: 1, inertia: {shape: rod, from: [= -a, 0, 0], to: [= x1, = y1, 0]}}
  coupler: {mass: 2, inertia: {shape: rod, from: [= x1, = y1, 0], to: [= x2, = y2, 0]}}
)--" + std::string(curve ? "" : "  rocker2: {mass: 1e-9, com: [= (a + x2)/2, = y2/2, 0]}\n") +
                   R"--(joints:
  A: {type: revolute, bodies: [ground, rocker1], at: [= -a, 0, 0], axis: z}
  B: {type: revolute, bodies: [rocker1, coupler], at: [= x1, = y1, 0], axis: z})--" +
                   rocker + R"--(
record: {P: {body: coupler, at: [= (x1 + x2)/2, = (y1 + y2)/2, 0]}}
)--" + (curve ? law : ""));
}

TEST(LagrangianTest, APointOnWattsCurveReplacesARocker) {
  const ProbedRun linkage = probe_run(watt(false), plain_run(0.3, 0.05));
  const ProbedRun curve = probe_run(watt(true), plain_run(0.3, 0.05));
  EXPECT_FINISHED(linkage);
  EXPECT_FINISHED(curve);
  for (double t = 0; t < 0.31; t += 0.05) {
    EXPECT_NEAR(curve.at(t, "P.x"), linkage.at(t, "P.x"), 1e-8) << t;
    EXPECT_NEAR(curve.at(t, "P.y"), linkage.at(t, "P.y"), 1e-8) << t;
    EXPECT_NEAR(curve.at(t, "A.angle"), linkage.at(t, "A.angle"), 1e-8) << t;
  }
  EXPECT_LT(curve.energy_drift(), 1e-8);
}

TEST(LagrangianTest, ACamBetweenSpatialJointsKeepsItsLawAndItsEnergy) {
  const ProbedRun run = probe_run(example("cam-lift"), plain_run(1, 0.1));
  EXPECT_FINISHED(run);
  for (double t = 0; t < 1.01; t += 0.1) {
    EXPECT_NEAR(run.at(t, "guide.displacement"), 0.02 * (1 - std::cos(run.at(t, "bearing.angle"))), 1e-13) << t;
  }
  EXPECT_LT(std::abs(run.summary.balance_error), 1e-9);
}

/// A bead on a wire that moves: y = x²/2 + w(t).
TEST(LagrangianTest, AConstraintThatMovesByItselfWorks) {
  const ProbedRun run = probe_run(from_text(R"--(
gravity: [0, 0, 0]
bodies: {}
lagrangian:
  coordinates: {x: m, y: m}
  kinetic_energy: = 1/2*2*(x.velocity^2 + y.velocity^2)
  potential_energy: = 2*9.81*y
  constraints: {wire: "= y - x^2/2 - 0.2*sin(3*t)"}
initial: {x: {position: 0.5, velocity: 0.1}}
)--"),
                                  plain_run(2, 0.5));
  EXPECT_FINISHED(run);
  // In x alone: (1 + x²) x'' + x x'² + x (g + w'') = 0.
  const auto rate = [](const Vec& s) {
    const double x = s[0], v = s[1], w2 = -1.8 * std::sin(3 * s[2]);
    return Vec{v, -(x * v * v + x * (9.81 + w2)) / (1 + x * x), 1};
  };
  for (const double t : {0.5, 1.0, 2.0}) {
    const Vec y = integrate(rate, {0.5, 0.1, 0}, t, 1e-3);
    EXPECT_NEAR(run.at(t, "x"), y[0], 1e-9) << t;
    EXPECT_NEAR(run.at(t, "x.velocity"), y[1], 1e-8) << t;
  }
  // The wire's force times its velocity is power that comes from outside.
  EXPECT_GT(run.energy_drift(), 0.1);
  ASSERT_TRUE(run.summary.work.has_value());
  EXPECT_LT(std::abs(run.summary.balance_error), 1e-7);
}

// ---------------------------------------------------------------------------------------------------------------------
// Drives by formulas

TEST(LagrangianTest, ADriveOnAQuantityIsTheDriveOnTheDistanceOfTwoPoints) {
  const std::string model = R"--(
gravity: [0, -9.81, 0]
bodies: {boom: {mass: 3, inertia: {shape: rod, from: [0, 0, 0], to: [2, 0, 0]}}}
joints: {hinge: {type: revolute, bodies: [ground, boom], at: [0, 0, 0], axis: z}}
record: {P: {body: boom, at: [1, 0, 0]}}
drives:
  ram: {)--";
  const std::string law = ", motion: \"= sqrt(2) + 0.1*sin(2*t)\"}\n";
  const ProbedRun distance =
      probe_prescribed(from_text(model + "bodies: [ground, boom], points: [[0, -1, 0], [1, 0, 0]]" + law), 1, 0.25);
  const ProbedRun quantity = probe_prescribed(from_text(model + "quantity: \"= hypot(P.x, P.y + 1)\"" + law), 1, 0.25);
  EXPECT_FINISHED(distance);
  EXPECT_FINISHED(quantity);
  for (double t = 0; t < 1.01; t += 0.25) {
    EXPECT_NEAR(quantity.at(t, "ram.effort"), distance.at(t, "ram.effort"), 1e-9 * 100) << t;
    EXPECT_NEAR(quantity.at(t, "hinge.angle"), distance.at(t, "hinge.angle"), 1e-12) << t;
  }
}

TEST(LagrangianTest, MotionsAndDrivesByTheirMapsSatisfyTheEquationsOfMotion) {
  // Two cables pull on three coordinates; what they do to each is their map. One coordinate follows by a constraint.
  const ModelSpec spec = from_text(R"--(
gravity: [0, 0, 0]
bodies: {}
lagrangian:
  coordinates: {a: rad, b: rad, c: {unit: m, guess: 0.2 m}}
  kinetic_energy: "= 1/2*(2 + cos(b))*a.velocity^2 + 1/2*b.velocity^2 + 0.3*a.velocity*b.velocity + 1/2*4*c.velocity^2"
  potential_energy: "= 5*sin(a) + 3*c + b^2"
  dissipation: = 0.1*b.velocity^2
constraints: {tie: "= c - 0.2*cos(a) - 0.1*b"}
motions: {a: "= 0.3*sin(2*t)", b: "= 0.4*t^2"}
drives:
  left: {map: {a: "= 1 + 0.2*cos(b)", c: 0.5}}
  right: {map: {b: 2, a: "= -0.3*c"}}
)--");
  EngineProbe engine(spec);
  PrescribedMotion motion(engine.dynamics, assemble(*engine.system).state);
  for (double t = 0; t < 2; t += 0.3) {
    const PrescribedResult result = motion.solve(t);
    ASSERT_EQ(result.status, PrescribedStatus::kSolved) << result.message;
    const State& s = result.state;
    engine.evaluate(s);
    const double a = s.q[0], b = s.q[1], c = s.q[2], av = s.v[0], bv = s.v[1], s2 = result.vdot[0], b2 = result.vdot[1];
    EXPECT_NEAR(a, 0.3 * std::sin(2 * t), 1e-12);
    EXPECT_NEAR(b2, 0.8, 1e-10);
    EXPECT_NEAR(c, 0.2 * std::cos(a) + 0.1 * b, 1e-12);
    int left = 0, right = 1;
    for (int d = 0; d < engine.dynamics->nu(); ++d) {
      if (engine.dynamics->drives[d].name == "left") left = d;
      if (engine.dynamics->drives[d].name == "right") right = d;
    }
    const double u1 = result.u[left], u2 = result.u[right], lambda = result.lambda[0];
    // Written out by hand: d/dt ∂T/∂v − ∂T/∂q + ∂V/∂q − Q.
    const double along_a = (2 + std::cos(b)) * s2 - std::sin(b) * bv * av + 0.3 * b2 + 5 * std::cos(a);
    const double along_b = b2 + 0.3 * s2 + 0.5 * std::sin(b) * av * av + 2 * b + 0.2 * bv;
    const double along_c = 4 * result.vdot[2] + 3;
    EXPECT_NEAR(along_a, (1 + 0.2 * std::cos(b)) * u1 - 0.3 * c * u2 + 0.2 * std::sin(a) * lambda, 1e-9) << t;
    EXPECT_NEAR(along_b, 2 * u2 - 0.1 * lambda, 1e-9) << t;
    EXPECT_NEAR(along_c, 0.5 * u1 + lambda, 1e-9) << t;
  }
}

// ---------------------------------------------------------------------------------------------------------------------
// Rates that depend on each other

std::string plane_with(const std::string& constraints, const std::string& rest = "") {
  return "lagrangian:\n  coordinates: {x: m, y: m, h: rad}\n"
         "  kinetic_energy: \"= (x.velocity^2 + y.velocity^2 + h.velocity^2)/2\"\n"
         "constraints: {" +
         constraints + "}\n" + rest;
}

TEST(LagrangianTest, ARateLeftOutIsWatchedAndEndsTheRunWhenItBreaks) {
  // Dependent at h = 0 only: one of them is left out there, and a moment later it binds.
  const std::string rolling =
      R"(s1: {velocity: "= sin(h)*x.velocity - cos(h)*y.velocity"}, s2: {velocity: "= y.velocity"})";
  const ProbedRun run = probe_run(
      from_text(plane_with(rolling, "initial: {h: {position: 0, velocity: 1}, x: {velocity: 1}}")), plain_run(1, 0.1));
  EXPECT_EQ(run.summary.status, RunStatus::kRedundancyEnded) << run.summary.message;
  EXPECT_LT(run.summary.t_reached, 0.2);
}

TEST(LagrangianTest, APrescribedMotionThatBreaksARateIsContradictory) {
  const auto solve = [](const std::string& rate) {
    const ModelSpec spec =
        from_text(plane_with("c1: \"= x - y\", c2: {velocity: \"= " + rate + "\"}",
                             "motions: {x: \"= t\", h: 0}\ndrives: {d: {map: {x: 1}}, e: {map: {h: 1}}}"));
    EngineProbe engine(spec);
    AssemblyOptions options;
    PrescribedMotion motion(engine.dynamics, assemble(*engine.system, options).state);
    return motion.solve(0.5);
  };
  const PrescribedResult kept = solve("x.velocity - y.velocity");
  EXPECT_EQ(kept.status, PrescribedStatus::kSolved) << kept.message;
  const PrescribedResult broken = solve("x.velocity - y.velocity - t");
  EXPECT_EQ(broken.status, PrescribedStatus::kContradictory);
  EXPECT_NE(broken.message.find("'c2'"), std::string::npos) << broken.message;
}

TEST(LagrangianTest, RatesThatContradictEachOtherAreFoundBeforeAnyRun) {
  const auto analyzed = [](const std::string& constraints) {
    return analyze_mechanism(*EngineProbe(from_text(plane_with(constraints))).system);
  };
  const std::string first = R"(c1: {velocity: "= x.velocity - y.velocity"})";
  EXPECT_FALSE(analyzed(first + R"(, c2: {velocity: "= 3*x.velocity - 3*y.velocity"})").rate_conflict);
  const MechanismAnalysis bad = analyzed(first + R"(, c2: {velocity: "= 2*x.velocity - 2*y.velocity - 0.5"})");
  ASSERT_TRUE(bad.rate_conflict);
  const double off = bad.rate_conflict->residual;  // of whichever was left out
  EXPECT_NEAR(off, bad.rate_conflict->row.find("c2") == 0 ? 0.5 : 0.25, 1e-12);
  // Moving by themselves, together and apart.
  EXPECT_FALSE(analyzed(R"(c1: "= x - y - t", c2: "= 2*x - 2*y - 2*t")").rate_conflict);
  EXPECT_TRUE(analyzed(R"(c1: "= x - y - t", c2: "= 2*x - 2*y - t")").rate_conflict);
}

TEST(LagrangianTest, EnergiesOfCoordinatesWithoutConstraintsAreAnalyzedBesideOthers) {
  // The energies read h, which no constraint does.
  const MechanismAnalysis analysis =
      analyze_mechanism(*EngineProbe(from_text(plane_with("c1: \"= x - y\", c2: \"= 2*x - 2*y\""))).system);
  ASSERT_TRUE(analysis.redundancy);
  EXPECT_EQ(analysis.redundancy->redundant, 1);
  EXPECT_EQ(analysis.redundancy->mobility, 2);
}

TEST(LagrangianTest, MotionsWithoutDrivesAreNoInputs) {
  const std::string motions =
      "motions: {x: \"= 0.1\"}\ndrives: {d: {joint: y, effort: 1}}\ninitial: {x: {position: 0}}";
  const EngineProbe engine(from_text(plane_with("c: \"= h - x\"", motions)));
  const Linearization linear = linearize(*engine.dynamics, engine.start());
  EXPECT_EQ(linear.inputs, std::vector<std::string>{"d"});
  EXPECT_EQ(linear.B.cols(), 1);
  EXPECT_EQ(acting_drives(*engine.dynamics).size(), 1U);
}

// ---------------------------------------------------------------------------------------------------------------------
// What cannot be told is not told

const char* const kRods = R"(
gravity: [0, 0, 0]
lagrangian:
  coordinates: {x: m, y: {unit: m, guess: -0.8}}
  kinetic_energy: "= x.velocity^2 + y.velocity^2"
constraints: {rod: "= hypot(x, y) - 0.8", other: "= hypot(x, y) - 0.9"}
)";

TEST(LagrangianTest, ConstraintsThatContradictEachOtherAreToldWithWhatIsBetweenThem) {
  const MechanismAnalysis analysis = analyze_mechanism(*EngineProbe(from_text(kRods)).system);
  ASSERT_EQ(analysis.closure.verdict, ClosureVerdict::kContradictory);
  ASSERT_EQ(analysis.closure.contradictions.size(), 1U);
  const Contradiction& one = analysis.closure.contradictions.front();
  EXPECT_FALSE(one.has_joints);
  EXPECT_NEAR(one.misclosure, 0.1, 1e-6);
  EXPECT_EQ(one.joints.size(), 2U);
  EXPECT_NE(analysis.closure.text.find("the constraints 'rod' and 'other' miss each other by 0.1"), std::string::npos)
      << analysis.closure.text;
}

const char* const kTurningWire = R"--(
gravity: [0, 0, 0]
lagrangian:
  coordinates: {x: {unit: m, guess: 0.4}, y: m}
  kinetic_energy: "= x.velocity^2 + y.velocity^2"
constraints: {wire: "= y*cos(1.2*t) - x*sin(1.2*t)"}
)--";

TEST(LagrangianTest, OfAMovingConstraintNoStabilityAndNoFrequencyIsTold) {
  const EngineProbe engine(from_text(kTurningWire));
  for (const double t : {0.0, 0.6}) {
    const State start = assemble(*engine.system, {.t = t}).state;
    EXPECT_NEAR(start.q[1] * std::cos(1.2 * t), start.q[0] * std::sin(1.2 * t), 1e-12);  // closed at its own time
    const EquilibriumResult rest = solve_equilibrium(*engine.dynamics, start, {.t = t});
    ASSERT_EQ(rest.status, EquilibriumStatus::kFound);
    EXPECT_EQ(rest.stability.stability, Stability::kUnknown);
    ASSERT_EQ(rest.notices.size(), 1U);
    EXPECT_NE(rest.notices[0].find("'wire' moves by itself"), std::string::npos);
    EXPECT_EQ(linearize(*engine.dynamics, start).status, LinearizationStatus::kUnsupported);
  }
}

TEST(LagrangianTest, WhereConditionsOnVelocitiesComeToRestIsNotTold) {
  const EngineProbe engine(from_text(plane_with(R"(edge: {velocity: "= sin(h)*x.velocity - cos(h)*y.velocity"})")));
  const EquilibriumResult rest = solve_equilibrium(*engine.dynamics, engine.start());
  EXPECT_EQ(rest.status, EquilibriumStatus::kUnsupported);
  EXPECT_NE(rest.message.find("'edge'"), std::string::npos) << rest.message;
}

TEST(LagrangianTest, AnEnergyWithoutAValueEndsTheRun) {
  const ModelSpec spec = from_text(R"--(
lagrangian:
  coordinates: {x: {unit: m, guess: 0.5}}
  kinetic_energy: "= x.velocity^2"
  potential_energy: "= 3*x + log(x/0.1)"
)--");
  const ProbedRun run = probe_run(spec, plain_run(3, 0.01));
  EXPECT_EQ(run.summary.status, RunStatus::kStepTooSmall);
  ModelSpec bad = spec;
  bad.lagrangian.coordinates[0].guess = Number(-0.5);
  const ProbedRun from_the_start = probe_run(bad, plain_run(3, 0.01));
  EXPECT_EQ(from_the_start.summary.status, RunStatus::kStepTooSmall);
  EXPECT_NE(from_the_start.summary.message.find("energy has no finite value"), std::string::npos)
      << from_the_start.summary.message;
}

}  // namespace
}  // namespace ferrers::witness
