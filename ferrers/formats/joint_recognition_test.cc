#include "ferrers/formats/joint_recognition.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ferrers/math/rotation.h"
#include "ferrers/model/model.h"
#include "ferrers/model/pose_spec.h"

namespace ferrers {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

using Eigen::Vector3d;

BodySpec body(const std::string& name, double mass) {
  BodySpec spec;
  spec.name = name;
  spec.mass = Number(mass);
  spec.com = number3(0, 0, 0);
  spec.pose = PoseSpec();
  if (mass == 0) return spec;
  spec.inertia.kind = InertiaSpec::Kind::kTensor;
  spec.inertia.moments = number3(1, 1, 1);
  return spec;
}

/// A revolute joint at `point` of both bodies, whose frames coincide with the world's as drawn.
JointSpec pin(const std::string& name, const std::string& first, const std::string& second, const Vector3d& axis,
              const Vector3d& point = Vector3d(0, 0, 1)) {
  JointSpec spec;
  spec.name = name;
  spec.bodies = {NameRef(first), NameRef(second)};
  const PoseSpec frame = pose_spec(Pose(frame_from_z(axis), point));
  spec.frames = {frame, frame};
  return spec;
}

/// ground - x - a - y - b - z - arm.
ModelSpec ball() {
  ModelSpec spec;
  spec.bodies = {body("a", 0), body("b", 0), body("arm", 1)};
  spec.joints = {pin("jx", "ground", "a", Vector3d::UnitX()), pin("jy", "a", "b", Vector3d::UnitY()),
                 pin("jz", "b", "arm", Vector3d::UnitZ())};
  return spec;
}

TEST(JointRecognitionTest, ThreePerpendicularPinsThroughOnePointAreSpherical) {
  const std::vector<RevoluteRow> rows = find_revolute_rows(ball());
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].type, JointType::kSpherical);
  EXPECT_THAT(rows[0].joints, ElementsAre("jx", "jy", "jz"));
  EXPECT_THAT(rows[0].between, ElementsAre("a", "b"));
}

TEST(JointRecognitionTest, TwoPerpendicularPinsAreUniversal) {
  ModelSpec spec = ball();
  spec.bodies[1] = body("b", 2);
  const std::vector<RevoluteRow> rows = find_revolute_rows(spec);
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].type, JointType::kUniversal);
  EXPECT_THAT(rows[0].joints, ElementsAre("jx", "jy"));
}

TEST(JointRecognitionTest, AxesMayMeetAwayFromTheirOrigins) {
  ModelSpec spec = ball();
  spec.joints[2] = pin("jz", "b", "arm", Vector3d::UnitZ(), Vector3d(0, 0, -7));
  EXPECT_EQ(find_revolute_rows(spec).at(0).type, JointType::kSpherical);
}

TEST(JointRecognitionTest, AxesThatDoNotMeetInOnePointAreNotOneJoint) {
  ModelSpec spec = ball();
  spec.joints[2] = pin("jz", "b", "arm", Vector3d::UnitZ(), Vector3d(0, 0.01, 1));  // meets y, elsewhere
  EXPECT_EQ(find_revolute_rows(spec).at(0).type, JointType::kUniversal);
  spec.joints[1] = pin("jy", "a", "b", Vector3d::UnitY(), Vector3d(0, 0, 1.01));
  EXPECT_THAT(find_revolute_rows(spec).at(0).joints, ElementsAre("jy", "jz"));  // which meet all the same
  spec.joints[1] = pin("jy", "a", "b", Vector3d::UnitY(), Vector3d(0.01, 0, 1.01));
  EXPECT_THAT(find_revolute_rows(spec), IsEmpty());
}

TEST(JointRecognitionTest, AxesThatAreNotPerpendicularAreNotOneJoint) {
  ModelSpec spec = ball();
  spec.bodies[1] = body("b", 2);
  spec.joints[1] = pin("jy", "a", "b", Vector3d(0.1, 1, 0).normalized());
  EXPECT_THAT(find_revolute_rows(spec), IsEmpty());
}

TEST(JointRecognitionTest, WhatIsNamedElsewhereStays) {
  using Change = std::function<void(ModelSpec&)>;
  const std::vector<Change> all = {
      [](ModelSpec& spec) {
        spec.couplings.push_back({"c", {{"jx", ""}, {"jz", ""}}, {Number(1), Number(1)}, {}});
        spec.couplings.push_back({"d", {{"jy", ""}}, {Number(1)}, {}});
      },
      [](ModelSpec& spec) {
        DriveSpec drive;
        drive.name = "motor";
        drive.coordinate = CoordinateRef{"jy", ""};
        spec.drives.push_back(drive);
      },
      [](ModelSpec& spec) {
        spec.joints[1].limits = {Number(-1), Number(1)};
      },
      [](ModelSpec& spec) { spec.joints[1].friction = FrictionSpec(); },
      [](ModelSpec& spec) {
        spec.forces.push_back({"spring", TorsionSpringSpec{{"jy", ""}, Number(1), Number(0), Number(0)}, {}});
      },
      [](ModelSpec& spec) {
        InitialSpec initial;
        initial.joint = "jy";
        spec.initial.push_back(initial);
      },
      [](ModelSpec& spec) {
        spec.lagrangian.kinetic_energy = Expression::variable("jy.velocity") * Expression::variable("jy.velocity");
      },
      [](ModelSpec& spec) {
        spec.constraints.push_back({"k", Expression::variable("jy.position"), false, {}});
      },
      [](ModelSpec& spec) {
        spec.bodies.push_back(body("more", 1));  // a third joint on each body between
        spec.joints.push_back(pin("ja", "a", "more", Vector3d::UnitX()));
        spec.joints.push_back(pin("jb", "b", "more", Vector3d::UnitX()));
      },
      [](ModelSpec& spec) {
        RecordSpec record;
        record.name = "P";
        record.body = "a";
        spec.records.push_back(record);
        record.body = "b";
        spec.records.push_back(record);
      },
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    ModelSpec spec = ball();
    all[i](spec);
    EXPECT_THAT(find_revolute_rows(spec), IsEmpty()) << i;
  }
}

/// The pose of the last body of a row of joints, each at its angle.
Pose along(const Model& model, const std::vector<double>& angles) {
  Pose X;
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const Joint& joint = model.joints()[i];
    const Pose turn(Eigen::AngleAxisd(angles[i], Vector3d::UnitZ()).toRotationMatrix(), Vector3d::Zero());
    X = X * joint.X_1F * turn * joint.X_2M.inverse();
  }
  return X;
}

TEST(JointRecognitionTest, TheMergedJointMovesItsEndsAsTheRowDoes) {
  ModelSpec spec = ball();
  (*spec.joints[0].frames)[0].position = number3(0.3, -0.2, 1);
  spec.joints[2] = pin("jz", "b", "arm", Vector3d::UnitZ(), Vector3d(0, 0, 4));
  const Model row = *build_model(spec).model;
  Diagnostics told;
  merge_revolute_rows(spec, find_revolute_rows(spec), told);
  EXPECT_EQ(told.items().size(), 1U);
  EXPECT_EQ(spec.bodies.size(), 1U);
  const ModelBuildResult built = build_model(spec);
  ASSERT_TRUE(built.model);
  const Joint& merged = built.model->joints().at(0);
  EXPECT_EQ(merged.name, "jx");
  EXPECT_EQ(merged.type, JointType::kSpherical);
  // As drawn the two are the same; at any angles the point of the joint stays where it is on both ends.
  const Pose zero = merged.X_1F * merged.X_2M.inverse();
  EXPECT_TRUE(zero.R.isApprox(along(row, {0, 0, 0}).R, 1e-14));
  EXPECT_TRUE(zero.p.isApprox(along(row, {0, 0, 0}).p, 1e-14));
  const Pose turned = along(row, {0.3, -0.7, 1.1});
  EXPECT_TRUE((turned * merged.X_2M.p).isApprox(merged.X_1F.p, 1e-14));
}

TEST(JointRecognitionTest, TheAnglesOfAMergedUniversalJointAreThoseOfItsRow) {
  ModelSpec spec = ball();
  spec.bodies[1] = body("b", 2);
  const Model row = *build_model(spec).model;
  Diagnostics told;
  merge_revolute_rows(spec, find_revolute_rows(spec), told);
  const Model model = *build_model(spec).model;
  const Joint& merged = model.joints().at(0);
  ASSERT_EQ(merged.type, JointType::kUniversal);
  const double a = 0.4, b = -0.9;
  const Eigen::Matrix3d turn =
      (Eigen::AngleAxisd(a, Vector3d::UnitZ()) * Eigen::AngleAxisd(b, Vector3d::UnitX())).toRotationMatrix();
  const Pose X = merged.X_1F * Pose(turn, Vector3d::Zero()) * merged.X_2M.inverse();
  const Pose expected = along(row, {a, b});
  EXPECT_TRUE(X.R.isApprox(expected.R, 1e-14));
  EXPECT_TRUE(X.p.isApprox(expected.p, 1e-14));
}

}  // namespace
}  // namespace ferrers
