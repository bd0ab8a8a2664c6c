#include "ferrers/formats/mjcf_mass.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ferrers::mjcf {
namespace {

constexpr double kPi = 3.14159265358979323846;

Geom make_geom(Shape shape, std::array<double, 3> size, bool shell = false) {
  Geom geom;
  geom.shape = shape;
  geom.size = size;
  geom.shell = shell;
  return geom;
}

TEST(MjcfMassTest, SolidShapesHaveTheirTextbookVolumesAndMoments) {
  const Geom box = make_geom(Shape::kBox, {1, 2, 3});
  EXPECT_DOUBLE_EQ(extent_of(box), 48);
  EXPECT_TRUE(unit_moments(box).isApprox(Vector3d(13, 10, 5) / 3, 1e-15));
  const Geom sphere = make_geom(Shape::kSphere, {2, 0, 0});
  EXPECT_DOUBLE_EQ(extent_of(sphere), 4 * kPi / 3 * 8);
  EXPECT_TRUE(unit_moments(sphere).isApprox(1.6 * Vector3d::Ones(), 1e-15));
  const Geom cylinder = make_geom(Shape::kCylinder, {1, 2, 0});
  EXPECT_DOUBLE_EQ(extent_of(cylinder), 4 * kPi);
  EXPECT_TRUE(unit_moments(cylinder).isApprox(Vector3d(19.0 / 12, 19.0 / 12, 0.5), 1e-15));
  const Geom ellipsoid = make_geom(Shape::kEllipsoid, {1, 2, 3});
  EXPECT_DOUBLE_EQ(extent_of(ellipsoid), 8 * kPi);
  EXPECT_TRUE(unit_moments(ellipsoid).isApprox(Vector3d(13, 10, 5) / 5, 1e-15));
}

TEST(MjcfMassTest, ACapsuleWithoutLengthIsASphereAndAThinOneIsARod) {
  for (const bool shell : {false, true}) {
    const Geom sphere = make_geom(Shape::kSphere, {2, 0, 0}, shell);
    const Geom short_capsule = make_geom(Shape::kCapsule, {2, 0, 0}, shell);
    EXPECT_DOUBLE_EQ(extent_of(short_capsule), extent_of(sphere));
    EXPECT_TRUE(unit_moments(short_capsule).isApprox(unit_moments(sphere), 1e-14));
    const Geom thin = make_geom(Shape::kCapsule, {1e-9, 3, 0}, shell);
    EXPECT_NEAR(unit_moments(thin).x(), 3, 1e-7);  // length² / 12
  }
}

TEST(MjcfMassTest, ShellsOfCubeSphereAndTubeHaveTheirTextbookMoments) {
  const Geom cube = make_geom(Shape::kBox, {0.5, 0.5, 0.5}, true);
  EXPECT_DOUBLE_EQ(extent_of(cube), 6);
  EXPECT_TRUE(unit_moments(cube).isApprox(5.0 / 18 * Vector3d::Ones(), 1e-14));
  const Geom round = make_geom(Shape::kEllipsoid, {2, 2, 2}, true);
  EXPECT_NEAR(extent_of(round), 16 * kPi, 1e-12);
  EXPECT_TRUE(unit_moments(round).isApprox(8.0 / 3 * Vector3d::Ones(), 1e-14));
  const Geom can = make_geom(Shape::kCylinder, {1, 1, 0}, true);  // a third of it are the ends
  EXPECT_TRUE(unit_moments(can).isApprox(Vector3d(35, 35, 30) / 36, 1e-14));
  const Geom tube = make_geom(Shape::kCylinder, {1, 1e9, 0}, true);
  EXPECT_NEAR(unit_moments(tube).z(), 1, 1e-8);
  const Geom disk = make_geom(Shape::kCylinder, {1, 1e-12, 0}, true);
  EXPECT_TRUE(unit_moments(disk).isApprox(Vector3d(0.25, 0.25, 0.5), 1e-11));
}

TEST(MjcfMassTest, TwoHalvesOfABoxAreTheBox) {
  Geom left = make_geom(Shape::kBox, {0.5, 1, 1});
  Geom right = left;
  left.X_BG.p = {-0.5, 0, 7};
  right.X_BG = {Eigen::AngleAxisd(kPi / 2, Vector3d::UnitX()).toRotationMatrix(), {0.5, 0, 7}};
  Geom whole = make_geom(Shape::kBox, {1, 1, 1});
  whole.X_BG.p = {0, 0, 7};
  const MassProperties sum = mass_of({left, right}), one = mass_of({whole});
  EXPECT_DOUBLE_EQ(sum.mass, 8000);
  EXPECT_TRUE(sum.com.isApprox(one.com, 1e-14));
  EXPECT_TRUE(sum.inertia.isApprox(one.inertia, 1e-13));
}

TEST(MjcfMassTest, PlanesWeighNothingAndTheMassOfAMeshIsUnknownUnlessItIsZero) {
  EXPECT_EQ(mass_of({make_geom(Shape::kPlane, {1, 1, 1})}).mass, 0);
  Geom mesh = make_geom(Shape::kMesh, {0, 0, 0});
  mesh.sized = false;
  EXPECT_TRUE(is_unknown(mesh));
  mesh.mass = 0;
  EXPECT_FALSE(is_unknown(mesh));
}

TEST(MjcfMassTest, BoundsRaiseMassAndMomentsAndBalancingMakesThemEqual) {
  MassProperties mass;
  mass.mass = 1;
  mass.inertia = Vector3d(1, 2, 9).asDiagonal();
  Settings settings;
  settings.bound_mass = 3;
  settings.bound_inertia = 1.5;
  apply_bounds(settings, mass);
  EXPECT_EQ(mass.mass, 3);
  EXPECT_TRUE(mass.inertia.isApprox(Matrix3d(Vector3d(1.5, 2, 9).asDiagonal()), 1e-14));
  settings.balance_inertia = true;
  apply_bounds(settings, mass);
  EXPECT_TRUE(mass.inertia.isApprox(12.5 / 3 * Matrix3d::Identity(), 1e-14));
}

}  // namespace
}  // namespace ferrers::mjcf
