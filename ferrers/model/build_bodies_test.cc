#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "ferrers/model/mass_properties.h"
#include "ferrers/testing/build_checks.h"
#include "ferrers/testing/zoo_parts.h"

namespace ferrers {
namespace {

using namespace witness;  // NOLINT(google-build-using-namespace): a test's vocabulary
using testing::HasSubstr;

/// One body, free to move.
ModelSpec one_body(BodySpec body) {
  ModelSpec spec;
  body.name = "block";
  spec.joints.push_back(joint(JointType::kFree, "base", "ground", "block", Point::Zero()));
  spec.joints[0].place = {};
  spec.bodies.push_back(std::move(body));
  return spec;
}

BodySpec massive(double mass, InertiaSpec inertia = {}) {
  BodySpec body;
  body.mass = mass;
  body.com = number3(1, 2, 3);
  body.inertia = std::move(inertia);
  return body;
}

InertiaSpec tensor(const Number3& moments, const Number3& products = {}) {
  InertiaSpec inertia;
  inertia.kind = InertiaSpec::Kind::kTensor;
  inertia.moments = moments;
  inertia.products = products;
  return inertia;
}

InertiaSpec spanned(InertiaSpec::Kind kind, const Number3& from, const Number3& to, double radius = 0) {
  InertiaSpec inertia;
  inertia.kind = kind;
  inertia.from = from;
  inertia.to = to;
  inertia.radius = radius;
  return inertia;
}

RotationSpec about_z(double angle) {
  RotationSpec rotation;
  rotation.axis_angle = {number3(0, 0, 2), Number(angle)};
  return rotation;
}

const Body& block(const Model& model) { return model.bodies().at(1); }

TEST(BuildBodiesTest, GroundIsTheFirstBodyAndOrderIsKept) {
  const Model model = built(one_body(massive(2.0)));
  EXPECT_EQ(model.body(kGround).name, "ground");
  EXPECT_EQ(block(model).name, "block");
  EXPECT_EQ(block(model).mass_kg, 2.0);
  EXPECT_EQ(block(model).com_m, Vector3d(1, 2, 3));
  EXPECT_EQ(block(model).inertia_kgm2, Matrix3d::Zero());
  EXPECT_EQ(block(model).X_WB.R, Matrix3d::Identity());
}

TEST(BuildBodiesTest, ShapeWithEndPointsGivesItsMiddleAsMassCentre) {
  BodySpec body = massive(3.0, spanned(InertiaSpec::Kind::kRod, number3(1, 0, 0), number3(1, 4, 0)));
  body.com.reset();
  const Model model = built(one_body(body));
  EXPECT_EQ(block(model).com_m, Vector3d(1, 2, 0));
  EXPECT_EQ(block(model).inertia_kgm2, rod_inertia(3.0, Vector3d(0, 4, 0)));
}

TEST(BuildBodiesTest, CentreOffTheMiddleOfItsShapeIsAWarning) {
  const BodySpec body = massive(3.0, spanned(InertiaSpec::Kind::kRod, number3(1, 0, 0), number3(1, 4, 0)));
  const ModelBuildResult result = build_model(one_body(body));
  EXPECT_EQ(codes(result.diagnostics), Codes{"F333"});
  ASSERT_TRUE(result.model);
  EXPECT_EQ(block(*result.model).com_m, Vector3d(1, 2, 3));
}

TEST(BuildBodiesTest, ShapesUseTheirOwnFormula) {
  InertiaSpec box;
  box.kind = InertiaSpec::Kind::kBox;
  box.size = number3(1, 2, 3);
  box.rotation = about_z(M_PI / 2);
  EXPECT_LT((block(built(one_body(massive(2.0, box)))).inertia_kgm2 - box_inertia(2.0, Vector3d(2, 1, 3))).norm(),
            1e-14);
  InertiaSpec sphere;
  sphere.kind = InertiaSpec::Kind::kSphere;
  sphere.radius = 0.5;
  EXPECT_EQ(block(built(one_body(massive(2.0, sphere)))).inertia_kgm2, sphere_inertia(2.0, 0.5));
  const InertiaSpec cylinder = spanned(InertiaSpec::Kind::kCylinder, number3(1, 2, 2), number3(1, 2, 4), 0.3);
  EXPECT_EQ(block(built(one_body(massive(2.0, cylinder)))).inertia_kgm2, cylinder_inertia(2.0, Vector3d(0, 0, 2), 0.3));
}

TEST(BuildBodiesTest, PoseKeepsCentreAndInertiaInTheBodyFrame) {
  BodySpec body = massive(1.0, tensor(number3(1, 2, 3)));
  body.pose = PoseSpec{number3(5, 0, 0), about_z(M_PI / 2), {}};
  const Model model = built(one_body(body));
  EXPECT_EQ(block(model).com_m, Vector3d(1, 2, 3));
  EXPECT_EQ(block(model).inertia_kgm2(0, 0), 1.0);
  EXPECT_LT((block(model).X_WB * Vector3d::UnitX() - Vector3d(5, 1, 0)).norm(), 1e-15);
}

TEST(BuildBodiesTest, QuaternionIsWFirstAndMustBeAUnit) {
  BodySpec body = massive(1.0);
  RotationSpec rotation;
  const double half = std::sqrt(0.5);
  rotation.quaternion = {Number(half), Number(0), Number(0), Number(half)};
  body.pose = PoseSpec{number3(0, 0, 0), rotation, {}};
  EXPECT_LT((block(built(one_body(body))).X_WB.R.col(0) - Vector3d::UnitY()).norm(), 1e-15);
  body.pose->rotation->quaternion = {Number(0.5), Number(0), Number(0), Number(0.5)};
  EXPECT_EQ(build_codes(one_body(body)), Codes{"F327"});
  body.pose->rotation->axis_angle = about_z(1).axis_angle;
  EXPECT_EQ(build_codes(one_body(body)), Codes{"F327"});
}

TEST(BuildBodiesTest, ZeroAxisOfARotationIsAnError) {
  BodySpec body = massive(1.0);
  RotationSpec rotation;
  rotation.axis_angle = {number3(0, 0, 0), Number(1)};
  body.pose = PoseSpec{number3(0, 0, 0), rotation, {}};
  EXPECT_EQ(build_codes(one_body(body)), Codes{"F318"});
}

TEST(BuildBodiesTest, MassMayBeLeftOutButNotWithAnInertia) {
  BodySpec body;
  EXPECT_FALSE(block(built(one_body(body))).has_mass);
  body.inertia = tensor(number3(1, 1, 1));
  EXPECT_EQ(build_codes(one_body(body)), Codes{"F313"});
}

TEST(BuildBodiesTest, MassNeedsAMassCentre) {
  BodySpec body = massive(1.0);
  body.com.reset();
  EXPECT_EQ(build_codes(one_body(body)), Codes{"F312"});
}

TEST(BuildBodiesTest, NegativeMassAndSizesAreErrors) {
  EXPECT_EQ(build_codes(one_body(massive(-1.0))), Codes{"F311"});
  InertiaSpec sphere;
  sphere.kind = InertiaSpec::Kind::kSphere;
  sphere.radius = -0.5;
  EXPECT_EQ(build_codes(one_body(massive(1.0, sphere))), Codes{"F311"});
}

TEST(BuildBodiesTest, NonPhysicalInertiaIsAnErrorAndRodsAreFine) {
  EXPECT_EQ(build_codes(one_body(massive(1.0, tensor(number3(1, 1, 3))))), Codes{"F314"});
  EXPECT_EQ(build_codes(one_body(massive(1.0, tensor(number3(1, 1, 1), number3(2, 0, 0))))), Codes{"F314"});
  EXPECT_EQ(build_codes(one_body(massive(1.0, tensor(number3(0, 1, 1))))), Codes{});
}

TEST(BuildBodiesTest, RodOfNoLengthAndCylinderWithoutEndsAreErrors) {
  BodySpec body = massive(1.0, spanned(InertiaSpec::Kind::kRod, number3(1, 2, 3), number3(1, 2, 3)));
  EXPECT_EQ(build_codes(one_body(body)), Codes{"F321"});
  body.inertia.to.reset();
  EXPECT_EQ(build_codes(one_body(body)), Codes{"F317"});
}

TEST(BuildBodiesTest, InertiaWithoutMassIsNoticed) {
  EXPECT_EQ(build_codes(one_body(massive(0.0, tensor(number3(1, 1, 1))))), Codes{"F333"});
}

TEST(BuildBodiesTest, BodyWithoutAJointIsAnError) {
  ModelSpec spec = one_body(massive(1.0));
  BodySpec loose = massive(1.0);
  loose.name = NameRef("loose", {7, 3, 5});
  spec.bodies.push_back(loose);
  const ModelBuildResult result = build_model(spec);
  ASSERT_EQ(codes(result.diagnostics), Codes{"F315"});
  EXPECT_EQ(result.diagnostics.items()[0].at.line, 7);
  EXPECT_THAT(result.diagnostics.items()[0].hint, HasSubstr("free"));
}

TEST(BuildBodiesTest, NamesAreCheckedAndGroundIsTaken) {
  ModelSpec spec = one_body(massive(1.0));
  for (const char* name : {"ground", "block", "bad name"}) {
    BodySpec body = massive(1.0);
    body.name = name;
    spec.bodies.push_back(body);
  }
  spec.joints.push_back(joint(JointType::kSpherical, "k", "ground", "bad name", Point::Zero()));
  const Codes found = build_codes(spec);
  EXPECT_EQ(found, (Codes{"F301", "F302", "F301"})) << messages(build_model(spec).diagnostics);
}

TEST(BuildBodiesTest, AllErrorsComeAtOnce) {
  ModelSpec spec = one_body(massive(-1.0, tensor(number3(1, 1, 3))));
  spec.joints.push_back(joint(JointType::kRevolute, "pin", "nobody", "block", Point::Zero()));
  spec.gravity[0] = NAN;
  EXPECT_THAT(build_codes(spec), testing::UnorderedElementsAre("F311", "F303", "F309"));
}

}  // namespace
}  // namespace ferrers
