#include "ferrers/dynamics/forward.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "ferrers/dynamics/inverse.h"
#include "ferrers/redundancy/selection.h"
#include "ferrers/testing/compare.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/random_mechanism.h"
#include "ferrers/testing/random_source.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

/// What every formulation owes: the same accelerations, the same unique reactions, and honest words where it cannot.
namespace ferrers::witness {
namespace {

constexpr double kAgreement = 1e-9;
constexpr int kRandomMechanisms = 200;

double largest_unique(const std::vector<JointReaction>& reactions) {
  double largest = 0;
  for (const JointReaction& r : reactions) {
    for (int k = 0; k < 6; ++k) {
      if (r.status[k] == ReactionStatus::kUnique) largest = std::max(largest, std::abs(r.value[k]));
    }
  }
  return largest;
}

// Accelerations, and reactions where they are unique; the others are flagged, whatever their values.
void expect_same_results(const EngineProbe& engine, const State& state, const ForwardResult& got,
                         const ForwardResult& wanted, double tolerance = kAgreement) {
  ASSERT_EQ(got.status, ForwardStatus::kSolved);
  EXPECT_TRUE(matrices_near(got.vdot, wanted.vdot, tolerance, "vdot"));
  const std::vector<JointReaction> a = engine.reactions(state, got), b = engine.reactions(state, wanted);
  const double scale = std::max(1.0, largest_unique(b));
  for (std::size_t j = 0; j < a.size(); ++j) {
    for (int k = 0; k < 6; ++k) {
      ASSERT_EQ(a[j].status[k], b[j].status[k]);
      if (a[j].status[k] != ReactionStatus::kUnique) continue;
      EXPECT_NEAR(a[j].value[k], b[j].value[k], tolerance * scale) << engine.model().joints()[j].name << " " << k;
    }
  }
}

bool has_regular_mass(const EngineProbe& engine) { return Eigen::LLT<MatrixXd>(engine.eq.M).info() == Eigen::Success; }

void expect_formulations_agree(EngineProbe& engine, const State& state) {
  const ForwardResult wanted = engine.forward(state, Formulation::kNullSpace);
  ASSERT_EQ(wanted.status, ForwardStatus::kSolved);
  for (const Formulation formulation : kFormulations) {
    SCOPED_TRACE(to_string(formulation));
    if (formulation == Formulation::kElimination && !has_regular_mass(engine)) continue;
    expect_same_results(engine, state, engine.forward(state, formulation), wanted);
  }
}

TEST(ForwardTest, EveryFormulationIsFoundByItsName) {
  for (const Formulation formulation : kFormulations) {
    EXPECT_EQ(find_formulation(to_string(formulation)), formulation);
    EXPECT_FALSE(to_string(formulation).empty());
  }
  EXPECT_EQ(find_formulation("spars"), std::nullopt);
}

TEST(ForwardTest, FormulationsAgreeOnTheZooInMotion) {
  for (const ZooEntry& entry : zoo()) {
    SCOPED_TRACE(entry.name);
    EngineProbe engine(entry.spec);
    if (!engine.dynamics->massless_bodies.empty()) continue;
    expect_formulations_agree(engine, engine.wandered(3, 0.2));
  }
}

TEST(ForwardTest, FormulationsAgreeOnRandomMechanismsInMotion) {
  for (int seed = 0; seed < kRandomMechanisms; ++seed) {
    const RandomMechanism mechanism = make_random_mechanism(seed);
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + mechanism.description);
    EngineProbe engine(mechanism.spec);
    expect_formulations_agree(engine, tree_state(*engine.system, wandered(engine.model(), seed)));
  }
}

VectorXd random_vector(RandomSource& random, long size) {
  VectorXd out(size);
  for (double& x : out) x = random.between(-1, 1);
  return out;
}

// gamma within the range of G: redundant rows do not contradict each other.
TEST(ForwardTest, OtherRightSidesWithTheSameFactorsGiveWhatAFreshSolutionGives) {
  RandomSource random(5);
  for (const ZooEntry& entry : zoo()) {
    SCOPED_TRACE(entry.name);
    EngineProbe engine(entry.spec);
    if (!engine.dynamics->massless_bodies.empty()) continue;
    const State state = engine.wandered(7, 0.2);
    Equations other = engine.eq;
    other.force = random_vector(random, engine.system->nv) * engine.eq.force.norm();
    other.constraints.gamma = other.constraints.G * random_vector(random, engine.system->nv);
    for (const Formulation formulation : kFormulations) {
      SCOPED_TRACE(to_string(formulation));
      if (formulation == Formulation::kElimination && !has_regular_mass(engine)) continue;
      const auto solver = make_forward_solver(formulation, *engine.system, engine.selection);
      ForwardResult first = make_forward_result(engine.eq), again = first, resolved = first, fresh = first;
      solver->solve(engine.eq, first);
      solver->resolve(other.force, other.constraints.gamma, resolved);
      make_forward_solver(formulation, *engine.system, engine.selection)->solve(other, fresh);
      EXPECT_EQ(resolved.status, ForwardStatus::kSolved);
      EXPECT_TRUE(matrices_near(resolved.vdot, fresh.vdot, 1e-10, "vdot"));
      EXPECT_TRUE(matrices_near(resolved.lambda, fresh.lambda, 1e-9, "lambda"));
      solver->resolve(engine.eq.force, engine.eq.constraints.gamma, again);
      EXPECT_TRUE(matrices_near(again.vdot, first.vdot, 1e-12, "what was solved before"));
    }
  }
}

/// The drive of a mechanism, once prescribed with everything else following it and once as a row of the equations.
void expect_multiplier_is_the_effort(const ModelSpec& spec, double t) {
  SCOPED_TRACE(spec.name + ", drive '" + spec.drives.front().name.name + "'");
  EngineProbe engine(spec);
  PrescribedMotion motion(engine.dynamics, assemble(*engine.system).state);
  const PrescribedResult wanted = motion.solve(t);
  ASSERT_EQ(wanted.status, PrescribedStatus::kSolved) << wanted.message;
  engine.evaluate(wanted.state);
  std::vector<int> driven;
  for (int i = 0; i < engine.dynamics->nu(); ++i) driven.push_back(i);
  engine.eq = make_equations(*engine.dynamics, driven);
  compute_equations(*engine.dynamics, wanted.state, engine.eq);
  const int m = engine.system->m;
  const ExtendedSelection extended = extend_selection(engine.selection, engine.eq.constraints.G, m,
                                                      VectorXd::Ones(engine.dynamics->nu()), engine.scaling.columns);
  ASSERT_TRUE(extended.implied.empty() && extended.conflicting.empty());
  const Selection& selection = extended.selection;
  for (const Formulation formulation : kFormulations) {
    SCOPED_TRACE(to_string(formulation));
    ForwardResult result = make_forward_result(engine.eq);
    make_forward_solver(formulation, *engine.system, selection)->solve(engine.eq, result);
    ASSERT_EQ(result.status, ForwardStatus::kSolved);
    EXPECT_TRUE(matrices_near(result.vdot, wanted.vdot, kAgreement, "vdot"));
    EXPECT_TRUE(matrices_near(result.lambda.tail(engine.dynamics->nu()), wanted.u, kAgreement, "efforts"));
  }
}

TEST(ForwardTest, TheMultiplierOfAPrescribedMotionIsTheDrivesEffort) {
  expect_multiplier_is_the_effort(make_driven_four_bar(), 0.3);
  for (const auto joints : {SliderCrankJoints::kRevolutePrismatic, SliderCrankJoints::kSphericalCylindrical}) {
    expect_multiplier_is_the_effort(make_slider_crank(joints), 0.01);
  }
  // Each pin of a four-bar in turn: some are in the tree, one closes the loop.
  const ModelSpec four_bar = make_four_bar(FourBarJoints::kRevolute);
  for (const JointSpec& pin : four_bar.joints) {
    ModelSpec spec = four_bar;
    spec.drives = {coordinate_drive("motor", pin.name.name, "0.3*sin(2*t)")};
    expect_multiplier_is_the_effort(spec, 0.2);
  }
}

ModelSpec without_mass(ModelSpec spec, const std::vector<std::size_t>& bodies) {
  for (const std::size_t b : bodies) {
    BodySpec& body = spec.bodies.at(b);
    body = tensor_body(body.name.name, {0, 0, 0}, Matrix3d::Zero(), 0);
  }
  return spec;
}

TEST(ForwardTest, BodiesWithoutMassNeedOnlyMoveMassWithThem) {
  EngineProbe engine(without_mass(make_four_bar(FourBarJoints::kRevolute), {1, 2}));  // only the crank is heavy
  const State state = engine.wandered(2, 0.2);
  const ForwardResult wanted = engine.forward(state, Formulation::kNullSpace);
  ASSERT_EQ(wanted.status, ForwardStatus::kSolved);
  ASSERT_FALSE(has_regular_mass(engine));
  for (const Formulation formulation : {Formulation::kSparse, Formulation::kAugmentedLagrangian}) {
    SCOPED_TRACE(to_string(formulation));
    expect_same_results(engine, state, engine.forward(state, formulation), wanted);
  }
  EXPECT_EQ(engine.forward(state, Formulation::kElimination).status, ForwardStatus::kSingularMass);
}

TEST(ForwardTest, AMotionThatMovesNoMassIsSaid) {
  EngineProbe engine(without_mass(make_four_bar(FourBarJoints::kRevolute), {0, 1, 2}));
  const State state = engine.wandered(2, 0.2);
  for (const Formulation formulation : kFormulations) {
    EXPECT_EQ(engine.forward(state, formulation).status, ForwardStatus::kSingularMass) << to_string(formulation);
  }
}

ModelSpec point_mass_on_a_ball(const Point& at) {
  ModelSpec spec;
  spec.name = "point_mass";
  spec.gravity = number3(0, 0, -9.81);
  spec.bodies = {tensor_body("bob", at, Matrix3d::Zero(), 1.3)};
  spec.joints = {joint(JointType::kSpherical, "ball", "ground", "bob", {0, 0, 0})};
  return spec;
}

// A frame without inertia between two hinges on one line, which both turn the same body.
ModelSpec idle_frame(double inertia, double lever) {
  ModelSpec spec;
  spec.name = "idle_frame";
  spec.gravity = number3(0, -9.81, 0);
  const Point axis(0.3, 0.5, 0.8);
  spec.bodies = {tensor_body("frame", {0, 0, 0}, Matrix3d::Zero(), 0),
                 tensor_body("body", {lever, 0, 0}, inertia * Matrix3d::Identity(), 1.7)};
  spec.joints = {joint(JointType::kRevolute, "outer", "ground", "frame", {0, 0, 0}, axis),
                 joint(JointType::kRevolute, "inner", "frame", "body", {0, 0, 0}, axis)};
  return spec;
}

// Whatever rounding makes of a pivot that is zero: no value of these masses has accelerations.
TEST(ForwardTest, AMotionWithoutMassIsSaidWhateverItsRounding) {
  RandomSource random(3);
  for (int i = 0; i < 50; ++i) {
    const Point at(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
    for (const ModelSpec& spec :
         {point_mass_on_a_ball(at), idle_frame(random.between(0.001, 1), random.between(0, 1))}) {
      SCOPED_TRACE(spec.name);
      EngineProbe engine(spec);
      State state = make_drawn_state(*engine.system);
      for (double& v : state.v) v = random.between(-1, 1);
      for (const Formulation formulation : kFormulations) {
        EXPECT_EQ(engine.forward(state, formulation).status, ForwardStatus::kSingularMass) << to_string(formulation);
      }
    }
  }
}

// Nine orders of magnitude between the inertias are no singular mass: the small body alone feels the torque on it.
TEST(ForwardTest, ALightFrameIsNoFrameWithoutMass) {
  const double small = 1e-9;
  ModelSpec spec = idle_frame(1, 0);
  const Matrix3d tensor = small * Matrix3d::Identity();
  spec.bodies[0] = tensor_body("frame", {0, 0, 0}, tensor, 1);
  spec.drives = {coordinate_drive("motor", "outer", "", "2e-9")};
  EngineProbe engine(spec);
  const State state = make_drawn_state(*engine.system);
  for (const Formulation formulation : {Formulation::kNullSpace, Formulation::kElimination, Formulation::kSparse}) {
    const ForwardResult got = engine.forward(state, formulation);
    ASSERT_EQ(got.status, ForwardStatus::kSolved) << to_string(formulation);
    EXPECT_NEAR(got.vdot[0], 2, 1e-6) << to_string(formulation);
  }
}

// The drawn pose, its independent coordinates moving at unit rates.
State moving(EngineProbe& engine, const Selection& s) {
  State state = make_drawn_state(*engine.system);
  compute_kinematics(*engine.dynamics, state, engine.eq);
  const RowMatrixXd& G = engine.eq.constraints.G;
  for (const int i : s.independent) state.v[i] = 1;
  const VectorXd rates = G(s.rows, Eigen::all) * state.v;
  state.v(s.dependent) = -MatrixXd(G(s.rows, s.dependent)).partialPivLu().solve(rates);
  return state;
}

// A02 at cranks `off` from the coupler's line: the rank falls there. Rows and coordinates as chosen far away.
double pivot_near_singular_pose(Formulation formulation, int loops, double off, ForwardResult* result = nullptr) {
  const double right = std::numbers::pi / 2;
  EngineProbe healthy(make_n_four_bar(loops, right - 0.5)), engine(make_n_four_bar(loops, right - off));
  healthy.evaluate(make_drawn_state(*healthy.system));
  const auto solver = make_forward_solver(formulation, *healthy.system, healthy.selection);
  ForwardResult out = make_forward_result(healthy.eq);
  solver->solve(healthy.eq, out);
  compute_equations(*engine.dynamics, moving(engine, healthy.selection), engine.eq);
  solver->solve(engine.eq, out);
  EXPECT_EQ(out.status, ForwardStatus::kSolved);
  if (result != nullptr) *result = out;
  return solver->smallest_pivot();
}

TEST(ForwardTest, PivotsFallLinearlyTowardsASingularPose) {
  for (const Formulation formulation : kFormulations) {
    SCOPED_TRACE(to_string(formulation));
    for (const int loops : {1, 2, 5}) {
      const double reference = pivot_near_singular_pose(formulation, loops, 1e-2) / 1e-2;
      EXPECT_GT(reference, 0.01);
      for (const double off : {1e-3, -1e-3}) {
        EXPECT_NEAR(pivot_near_singular_pose(formulation, loops, off) / std::abs(off) / reference, 1, 0.05) << off;
      }
      if (formulation == Formulation::kAugmentedLagrangian) continue;  // tells no pivot below 3e-5
      for (const double off : {1e-5, 1e-7}) {
        EXPECT_NEAR(pivot_near_singular_pose(formulation, loops, off) / off / reference, 1, 0.05) << off;
      }
    }
  }
}

// A parallelogram's couplers do not turn: v_d = v known, so accelerations are known on the branch, however close.
TEST(ForwardTest, AccelerationsNearASingularPoseLoseNoMoreThanTheDistance) {
  for (const double off : {1e-2, 1e-4, 1e-6}) {
    ForwardResult wanted, got;
    pivot_near_singular_pose(Formulation::kNullSpace, 3, off, &wanted);
    pivot_near_singular_pose(Formulation::kSparse, 3, off, &got);
    EXPECT_TRUE(matrices_near(got.vdot, wanted.vdot, 1e-13 / off, "sparse"));
    if (off < 1e-4) continue;  // squared condition
    pivot_near_singular_pose(Formulation::kElimination, 3, off, &got);
    EXPECT_TRUE(matrices_near(got.vdot, wanted.vdot, 1e-13 / (off * off), "elimination"));
  }
}

}  // namespace
}  // namespace ferrers::witness
