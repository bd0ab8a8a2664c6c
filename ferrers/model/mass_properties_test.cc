#include "ferrers/model/mass_properties.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <functional>
#include <random>

namespace ferrers {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// The tensor of a uniform solid by Monte Carlo: points of its bounding box that `inside` accepts, kg each alike.
Matrix3d sampled_inertia(double mass_kg, const Vector3d& half_size,
                         const std::function<bool(const Vector3d&)>& inside) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Matrix3d sum = Matrix3d::Zero();
  int count = 0;
  for (int i = 0; i < 400000; ++i) {
    const Vector3d p = half_size.cwiseProduct(Vector3d(unit(random), unit(random), unit(random)));
    if (!inside(p)) continue;
    sum += p.squaredNorm() * Matrix3d::Identity() - p * p.transpose();
    ++count;
  }
  return mass_kg / count * sum;
}

TEST(MassPropertiesTest, BoxAgreesWithItsIntegral) {
  const Vector3d size(0.4, 1.0, 2.0);
  const Matrix3d sampled = sampled_inertia(3.0, 0.5 * size, [](const Vector3d&) { return true; });
  EXPECT_LT((box_inertia(3.0, size) - sampled).norm(), 0.005 * sampled.norm());
}

TEST(MassPropertiesTest, SphereAgreesWithItsIntegral) {
  const Matrix3d sampled =
      sampled_inertia(2.0, Vector3d::Constant(0.5), [](const Vector3d& p) { return p.norm() < 0.5; });
  EXPECT_LT((sphere_inertia(2.0, 0.5) - sampled).norm(), 0.005 * sampled.norm());
}

TEST(MassPropertiesTest, SkewCylinderAgreesWithItsIntegral) {
  const Vector3d span(1.0, 2.0, 2.0);  // of length 3
  const double radius = 0.8;
  const auto inside = [&](const Vector3d& p) {
    const double along = p.dot(span) / 3.0;
    return std::abs(along) < 1.5 && (p - along * span / 3.0).norm() < radius;
  };
  const Matrix3d sampled = sampled_inertia(5.0, Vector3d::Constant(2.0), inside);
  EXPECT_LT((cylinder_inertia(5.0, span, radius) - sampled).norm(), 0.01 * sampled.norm());
}

TEST(MassPropertiesTest, RodHasNoInertiaAboutItsOwnLine) {
  const Vector3d span(1.0, -2.0, 0.5);
  const Matrix3d I = rod_inertia(2.0, span);
  EXPECT_LT((I * span).norm(), 1e-14);
  const Vector3d across = span.cross(Vector3d::UnitZ()).normalized();
  EXPECT_NEAR(across.dot(I * across), 2.0 * span.squaredNorm() / 12.0, 1e-14);
}

TEST(MassPropertiesTest, ThinCylinderIsARod) {
  const Vector3d span(0.3, 0.1, -0.4);
  EXPECT_LT((cylinder_inertia(1.5, span, 0.0) - rod_inertia(1.5, span)).norm(), 1e-16);
}

TEST(MassPropertiesTest, ProductsAreTheOffDiagonalEntries) {
  const Matrix3d I = inertia_tensor(Vector3d(1, 2, 3), Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(I, I.transpose());
  EXPECT_EQ(I(0, 1), 0.1);
  EXPECT_EQ(I(0, 2), 0.2);
  EXPECT_EQ(I(1, 2), 0.3);
  EXPECT_EQ(I.diagonal(), Vector3d(1, 2, 3));
}

TEST(MassPropertiesTest, TurningABoxByAQuarterExchangesItsMoments) {
  const Matrix3d R = Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitZ()).toRotationMatrix();
  const Matrix3d turned = rotate_inertia(box_inertia(1.0, Vector3d(1, 2, 3)), R);
  EXPECT_LT((turned - box_inertia(1.0, Vector3d(2, 1, 3))).norm(), 1e-14);
}

TEST(MassPropertiesTest, RodsPointsAndFlatPlatesArePhysical) {
  EXPECT_EQ(check_inertia(Matrix3d::Zero()), InertiaVerdict::kPhysical);
  EXPECT_EQ(check_inertia(rod_inertia(1e-6, Vector3d(3, 4, 5))), InertiaVerdict::kPhysical);
  EXPECT_EQ(check_inertia(box_inertia(1e6, Vector3d(3, 4, 0))), InertiaVerdict::kPhysical);
}

TEST(MassPropertiesTest, RoundingOfSevenDigitsIsForgiven) {
  EXPECT_EQ(check_inertia(Vector3d(0, 1.0, 1.0000005).asDiagonal()), InertiaVerdict::kPhysical);
}

TEST(MassPropertiesTest, MomentBeyondTheSumOfTheOthersIsNoBody) {
  EXPECT_EQ(check_inertia(Vector3d(1, 1, 2.01).asDiagonal()), InertiaVerdict::kTriangle);
  EXPECT_EQ(check_inertia(Vector3d(1e-9, 1e-9, 2.01e-9).asDiagonal()), InertiaVerdict::kTriangle);
}

TEST(MassPropertiesTest, LargeProductMakesAPrincipalMomentNegative) {
  EXPECT_EQ(check_inertia(inertia_tensor(Vector3d(1, 1, 1), Vector3d(1.5, 0, 0))), InertiaVerdict::kNegative);
  EXPECT_EQ(check_inertia(Vector3d(-0.1, 1, 1).asDiagonal()), InertiaVerdict::kNegative);
}

TEST(MassPropertiesTest, ProductsCountInTheTriangleInequality) {
  // Diagonal (2, 2, 3.5) alone is fine; the product makes principal moments 0.5, 3.5, 3.5, still fine, then
  // 0.2, 3.8, 3.5.
  EXPECT_EQ(check_inertia(inertia_tensor(Vector3d(2, 2, 3.5), Vector3d(1.5, 0, 0))), InertiaVerdict::kPhysical);
  EXPECT_EQ(check_inertia(inertia_tensor(Vector3d(2, 2, 3.5), Vector3d(1.8, 0, 0))), InertiaVerdict::kTriangle);
}

}  // namespace
}  // namespace ferrers
