#include "ferrers/dynamics/reactions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "ferrers/dynamics/forward_dynamics.h"
#include "ferrers/testing/compare.h"
#include "ferrers/testing/elastic_joints.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/random_mechanism.h"
#include "ferrers/testing/transforms.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {
namespace {

constexpr ReactionStatus kUnique = ReactionStatus::kUnique, kUndetermined = ReactionStatus::kUndetermined;

/// force_x … moment_z, all unique.
void expect_reaction(const JointReaction& r, const std::array<double, 6>& wanted, double tolerance) {
  for (int k = 0; k < 6; ++k) {
    EXPECT_EQ(r.status[k], kUnique) << kComponentNames[k];
    EXPECT_NEAR(r.value[k], wanted[k], tolerance) << kComponentNames[k];
  }
}

// Closed form: the pivot gives the bob m (a − g), where a = −ω² e_r − g cos φ e_φ for the angle φ from the horizontal.
TEST(ReactionsTest, ThePivotOfAPendulumCarriesItsWeightAndPull) {
  EngineProbe engine(make_pendulum());
  State state = make_drawn_state(*engine.system);
  const double phi = 0.6, w = 2, g = 9.81;
  state.q[0] = phi;
  state.v[0] = w;
  const ForwardResult result = engine.forward(state);
  EXPECT_NEAR(result.vdot[0], -g * std::cos(phi), 1e-14);
  const double along = -w * w, across = -g * std::cos(phi);
  const double a_x = along * std::cos(phi) - across * std::sin(phi);
  const double a_y = along * std::sin(phi) + across * std::cos(phi);
  expect_reaction(engine.reactions(state, result)[0], {a_x, a_y + g, 0, 0, 0, 0}, 1e-13);
  // The joint's frame stays with ground: same components here, since its z and the world's agree up to the x axis.
  const JointReaction own = engine.reactions(state, result, ReactionAxes::kJoint)[0];
  EXPECT_NEAR(std::hypot(own.value[0], own.value[1]), std::hypot(a_x, a_y + g), 1e-13);
}

// Closed form: the spherical hinge takes the weight m g, and both the couple force H = m g b / h.
TEST(ReactionsTest, ADeterminateDoorLoadsItsHingesByTheLever) {
  ModelSpec spec = make_door(2);
  spec.joints = {joint(JointType::kSpherical, "lower", "ground", "door", {0, 0, 0}),
                 joint(JointType::kPointOnLine, "upper", "ground", "door", {0, 0, 1.7})};
  EngineProbe engine(spec);
  const State state = make_drawn_state(*engine.system);
  const ForwardResult result = engine.forward(state);
  EXPECT_LT(result.vdot.norm(), 1e-12);
  const auto reactions = engine.reactions(state, result);
  constexpr double kCouple = 51.935294118, kWeight = 196.2;
  expect_reaction(reactions[0], {kCouple, 0, kWeight, 0, 0, 0}, 1e-9);
  expect_reaction(reactions[1], {-kCouple, 0, 0, 0, 0, 0}, 1e-9);
}

// Every hinge alone would do: nothing but the moment about the hinge line, which no hinge carries, is determined.
TEST(ReactionsTest, ADoorOnTwoFullHingesSharesItsLoadInNoKnownWay) {
  EngineProbe engine(make_door(2));
  const State state = make_drawn_state(*engine.system);
  for (const JointReaction& r : engine.reactions(state, engine.forward(state))) {
    for (int k = 0; k < 5; ++k) EXPECT_EQ(r.status[k], kUndetermined) << kComponentNames[k];
    EXPECT_EQ(r.status[5], kUnique);
    EXPECT_NEAR(r.value[5], 0, 1e-12);
  }
}

TEST(ReactionsTest, APlanarLoopLeavesItsOutOfPlaneLoadsUndetermined) {
  EngineProbe engine(make_four_bar(FourBarJoints::kRevolute));
  const State state = engine.wandered(3);
  const std::array<ReactionStatus, 6> wanted = {kUnique, kUnique, kUndetermined, kUndetermined, kUndetermined, kUnique};
  for (const JointReaction& r : engine.reactions(state, engine.forward(state))) EXPECT_EQ(r.status, wanted);
}

/// With spherical and cylindrical joints everything is determined, and the in-plane forces are the same.
TEST(ReactionsTest, DeterminateAndRedundantFourBarsShareTheirInPlaneForces) {
  EngineProbe redundant(make_four_bar(FourBarJoints::kRevolute));
  EngineProbe determinate(make_four_bar(FourBarJoints::kSphericalCylindrical));
  const State state = redundant.wandered(5);
  const State same = tree_state(*determinate.system, absolute_state(*redundant.system, state));
  const auto a = redundant.reactions(state, redundant.forward(state));
  const auto b = determinate.reactions(same, determinate.forward(same));
  for (std::size_t j = 0; j < a.size(); ++j) {
    for (int k = 0; k < 6; ++k) EXPECT_EQ(b[j].status[k], kUnique) << j << kComponentNames[k];
    for (const int k : {0, 1}) EXPECT_NEAR(a[j].value[k], b[j].value[k], 1e-10) << j << kComponentNames[k];
  }
}

// Effort, spring and damping in a joint are not part of its reaction: along the freedom it stays zero.
TEST(ReactionsTest, DriveAndSpringEffortsAreNotReactions) {
  ModelSpec spec = make_pendulum();
  spec.drives = {coordinate_drive("motor", "pivot", "", "9.81 + 5")};
  TorsionSpringSpec spring;
  spring.coordinate = {NameRef("pivot"), ""};
  spring.stiffness = Number(5);
  spring.free_angle = Number(1);  // gives +5 at angle 0
  ForceSpec force;
  force.name = "spring";
  force.element = spring;
  spec.forces = {force};
  EngineProbe engine(spec);
  const State state = make_drawn_state(*engine.system);
  const ForwardResult result = engine.forward(state);
  EXPECT_NEAR(result.vdot[0], 10, 1e-13);
  expect_reaction(engine.reactions(state, result)[0], {0, 9.81 + 10, 0, 0, 0, 0}, 1e-13);
}

/// The joints' reactions at a state by the options given.
std::vector<JointReaction> solve(EngineProbe& engine, const State& state, const DistributionOptions& options,
                                 DistributionOutcome* outcome = nullptr, ReactionAxes axes = ReactionAxes::kWorld) {
  const ForwardResult result = engine.forward(state);
  std::vector<JointReaction> all =
      ReactionSolver(engine.dynamics, options)
          .solve(state, engine.eq, engine.selection, result.vdot, result.lambda, engine.eq.u, axes, outcome);
  all.resize(engine.model().coordinates_begin());  // without multipliers of couplings
  return all;
}

constexpr double kRadial = 2e6, kAxial = 1e6, kBend = 4e4;

ModelSpec make_elastic_door() {
  ModelSpec spec = make_door(2);
  for (JointSpec& hinge : spec.joints) {
    set_stiffness(hinge, number3(kRadial, kRadial, kAxial), number3(kBend, kBend, kBend));
  }
  return spec;
}

// Closed form: the couple m g b is shared by the radial pair, of rotational stiffness k_t h²/2, and both hinges' own
// 2 k_r; the weight goes half to each hinge.
TEST(ReactionsTest, ElasticHingesShareADoorByTheirStiffness) {
  EngineProbe engine(make_elastic_door());
  const State state = make_drawn_state(*engine.system);
  const double weight = 20 * 9.81, b = 0.45, h = 1.7;
  const double pair = 0.5 * kRadial * h * h;
  const double couple = weight * b / h * pair / (pair + 2 * kBend);
  const double moment = 0.5 * (weight * b - couple * h);
  const auto reactions = engine.reactions(state, engine.forward(state));
  const double wanted[2][6] = {{couple, 0, weight / 2, 0, -moment, 0}, {-couple, 0, weight / 2, 0, -moment, 0}};
  for (int j = 0; j < 2; ++j) {
    for (int k = 0; k < 6; ++k) {
      EXPECT_NEAR(reactions[j].value[k], wanted[j][k], 1e-10 * std::max(1.0, std::abs(wanted[j][k]))) << j << k;
      EXPECT_EQ(reactions[j].status[k], k == 5 ? kUnique : ReactionStatus::kDistributed);
    }
  }
}

// Closed form: a rigid beam on n equal springs carries a load P at x_P as P/n and by its moment about the middle.
TEST(ReactionsTest, ABeamOnEqualSprings) {
  const std::vector<double> places = {0, 0.4, 1.1, 1.5, 2.3};
  const double x_P = 0.7, mass = 12, P = mass * 9.81;
  ModelSpec spec;
  spec.bodies = {box_body("beam", {x_P, 0, 0}, {2.5, 0.1, 0.1}, mass)};
  spec.joints = {joint(JointType::kPlanar, "guide", "ground", "beam", {0, 0, 0}, {0, 1, 0})};
  for (std::size_t i = 0; i < places.size(); ++i) {
    spec.joints.push_back(joint(JointType::kPointOnPlane, numbered("support", static_cast<int>(i)), "ground", "beam",
                                {places[i], 0, 0}, {0, 0, 1}));
    set_stiffness(spec.joints.back(), 3e5, kRigid);
  }
  EngineProbe engine(spec);
  const State state = make_drawn_state(*engine.system);
  const auto reactions = engine.reactions(state, engine.forward(state));
  double middle = 0, square = 0;
  for (const double x : places) middle += x / 5;
  for (const double x : places) square += (x - middle) * (x - middle);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double wanted = P * (0.2 + (places[i] - middle) * (x_P - middle) / square);
    EXPECT_EQ(reactions[i + 1].status[2], ReactionStatus::kDistributed);
    EXPECT_NEAR(reactions[i + 1].value[2] / wanted, 1, 1e-10) << i;
    EXPECT_EQ(reactions[i + 1].status[0], kUnique) << "the plane holds no force along it";
  }
  for (int k = 0; k < 6; ++k) EXPECT_EQ(reactions[0].status[k], kUnique) << kComponentNames[k];
}

TEST(ReactionsTest, StiffnessIsUsedOnlyWhereItIsWanted) {
  EngineProbe engine(make_elastic_door());
  const State state = make_drawn_state(*engine.system);
  DistributionOptions options;
  options.by = DistributionBy::kNothing;
  DistributionOutcome outcome;
  for (const JointReaction& r : solve(engine, state, options, &outcome)) EXPECT_EQ(r.status[0], kUndetermined);
  EXPECT_FALSE(outcome.used);
  options.by = DistributionBy::kEqualStiffness;
  const auto equal = solve(engine, state, options, &outcome);
  EXPECT_TRUE(outcome.used);
  // k for forces and k L² for moments, L the spacing of the hinges: the pair turns with k h²/2, the hinges with 2 k h².
  EXPECT_NEAR(equal[0].value[0] / (20 * 9.81 * 0.45 / 1.7 * 0.5 / 2.5), 1, 1e-10);
}

TEST(ReactionsTest, MisalignmentLoadsElasticJointsAndContradictsRigidOnes) {
  ModelSpec spec = make_elastic_door();
  const State none = make_drawn_state(*EngineProbe(spec).system);
  EngineProbe straight(spec);
  set_misalignment(spec.joints[1], number3(0, 0, 1e-4), number3(0, 0, 0));
  EngineProbe off(spec);
  const auto before = solve(straight, none, {}), after = solve(off, none, {});
  EXPECT_NEAR(after[1].value[2] - before[1].value[2], -0.5 * kAxial * 1e-4, 1e-9);
  EXPECT_NEAR(after[0].value[2] - before[0].value[2], 0.5 * kAxial * 1e-4, 1e-9);
  for (JointSpec& hinge : spec.joints) hinge.stiffness.reset();
  EngineProbe rigid(spec);
  DistributionOutcome outcome;
  const auto reactions = solve(rigid, none, {}, &outcome);
  EXPECT_EQ(outcome.contradictory, (std::vector<std::string>{"hinge1", "hinge2"}));
  for (int k = 0; k < 5; ++k) EXPECT_EQ(reactions[0].status[k], kUndetermined);
}

TEST(ReactionsTest, StiffnessOfAnyOneBricardJointDeterminesAllReactions) {
  for (std::size_t j = 0; j < 6; ++j) {
    ModelSpec spec = make_bricard(BricardRods::kBricks);
    set_stiffness(spec.joints[j], 1e6, 1e4);
    EngineProbe engine(spec);
    const State state = engine.wandered(2);
    for (const JointReaction& r : engine.reactions(state, engine.forward(state))) {
      for (int k = 0; k < 6; ++k) EXPECT_NE(r.status[k], kUndetermined) << j << kComponentNames[k];
    }
  }
}

/// Force and moment of every joint, world axes; empty where some are undetermined.
MatrixXd wrenches(EngineProbe& engine, const DistributionOptions& options) {
  const auto reactions = solve(engine, make_drawn_state(*engine.system), options);
  MatrixXd out(6, static_cast<long>(reactions.size()));
  for (std::size_t j = 0; j < reactions.size(); ++j) {
    for (int k = 0; k < 6; ++k) {
      if (reactions[j].status[k] == kUndetermined) return {};
      out(k, static_cast<long>(j)) = reactions[j].value[k];
    }
  }
  return out;
}

/// The same mechanism turned, in other units of length, cut elsewhere and in another order gives the same wrenches.
void expect_same_however_described(const ModelSpec& spec, const DistributionOptions& options, const MatrixXd& wanted,
                                   std::uint64_t seed) {
  const Matrix3d R = RandomSource(seed).rotation();
  EngineProbe turned(rotated(spec, R));
  MatrixXd got = wrenches(turned, options);
  ASSERT_EQ(got.cols(), wanted.cols());
  got.topRows<3>() = (R.transpose() * got.topRows<3>()).eval();
  got.bottomRows<3>() = (R.transpose() * got.bottomRows<3>()).eval();
  EXPECT_TRUE(matrices_near(got, wanted, 1e-9, "turned"));

  EngineProbe small(scaled(spec, 1e-3));
  got = wrenches(small, options);
  ASSERT_EQ(got.cols(), wanted.cols());
  got.topRows<3>() *= 1e3;
  got.bottomRows<3>() *= 1e6;
  EXPECT_TRUE(matrices_near(got, wanted, 1e-9, "scaled"));

  TopologyOptions choice;
  choice.cut.assign(spec.joints.size(), false);
  choice.cut[seed % spec.joints.size()] = true;
  EngineProbe other(spec, choice);
  EXPECT_TRUE(matrices_near(wrenches(other, options), wanted, 1e-9, "cut elsewhere"));

  EngineProbe mixed(permuted(spec, seed));
  const MatrixXd shuffled = wrenches(mixed, options);
  ASSERT_EQ(shuffled.cols(), wanted.cols());
  for (std::size_t j = 0; j < spec.joints.size(); ++j) {
    const auto there = static_cast<long>(mixed.model().find_joint(spec.joints[j].name.name)->index());
    EXPECT_TRUE(matrices_near(shuffled.col(there), wanted.col(static_cast<long>(j)), 1e-9, "reordered"));
  }
}

TEST(ReactionsTest, DistributedReactionsAreTheSameHoweverTheMechanismIsDescribed) {
  int divided = 0;
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    const RandomMechanism mechanism = make_random_mechanism(seed);
    ModelSpec spec = mechanism.spec;
    set_random_stiffness(spec, seed, 3, 7);
    SCOPED_TRACE(mechanism.description + ", seed " + std::to_string(seed));
    DistributionOptions options;
    options.by = seed % 2 == 0 ? DistributionBy::kJointStiffness : DistributionBy::kEqualStiffness;
    EngineProbe engine(spec);
    const MatrixXd wanted = wrenches(engine, options);
    if (wanted.cols() == 0) continue;  // couplings beside meshes stay rigid
    if (mechanism.verdict.redundant > 0) ++divided;
    expect_same_however_described(spec, options, wanted, seed);
  }
  EXPECT_GE(divided, 40);
}

TEST(ReactionsTest, RangesHoldTheValueAndAreTheValueWhereItIsUnique) {
  ModelSpec spec = make_four_bar(FourBarJoints::kRevolute);
  spec.gravity = number3(1, -9.81, 6);
  set_random_stiffness(spec, 2, 3, 6);
  EngineProbe engine(spec);
  const State state = engine.wandered(4);
  DistributionOptions options;
  options.range = StiffnessRange{0.5, 2};
  DistributionOutcome outcome;
  int wide = 0;
  for (const JointReaction& r : solve(engine, state, options, &outcome)) {
    for (int k = 0; k < 6; ++k) {
      EXPECT_LE(r.low[k], r.value[k] + 1e-9);
      EXPECT_GE(r.high[k], r.value[k] - 1e-9);
      if (r.status[k] == kUnique) {
        EXPECT_EQ(r.high[k], r.low[k]);
      }
      if (r.high[k] - r.low[k] > 1e-3 * std::abs(r.value[k])) ++wide;
    }
  }
  EXPECT_EQ(outcome.bounds, BoundsMethod::kExact);
  EXPECT_GE(wide, 8);
}

TEST(ReactionsTest, WrongSizesAreACallersBug) {
  EngineProbe engine(make_pendulum());
  const State state = make_drawn_state(*engine.system);
  ForwardResult result = engine.forward(state);
  result.vdot.resize(2);
  EXPECT_THROW(engine.reactions(state, result), std::invalid_argument);
}

TEST(ReactionsTest, StatusesHaveNames) {
  EXPECT_EQ(to_string(ReactionStatus::kUnique), "unique");
  EXPECT_EQ(to_string(ReactionStatus::kDistributed), "distributed");
  EXPECT_EQ(to_string(ReactionStatus::kUndetermined), "undetermined");
}

// Long mechanisms keep their self-stresses with the zeros left out. Both ways give the same reactions and verdicts.
TEST(ReactionsTest, SelfStressesWithoutTheirZerosJudgeAsDenseOnesDo) {
  std::vector<ModelSpec> specs = {make_n_four_bar(60, 0.3)};
  for (const ZooEntry& entry : zoo()) specs.push_back(entry.spec);
  int undetermined = 0, isostatic = 0;
  for (const ModelSpec& spec : specs) {
    const std::string& name = spec.name;
    EngineProbe engine(spec);
    if (!engine.dynamics->massless_bodies.empty()) continue;
    const State state = engine.start();
    engine.evaluate(state);
    const ForwardResult result = engine.forward(state, Formulation::kSparse);
    if (result.status != ForwardStatus::kSolved) continue;
    const VectorXd u = engine.eq.u, lambda = result.lambda.head(engine.system->m);
    const auto solve = [&](int largest_dense) {
      return ReactionSolver(engine.dynamics, {}, largest_dense)
          .solve(state, engine.eq, engine.selection, result.vdot, lambda, u);
    };
    const std::vector<JointReaction> dense = solve(std::numeric_limits<int>::max()), sparse = solve(-1);
    ASSERT_EQ(dense.size(), sparse.size());
    for (std::size_t j = 0; j < dense.size(); ++j) {
      for (int k = 0; k < dense[j].components; ++k) {
        EXPECT_EQ(dense[j].status[k], sparse[j].status[k]) << name << ", joint " << j << ", " << kComponentNames[k];
        EXPECT_EQ(dense[j].value[k], sparse[j].value[k]) << name << ", joint " << j;
        undetermined += dense[j].status[k] == kUndetermined ? 1 : 0;
      }
    }
    isostatic += static_cast<int>(engine.selection.rows.size()) == engine.system->m ? 1 : 0;
  }
  EXPECT_GT(undetermined, 100);
  EXPECT_GT(isostatic, 3) << "no self-stress at all is a case of its own";
}

TEST(ReactionsTest, MoreSelfStressesThanStiffnessCanDivideAreToldAndNothingIsDivided) {
  EngineProbe engine(make_n_four_bar(510, 0.3));
  const State state = make_drawn_state(*engine.system);
  const ForwardDynamics dynamics(engine.dynamics, state);
  compute_equations(*engine.dynamics, state, engine.eq);
  const ReactionSolver solver(engine.dynamics, {.by = DistributionBy::kEqualStiffness, .range = {}});
  DistributionOutcome outcome;
  const std::vector<JointReaction> reactions =
      solver.solve(state, engine.eq, dynamics.selection(), dynamics.result().vdot,
                   dynamics.result().lambda.head(engine.system->m), VectorXd(0), ReactionAxes::kWorld, &outcome);
  EXPECT_EQ(outcome.too_many, 3 * 510);
  EXPECT_FALSE(outcome.used);
  for (const JointReaction& one : reactions) {
    for (const ReactionStatus status : one.status) EXPECT_NE(status, ReactionStatus::kDistributed);
  }
}

}  // namespace
}  // namespace ferrers::witness
