#include "ferrers/kinematics/assembly.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "ferrers/kinematics/coordinates.h"
#include "ferrers/testing/absolute_solver.h"
#include "ferrers/testing/compare.h"
#include "ferrers/testing/random_mechanism.h"
#include "ferrers/testing/random_source.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers {
namespace {

using witness::joint;
using witness::numbered;
using witness::numbers;
using witness::Point;
using witness::RandomSource;

std::shared_ptr<const System> built(const ModelSpec& spec, const std::vector<bool>& cut = {}) {
  const ModelBuildResult result = build_model(spec);
  for (const Diagnostic& d : result.diagnostics.items()) {
    if (d.severity == Severity::kError) ADD_FAILURE() << spec.name << ": " << d.code << " " << d.message;
  }
  return make_system(result.model.value(), {.cut = cut});
}

std::vector<Pose> poses_at(const System& system, const State& state) {
  PositionKinematics pos = make_position_kinematics(system);
  compute_positions(system, state.q, pos);
  std::vector<Pose> poses;
  for (std::size_t b = 0; b < system.model->bodies().size(); ++b) poses.push_back(body_pose(system, pos, BodyId(b)));
  return poses;
}

/// Closed by the witness' own rows, every joint the right way round.
void expect_closed(const System& system, const AssemblyResult& result, const std::string& what = "") {
  EXPECT_EQ(result.status, AssemblyStatus::kAssembled) << what << " " << result.message;
  EXPECT_LE(result.residual, closed_tolerance(system.scaling)) << what;
  EXPECT_TRUE(result.message.empty());
  EXPECT_TRUE(result.open_joints.empty());
  EXPECT_LT(witness::absolute_residual(*system.model, poses_at(system, result.state)).norm(), 1e-9) << what;
  EXPECT_EQ(result.state.v.norm(), 0);
}

double position_of(const System& system, const State& state, const std::string& name, int index = 0) {
  PositionKinematics pos = make_position_kinematics(system);
  compute_positions(system, state.q, pos);
  const CoordinateAccess access = system.access({*system.model->find_joint(name), index});
  return measure_coordinate(system, access, state, pos, make_velocity_kinematics(system)).value;
}

PoseSpec pose_spec(const Eigen::Matrix3d& R, const Point& p) {
  PoseSpec pose;
  pose.position = numbers(p);
  const Eigen::Quaterniond u(R);
  RotationSpec rotation;
  rotation.quaternion = std::array<Number, 4>{Number(u.w()), Number(u.x()), Number(u.y()), Number(u.z())};
  pose.rotation = rotation;
  return pose;
}

/// The same mechanism (without masses) described body by body in frames of their own, each body's `pose` wrong by up to
/// `error` (m, and about rad): a guess that no loop closes at.
ModelSpec body_fixed(ModelSpec spec, double error, std::uint64_t seed) {
  RandomSource random(seed);
  std::vector<std::pair<std::string, Pose>> frames = {{"ground", Pose()}};
  for (BodySpec& body : spec.bodies) {
    const Pose truth(random.rotation(), random.vector(1));
    frames.push_back({body.name.name, truth});
    body = BodySpec();
    body.name = frames.back().first;
    const Eigen::Matrix3d turned = quaternion_exp(random.vector(error)).toRotationMatrix() * truth.R;
    body.pose = pose_spec(turned, truth.p + random.vector(error));
  }
  const auto local = [&](const std::string& body, const Number3& drawn, bool direction) {
    const auto frame = std::find_if(frames.begin(), frames.end(), [&](const auto& f) { return f.first == body; });
    const Point x = witness::values(drawn);
    return numbers(direction ? Point(frame->second.R.transpose() * x) : frame->second.inverse() * x);
  };
  for (JointSpec& j : spec.joints) {
    for (const auto& [place, direction] : {std::pair{&j.place, false}, {&j.axis, true}}) {
      if (!place->drawn) continue;
      for (const NameRef& body : j.bodies) {
        place->on_body.push_back({body, local(body.name, *place->drawn, direction)});
      }
      place->drawn.reset();
    }
  }
  spec.forces.clear();
  spec.drives.clear();
  spec.initial.clear();
  spec.records.clear();
  return spec;
}

TEST(AssemblyTest, DrawnMechanismsAreAssembledAsDrawn) {
  for (const witness::ZooEntry& entry : witness::zoo()) {
    const auto system = built(entry.spec);
    const AssemblyResult result = assemble(*system);
    expect_closed(*system, result, entry.name);
    EXPECT_LT((result.state.q - make_drawn_state(*system).q).norm(), 1e-12) << entry.name;
  }
}

TEST(AssemblyTest, BodiesDescribedByThemselvesComeTogetherFromWrongPoses) {
  const ModelSpec specs[] = {witness::make_four_bar(witness::FourBarJoints::kRevolute),
                             witness::make_four_bar(witness::FourBarJoints::kSphericalCylindrical),
                             witness::make_parallel_cranks(),
                             witness::make_bricard(witness::BricardRods::kBricks),
                             witness::make_bennett(),
                             witness::make_sarrus(0.7),
                             witness::make_n_four_bar(2, 0.4),
                             witness::make_door(3)};
  for (const ModelSpec& spec : specs) {
    for (int seed = 0; seed < 4; ++seed) {
      const auto system = built(body_fixed(spec, 0.1, seed));
      expect_closed(*system, assemble(*system), spec.name + numbered(" seed ", seed));
    }
  }
}

TEST(AssemblyTest, RandomMechanismsCloseFromDisturbedCoordinates) {
  int redundant = 0;
  for (int seed = 0; seed < 60; ++seed) {
    const witness::RandomMechanism mechanism = witness::make_random_mechanism(seed);
    const auto system = built(mechanism.spec);
    redundant += mechanism.verdict.redundant > 0;
    RandomSource random(seed);
    VectorXd step(system->nv);
    for (double& x : step) x = random.between(-0.1, 0.1);
    State state = make_drawn_state(*system);
    displace(*system, step, state.q);
    const Scaling& scaling = system->scaling;
    int iterations = 0;
    const double residual = close_loops(*system, scaling, {}, 200, state, iterations);
    EXPECT_LE(residual, closed_tolerance(scaling)) << "seed " << seed << ": " << mechanism.description;
    EXPECT_LT(witness::absolute_residual(*system->model, poses_at(*system, state)).norm(), 1e-9)
        << "seed " << seed << ": " << mechanism.description;
  }
  EXPECT_GT(redundant, 20);
}

TEST(AssemblyTest, HeldCoordinatesStay) {
  const auto system = built(witness::make_driven_four_bar());
  State state = make_drawn_state(*system);
  const CoordinateAccess crank = system->access({*system->model->find_joint("O"), 0});
  ASSERT_TRUE(crank.in_tree);
  state.q[crank.q] = 0.3;
  int iterations = 0;
  const Scaling& scaling = system->scaling;
  EXPECT_LE(close_loops(*system, scaling, {crank.v}, 200, state, iterations), closed_tolerance(scaling));
  EXPECT_EQ(state.q[crank.q], 0.3);
  EXPECT_GT(iterations, 0);
}

/// A 1 m arm on a pin at the origin, drawn along x, and rods from `feet` to its tip with `lengths`.
ModelSpec arm_on_rods(const std::vector<Point>& feet, const std::vector<double>& lengths) {
  ModelSpec spec;
  spec.name = "arm";
  spec.bodies = {witness::rod_body("arm", {0, 0, 0}, {1, 0, 0}, 1)};
  spec.joints = {joint(JointType::kRevolute, "pin", "ground", "arm", {0, 0, 0})};
  for (std::size_t i = 0; i < feet.size(); ++i) {
    spec.joints.push_back(
        witness::distance_joint(numbered("rod", static_cast<int>(i)), "ground", "arm", feet[i], {1, 0, 0}));
    spec.joints.back().length = Number(lengths[i]);
  }
  return spec;
}

TEST(AssemblyTest, ARodOfAnotherLengthTurnsTheArm) {
  const auto system = built(arm_on_rods({{2, 0.5, 0}}, {1.6}));
  expect_closed(*system, assemble(*system));
}

// The tip comes no nearer to the foot than 2 m: 1 m stays open.
TEST(AssemblyTest, ARodThatIsTooShortStaysOpenByItsGap) {
  const auto system = built(arm_on_rods({{3, 0, 0}}, {1}));
  const AssemblyResult result = assemble(*system);
  EXPECT_EQ(result.status, AssemblyStatus::kOpen);
  ASSERT_EQ(result.open_joints.size(), 1u);
  EXPECT_EQ(result.open_joints[0].name, "rod0");
  EXPECT_NEAR(result.open_joints[0].gap_m, 1, 1e-6);
  EXPECT_NEAR(result.residual, 1, 1e-6);
  EXPECT_NE(result.message.find("rod0"), std::string::npos);
}

// By symmetry the tip stays on the x axis and both rods end 5 mm short.
TEST(AssemblyTest, TwoRodsThatContradictEachOtherStayOpenBoth) {
  const double exact = std::hypot(1.0, 2.0);
  const auto fits = built(arm_on_rods({{0, 2, 0}, {0, -2, 0}}, {exact, exact}));
  expect_closed(*fits, assemble(*fits));
  const auto system = built(arm_on_rods({{0, 2, 0}, {0, -2, 0}}, {exact - 0.005, exact - 0.005}));
  const AssemblyResult result = assemble(*system);
  EXPECT_EQ(result.status, AssemblyStatus::kOpen);
  ASSERT_EQ(result.open_joints.size(), 2u);
  for (const OpenJoint& open : result.open_joints) EXPECT_NEAR(open.gap_m, 0.005, 1e-5) << open.name;
}

/// Bennett's linkage link by link: twists 50 and 110 degrees, sides 1 and b; one side of length b is longer by `error`.
ModelSpec bennett_links(double error) {
  const double alpha = 50 * std::numbers::pi / 180, beta = 110 * std::numbers::pi / 180;
  const double a = 1, b = a * std::sin(beta) / std::sin(alpha), turn = 0.9;
  const double other =
      2 * std::atan(std::sin((beta + alpha) / 2) / (std::sin((beta - alpha) / 2) * std::tan(turn / 2)));
  const std::array<double, 4> turns = {turn, other, -turn, -other}, twists = {alpha, beta, alpha, beta};
  const std::array<double, 4> sides = {a, b + error, a, b};
  ModelSpec spec;
  spec.name = "bennett_links";
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  std::string last = "ground";
  for (int i = 0; i < 4; ++i) {  // ground is the fourth link: it carries J1 at its origin and J4 behind it
    const Point end_of_last = i == 0 ? Point::Zero() : Point(sides[i - 1], 0, 0);
    const double twist_of_last = i == 0 ? 0 : twists[i - 1];
    const std::string next = i == 3 ? "ground" : numbered("link", i + 1);
    JointSpec j;
    j.name = numbered("J", i + 1);
    j.bodies = {NameRef(last), NameRef(next)};
    j.place.on_body = {{last, numbers(end_of_last)}, {next, numbers(Point::Zero())}};
    j.axis.on_body = {{last, numbers({0, -std::sin(twist_of_last), std::cos(twist_of_last)})},
                      {next, numbers(Point::UnitZ())}};
    frame = frame * Eigen::AngleAxisd(turns[i], Point::UnitZ());
    if (i < 3) {
      BodySpec body;
      body.name = next;
      body.pose = pose_spec(frame.linear(), frame.translation());
      spec.bodies.push_back(body);
    } else {  // ground's fourth joint, from the closed loop: J1's frame is one side of b and a twist of beta further
      const Eigen::Isometry3d closing = Eigen::Translation3d(b, 0, 0) * Eigen::AngleAxisd(beta, Point::UnitX());
      const Eigen::Isometry3d on_ground = closing.inverse();
      j.place.on_body[1].second = numbers(on_ground.translation());
      j.axis.on_body[1].second = numbers(on_ground.linear().col(2));
    }
    spec.joints.push_back(j);
    frame = frame * Eigen::Translation3d(sides[i], 0, 0) * Eigen::AngleAxisd(twists[i], Point::UnitX());
    last = next;
  }
  return spec;
}

TEST(AssemblyTest, BennettsLinkageClosesLinkByLink) {
  const auto system = built(bennett_links(0));
  expect_closed(*system, assemble(*system));
}

// A micrometre destroys an overconstrained loop of metres: it must be said, not squeezed shut. The best residual is
// about half of the error.
TEST(AssemblyTest, ASideThatIsAMicrometreTooLongLeavesBennettsLinkageOpen) {
  const auto system = built(bennett_links(1e-6));
  const AssemblyResult result = assemble(*system);
  EXPECT_EQ(result.status, AssemblyStatus::kOpen);
  EXPECT_GT(result.residual, 3e-7);
  EXPECT_LT(result.residual, 1e-6);
  ASSERT_FALSE(result.open_joints.empty());
  EXPECT_FALSE(result.message.empty());
  // No displacement closes it further: the scaled residual is orthogonal to the columns of the scaled Jacobian.
  const Scaling& scaling = system->scaling;
  PositionKinematics pos = make_position_kinematics(*system);
  compute_positions(*system, result.state.q, pos);
  ConstraintKinematics c = make_constraint_kinematics(*system);
  compute_constraints(*system, result.state, pos, make_velocity_kinematics(*system), c);
  const VectorXd residual = scaling.rows.cwiseProduct(c.phi);
  const MatrixXd G = scaling.rows.asDiagonal() * c.G * scaling.columns.asDiagonal();
  EXPECT_LT((G.transpose() * residual).norm(), 1e-3 * residual.norm());
}

TEST(AssemblyTest, NoPoseClosesTheWrongBennettLinkage) {
  const auto system = built(bennett_links(1e-6));
  const Scaling& scaling = system->scaling;
  const CoordinateAccess crank = system->access({JointId(0), 0});
  ASSERT_TRUE(crank.in_tree);
  State state = make_drawn_state(*system);
  double best = 1;
  for (int i = 0; i < 126; ++i) {  // once round, the loop following as well as it can
    state.q[crank.q] = 0.05 * i;
    int iterations = 0;
    const double r = close_loops(*system, scaling, {crank.v}, 60, state, iterations);
    best = std::min(best, r);
  }
  EXPECT_GT(best, 3e-7);
  EXPECT_LT(best, 1e-6);
}

// All bars in one line and half a metre too long: no rotation shortens them to first order.
TEST(AssemblyTest, BarsInOneLineAreKickedOutOfIt) {
  ModelSpec spec;
  spec.name = "line";
  const double at[] = {0, 1, 2, 3};
  std::string last = "ground";
  for (int i = 0; i < 4; ++i) {
    const std::string next = i == 3 ? "ground" : numbered("bar", i + 1);
    if (i < 3) {
      BodySpec body;
      body.name = next;
      body.pose = pose_spec(Eigen::Matrix3d::Identity(), {at[i], 0, 0});
      spec.bodies.push_back(body);
    }
    JointSpec j = joint(JointType::kRevolute, numbered("J", i + 1), last, next, {0, 0, 0});
    j.place.drawn.reset();
    j.place.on_body = {{last, numbers({i == 0 ? 0.0 : 1.0, 0, 0})}, {next, numbers({i == 3 ? 2.5 : 0.0, 0, 0})}};
    spec.joints.push_back(j);
    last = next;
  }
  const auto system = built(spec);
  State start = make_drawn_state(*system);
  int iterations = 0;
  const Scaling& scaling = system->scaling;
  EXPECT_NEAR(close_loops(*system, scaling, {}, 200, start, iterations), 0.5, 1e-12);  // without a kick
  const AssemblyResult result = assemble(*system);
  expect_closed(*system, result);
  const AssemblyResult again = assemble(*system);
  EXPECT_EQ(again.state.q, result.state.q);  // always the same way
}

InitialSpec exact_position(const std::string& of_joint, double position, bool guess = false) {
  InitialSpec initial;
  initial.joint = of_joint;
  initial.position = {Number(position)};
  initial.guess = guess;
  return initial;
}

/// The driven four-bar with initial positions; `cut` forces some of its joints to be cut.
AssemblyResult assemble_four_bar(const std::vector<InitialSpec>& initial, std::shared_ptr<const System>& system,
                                 const std::string& cut = "") {
  ModelSpec spec = witness::make_driven_four_bar();
  spec.initial = initial;
  std::vector<bool> is_cut(spec.joints.size(), false);
  for (std::size_t j = 0; j < is_cut.size(); ++j) is_cut[j] = spec.joints[j].name.name == cut;
  system = built(spec, is_cut);
  return assemble(*system);
}

TEST(InitialPositionTest, ExactPositionsAreMetInTheTreeAndAtCutJointsOverTurnsToo) {
  for (const char* cut : {"", "O", "A", "B", "C"}) {
    std::shared_ptr<const System> system;
    for (const double position : {0.4, -0.7, 2.5, 7.0, -9.0}) {
      const AssemblyResult result = assemble_four_bar({exact_position("O", position)}, system, cut);
      expect_closed(*system, result, numbered("cut ", cut[0]) + " at " + std::to_string(position));
      EXPECT_NEAR(position_of(*system, result.state, "O"), position, 1e-9) << cut;
    }
  }
}

TEST(InitialPositionTest, TheBranchIsTheDrawnOneWhateverIsCut) {
  std::vector<double> rocker;
  for (const char* cut : {"O", "A", "B", "C"}) {
    std::shared_ptr<const System> system;
    const AssemblyResult result = assemble_four_bar({exact_position("O", 1.3)}, system, cut);
    const std::vector<Pose> poses = poses_at(*system, result.state);
    rocker.push_back(poses.back().R(0, 0));
  }
  for (const double r : rocker) EXPECT_NEAR(r, rocker[0], 1e-9);
}

TEST(InitialPositionTest, TwoPositionsThatExcludeEachOtherAreInconsistent) {
  for (const char* cut : {"", "O", "C"}) {
    std::shared_ptr<const System> system;
    const AssemblyResult fits = assemble_four_bar({exact_position("O", 0.4)}, system, cut);
    const double rocker = position_of(*system, fits.state, "C");
    const AssemblyResult both = assemble_four_bar({exact_position("O", 0.4), exact_position("C", rocker)}, system, cut);
    EXPECT_EQ(both.status, AssemblyStatus::kAssembled) << cut << both.message;
    const AssemblyResult wrong =
        assemble_four_bar({exact_position("O", 0.4), exact_position("C", rocker + 0.1)}, system, cut);
    EXPECT_EQ(wrong.status, AssemblyStatus::kInconsistentInitial) << cut;
    EXPECT_FALSE(wrong.message.empty());
  }
}

TEST(InitialPositionTest, APositionOutOfReachIsInconsistent) {
  for (const char* cut : {"", "C"}) {
    std::shared_ptr<const System> system;
    const AssemblyResult result = assemble_four_bar({exact_position("C", 3.0)}, system, cut);  // the rocker swings less
    EXPECT_EQ(result.status, AssemblyStatus::kInconsistentInitial) << cut;
  }
}

TEST(InitialPositionTest, GuessesOnlyStartTheSearch) {
  std::shared_ptr<const System> system;
  const AssemblyResult result = assemble_four_bar({exact_position("O", 0.5, true)}, system, "B");
  expect_closed(*system, result);
  EXPECT_LT(std::abs(position_of(*system, result.state, "O") - 0.5), 0.5);
  EXPECT_GT(std::abs(position_of(*system, result.state, "O") - 0.5), 1e-6);
}

// Spherical joints are cut where others can carry the tree; their rotation must be met all the same.
TEST(InitialPositionTest, ExactRotationsOfCutSphericalJointsAreMet) {
  ModelSpec spec = witness::make_four_bar(witness::FourBarJoints::kSphericalCylindrical);
  spec.initial = {exact_position(spec.joints[0].name.name, 0.4)};
  const auto ball = std::find_if(spec.joints.begin(), spec.joints.end(),
                                 [](const JointSpec& j) { return j.type == JointType::kSpherical; });
  const auto turned = built(spec);
  const JointId id = *turned->model->find_joint(ball->name.name);
  ASSERT_GE(turned->topology->closure_of_joint[id.index()], 0);
  const auto rotation = [&](const System& system, const State& state) {
    PositionKinematics pos = make_position_kinematics(system);
    compute_positions(system, state.q, pos);
    const JointMotion m =
        measure_joint(system, id, state, VectorXd::Zero(system.nv), pos, make_velocity_kinematics(system));
    return std::array<double, 4>{m.q[0], m.q[1], m.q[2], m.q[3]};
  };
  const std::array<double, 4> wanted = rotation(*turned, assemble(*turned).state);
  EXPECT_LT(wanted[0], 0.999);
  InitialSpec exact;
  exact.joint = ball->name.name;
  exact.position = {Number(wanted[0]), Number(wanted[1]), Number(wanted[2]), Number(wanted[3])};
  spec.initial = {exact};
  const auto system = built(spec);
  const AssemblyResult result = assemble(*system);
  expect_closed(*system, result);
  const std::array<double, 4> got = rotation(*system, result.state);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(got[i], wanted[i], 1e-9);
  exact.position = {Number(0), Number(1), Number(0), Number(0)};  // half a turn out of the plane
  spec.initial = {exact};
  const auto wrong = built(spec);
  EXPECT_EQ(assemble(*wrong).status, AssemblyStatus::kInconsistentInitial);
}

// A hinge upside down satisfies its dot products, yet is no hinge.
TEST(AssemblyTest, SolutionsWithReversedAxesAreRefused) {
  for (const JointType type :
       {JointType::kRevolute, JointType::kPrismatic, JointType::kPlanar, JointType::kCylindrical}) {
    ModelSpec spec;
    spec.name = "upside_down";
    BodySpec body;
    body.name = "body";
    body.pose = pose_spec(Eigen::AngleAxisd(std::numbers::pi, Point::UnitX()).toRotationMatrix(), {0, 0, 0});
    spec.bodies = {body};
    JointSpec j = joint(type, "J", "ground", "body", {0, 0, 0});
    j.place.drawn.reset();
    j.place.on_body = {{"ground", numbers({0, 0, 0})}, {"body", numbers({0, 0, 0})}};
    if (j.axis.drawn) {
      j.axis.drawn.reset();
      j.axis.on_body = {{"ground", numbers({0, 0, 1})}, {"body", numbers({0, 0, 1})}};
    }
    spec.joints = {j};
    const auto system = built(spec, {true});
    const AssemblyResult result = assemble(*system);
    const bool upright = poses_at(*system, result.state)[1].R(2, 2) > 0;
    EXPECT_TRUE(result.status != AssemblyStatus::kAssembled || upright) << joint_type_info(type).name;
    State flipped = make_drawn_state(*system);
    int iterations = 0;
    const Scaling& scaling = system->scaling;
    EXPECT_GE(close_loops(*system, scaling, {}, 200, flipped, iterations), scaling.length_m);
  }
}

TEST(AssemblyTest, AnAngleThatStaysOpenIsToldAsItIsUpToHalfATurn) {
  for (const double angle : {0.3, 1.2, 2.2, std::numbers::pi}) {
    ModelSpec spec;
    spec.bodies = {witness::box_body("slider", {1, 0, 0}, {1, 1, 1}, 1)};
    JointSpec hold = joint(JointType::kWeld, "hold", "ground", "slider", Point::Zero());
    hold.place = hold.axis = {};
    hold.frames = {pose_spec(Eigen::AngleAxisd(angle, Point(1, 2, 2) / 3).toRotationMatrix(), Point::Zero()),
                   PoseSpec()};
    spec.joints = {joint(JointType::kPrismatic, "guide", "ground", "slider", Point::Zero(), Point::UnitX()), hold};
    const auto system = built(spec, {false, true});
    const AssemblyResult result = assemble(*system);
    ASSERT_EQ(result.open_joints.size(), 1u) << angle;
    EXPECT_NEAR(result.open_joints[0].angle_rad, angle, 1e-9);
  }
}

}  // namespace
}  // namespace ferrers
