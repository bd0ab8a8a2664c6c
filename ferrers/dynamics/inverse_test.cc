#include "ferrers/dynamics/inverse.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/zoo.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers::witness {
namespace {

constexpr ReactionStatus kUnique = ReactionStatus::kUnique, kUndetermined = ReactionStatus::kUndetermined;

/// A driven mechanism solved instant by instant.
struct Driven {
  EngineProbe engine;
  PrescribedMotion motion;
  PrescribedResult result;
  std::vector<JointReaction> reactions;

  explicit Driven(const ModelSpec& spec) : engine(spec), motion(engine.dynamics, assemble(*engine.system).state) {}

  void solve(double t) {
    result = motion.solve(t);
    ASSERT_EQ(result.status, PrescribedStatus::kSolved) << result.message;
    reactions = ReactionSolver(engine.dynamics)
                    .solve(result.state, motion.equations(), motion.selection(), result.vdot, result.lambda, result.u);
  }
  const JointReaction& at(const std::string& joint) const {
    return reactions[engine.model().find_joint(joint)->index()];
  }
};

void expect_force(const JointReaction& r, double x, double y, double tolerance) {
  EXPECT_EQ(r.status[0], kUnique);
  EXPECT_EQ(r.status[1], kUnique);
  EXPECT_NEAR(r.value[0], x, tolerance);
  EXPECT_NEAR(r.value[1], y, tolerance);
}

struct SliderCrankFigures {
  double angle_deg, torque, o_x, o_y, a_x, a_y, b_x, b_y, guide;
};

// Closed form of the plane mechanism at 30 rad/s; the spatial one has three redundant rows, or none.
constexpr SliderCrankFigures kSliderCrank[] = {
    {0, 4.9050000000, -1836.000, 34.33500, -1656.000, 14.71500, -1008.000, -14.71500, 53.95500},
    {45, 143.880961235, -1036.18413621, -8.98210247838, -908.904915592, 98.6771181352, -522.171697943, 260.165949056,
     -220.925949056},
    {90, -86.4142845335, 432.071422667, -497.093571429, 432.071422667, -336.713571429, 314.23376194, -96.1435714286,
     135.383571429},
    {180, -4.9050000000, 1044.000, 34.33500, 864.0000, 14.71500, 432.0000, -14.71500, 53.95500}};

TEST(InverseTest, ASliderCrankAtConstantSpeedNeedsTheKnownForces) {
  for (const auto joints : {SliderCrankJoints::kRevolutePrismatic, SliderCrankJoints::kSphericalCylindrical}) {
    for (const SliderCrankFigures& f : kSliderCrank) {
      SCOPED_TRACE(f.angle_deg);
      const bool redundant = joints == SliderCrankJoints::kRevolutePrismatic;
      if (!redundant && std::fmod(f.angle_deg, 180) == 0) continue;  // in line: see the next test
      Driven crank(make_slider_crank(joints, f.angle_deg * std::numbers::pi / 180));
      crank.solve(0);
      const double tolerance = 1e-8 * std::hypot(f.o_x, f.o_y);
      EXPECT_NEAR(crank.result.u[0], f.torque, 1e-8 * std::max(143.880961235, std::abs(f.torque)));
      expect_force(crank.at("O"), f.o_x, f.o_y, tolerance);
      expect_force(crank.at("A"), f.a_x, f.a_y, tolerance);
      expect_force(crank.at("B"), f.b_x, f.b_y, tolerance);
      EXPECT_NEAR(crank.at("guide").value[1], f.guide, tolerance);
      EXPECT_EQ(crank.at("guide").status[1], kUnique);
      for (const char* joint : {"O", "A", "B", "guide"}) {
        EXPECT_EQ(crank.at(joint).status[2], redundant ? kUndetermined : kUnique) << joint;
      }
    }
  }
}

// With crank and rod in line, the spherical joint and the cylindrical guide let the rod spin about that line: the drive
// does not determine that motion, which is said, yet what it does determine has finite forces.
TEST(InverseTest, ARodThatMaySpinInLineIsSaidToBeUndriven) {
  Driven crank(make_slider_crank(SliderCrankJoints::kSphericalCylindrical, 0));
  EXPECT_EQ(crank.motion.check().status, PrescribedStatus::kUndriven);
}

TEST(InverseTest, MotionThroughAnIdleSpinKeepsItsUniqueForces) {
  Driven crank(make_slider_crank(SliderCrankJoints::kSphericalCylindrical, std::numbers::pi / 4));
  const SliderCrankFigures& f = kSliderCrank[3];
  const double t_180 = 3 * std::numbers::pi / 4 / 30;
  for (int i = 0; i <= 30; ++i) crank.solve(t_180 * i / 30);
  EXPECT_NEAR(crank.result.u[0], f.torque, 1e-6);
  expect_force(crank.at("O"), f.o_x, f.o_y, 1e-5);
  expect_force(crank.at("B"), f.b_x, f.b_y, 1e-5);
}

TEST(InverseTest, TheSameFiguresComeWhenTheCrankArrivesThere) {
  // Drawn at 45 degrees; an eighth of a turn later it stands at 90.
  Driven crank(make_slider_crank(SliderCrankJoints::kRevolutePrismatic, std::numbers::pi / 4));
  const double t_90 = std::numbers::pi / 4 / 30;
  for (int i = 0; i <= 10; ++i) crank.solve(t_90 * i / 10);
  EXPECT_NEAR(crank.result.u[0], kSliderCrank[2].torque, 1e-6);
  expect_force(crank.at("O"), kSliderCrank[2].o_x, kSliderCrank[2].o_y, 1e-6);
}

// Closed form of the plane mechanism; published multibody runs agree with it to 0.01 N·m.
TEST(InverseTest, ADrivenFourBarNeedsTheKnownTorque) {
  Driven bar(make_driven_four_bar());
  const std::array<std::pair<double, double>, 7> torques = {{{0, 66.01166666667},
                                                             {0.5, 24.75975626694},
                                                             {1, -16.87515385932},
                                                             {2, -36.114142542519},
                                                             {3, 64.21764813698},
                                                             {5, -49.46537382281},
                                                             {7.5, -44.17640094092}}};
  for (const auto& [t, torque] : torques) {
    bar.solve(t);
    EXPECT_NEAR(bar.result.u[0], torque, 1e-8 * std::abs(torque)) << t;
    if (t == 0) {
      expect_force(bar.at("O"), 1.06666667, 71.7166667, 1e-7);
      expect_force(bar.at("B"), 8.53333333, 18.5533333, 1e-7);
    } else if (t == 1) {
      expect_force(bar.at("O"), 14.7052988, 25.3701747, 1e-7);
      expect_force(bar.at("B"), -13.6375698, 29.5867959, 1e-7);
    }
    for (const char* joint : {"O", "A", "C", "B"}) {
      for (const int k : {2, 3, 4}) EXPECT_EQ(bar.at(joint).status[k], kUndetermined) << joint << kComponentNames[k];
      EXPECT_EQ(bar.at(joint).status[5], kUnique);  // the freedom
    }
  }
}

TEST(InverseTest, ResultsDoNotDependOnTheGrid) {
  Driven fine(make_driven_four_bar()), coarse(make_driven_four_bar());
  for (int i = 0; i <= 100; ++i) fine.solve(0.01 * i);
  coarse.solve(1);
  EXPECT_NEAR(fine.result.u[0], coarse.result.u[0], 1e-10);
  EXPECT_LT((fine.result.state.q - coarse.result.state.q).norm(), 1e-12);
}

TEST(InverseTest, ACoordinateFollowsItsLawWithBothDerivatives) {
  Driven bar(make_driven_four_bar());
  const double t = 0.7;
  bar.solve(t);
  const CoordinateAccess crank = bar.engine.system->access({*bar.engine.model().find_joint("O"), 0});
  ASSERT_TRUE(crank.in_tree);
  EXPECT_NEAR(bar.result.state.q[crank.q], 1.2 * (1 - std::cos(2 * t)), 1e-12);
  EXPECT_NEAR(bar.result.state.v[crank.v], 2.4 * std::sin(2 * t), 1e-12);
  EXPECT_NEAR(bar.result.vdot[crank.v], 4.8 * std::cos(2 * t), 1e-11);
}

TEST(InverseTest, AnUndrivenMechanismNamesWhatStillMoves) {
  ModelSpec spec = make_driven_four_bar();
  spec.drives.clear();
  const Driven bar(spec);
  const PrescribedResult check = bar.motion.check();
  EXPECT_EQ(check.status, PrescribedStatus::kUndriven);
  // In the drawn pose coupler and rocker start to turn alike: C is at rest for an instant.
  for (const char* name : {"O", "A", "B"}) EXPECT_NE(check.message.find(name), std::string::npos) << check.message;
}

// What is suggested determines the motion, for every mechanism of the zoo whose coordinates are all scalars.
TEST(InverseTest, DrivingWhatIsSuggestedDeterminesTheMotion) {
  int tried = 0;
  for (ZooEntry& entry : zoo()) {
    entry.spec.drives.clear();
    const Driven loose(entry.spec);
    const PrescribedResult check = loose.motion.check();
    if (entry.mobility == 0) {
      EXPECT_EQ(check.status, PrescribedStatus::kSolved) << entry.name;
      continue;
    }
    ASSERT_EQ(check.status, PrescribedStatus::kUndriven) << entry.name;
    if (static_cast<int>(check.to_drive.size()) < entry.mobility) continue;
    ++tried;
    for (std::size_t i = 0; i < check.to_drive.size(); ++i) {
      DriveSpec drive;
      drive.name = numbered("drive", static_cast<int>(i));
      const Joint& joint = loose.engine.model().joint(check.to_drive[i].joint);
      drive.coordinate = CoordinateRef{
          NameRef(joint.name), std::string(joint_type_info(joint.type).coordinates[check.to_drive[i].index].name)};
      drive.motion = {law("0*t")};
      entry.spec.drives.push_back(drive);
    }
    const Driven driven(entry.spec);
    EXPECT_EQ(driven.motion.check().status, PrescribedStatus::kSolved) << entry.name << driven.motion.check().message;
  }
  EXPECT_GT(tried, 10);
}

TEST(InverseTest, APositionOutOfReachIsReportedAtItsTime) {
  ModelSpec spec = make_driven_four_bar();
  spec.drives = {coordinate_drive("pull", "B", "t")};  // the rocker cannot turn right round
  Driven bar(spec);
  PrescribedResult last;
  double t = 0;
  for (; t < 6; t += 0.1) {
    last = bar.motion.solve(t);
    if (last.status != PrescribedStatus::kSolved) break;
  }
  EXPECT_TRUE(last.status == PrescribedStatus::kNotReached || last.status == PrescribedStatus::kSingular);
  EXPECT_GT(t, 0.1);
  EXPECT_LT(t, 6);
  EXPECT_FALSE(last.message.empty());
}

// A slider driven through its dead point: the crank's direction is not determined there.
TEST(InverseTest, ADeadPointIsReported) {
  ModelSpec spec = make_slider_crank(SliderCrankJoints::kRevolutePrismatic, 0);
  DriveSpec push = coordinate_drive("push", "guide", "0*t");
  spec.drives = {push};
  Driven crank(spec);
  PrescribedResult result = crank.motion.check();
  if (result.status == PrescribedStatus::kSolved) result = crank.motion.solve(0);
  EXPECT_NE(result.status, PrescribedStatus::kSolved);
}

// Laws that end somewhere: it is said whose, what is missing and when, and nothing waits for ever.
TEST(InverseTest, ALawWithoutFiniteValuesIsNamedWithItsTime) {
  struct Case {
    const char* law;
    double good, bad;
    const char* what;
  };
  for (const Case& one : {Case{"log(t)", 0.5, 0, "value"}, Case{"sqrt(t)", 0.5, 0, "rate"},
                          Case{"t^1.5", 0.5, 0, "acceleration"}, Case{"log(t+0.5)+sqrt(0.5-t)", 0.2, 0.7, "value"}}) {
    SCOPED_TRACE(one.law);
    ModelSpec spec;
    spec.name = "slide";
    spec.bodies = {box_body("block", {0, 0, 0}, {0.1, 0.1, 0.1}, 2)};
    spec.joints = {joint(JointType::kPrismatic, "slide", "ground", "block", {0, 0, 0}, {1, 0, 0})};
    spec.drives = {coordinate_drive("screw", "slide", one.law)};
    Driven slide(spec);
    slide.solve(one.good);
    const PrescribedResult failed = slide.motion.solve(one.bad);
    EXPECT_EQ(failed.status, PrescribedStatus::kUndefined);
    const std::string wanted = std::string("the motion of drive 'screw' has no finite ") + one.what +
                               " at t = " + (one.bad > 0 ? "0.7 s" : "0 s");
    EXPECT_EQ(failed.message, wanted);
  }
}

// A finite position further away than pieces of 0.1 can be counted ends as well.
TEST(InverseTest, APositionBeyondAllPiecesIsNotReached) {
  ModelSpec spec = make_driven_four_bar();
  spec.drives[0].motion = {law("1e300")};
  Driven bar(spec);
  EXPECT_EQ(bar.motion.solve(0).status, PrescribedStatus::kNotReached);
}

// A drive on a distance pushes its two points apart: a mass hung on a slide is held by m g.
TEST(InverseTest, DrivesOnDistancesAndPointsHoldAWeight) {
  ModelSpec spec;
  spec.name = "lift";
  spec.bodies = {box_body("car", {0, 0, 2}, {0.5, 0.5, 0.5}, 3)};
  spec.joints = {joint(JointType::kPrismatic, "rail", "ground", "car", {0, 0, 2})};
  DriveSpec rope;
  rope.name = "rope";
  rope.bodies = std::array<NameRef, 2>{NameRef("ground"), NameRef("car")};
  rope.points = std::array<Number3, 2>{number3(0, 0, 0), number3(0, 0, 2)};
  rope.motion = {law("2 + t^2")};
  spec.drives = {rope};
  Driven lift(spec);
  lift.solve(0.5);
  EXPECT_NEAR(lift.result.state.q[0], 0.25, 1e-12);
  EXPECT_NEAR(lift.result.u[0], 3 * (9.81 + 2), 1e-10);

  // A recorded point of a body on a planar joint, moved along a path; the effort is the force on it.
  ModelSpec plane;
  plane.bodies = {box_body("plate", {0, 0, 0}, {1, 1, 0.1}, 2)};
  plane.joints = {joint(JointType::kFree, "float", "ground", "plate", {0, 0, 0})};
  plane.records = {record("C", "plate", {0, 0, 0})};
  DriveSpec path;
  path.name = "path";
  path.point = NameRef("C");
  path.motion = {law("t^2"), law("sin(t)"), law("0*t")};
  plane.drives = {path};
  const Driven plate(plane);
  EXPECT_EQ(plate.motion.check().status, PrescribedStatus::kUndriven);  // it may still turn
}

}  // namespace
}  // namespace ferrers::witness
