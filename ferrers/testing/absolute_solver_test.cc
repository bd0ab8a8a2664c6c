#include "ferrers/testing/absolute_solver.h"

#include <gtest/gtest.h>

#include <cmath>

#include "ferrers/testing/compare.h"
#include "ferrers/testing/finite_difference.h"
#include "ferrers/testing/random_mechanism.h"
#include "ferrers/testing/zoo.h"

namespace ferrers::witness {
namespace {

Model built(const ModelSpec& spec) { return build_model(spec).model.value(); }

double spin_z(const Model& model, const AbsoluteMotion& motion, const std::string& body) {
  return motion.accelerations[model.find_body(body)->index()].z();
}

/// Multipliers of one joint as moment and force on its second body about its drawn point.
Vector6d reaction(const Model& model, const AbsoluteState& state, const AbsoluteMotion& motion,
                  const std::string& name) {
  const JointId id = *model.find_joint(name);
  const Joint& joint = model.joint(id);
  const int first = motion.constraints.first_row[id.index()], next = motion.constraints.first_row[id.index() + 1];
  const Vector3d at = state.poses[joint.first.index()] * joint.X_1F.p;
  return joint_reaction(model, state.poses, id, motion.lambda.segment(first, next - first), at);
}

/// Velocities of a mechanism of mobility 1 whose body `name` turns at `speed` about z.
AbsoluteState turning(const Model& model, const std::string& name, double speed) {
  AbsoluteState state = drawn_state(model);
  const Eigen::MatrixXd N = admissible_twists(model, state.poses);
  const int at = 6 * (model.find_body(name)->index() - 1);
  const Eigen::VectorXd V = N.col(0) * (speed / N(at + 2, 0));
  for (std::size_t i = 1; i < state.twists.size(); ++i) state.twists[i] = V.segment<6>(6 * (static_cast<long>(i) - 1));
  return state;
}

// Closed form: a thin-rod Bricard loop released from the cube starts at 0.2 g; bricks of 0.1 m a little slower.
TEST(AbsoluteSolverTest, TheBricardLoopStartsAsPublished) {
  for (const auto& [rods, wanted] : {std::pair{BricardRods::kThin, 1.962}, {BricardRods::kBricks, 1.958083832335}}) {
    const Model model = built(make_bricard(rods));
    const AbsoluteState state = drawn_state(model);
    const AbsoluteMotion motion = solve_absolute(model, state, applied_wrenches(model, state, 0));
    EXPECT_NEAR(std::abs(motion.accelerations[1].y()), wanted, 1e-11);
  }
}

// Published consistent start of the IVP test set.
TEST(AbsoluteSolverTest, AndrewsMechanismStartsAsPublished) {
  const Model model = built(make_andrews());
  const AbsoluteState state = drawn_state(model);
  const AbsoluteMotion motion = solve_absolute(model, state, applied_wrenches(model, state, 0));
  const double beta = spin_z(model, motion, "K1");
  EXPECT_NEAR(beta, 14222.4439199541, 1e-6);
  EXPECT_NEAR(spin_z(model, motion, "K2") - beta, -10666.8329399655, 1e-6);
}

// Closed form of the parallelogram branch: θ'' = (G/I) sin θ with I = (N+1)/3 + N and G = ((N+1)/2 + N) g.
TEST(AbsoluteSolverTest, NFourBarsAccelerateLikeOnePendulum) {
  for (const int n : {1, 2, 4}) {
    const Model model = built(make_n_four_bar(n, 0.4));
    const AbsoluteState state = drawn_state(model);
    const AbsoluteMotion motion = solve_absolute(model, state, applied_wrenches(model, state, 0));
    const double inertia = (n + 1) / 3.0 + n, weight = ((n + 1) / 2.0 + n) * 9.81;
    EXPECT_NEAR(-spin_z(model, motion, "crank0"), weight / inertia * std::sin(0.4), 1e-10) << n;
  }
}

// Closed form of planar inverse dynamics.
TEST(AbsoluteSolverTest, ADrivenFourBarNeedsTheKnownTorque) {
  const Model model = built(make_driven_four_bar());
  const AbsoluteState state = drawn_state(model);
  const AppliedForcesOptions no_drives{.drive_efforts = false};
  const AbsoluteMotion motion = solve_absolute(model, state, applied_wrenches(model, state, 0, no_drives), 0.0);
  EXPECT_NEAR(motion.lambda[motion.lambda.size() - 1], 66.01166666667, 1e-9);
  const Vector6d at_o = reaction(model, state, motion, "O"), at_b = reaction(model, state, motion, "B");
  EXPECT_NEAR(at_o[3], 1.06666667, 1e-7);
  EXPECT_NEAR(at_o[4], 71.7166667, 1e-7);
  EXPECT_NEAR(at_b[3], 8.53333333, 1e-7);
  EXPECT_NEAR(at_b[4], 18.5533333, 1e-7);
}

// Closed form at 45 degrees and 30 rad/s; the redundant R-R-R-P and the determinate R-S-R-C agree on it.
TEST(AbsoluteSolverTest, ASliderCrankNeedsTheKnownTorqueWithAnyJoints) {
  for (const auto joints : {SliderCrankJoints::kRevolutePrismatic, SliderCrankJoints::kSphericalCylindrical}) {
    const Model model = built(make_slider_crank(joints));
    const AbsoluteState state = turning(model, "crank", 30);
    const AppliedForcesOptions no_drives{.drive_efforts = false};
    const AbsoluteMotion motion = solve_absolute(model, state, applied_wrenches(model, state, 0, no_drives), 0.0);
    EXPECT_NEAR(motion.lambda[motion.lambda.size() - 1], 143.880961235, 1e-8);
    const Vector6d at_o = reaction(model, state, motion, "O"), at_a = reaction(model, state, motion, "A");
    EXPECT_NEAR(at_o[3], -1036.18413621, 1e-7);
    EXPECT_NEAR(at_o[4], -8.98210247838, 1e-8);
    EXPECT_NEAR(at_a[3], -908.904915592, 1e-7);
    EXPECT_NEAR(at_a[4], 98.6771181352, 1e-8);
    EXPECT_NEAR(reaction(model, state, motion, "guide")[4], -220.925949056, 1e-8);
  }
}

// Exact: elliptic functions give P(1).
TEST(AbsoluteSolverTest, StepsConvergeToTheExactPendulumWithOrderFour) {
  const Model model = built(make_pendulum());
  const auto error = [&](int steps) {
    AbsoluteState state = drawn_state(model);
    for (int i = 0; i < steps; ++i) state = step_absolute(model, state, i / static_cast<double>(steps), 1.0 / steps);
    return (state.poses[1] * Vector3d(1, 0, 0) - Vector3d(-0.9862917511318753, -0.1650108531255412, 0)).norm();
  };
  const double coarse = error(50), fine = error(100);
  EXPECT_LT(fine, 1e-6);
  EXPECT_NEAR(observed_order(coarse, fine), 4, 0.4);
}

TEST(AbsoluteSolverTest, AnUndampedMechanismKeepsItsEnergy) {
  const Model model = built(make_bricard(BricardRods::kBricks));
  AbsoluteState state = drawn_state(model);
  const double start = total_energy(model, state);
  for (int i = 0; i < 50; ++i) state = step_absolute(model, state, 0.01 * i, 0.01);
  EXPECT_NEAR(total_energy(model, state), start, 1e-7);
  EXPECT_GT(state.twists[1].norm(), 0.1);
  // Published position of P3 at t = 0.5.
  const Vector3d P3 = state.poses[model.find_body("rod2")->index()] * Vector3d(1, -1, 0);
  EXPECT_NEAR((P3 - Vector3d(0.774717808039, -0.979815047656, -0.199906158953)).norm(), 0, 1e-7);
}

class RandomRowsTest : public ::testing::TestWithParam<int> {};

TEST_P(RandomRowsTest, RowsAreTheDerivativesOfTheResiduals) {
  const RandomMechanism mechanism = make_random_mechanism(GetParam());
  const Model model = built(mechanism.spec);
  const AbsoluteState state = wandered(model, GetParam());
  const AbsoluteConstraints c = absolute_constraints(model, state);
  const auto residual = [&](const Eigen::VectorXd& d) {
    return absolute_residual(model, displaced(model, state.poses, d));
  };
  const Eigen::MatrixXd G = difference_jacobian(residual, Eigen::VectorXd::Zero(c.G.cols()), 1e-3);
  EXPECT_TRUE(matrices_near(c.G, G, 1e-9, mechanism.description));
}

TEST_P(RandomRowsTest, GammaIsTheDriftOfTheRowsAlongTheMotion) {
  const RandomMechanism mechanism = make_random_mechanism(GetParam());
  const Model model = built(mechanism.spec);
  const AbsoluteState state = wandered(model, GetParam());
  Eigen::VectorXd V(6 * (static_cast<long>(state.twists.size()) - 1));
  for (long i = 0; i < V.size() / 6; ++i) V.segment<6>(6 * i) = state.twists[i + 1];
  const auto rows = [&](double t) {
    const AbsoluteState moved{displaced(model, state.poses, t * V), state.twists};
    return Eigen::VectorXd(absolute_constraints(model, moved).G * V);
  };
  const AbsoluteConstraints c = absolute_constraints(model, state);
  EXPECT_TRUE(matrices_near(c.gamma, -differentiate(rows, 0.0, 1e-3), 1e-8, mechanism.description));
  EXPECT_LT((c.G * V).norm(), 1e-10 * (1 + V.norm()));
}

TEST_P(RandomRowsTest, AccelerationsSatisfyEquationsOfMotionAndConstraints) {
  const RandomMechanism mechanism = make_random_mechanism(GetParam());
  const Model model = built(mechanism.spec);
  const AbsoluteState state = wandered(model, GetParam());
  const std::vector<Vector6d> wrenches = applied_wrenches(model, state, 0);
  const AbsoluteMotion motion = solve_absolute(model, state, wrenches);
  EXPECT_LT(motion.inconsistency, 1e-9) << mechanism.description;
  EXPECT_TRUE(motion.inertia_regular);
  const Eigen::MatrixXd M = absolute_mass_matrix(model, state.poses);
  const Eigen::VectorXd reactions = motion.constraints.G.transpose() * motion.lambda;
  for (std::size_t i = 1; i < wrenches.size(); ++i) {
    const long at = 6 * (static_cast<long>(i) - 1);
    const Vector3d w = state.twists[i].head<3>();
    Vector6d balance = M.block<6, 6>(at, at) * motion.accelerations[i] - wrenches[i] - reactions.segment<6>(at);
    balance.head<3>() += w.cross(Vector3d(M.block<3, 3>(at, at) * w));
    EXPECT_LT(balance.norm(), 1e-8 * (1 + reactions.norm())) << mechanism.description;
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomRowsTest, ::testing::Range(0, 25));

}  // namespace
}  // namespace ferrers::witness
