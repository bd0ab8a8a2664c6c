#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "ferrers/testing/build_checks.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers {
namespace {

using namespace witness;  // NOLINT(google-build-using-namespace): a test's vocabulary

/// Bodies a, b, c: hinge (revolute) a on ground, tube (cylindrical) b on a, ball (spherical) c on b; point P on b.
ModelSpec chain() {
  ModelSpec spec;
  for (const char* name : {"a", "b", "c"}) {
    BodySpec body;
    body.name = name;
    spec.bodies.push_back(body);
  }
  spec.joints = {joint(JointType::kRevolute, "hinge", "ground", "a", Point::Zero()),
                 joint(JointType::kCylindrical, "tube", "a", "b", Point::Zero()),
                 joint(JointType::kSpherical, "ball", "b", "c", Point::Zero())};
  spec.records = {record("P", "b", Point(1, 2, 3))};
  return spec;
}

ModelSpec with_drive(const DriveSpec& drive) {
  ModelSpec spec = chain();
  spec.drives = {drive};
  return spec;
}

DriveSpec point_drive() {
  DriveSpec drive;
  drive.name = "path";
  drive.point = "P";
  drive.motion = {law("t"), law("0"), law("1")};
  return drive;
}

InitialSpec initial(const std::string& joint_name, std::vector<Number> position, std::vector<Number> velocity = {}) {
  InitialSpec spec;
  spec.joint = joint_name;
  spec.position = std::move(position);
  spec.velocity = std::move(velocity);
  return spec;
}

ModelSpec with_initial(std::vector<InitialSpec> values) {
  ModelSpec spec = chain();
  spec.initial = std::move(values);
  return spec;
}

EventSpec event(const std::string& when, EventSpec::Action action) {
  Diagnostics diagnostics;
  EventSpec spec;
  spec.name = "stop";
  spec.when = *Expression::parse(when, {}, diagnostics);
  spec.action = action;
  return spec;
}

TEST(BuildDrivesTest, AWeightIsAboveZeroAndOneByDefault) {
  DriveSpec drive = coordinate_drive("motor", "hinge", "t");
  EXPECT_EQ(built(with_drive(drive)).drives()[0].weight, 1);
  drive.weight = Number(0.25);
  EXPECT_EQ(built(with_drive(drive)).drives()[0].weight, 0.25);
  for (const double wrong : {0.0, -1.0}) {
    drive.weight = Number(wrong);
    EXPECT_EQ(build_codes(with_drive(drive)), Codes{"F334"});
  }
}

TEST(BuildDrivesTest, DriveSitsOnACoordinate) {
  DriveSpec drive = coordinate_drive("motor", "tube", "2*t", "3");
  EXPECT_EQ(build_codes(with_drive(drive)), Codes{"F305"});
  drive.coordinate->coordinate = "displacement";
  const Model model = built(with_drive(drive));
  EXPECT_EQ(model.drives()[0].kind, Drive::Kind::kCoordinate);
  EXPECT_EQ(model.drives()[0].coordinate, (JointCoordinate{JointId(1), 1}));
  EXPECT_EQ(model.drives()[0].motion.size(), 1U);
  EXPECT_EQ(model.drives()[0].effort.size(), 1U);
}

TEST(BuildDrivesTest, DriveOnADistanceNeedsTwoPointsApart) {
  DriveSpec drive;
  drive.name = "ram";
  drive.bodies = {{NameRef("ground"), NameRef("b")}};
  drive.points = {{number3(1, 0, 0), number3(1, 0, 2)}};
  drive.effort = {law("5 N")};
  const Model model = built(with_drive(drive));
  EXPECT_EQ(model.drives()[0].kind, Drive::Kind::kDistance);
  EXPECT_EQ(model.drives()[0].second, BodyId(2));
  drive.points = {{number3(1, 0, 0), number3(1, 0, 0)}};
  EXPECT_EQ(build_codes(with_drive(drive)), Codes{"F321"});
  drive.points.reset();
  EXPECT_EQ(build_codes(with_drive(drive)), Codes{"F329"});
}

TEST(BuildDrivesTest, DriveOnARecordedPointHasThreeLaws) {
  const Model model = built(with_drive(point_drive()));
  EXPECT_EQ(model.drives()[0].kind, Drive::Kind::kPoint);
  EXPECT_EQ(model.drives()[0].second, BodyId(2));
  EXPECT_EQ(model.drives()[0].point_2_m, Vector3d(1, 2, 3));
  EXPECT_EQ(model.drives()[0].motion.size(), 3U);
  DriveSpec short_of_laws = point_drive();
  short_of_laws.motion.pop_back();
  EXPECT_EQ(build_codes(with_drive(short_of_laws)), Codes{"F329"});
  DriveSpec lost = point_drive();
  lost.point = "Q";
  EXPECT_EQ(build_codes(with_drive(lost)), Codes{"F306"});
}

TEST(BuildDrivesTest, ExactlyOneTargetIsNeeded) {
  DriveSpec none;
  none.name = "motor";
  EXPECT_EQ(build_codes(with_drive(none)), Codes{"F329"});
  DriveSpec two = point_drive();
  two.coordinate = coordinate_drive("m", "hinge", "t").coordinate;
  EXPECT_EQ(build_codes(with_drive(two)), Codes{"F329"});
}

TEST(BuildInitialTest, WholeJointsTakeAllTheirNumbers) {
  const Model model = built(
      with_initial({initial("hinge", {Number(0.3)}, {Number(6.0)}),
                    initial("ball", {Number(0), Number(1), Number(0), Number(0)}, {Number(1), Number(2), Number(3)})}));
  EXPECT_FALSE(model.initial()[0].whole_joint);
  EXPECT_EQ(model.initial()[0].position, std::vector<double>{0.3});
  EXPECT_EQ(model.initial()[0].velocity, std::vector<double>{6.0});
  EXPECT_TRUE(model.initial()[1].whole_joint);
  EXPECT_EQ(model.initial()[1].velocity, (std::vector<double>{1, 2, 3}));
}

TEST(BuildInitialTest, OneCoordinateOfSeveralIsNamed) {
  InitialSpec spec = initial("tube", {Number(0.2)});
  EXPECT_EQ(build_codes(with_initial({spec})), Codes{"F331"});
  spec.coordinate = "displacement";
  const Model model = built(with_initial({spec}));
  EXPECT_EQ(model.initial()[0].coordinate.index, 1);
  spec.coordinate = "angle_1";
  EXPECT_EQ(build_codes(with_initial({spec})), Codes{"F305"});
}

TEST(BuildInitialTest, WrongValuesAreErrors) {
  EXPECT_EQ(build_codes(with_initial({initial("hinge", {Number(1), Number(2)})})), Codes{"F331"});
  EXPECT_EQ(build_codes(with_initial({initial("hinge", {})})), Codes{"F331"});
  EXPECT_EQ(build_codes(with_initial({initial("hing", {Number(1)})})), Codes{"F304"});
  EXPECT_EQ(build_codes(with_initial({initial("ball", {Number(1), Number(1), Number(0), Number(0)})})), Codes{"F327"});
  EXPECT_EQ(build_codes(with_initial({initial("hinge", {Number(1)}), initial("hinge", {}, {Number(1)})})),
            Codes{"F331"});
}

TEST(BuildInitialTest, JointWithoutCoordinatesHasNoInitialValues) {
  ModelSpec spec = with_initial({initial("clamp", {Number(1)})});
  spec.joints.push_back(joint(JointType::kWeld, "clamp", "ground", "c", Point::Zero()));
  EXPECT_EQ(build_codes(spec), Codes{"F331"});
}

TEST(BuildRecordsTest, UnknownBodiesAndRepeatedNamesAreErrors) {
  ModelSpec spec = chain();
  spec.records.push_back(record("P", "d", Point::Zero()));
  EXPECT_EQ(build_codes(spec), (Codes{"F302", "F303"}));
}

TEST(BuildEventsTest, SwitchNeedsADriveAndOnlySwitchTakesOne) {
  ModelSpec spec = with_drive(point_drive());
  spec.events = {event("hinge.angle - 12", EventSpec::Action::kStop)};
  const Model model = built(spec);
  EXPECT_EQ(model.events()[0].when.inputs().at(0).kind, LawInput::Kind::kPosition);
  spec.events[0].action = EventSpec::Action::kSwitch;
  EXPECT_EQ(build_codes(spec), Codes{"F332"});
  spec.events[0].drive = "path";
  const Model switching = built(spec);
  EXPECT_EQ(switching.events()[0].drive, DriveId(0));
  spec.events[0].drive = "pth";
  EXPECT_EQ(build_codes(spec), Codes{"F306"});
  spec.events[0].action = EventSpec::Action::kRecord;
  EXPECT_EQ(build_codes(spec), Codes{"F332"});
}

}  // namespace
}  // namespace ferrers
