#include "ferrers/math/rotation.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <stdexcept>

namespace ferrers {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

double rotation_error(const Matrix3d& R) {
  return std::max((R.transpose() * R - Matrix3d::Identity()).norm(), std::abs(R.determinant() - 1));
}

Vector3d random_vector(double scale) {
  const auto entry = [scale] { return *rc::gen::inRange(-1000000, 1000001) * 1e-6 * scale; };
  const double x = entry(), y = entry(), z = entry();
  return {x, y, z};
}

TEST(RotationTest, TheDefaultXAxisIsTheWorldAxisLeastAlignedWithZ) {
  EXPECT_TRUE(frame_from_z(Vector3d::UnitZ()).isApprox(Matrix3d::Identity()));
  EXPECT_TRUE(frame_from_z(Vector3d::UnitX()).col(0).isApprox(Vector3d::UnitY()));
  EXPECT_TRUE(frame_from_z(Vector3d::UnitY()).col(0).isApprox(Vector3d::UnitX()));
  EXPECT_TRUE(frame_from_z(-Vector3d::UnitZ()).col(0).isApprox(Vector3d::UnitX()));
  const Vector3d tilted = Vector3d(3, 1, 2).normalized();
  EXPECT_GT(frame_from_z(tilted).col(0).y(), 0.9);
}

TEST(RotationTest, TiesGoToTheFirstAxisEvenThroughRounding) {
  for (const double noise : {0.0, 1e-16, -1e-16, 3e-12, -3e-12}) {
    const Vector3d diagonal = Vector3d(1 + noise, 1, 1 - noise).normalized();
    const Vector3d x = frame_from_z(diagonal).col(0);
    EXPECT_GT(x.x(), std::max(x.y(), x.z())) << noise;
  }
}

RC_GTEST_PROP(RotationTest, FrameFromZIsARotationWithThatZ, ()) {
  const Vector3d v = random_vector(1);
  RC_PRE(v.norm() > 1e-3);
  const Vector3d z = v.normalized();
  const Matrix3d R = frame_from_z(z);
  RC_ASSERT(rotation_error(R) < 1e-14);
  RC_ASSERT((R.col(2) - z).norm() < 1e-15);
}

RC_GTEST_PROP(RotationTest, FrameFromZxKeepsZAndLeansXTowardsX, ()) {
  const double scale = std::pow(10.0, *rc::gen::inRange(-200, 200));
  const Vector3d z = random_vector(scale), x = random_vector(1 / scale);
  RC_PRE(z.norm() > 1e-3 * scale && x.norm() > 1e-3 / scale);
  const Vector3d unit_z = (z / scale).normalized(), unit_x = (x * scale).normalized();
  RC_PRE(unit_z.cross(unit_x).norm() > 1e-6);
  const Matrix3d R = frame_from_zx(z, x);
  RC_ASSERT(rotation_error(R) < 1e-14);
  RC_ASSERT((R.col(2) - unit_z).norm() < 1e-14);
  RC_ASSERT(R.col(0).dot(unit_x) > 0);
  RC_ASSERT(std::abs(R.col(1).dot(unit_x)) < 1e-9);
}

TEST(RotationTest, FramesOfNoDirectionAreTheCallersMistake) {
  EXPECT_THROW(frame_from_z(Vector3d::Zero()), std::invalid_argument);
  EXPECT_THROW(frame_from_z(Vector3d(2, 0, 0)), std::invalid_argument);
  EXPECT_THROW(frame_from_zx(Vector3d::Zero(), Vector3d::UnitX()), std::invalid_argument);
  EXPECT_THROW(frame_from_zx(Vector3d::UnitX(), Vector3d::Zero()), std::invalid_argument);
  EXPECT_THROW(frame_from_zx(Vector3d(1, 2, 3), Vector3d(-2, -4, -6)), std::invalid_argument);
  EXPECT_THROW(frame_from_zx(Vector3d(NAN, 2, 3), Vector3d::UnitX()), std::invalid_argument);
}

RC_GTEST_PROP(RotationTest, ExponentialAndLogarithmUndoEachOther, ()) {
  const Vector3d w = random_vector(std::pow(10.0, *rc::gen::inRange(-12, 1)) * 1.7);
  RC_PRE(w.norm() < 3.1);
  const Vector3d back = rotation_log(quaternion_exp(w).toRotationMatrix());
  RC_ASSERT((back - w).norm() < 1e-13 + 1e-14 / (3.15 - w.norm()));
}

TEST(RotationTest, APoseTimesItsInverseIsNothing) {
  const Pose X(quaternion_exp({0.3, -1.1, 0.7}).toRotationMatrix(), {1, 2, 3});
  const Pose I = X * X.inverse();
  EXPECT_LT((I.R - Matrix3d::Identity()).norm() + I.p.norm(), 1e-14);
  const Vector3d a(1, -2, 0.5), b(0.3, 4, -1);
  EXPECT_LT((cross_matrix(a) * b - a.cross(b)).norm(), 1e-15);
}

}  // namespace
}  // namespace ferrers
