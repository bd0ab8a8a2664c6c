#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "ferrers/dynamics/inverse.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

/// Inverse dynamics where laws are given twice, where more drives act than the motion needs, with tables and paths as
/// laws, and with friction.
namespace ferrers::witness {
namespace {

constexpr ReactionStatus kUnique = ReactionStatus::kUnique, kDistributed = ReactionStatus::kDistributed,
                         kUndetermined = ReactionStatus::kUndetermined;

struct Driven {
  EngineProbe engine;
  PrescribedMotion motion;
  PrescribedResult result;
  std::vector<JointReaction> reactions;

  explicit Driven(const ModelSpec& spec, const TopologyOptions& options = {})
      : engine(spec, options), motion(engine.dynamics, assemble(*engine.system).state) {}

  void solve(double t) {
    result = motion.solve(t);
    ASSERT_EQ(result.status, PrescribedStatus::kSolved) << result.message;
    reactions = ReactionSolver(engine.dynamics)
                    .solve(result.state, motion.equations(), motion.selection(), result.vdot, result.lambda, result.u,
                           ReactionAxes::kJoint);
  }
  int drive(const std::string& name) const {
    for (int i = 0; i < engine.dynamics->nu(); ++i) {
      if (engine.dynamics->drives[i].name == name) return i;
    }
    return -1;
  }
  double effort(const std::string& name) const { return result.u[drive(name)]; }
  bool shared(const std::string& name) const { return result.effort_is_shared[drive(name)]; }
  /// How far M vdot + h = tau + B u + Gᵀ lambda is from holding.
  double imbalance() const {
    const Equations& eq = motion.equations();
    const VectorXd rest = eq.M * result.vdot + eq.h - eq.tau - eq.B_transposed.transpose() * result.u -
                          eq.constraints.G.transpose() * result.lambda;
    return rest.norm() / (eq.h.norm() + 1);
  }
};

// Crank 1 m on the origin, coupler 2 m, crank 1 m on (2, 0): a parallelogram, so that both cranks turn alike.
ModelSpec parallelogram() {
  ModelSpec spec;
  spec.name = "parallelogram";
  spec.gravity = number3(0, -9.81, 0);
  const Point a(0.6, 0.8, 0), b(2.6, 0.8, 0);
  spec.bodies = {bar_body("left", {0, 0, 0}, a, 1, 0.02), bar_body("top", a, b, 2, 0.02),
                 bar_body("right", {2, 0, 0}, b, 1.5, 0.02)};
  spec.joints = {joint(JointType::kRevolute, "O", "ground", "left", {0, 0, 0}),
                 joint(JointType::kRevolute, "A", "left", "top", a),
                 joint(JointType::kRevolute, "C", "top", "right", b),
                 joint(JointType::kRevolute, "B", "ground", "right", {2, 0, 0})};
  return spec;
}

TEST(InverseSharingTest, LawsThatAgreeAreFollowedAndTheLeastEffortIsTaken) {
  ModelSpec single = parallelogram();
  single.drives = {coordinate_drive("left_motor", "O", "0.3*t^2")};
  ModelSpec spec = single;
  spec.drives.push_back(coordinate_drive("right_motor", "B", "0.3*t^2"));
  spec.drives[1].weight = Number(2.0);
  Driven one(single), two(spec);
  for (const double t : {0.0, 0.5, 1.0}) {
    one.solve(t);
    two.solve(t);
    EXPECT_FALSE(one.shared("left_motor"));
    EXPECT_TRUE(two.shared("left_motor"));
    EXPECT_TRUE(two.shared("right_motor"));
    const double whole = one.effort("left_motor");
    EXPECT_NEAR(two.effort("left_motor"), whole * 4 / 5, 1e-11 * std::abs(whole));
    EXPECT_NEAR(two.effort("right_motor"), whole / 5, 1e-11 * std::abs(whole));
    EXPECT_LT(two.imbalance(), 1e-12);
  }
}

// A component is distributed exactly when another division of the effort changes it, and not undetermined before.
TEST(InverseSharingTest, ReactionsThatDependOnTheSharingAreMarked) {
  ModelSpec spec = parallelogram();
  spec.drives = {coordinate_drive("left_motor", "O", "0.3*t^2"), coordinate_drive("right_motor", "B", "0.3*t^2")};
  Driven shared(spec);
  shared.solve(0.7);
  ModelSpec fixed = spec;
  fixed.drives[1] = coordinate_drive("right_motor", "B", "", "3");
  Driven other(fixed);
  other.solve(0.7);
  int unique = 0, distributed = 0;
  for (std::size_t j = 0; j < shared.reactions.size(); ++j) {
    for (int k = 0; k < 6; ++k) {
      const ReactionStatus plain = other.reactions[j].status[k], marked = shared.reactions[j].status[k];
      if (plain == kUndetermined) {
        EXPECT_EQ(marked, kUndetermined) << j << " " << k;
        continue;
      }
      const bool changes = std::abs(shared.reactions[j].value[k] - other.reactions[j].value[k]) > 1e-9;
      EXPECT_EQ(marked, changes ? kDistributed : kUnique) << j << " " << k;
      ++(changes ? distributed : unique);
    }
  }
  EXPECT_GT(unique, 0);
  EXPECT_GT(distributed, 0);
}

// Two motors on one shaft load no joint differently, however they share.
TEST(InverseSharingTest, MotorsOnOneShaftLeaveReactionsUnique) {
  ModelSpec spec = parallelogram();
  spec.drives = {coordinate_drive("motor", "O", "0.3*t^2"), coordinate_drive("helper", "O", "")};
  Driven pair(spec);
  pair.solve(0.4);
  EXPECT_NEAR(pair.effort("motor"), pair.effort("helper"), 1e-11);
  EXPECT_TRUE(pair.shared("helper"));
  for (const JointReaction& r : pair.reactions) {
    for (int k = 0; k < 6; ++k) EXPECT_NE(r.status[k], kDistributed);
  }
}

TEST(InverseSharingTest, ADriveWithoutAnyLawHelpsAndOneWithAnEffortActs) {
  ModelSpec spec = parallelogram();
  spec.drives = {coordinate_drive("motor", "O", "0.3*t^2"), coordinate_drive("helper", "B", ""),
                 coordinate_drive("load", "A", "", "1 + t")};
  Driven mix(spec);
  mix.solve(0.4);
  EXPECT_TRUE(mix.shared("motor"));
  EXPECT_TRUE(mix.shared("helper"));
  EXPECT_FALSE(mix.shared("load"));
  EXPECT_EQ(mix.effort("load"), 1.4);
  EXPECT_NEAR(mix.effort("motor"), mix.effort("helper"), 1e-11);
  EXPECT_LT(mix.imbalance(), 1e-12);
}

TEST(InverseSharingTest, LawsThatContradictEachOtherAreToldByNameTimeAndAmount) {
  ModelSpec spec = parallelogram();
  spec.drives = {coordinate_drive("left_motor", "O", "0.3*t^2"),
                 coordinate_drive("right_motor", "B", "0.3*t^2 + 0.01*t^3")};
  Driven two(spec);
  PrescribedResult result = two.motion.solve(0);
  EXPECT_EQ(result.status, PrescribedStatus::kSolved) << result.message;
  result = two.motion.solve(0.5);
  EXPECT_EQ(result.status, PrescribedStatus::kContradictory);
  for (const char* word : {"left_motor", "right_motor", "t = 0.5 s", "difference of 0.00125 rad"}) {
    EXPECT_NE(result.message.find(word), std::string::npos) << word << ": " << result.message;
  }
}

TEST(InverseSharingTest, LawsThatMeetAtOneInstantOnlyAreContradictoryThere) {
  ModelSpec spec = parallelogram();
  spec.drives = {coordinate_drive("left_motor", "O", "0.3*t"), coordinate_drive("right_motor", "B", "0.4*t")};
  const PrescribedResult result = Driven(spec).motion.solve(0);
  EXPECT_EQ(result.status, PrescribedStatus::kContradictory);
  EXPECT_NE(result.message.find("the rate"), std::string::npos) << result.message;
}

// Turned into line the parallelogram has a dead point for one crank alone; a second law carries it across.
TEST(InverseSharingTest, ASecondLawCarriesAMechanismThroughADeadPoint) {
  ModelSpec spec = parallelogram();
  spec.drives = {coordinate_drive("left_motor", "O", "-2*t"), coordinate_drive("right_motor", "B", "-2*t")};
  Driven two(spec);
  const double in_line = std::atan2(0.8, 0.6) / 2;
  for (int i = 0; i <= 40; ++i) two.solve(2 * in_line * i / 40);
  const std::optional<JointId> coupler = two.engine.model().find_joint("A");
  const CoordinateAccess access = two.engine.system->access({*coupler, 0});
  const Jet jet = measure_coordinate(*two.engine.system, access, two.result.state, two.motion.equations().pos,
                                     two.motion.equations().vel);
  EXPECT_NEAR(jet.value, 4 * in_line, 1e-9);  // still parallel: the coupler turns back as the cranks turn
}

// --- every joint type ---------------------------------------------------------------------------------------------

// All coordinates of one joint follow laws; beside it a free joint can carry the body instead, so that it is cut.
ModelSpec held_by(JointType type, bool beside_free) {
  ModelSpec spec;
  spec.name = "held";
  spec.bodies = {tensor_body("body", {0.4, 0.3, -0.2}, Eigen::Vector3d(0.2, 0.3, 0.4).asDiagonal(), 3)};
  JointSpec held = joint(type, "held", "ground", "body", {0.1, 0, 0}, {0.3, 0.2, 1});
  if (type == JointType::kUniversal) {
    held = universal_joint("held", "ground", "body", {0.1, 0, 0}, Point::UnitZ(), Point::UnitX());
  }
  if (type == JointType::kScrew) held.lead = Number(0.2);
  spec.joints = {held};
  if (beside_free) spec.joints.push_back(joint(JointType::kFree, "beside", "ground", "body", {0, 0, 0}));
  const char* laws[] = {"0.3*t + 0.5*t^2", "0.2*sin(2*t)", "0.4*t^2 - 0.1*t"};
  const JointTypeInfo& info = joint_type_info(type);
  for (int k = 0; k < info.nv; ++k) {
    DriveSpec drive = coordinate_drive(numbered("drive", k), "held", laws[k]);
    drive.coordinate->coordinate = info.coordinates[k].name;
    spec.drives.push_back(drive);
  }
  return spec;
}

TEST(InverseSharingTest, EveryJointTypeIsDrivenAlikeInTheTreeAndCut) {
  for (const JointType type : {JointType::kRevolute, JointType::kPrismatic, JointType::kScrew, JointType::kCylindrical,
                               JointType::kUniversal, JointType::kPlanar}) {
    SCOPED_TRACE(joint_type_info(type).name);
    TopologyOptions cut;
    cut.cut = {true, false};
    Driven tree(held_by(type, false)), loop(held_by(type, true), cut);
    ASSERT_TRUE(tree.engine.dynamics->drives[0].access.in_tree);
    ASSERT_FALSE(loop.engine.dynamics->drives[0].access.in_tree);
    for (const double t : {0.0, 0.3, 0.9}) {
      tree.solve(t);
      loop.solve(t);
      const double size = 1 + tree.result.u.norm();
      EXPECT_LT((tree.result.u - loop.result.u).norm(), 1e-11 * size);
      EXPECT_LT(loop.imbalance(), 1e-12);
      for (int k = 0; k < 6; ++k) {
        EXPECT_NEAR(tree.reactions[0].value[k], loop.reactions[0].value[k], 1e-10 * size);
        EXPECT_EQ(loop.reactions[0].status[k], kUnique);
      }
    }
  }
}

// Coordinates that couplings tie: one law moves both, and the effort is felt through the gear.
TEST(InverseSharingTest, ALawMovesWhatACouplingTies) {
  ModelSpec spec;
  spec.name = "geared";
  spec.gravity = number3(0, 0, 0);
  spec.bodies = {tensor_body("slow", {0, 0, 0}, Eigen::Vector3d(1, 1, 2).asDiagonal(), 1),
                 tensor_body("fast", {1, 0, 0}, Eigen::Vector3d(1, 1, 0.5).asDiagonal(), 1)};
  spec.joints = {joint(JointType::kRevolute, "a", "ground", "slow", {0, 0, 0}),
                 joint(JointType::kRevolute, "b", "ground", "fast", {1, 0, 0})};
  CouplingSpec gear;
  gear.name = "gear";
  gear.coordinates = {CoordinateRef{NameRef("a"), ""}, CoordinateRef{NameRef("b"), ""}};
  gear.coefficients = {Number(3.0), Number(1.0)};  // b = −3 a
  spec.couplings = {gear};
  spec.drives = {coordinate_drive("motor", "b", "0.6*t^2")};
  Driven pair(spec);
  pair.solve(0.5);
  EXPECT_NEAR(pair.effort("motor"), (0.5 + 2.0 / 9) * 1.2, 1e-12);
  // A second law on the other side is consistent when it is the first through the gear.
  spec.drives.push_back(coordinate_drive("second", "a", "-0.2*t^2"));
  Driven both(spec);
  both.solve(0.5);
  EXPECT_NEAR(both.effort("motor") - both.effort("second") / 3, (0.5 + 2.0 / 9) * 1.2, 1e-12);
  EXPECT_NEAR(both.effort("second"), -both.effort("motor") / 3, 1e-12);  // least effort
}

// With the drive as a constraint there are 21 rows of rank 18: what is redundant stays so, and torque and in-plane
// forces stay unique.
TEST(InverseSharingTest, ADriveAsAConstraintAddsItsRankToTheFourBars) {
  Driven bar(make_driven_four_bar());
  bar.solve(0.5);
  const RedundancyReport report = analyze_redundancy(*bar.engine.system, bar.result.state);
  Equations eq = make_equations(*bar.engine.dynamics, {0});
  compute_kinematics(*bar.engine.dynamics, bar.result.state, eq);
  MatrixXd G = eq.constraints.G * bar.engine.scaling.columns.asDiagonal();
  G.topRows(report.closure_rows) = bar.engine.scaling.rows.asDiagonal() * MatrixXd(G.topRows(report.closure_rows));
  const int added = decide_rank(compute_singular_values(G), 1.0).rank - report.closure_rank;
  EXPECT_EQ(report.constraint_rows + 1, 21);
  EXPECT_EQ(report.rank + added, 18);
  EXPECT_FALSE(bar.shared("motor"));
  for (const JointReaction& reaction : bar.reactions) {
    for (const int k : {0, 1}) EXPECT_EQ(reaction.status[k], kUnique);
  }
}

// --- paths and tables ---------------------------------------------------------------------------------------------

// Two links of 1 m and 0.8 m in the vertical plane.
ModelSpec arm() {
  ModelSpec spec;
  spec.name = "arm";
  spec.gravity = number3(0, -9.81, 0);
  const Point elbow(0.8, 0.6, 0), tip(0.8, -0.2, 0);
  spec.bodies = {rod_body("upper", {0, 0, 0}, elbow, 2), rod_body("lower", elbow, tip, 1)};
  spec.joints = {joint(JointType::kRevolute, "shoulder", "ground", "upper", {0, 0, 0}),
                 joint(JointType::kRevolute, "elbow", "upper", "lower", elbow)};
  spec.records = {record("tip", "lower", tip)};
  return spec;
}

DriveSpec path(const std::string& x, const std::string& y, const std::string& z) {
  DriveSpec drive;
  drive.name = "path";
  drive.point = NameRef("tip");
  drive.motion = {law(x), law(y), law(z)};
  return drive;
}

TEST(InverseSharingTest, APathIsFollowedWithAComponentThatTheMechanismImplies) {
  ModelSpec spec = arm();
  spec.drives = {path("0.8 + 0.2*sin(t)", "-0.2 + 0.1*t", "0*t")};
  Driven tip(spec);
  struct Figures {
    double t, x, y;
  };
  // Lagrange's equations in the links' angles, through the transposed Jacobian; by hand.
  for (const auto& [t, force_x, force_y] :
       {Figures{0, 0.008561197916663, 19.47118815104}, Figures{0.3, -1.361076082233, 18.428148538},
        Figures{0.8, -3.010463233019, 17.04070657211}}) {
    tip.solve(t);
    EXPECT_NEAR(tip.effort("path.x"), force_x, 1e-10);
    EXPECT_NEAR(tip.effort("path.y"), force_y, 1e-10);
    const NodePoint point = tip.engine.system->point(*tip.engine.model().find_body("lower"), {0.8, -0.2, 0});
    const Vector3d p = point_position(tip.motion.equations().pos, point);
    EXPECT_NEAR(p.x(), 0.8 + 0.2 * std::sin(t), 1e-12);
    EXPECT_NEAR(p.y(), -0.2 + 0.1 * t, 1e-12);
    EXPECT_LT(tip.imbalance(), 1e-12);
    // The force along z does no work and is the least: none.
    EXPECT_NEAR(tip.effort("path.z"), 0, 1e-12);
    EXPECT_FALSE(tip.shared("path.x"));
    EXPECT_FALSE(tip.shared("path.y"));
  }
}

TEST(InverseSharingTest, APathOutOfThePlaneIsContradictory) {
  ModelSpec spec = arm();
  spec.drives = {path("0.8 + 0.2*sin(t)", "-0.2 + 0.1*t", "0.05*t")};
  Driven tip(spec);
  const PrescribedResult result = tip.motion.solve(0.5);
  EXPECT_EQ(result.status, PrescribedStatus::kContradictory);
  EXPECT_NE(result.message.find("'path.z' asks for the position 0.025 m"), std::string::npos) << result.message;
}

// Torques of joint drives that make the same motion have the same power as the forces on the tip.
TEST(InverseSharingTest, PathForcesAndJointTorquesDoTheSameWork) {
  ModelSpec spec = arm();
  spec.drives = {path("0.8 + 0.2*sin(t)", "-0.2 + 0.1*t", "0*t")};
  Driven tip(spec);
  tip.solve(0.3);
  const State state = tip.result.state;
  ModelSpec joints = arm();
  const auto quadratic = [&](int v) {
    return fmt::format("{:.17g} + {:.17g}*(t - 0.3) + {:.17g}*(t - 0.3)^2", state.q[v], state.v[v],
                       tip.result.vdot[v] / 2);
  };
  joints.drives = {coordinate_drive("m1", "shoulder", quadratic(0)), coordinate_drive("m2", "elbow", quadratic(1))};
  Driven motors(joints);
  motors.solve(0.3);
  const Equations& eq = tip.motion.equations();
  const double tip_power = tip.result.u.dot(eq.B_transposed * state.v);
  EXPECT_NEAR(motors.result.u.dot(motors.result.state.v), tip_power, 1e-10 * (1 + std::abs(tip_power)));
}

double torque_error_with_table(double every) {
  ModelSpec analytic = make_driven_four_bar(), sampled = analytic;
  LawSpec table;
  table.samples.emplace();
  for (int i = 0; i * every <= 3 + 1e-9; ++i) {
    table.samples->first.push_back(i * every);
    table.samples->second.push_back(1.2 * (1 - std::cos(2 * i * every)));
  }
  sampled.drives[0].motion = {table};
  Driven exact(analytic), spline(sampled);
  double error = 0;
  for (int i = 0; i <= 300; ++i) {  // away from the ends, where the spline's second derivative is made zero
    exact.solve(1 + 0.0037 * i);
    spline.solve(1 + 0.0037 * i);
    error = std::max(error, std::abs(exact.effort("motor") - spline.effort("motor")));
  }
  return error;
}

// The second derivative of a cubic spline is off by (h²/12) f'''' or less, and with it the torque.
TEST(InverseSharingTest, ATableGivesTheTorqueToSecondOrderInItsSpacing) {
  const double coarse = torque_error_with_table(0.02), fine = torque_error_with_table(0.01);
  EXPECT_LT(fine, 0.01);
  EXPECT_NEAR(coarse / fine, 4, 0.8);
}

// --- friction -------------------------------------------------------------------------------------------------------

TEST(InverseSharingTest, ADriveOvercomesFriction) {
  const double angle = 0.6, mu = 0.3, g = 9.81, mass = 2.5;
  ModelSpec spec;
  spec.name = "incline";
  spec.bodies = {box_body("block", {0, 0, 0}, {0.1, 0.1, 0.1}, mass)};
  spec.joints = {
      joint(JointType::kPrismatic, "slope", "ground", "block", {0, 0, 0}, {std::cos(angle), 0, std::sin(angle)})};
  FrictionSpec friction;
  friction.coulomb = Number(mu);
  spec.joints[0].friction = friction;
  spec.drives = {coordinate_drive("winch", "slope", "0.5*t + t^2")};
  Driven winch(spec);
  winch.solve(0.2);
  EXPECT_NEAR(winch.effort("winch"), mass * (2 + g * std::sin(angle) + mu * g * std::cos(angle)), 1e-11);
}

// Inverse dynamics with friction is undone by forward dynamics with friction.
TEST(InverseSharingTest, FrictionIsTheSameBothWays) {
  ModelSpec spec = make_slider_crank(SliderCrankJoints::kSphericalCylindrical);
  for (JointSpec& one : spec.joints) {
    FrictionSpec friction;
    friction.coulomb = Number(0.15);
    friction.radius = Number(0.01);
    one.friction = friction;
  }
  Driven crank(spec);
  crank.solve(0.01);
  const double frictionless = [] {
    Driven smooth(make_slider_crank(SliderCrankJoints::kSphericalCylindrical));
    smooth.solve(0.01);
    return smooth.result.u[0];
  }();
  EXPECT_GT(crank.result.u[0], frictionless + 0.1);
  spec.drives[0].motion.clear();
  spec.drives[0].effort = {law(fmt::format("{:.17g}", crank.result.u[0]))};
  EngineProbe forced(spec);
  forced.evaluate(crank.result.state);
  const auto solver = make_forward_solver(Formulation::kNullSpace, *forced.system, forced.selection);
  ForwardResult forward = make_forward_result(*forced.system);
  solver->solve(forced.eq, forward);
  FrictionSolver friction(forced.dynamics);
  ASSERT_EQ(friction.solve(crank.result.state, forced.eq, forced.selection, *solver, forward), FrictionStatus::kSolved);
  EXPECT_LT((forward.vdot - crank.result.vdot).norm(), 1e-9 * crank.result.vdot.norm());
}

TEST(InverseSharingTest, FrictionOnAnUndeterminedReactionHasNoEffort) {
  ModelSpec spec = make_driven_four_bar();
  FrictionSpec friction;
  friction.coulomb = Number(0.1);
  friction.radius = Number(0.02);
  spec.joints[2].friction = friction;
  const PrescribedResult result = Driven(spec).motion.solve(0.2);
  EXPECT_EQ(result.status, PrescribedStatus::kUndeterminedFriction);
  EXPECT_NE(result.message.find("'" + spec.joints[2].name.name + "'"), std::string::npos) << result.message;
}

}  // namespace
}  // namespace ferrers::witness
