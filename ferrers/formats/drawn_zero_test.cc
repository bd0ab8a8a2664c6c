#include "ferrers/formats/drawn_zero.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ferrers/kinematics/motion.h"
#include "ferrers/model/pose_spec.h"
#include "ferrers/testing/build_checks.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers {
namespace {

using witness::built;
using witness::Point;

/// A row of bodies whose joints are all drawn away from zero.
ModelSpec bent() {
  ModelSpec spec;
  const std::vector<JointType> types = {JointType::kRevolute, JointType::kPrismatic, JointType::kCylindrical,
                                        JointType::kPlanar,   JointType::kSpherical, JointType::kFree};
  std::string before = "ground";
  Pose X_W;
  for (std::size_t i = 0; i < types.size(); ++i) {
    const std::string name = "b" + std::to_string(i);
    const double angle = 0.3 + 0.2 * static_cast<double>(i);
    const Matrix3d turn = Eigen::AngleAxisd(angle, Point::UnitZ()).toRotationMatrix();
    Pose motion;
    if (types[i] != JointType::kPrismatic) motion.R = turn;
    if (types[i] == JointType::kPrismatic || types[i] == JointType::kCylindrical) motion.p = Point(0, 0, 0.4);
    if (types[i] == JointType::kPlanar) motion.p = Point(0.1, 0.2, 0);
    if (types[i] == JointType::kFree) motion.p = Point(0.1, 0.2, 0.3);
    const Pose F(Eigen::AngleAxisd(1.1, Point(1, 2, 2) / 3).toRotationMatrix(), Point(0.5, 0, 0.1)),
        M(Eigen::AngleAxisd(-0.7, Point(2, 1, 2) / 3).toRotationMatrix(), Point(0.1, 0.2, 0));
    X_W = X_W * F * motion * M.inverse();
    BodySpec body = witness::box_body(name, Point::Zero(), Point(1, 1, 1), 1);
    body.pose = pose_spec(X_W);
    spec.bodies.push_back(body);
    JointSpec joint;
    joint.name = "j" + std::to_string(i);
    joint.type = types[i];
    joint.bodies = {NameRef(before), NameRef(name)};
    joint.frames = {pose_spec(F), pose_spec(M)};
    if (types[i] == JointType::kRevolute) joint.limits = {Number(-1), Number(2)};
    spec.joints.push_back(joint);
    before = name;
  }
  return spec;
}

std::vector<Pose> drawn_poses(const Model& model, VectorXd& q) {
  const auto system = make_system(std::make_shared<const Model>(model));
  q = system->drawn_q;
  PositionKinematics pos = make_position_kinematics(*system);
  compute_positions(*system, q, pos);
  std::vector<Pose> poses;
  for (std::size_t b = 1; b < model.bodies().size(); ++b) poses.push_back(body_pose(*system, pos, BodyId(b)));
  return poses;
}

TEST(DrawnZeroTest, TheMechanismStaysWhereItIsDrawnAndItsCoordinatesAreZeroThere) {
  const Model model = built(bent());
  const auto zero = move_zeros_to_drawing(model);
  ASSERT_TRUE(zero);
  EXPECT_EQ(zero->moved.size(), 6u);
  const Model moved = built(zero->spec);
  VectorXd q, q_moved;
  const std::vector<Pose> before = drawn_poses(model, q), after = drawn_poses(moved, q_moved);
  for (std::size_t b = 0; b < before.size(); ++b) {
    EXPECT_LT((before[b].p - after[b].p).norm(), 1e-12);
    EXPECT_LT((before[b].R - after[b].R).norm(), 1e-12);
  }
  EXPECT_GT(q.head(5).norm(), 0.1);
  EXPECT_LT(q_moved.head(7).cwiseAbs().maxCoeff(), 1e-12);  // of revolute, prismatic, cylindrical and planar joints
  EXPECT_FALSE(move_zeros_to_drawing(moved));
}

TEST(DrawnZeroTest, LimitsMoveAlong) {
  const Model moved = built(move_zeros_to_drawing(built(bent()))->spec);
  EXPECT_NEAR((*moved.joints()[0].limits)[0], -1.3, 1e-12);
  EXPECT_NEAR((*moved.joints()[0].limits)[1], 1.7, 1e-12);
}

TEST(DrawnZeroTest, CoordinatesThatAreCoupledKeepTheirMeaning) {
  ModelSpec spec = bent();
  CouplingSpec coupling;
  coupling.name = "belt";
  coupling.coordinates = {{NameRef("j0"), ""}, {NameRef("j1"), ""}};
  coupling.coefficients = {Number(1), Number(-1)};
  spec.couplings = {coupling};
  EXPECT_FALSE(move_zeros_to_drawing(built(spec)));
}

}  // namespace
}  // namespace ferrers
