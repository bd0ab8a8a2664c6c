#include "ferrers/formats/asmt_joints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "ferrers/formats/asmt.h"
#include "ferrers/kinematics/system.h"
#include "ferrers/redundancy/mechanism_analysis.h"
#include "ferrers/testing/asmt_text.h"
#include "ferrers/testing/build_checks.h"

namespace ferrers {
namespace {

using testing::HasSubstr;
using witness::AsmtText;

struct Read {
  ImportedModel model;
  Diagnostics diagnostics;
};

Read read(const AsmtText& file) {
  Read result;
  const ImportOptions options;
  const FileLoader none;
  result.model = read_asmt(file.text(), {options, none, result.diagnostics});
  return result;
}

Pose turned(double angle, const Eigen::Vector3d& axis, const Eigen::Vector3d& place = Eigen::Vector3d::Zero()) {
  return {Eigen::AngleAxisd(angle, axis).toRotationMatrix(), place};
}

/// One part on the assembly, their markers joined.
AsmtText joined(const std::string& kind, const Pose& part, const witness::AsmtEntries& more = {}) {
  AsmtText file;
  file.marker("I");
  file.part("body", part);
  file.part_marker("body", "J");
  file.joint(kind, "k", "I", "body/J", more);
  return file;
}

/// Values of a constraint by the poses of the bodies: what recorded points and coordinates stand for.
double value_of(const ConstraintSpec& constraint, const ModelSpec& spec, const std::map<std::string, Pose>& bodies,
                const std::map<std::string, double>& coordinates = {}) {
  std::vector<std::string> names;
  std::vector<double> values;
  for (const ExpressionName& one : constraint.formula.names()) {
    names.push_back(one.name);
    const std::size_t dot = one.name.find('.');
    const auto coordinate = coordinates.find(one.name);
    if (coordinate != coordinates.end()) {
      values.push_back(coordinate->second);
      continue;
    }
    for (const RecordSpec& record : spec.records) {
      if (record.name.name != one.name.substr(0, dot)) continue;
      const Eigen::Vector3d place(record.place[0].value, record.place[1].value, record.place[2].value);
      values.push_back((bodies.at(record.body.name) * place)[one.name[dot + 1] - 'x']);
    }
  }
  EXPECT_EQ(names.size(), values.size());
  return ExpressionProgram(constraint.formula, names).evaluate(values.data());
}

TEST(AsmtJointsTest, ClassesWithACounterpartBecomeIt) {
  const std::vector<std::pair<std::string, JointType>> all = {{"FixedJoint", JointType::kWeld},
                                                              {"RevoluteJoint", JointType::kRevolute},
                                                              {"CylindricalJoint", JointType::kCylindrical},
                                                              {"TranslationalJoint", JointType::kPrismatic},
                                                              {"SphericalJoint", JointType::kSpherical},
                                                              {"UniversalJoint", JointType::kUniversal},
                                                              {"PlanarJoint", JointType::kPlanar},
                                                              {"PointInLineJoint", JointType::kPointOnLine},
                                                              {"PointInPlaneJoint", JointType::kPointOnPlane}};
  for (const auto& [kind, type] : all) {
    const Read result = read(joined(kind, turned(0.4, Eigen::Vector3d::UnitZ(), {3, 4, 5})));
    ASSERT_FALSE(result.diagnostics.has_errors()) << kind << witness::messages(result.diagnostics);
    ASSERT_EQ(result.model.spec.joints.size(), 1U) << kind;
    EXPECT_EQ(result.model.spec.joints[0].type, type) << kind;
    EXPECT_TRUE(result.model.spec.joints[0].frames) << kind;
    EXPECT_TRUE(result.model.spec.constraints.empty()) << kind;
  }
}

TEST(AsmtJointsTest, FramesHalfATurnApartAreReadWithThatHalfTurn) {
  const Pose flipped = turned(std::numbers::pi, Eigen::Vector3d::UnitX());
  for (const char* const kind : {"RevoluteJoint", "FixedJoint", "TranslationalJoint", "PlanarJoint"}) {
    const Read result = read(joined(kind, flipped));
    const JointSpec& joint = result.model.spec.joints.at(0);
    const auto& q = *(*joint.frames)[1].rotation->quaternion;
    EXPECT_NEAR(std::abs(q[1].value), 1, 1e-12) << kind;
    EXPECT_THAT(witness::messages(result.diagnostics),
                HasSubstr("1 joint has two frames that stand about half a turn"));
  }
}

TEST(AsmtJointsTest, OffsetsMoveTheFirstFrameAndDistancesAreLengths) {
  const Read plane = read(joined("PlanarJoint", {}, {{"offset", "7"}}));
  EXPECT_NEAR((*plane.model.spec.joints[0].frames)[0].position[2].value, 0.007, 1e-15);
  const Read rod = read(joined("SphSphJoint", {}, {{"distanceIJ", "30"}}));
  EXPECT_EQ(rod.model.spec.joints[0].type, JointType::kDistance);
  EXPECT_NEAR(rod.model.spec.joints[0].length->value, 0.03, 1e-15);
  EXPECT_TRUE(rod.model.spec.joints[0].points_on_bodies);
}

TEST(AsmtJointsTest, EquationsOfDirectionsHoldWhereTheFileSaysTheyDo) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), z = Eigen::Vector3d::UnitZ();
  struct Case {
    std::string kind;
    witness::AsmtEntries more;
    Pose holds, fails;
    std::size_t equations;
  };
  const std::vector<Case> all = {
      {"ParallelAxesJoint", {}, turned(0.7, z), turned(0.1, x), 2},
      {"PerpendicularJoint", {}, turned(std::numbers::pi / 2, x), turned(0.1, x), 1},
      {"AngleJoint", {{"theIzJz", "0.3"}}, turned(0.3, x), turned(0.4, x), 1},
      {"NoRotationJoint", {}, Pose(), turned(0.1, z), 3},
      {"LineInPlaneJoint", {{"offset", "0"}}, turned(std::numbers::pi / 2, x), turned(0.1, x), 1},
      {"ConstantVelocityJoint", {}, turned(0.3, x), turned(0.3, z) * turned(0.4, x), 1},
      {"CylSphJoint", {{"distanceIJ", "5"}}, turned(0.3, x, {0.003, 0.004, 1}), turned(0, x, {0.003, 0, 0}), 1},
      {"RevCylJoint", {{"distanceIJ", "5"}}, turned(0.3, z, {0.003, 0.004, 1}), turned(0, x, {0.003, 0, 0}), 3},
      {"RevRevJoint", {{"distanceIJ", "5"}}, turned(0.3, z, {0.003, 0.004, 0}), turned(0, x, {0.003, 0, 0}), 3},
  };
  for (const Case& one : all) {
    const Read result = read(joined(one.kind, {}, one.more));
    ASSERT_FALSE(result.diagnostics.has_errors()) << one.kind << witness::messages(result.diagnostics);
    const ModelSpec& spec = result.model.spec;
    ASSERT_EQ(spec.constraints.size(), one.equations) << one.kind;
    double worst = 0;
    for (const ConstraintSpec& constraint : spec.constraints) {
      EXPECT_NEAR(value_of(constraint, spec, {{"body", one.holds}}), 0, 1e-12) << one.kind << constraint.name.name;
      worst = std::max(worst, std::abs(value_of(constraint, spec, {{"body", one.fails}})));
    }
    EXPECT_GT(worst, 1e-3) << one.kind;
  }
}

TEST(AsmtJointsTest, EveryClassTakesAsManyFreedomsAsItHasEquations) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), z = Eigen::Vector3d::UnitZ();
  const Pose across = turned(std::numbers::pi / 2, x), off = turned(0.3, z, {30, 40, 0});
  struct Case {
    std::string kind;
    witness::AsmtEntries more;
    Pose stored;
    int freedoms;
  };
  const std::vector<Case> all = {
      {"FixedJoint", {}, Pose(), 0},
      {"RevoluteJoint", {}, turned(0.3, z), 1},
      {"CylindricalJoint", {}, turned(0.3, z, {0, 0, 5}), 2},
      {"TranslationalJoint", {}, turned(0, z, {0, 0, 5}), 1},
      {"SphericalJoint", {}, turned(0.3, x), 3},
      {"UniversalJoint", {}, across, 2},
      {"ConstantVelocityJoint", {}, turned(0.3, x), 2},
      {"PlanarJoint", {{"offset", "5"}}, turned(0.3, z, {1, 2, 5}), 3},
      {"PointInLineJoint", {}, turned(0.3, x, {0, 0, 5}), 4},
      {"PointInPlaneJoint", {{"offset", "5"}}, turned(0.3, x, {1, 2, 5}), 5},
      {"LineInPlaneJoint", {{"offset", "0"}}, across, 4},
      {"SphSphJoint", {{"distanceIJ", "50"}}, off, 5},
      {"CylSphJoint", {{"distanceIJ", "50"}}, off, 5},
      {"RevCylJoint", {{"distanceIJ", "50"}}, off, 3},
      {"RevRevJoint", {{"distanceIJ", "50"}}, off, 2},
      {"ParallelAxesJoint", {}, off, 4},
      {"PerpendicularJoint", {}, across, 5},
      {"AngleJoint", {{"theIzJz", "0.3"}}, turned(0.3, x), 5},
      {"NoRotationJoint", {}, turned(0, x, {1, 2, 3}), 3},
  };
  for (const Case& one : all) {
    const Read result = read(joined(one.kind, one.stored, one.more));
    ASSERT_FALSE(result.diagnostics.has_errors()) << one.kind << witness::messages(result.diagnostics);
    const MechanismAnalysis analysis = analyze_mechanism(*make_system(witness::built(result.model.spec)));
    ASSERT_TRUE(analysis.redundancy) << one.kind;
    EXPECT_EQ(analysis.redundancy->mobility, one.freedoms) << one.kind;
    EXPECT_EQ(analysis.redundancy->redundant, 0) << one.kind;
  }
}

TEST(AsmtJointsTest, ADistanceOfZeroFromAnAxisIsRefused) {
  EXPECT_THAT(witness::messages(read(joined("CylSphJoint", {}, {{"distanceIJ", "0"}})).diagnostics), HasSubstr("F602"));
}

/// A bed with a slider 'rack' along x and a hinge 'pinion' about z, as FreeCAD stores them.
AsmtText rack_and_pinion() {
  AsmtText file;
  file.marker("slide", turned(std::numbers::pi / 2, Eigen::Vector3d::UnitY()));  // its z is the world's x
  file.marker("hinge", turned(0, Eigen::Vector3d::UnitZ(), {0, 12, 0}));
  file.part("rack", turned(0, Eigen::Vector3d::UnitZ(), {4, 0, 0}));
  file.part_marker("rack", "slide", turned(std::numbers::pi / 2, Eigen::Vector3d::UnitY()));
  file.part_marker("rack", "mesh");
  file.part("pinion", turned(0.2, Eigen::Vector3d::UnitZ(), {0, 12, 0}));
  file.part_marker("pinion", "hinge");
  file.joint("TranslationalJoint", "slider", "slide", "rack/slide");
  file.joint("RevoluteJoint", "bearing", "hinge", "pinion/hinge");
  return file;
}

TEST(AsmtJointsTest, ARackAndItsPinionMoveTogetherByTheRadius) {
  AsmtText file = rack_and_pinion();
  file.joint("RackPinionJoint", "mesh", "rack/mesh", "pinion/hinge", {{"pitchRadius", "12"}});
  const Read result = read(file);
  ASSERT_FALSE(result.diagnostics.has_errors()) << witness::messages(result.diagnostics);
  ASSERT_EQ(result.model.spec.constraints.size(), 1U);
  const ConstraintSpec& mesh = result.model.spec.constraints[0];
  const auto value = [&](double way, double angle) {
    return value_of(mesh, result.model.spec, {}, {{"slider.position", way}, {"bearing.position", angle}});
  };
  EXPECT_NEAR(value(0.004, 0.2), 0, 1e-12);           // as stored
  EXPECT_NEAR(value(0.004 + 0.0012, 0.3), 0, 1e-12);  // x of the pinion seen from the rack falls as the rack goes on
  EXPECT_GT(std::abs(value(0.004, 0.3)), 1e-4);
}

TEST(AsmtJointsTest, APinionNamedFirstKeepsTheEquationOfItsTurningFrame) {
  AsmtText file = rack_and_pinion();
  file.joint("RackPinionJoint", "mesh", "pinion/hinge", "rack/mesh", {{"pitchRadius", "1"}});
  const Read result = read(file);
  ASSERT_FALSE(result.diagnostics.has_errors()) << witness::messages(result.diagnostics);
  const auto demanded = [](double way, double angle) {  // x of the rack in the pinion's axes, and the angle back
    const Eigen::Vector2d apart(way, -0.012);
    return Eigen::Vector2d(std::cos(angle), std::sin(angle)).dot(apart) - 0.001 * angle;
  };
  for (const auto& [way, angle] : std::vector<std::pair<double, double>>{{0.004, 0.2}, {0.01, -0.7}, {-0.02, 2}}) {
    EXPECT_NEAR(value_of(result.model.spec.constraints.at(0), result.model.spec, {},
                         {{"slider.position", way}, {"bearing.position", angle}}),
                demanded(way, angle) - demanded(0.004, 0.2), 1e-12);
  }
}

TEST(AsmtJointsTest, AScrewAdvancesByItsPitchPerTurn) {
  AsmtText file;
  file.marker("I");
  file.part("nut", turned(0.1, Eigen::Vector3d::UnitZ(), {0, 0, 3}));
  file.part_marker("nut", "J");
  file.joint("CylindricalJoint", "tube", "I", "nut/J");
  file.joint("ScrewJoint", "thread", "I", "nut/J", {{"pitch", "2"}});
  const Read result = read(file);
  ASSERT_FALSE(result.diagnostics.has_errors()) << witness::messages(result.diagnostics);
  const auto value = [&](double way, double angle) {
    return value_of(result.model.spec.constraints.at(0), result.model.spec, {},
                    {{"tube.displacement", way}, {"tube.angle", angle}});
  };
  EXPECT_NEAR(value(0.003, 0.1), 0, 1e-15);
  EXPECT_NEAR(value(0.005, 0.1 + 2 * std::numbers::pi), 0, 1e-15);
}

TEST(AsmtJointsTest, GearsTurnAgainstEachOtherByTheirRadii) {
  AsmtText file;
  file.marker("a");
  file.marker("b", turned(0, Eigen::Vector3d::UnitZ(), {50, 0, 0}));
  file.part("small");
  file.part_marker("small", "hub");
  file.part("large", turned(0.3, Eigen::Vector3d::UnitZ(), {50, 0, 0}));
  file.part_marker("large", "hub");
  file.joint("RevoluteJoint", "ja", "a", "small/hub");
  file.joint("RevoluteJoint", "jb", "large/hub", "b");  // from the gear to the frame: its angle counts back
  file.joint("GearJoint", "mesh", "small/hub", "large/hub", {{"radiusI", "20"}, {"radiusJ", "30"}});
  const Read result = read(file);
  ASSERT_FALSE(result.diagnostics.has_errors()) << witness::messages(result.diagnostics);
  const auto value = [&](double a, double b) {
    return value_of(result.model.spec.constraints.at(0), result.model.spec, {},
                    {{"ja.position", a}, {"jb.position", b}});
  };
  EXPECT_NEAR(value(0, -0.3), 0, 1e-15);
  EXPECT_NEAR(value(0.6, -0.3 + 0.4), 0, 1e-15);
}

TEST(AsmtJointsTest, RelationsWithoutCoordinatesAreRefusedByName) {
  AsmtText file;
  file.marker("a");
  file.part("ball");
  file.part_marker("ball", "hub");
  file.joint("SphericalJoint", "socket", "a", "ball/hub");
  file.joint("ScrewJoint", "thread", "a", "ball/hub", {{"pitch", "2"}});
  EXPECT_THAT(witness::messages(read(file).diagnostics), HasSubstr("F602: 'thread' relates motions"));
}

TEST(AsmtJointsTest, MotionsBecomeDrivesAndLimitsBecomeLimits) {
  AsmtText file = rack_and_pinion();
  file.motion("RotationalMotion", "motor", {{"MotionJoint", "/A/bearing"}, {"RotationZ", "4.0d*pi*time"}});
  file.motion("TranslationalMotion", "push", {{"MotionJoint", "/A/slider"}, {"TranslationZ", "10*time"}});
  file.limit("RotationLimit", "stop",
             {{"MarkerI", "/A/hinge"},
              {"MarkerJ", "/A/pinion/hinge"},
              {"MotionJoint", ""},
              {"Limit", "30.0*pi/180.0"},
              {"Type", "=<"},
              {"Tol", "1.0e-9"}});
  file.limit("TranslationLimit", "end",
             {{"MarkerI", "/A/rack/slide"},
              {"MarkerJ", "/A/slide"},
              {"MotionJoint", ""},
              {"Limit", "5"},
              {"Type", "=<"},
              {"Tol", "1.0e-9"}});
  const Read result = read(file);
  ASSERT_FALSE(result.diagnostics.has_errors()) << witness::messages(result.diagnostics);
  const ModelSpec& spec = result.model.spec;
  ASSERT_EQ(spec.drives.size(), 2U);
  EXPECT_EQ(spec.drives[0].coordinate->joint.name, "bearing");
  const double t = 2;
  const std::vector<std::string> inputs = {"t"};
  EXPECT_NEAR(ExpressionProgram(*spec.drives[0].motion[0].expression, inputs).evaluate(&t), 8 * std::numbers::pi,
              1e-12);
  EXPECT_NEAR(ExpressionProgram(*spec.drives[1].motion[0].expression, inputs).evaluate(&t), 0.02, 1e-15);
  EXPECT_NEAR((*spec.joints[1].limits)[1].value, std::numbers::pi / 6, 1e-12);
  EXPECT_LT((*spec.joints[1].limits)[0].value, -1e6);
  EXPECT_NEAR((*spec.joints[0].limits)[0].value, -0.005, 1e-12);  // its markers stand the other way round
}

TEST(AsmtJointsTest, AMotionOfAJointWithoutThatCoordinateIsRefused) {
  AsmtText file = rack_and_pinion();
  file.motion("RotationalMotion", "motor", {{"MotionJoint", "/A/slider"}, {"RotationZ", "time"}});
  EXPECT_THAT(witness::messages(read(file).diagnostics), HasSubstr("'motor' moves 'slider', which has no angle"));
}

}  // namespace
}  // namespace ferrers
